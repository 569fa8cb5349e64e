#include "measure/attribution/range_on_tape.hpp"

#include <algorithm>

#include "intersect/table/in_range.hpp"
#include "number/recorded.hpp"
#include "number/recorders/tape_recorder.hpp"

namespace lostbits::measure::attribution {
namespace {

NodeId input_of(const Tape& tape, std::ptrdiff_t index) {
    for (NodeId i = 0; i < tape.size(); ++i)
        if (tape[i].op == TapeOp::input && tape[i].operands[0] == index) return i;
    return no_node;
}

}  // namespace

void append_range_checks(Tape& tape, std::vector<std::string>& names, const intersect::table::Intersector& form,
                         const Format& format, const Range<double>& ray_range) {
    if (ray_range.is_whole()) return;
    const NodeId tmin = tape.add_input(format.parameters, ray_range.tmin);
    names.emplace_back("ray.tmin");
    const auto range = intersect::table::compared_range(*form.info, form.shape, ray_range);
    if (range.is_whole()) return;
    const auto end = std::ranges::find(names, "ray.tmax");
    const NodeId tmax = input_of(tape, end - names.begin());
    number::recorders::TapeRecorder recorder(tape, format.parameters);
    const auto recorded = [](NodeId i) { return Recorded::at(i); };
    const TapeOutputs form_outputs = tape.outputs;
    const Hit<Recorded> checked_hit =
        intersect::table::limit_to_range(*form.info, form.shape, range, recorded(tmin), recorded(tmax),
                                         Hit<Recorded>{RecordedMask(form_outputs.hit), recorded(form_outputs.t),
                                                       recorded(form_outputs.near), recorded(form_outputs.far)});
    tape.outputs = {checked_hit.hit.node(), checked_hit.t.node(), form_outputs.near, form_outputs.far};
}

}  // namespace lostbits::measure::attribution
