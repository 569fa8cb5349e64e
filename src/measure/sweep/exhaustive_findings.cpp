#include "measure/sweep/exhaustive_findings.hpp"

#include "measure/sweep/axis_columns.hpp"
#include "measure/sweep/box_of_row.hpp"
#include "measure/sweep/exhaustive_block.hpp"
#include "measure/sweep/mesh_floats.hpp"
#include "measure/truth/lost_bits.hpp"

namespace lostbits::measure::sweep {

FloatAnswer answer_at(const ExhaustiveRequest& request, std::size_t ray, std::size_t row, std::uint32_t place) {
    if (request.sweep->mesh) {
        const auto truths = rows_by_truth(request.rows, request.limit);
        const MeshAnswer there = mesh_answer_at({*request.sweep, request.rows, truths, ray, {place, place}}, row);
        return {there.outcome, static_cast<float>(there.t), there.truth, there.ulps};
    }
    const evaluate::TestedForm& form = request.rows[row];
    const bool unit = form.form->info->direction == intersect::Direction::unit;
    const truth::Length length = unit ? truth::Length::distance : truth::Length::parameter;
    const float value = scene::sweep::float_at(place);
    AxisColumns columns(*request.sweep, ray, 1);
    columns.set(std::span(&value, 1));
    float t = 0;
    std::uint8_t hit = 0;
    columns.answer(form, std::span(&t, 1), std::span(&hit, 1));
    const truth::Truth truth =
        columns.find_truth(0, {form.convention(), length, truth::Tightness::certified, request.limit});
    FloatAnswer found{answer::classify(truth.decision, hit != 0, static_cast<double>(t)),
                      hit != 0 ? t : std::numeric_limits<float>::quiet_NaN()};
    if (truth.is_hit()) {
        const scene::rays::RayGroup group = request.sweep->group_at(ray, value);
        found.truth = truth::round_truth(truth, group.rays[0], group.solids[0], binary64, length, form.convention(),
                                         group.rays.range(0));
    }
    if (found.outcome == answer::Outcome::agree_hit)
        found.ulps = truth::ulp_error(static_cast<double>(t), unit ? truth.distance : truth.t, binary32);
    return found;
}

double padding_max(const evaluate::TestedForm& row, const FloatTally& tally) {
    if (!BoxOfRow(row).is_asked()) return truth::missing;
    return tally.padding ? tally.padding->u : 0;
}

std::optional<std::uint32_t> RangeFinding::before(std::uint32_t place) const {
    const std::uint64_t steps = floats.steps_to(place);
    if (steps == 0) return std::nullopt;
    return floats.at(steps - 1);
}

std::vector<RangeFinding> findings_of(const ExhaustiveRequest& request, const ExhaustiveState& state) {
    const auto binades = binades_of(*request.sweep);
    std::vector<RangeFinding> all;
    for (std::size_t row = 0; row < request.rows.size(); ++row) {
        for (std::size_t ray = 0; ray < request.sweep->rays.size(); ++ray) {
            for (std::size_t range = 0; range < request.sweep->ranges().size(); ++range) {
                RangeFinding found{range, ray, row, request.sweep->ranges()[range], {}};
                for (std::size_t b = 0; b < binades.size(); ++b) {
                    if (binades[b].range == range) found.tally.append(state.tallies[request.place(b, ray, row)]);
                }
                all.push_back(std::move(found));
            }
        }
    }
    return all;
}

}  // namespace lostbits::measure::sweep
