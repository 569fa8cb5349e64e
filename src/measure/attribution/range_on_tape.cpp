#include "measure/attribution/range_on_tape.hpp"

#include <algorithm>

#include "intersect/table/in_range.hpp"
#include "number/recorded.hpp"
#include "number/recorders/tape_recorder.hpp"

namespace lostbits::measure::attribution {
namespace {

NodeId input_of(const Tape& tape, std::ptrdiff_t number) {
    for (NodeId i = 0; i < tape.size(); ++i)
        if (tape[i].op == TapeOp::input && tape[i].operands[0] == number) return i;
    return no_node;
}

}  // namespace

void append_range_checks(Tape& tape, std::vector<std::string>& names, const intersect::table::Intersector& form,
                         const Format& format, const Range<double>& given) {
    if (given.is_whole()) return;
    const NodeId tmin = tape.add_input(format.parameters, given.tmin);
    names.emplace_back("ray.tmin");
    const auto range = intersect::table::range_to_ask(*form.info, form.shape, given);
    if (range.is_whole()) return;
    const auto end = std::ranges::find(names, "ray.tmax");
    const NodeId tmax = input_of(tape, end - names.begin());
    number::recorders::TapeRecorder recorder(tape, format.parameters);
    const auto at = [](NodeId i) { return Recorded::at(i); };
    const TapeOutputs said = tape.outputs;
    const Hit<Recorded> kept =
        intersect::table::in_range(*form.info, form.shape, range, at(tmin), at(tmax),
                                   Hit<Recorded>{RecordedMask(said.hit), at(said.t), at(said.near), at(said.far)});
    tape.outputs = {kept.hit.node(), kept.t.node(), said.near, said.far};
}

}  // namespace lostbits::measure::attribution
