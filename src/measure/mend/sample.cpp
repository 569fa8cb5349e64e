#include "measure/mend/sample.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "measure/blame/attribution.hpp"
#include "measure/blame/rerun.hpp"
#include "measure/choice/candidates.hpp"
#include "measure/tape/tape_form.hpp"

namespace lostbits::measure::mend {

namespace {

/// With the direction along the axis that it is nearest to.
std::vector<double> along_axis(std::vector<double> numbers) {
    const auto d = numbers.begin() + 3;
    const auto largest = std::max_element(d, d + 3, [](double a, double b) { return std::fabs(a) < std::fabs(b); });
    const double one = std::copysign(1, *largest);
    std::fill(d, d + 3, 0.0);
    *largest = one;
    return numbers;
}

/// At most so many of the rays, evenly.
scene::rays::RayGroup some_of(const scene::rays::RayGroup& all, int rays) {
    const std::size_t step = (all.rays.size() + static_cast<std::size_t>(rays) - 1) / static_cast<std::size_t>(rays);
    scene::rays::RayGroup some{.rays = {}, .solids = all.paired ? std::vector<Solid<double>>() : all.solids};
    some.paired = all.paired;
    for (std::size_t i = 0; i < all.rays.size(); i += step) {
        some.rays.push(all.rays[i]);
        some.rays.push_range(all.rays, i);
        if (all.paired) some.solids.push_back(all.solids[i]);
    }
    some.rays.width = static_cast<int>(some.rays.size());
    some.rays.y1 = 1;
    return some;
}

}  // namespace

bool divides_by_zero(const Tape& tape) {
    return std::ranges::any_of(
        tape.nodes, [&](const TapeNode& n) { return n.op == TapeOp::div && tape[n.operands[1]].value == 0; });
}

Tape filled(Tape tape, const std::vector<double>& inputs, bool rounds) {
    for (TapeNode& n : tape.nodes)
        if (n.op == TapeOp::input) n.value = inputs.at(static_cast<std::size_t>(n.operands[0]));
    const blame::Rerun run(tape, [rounds](NodeId) { return rounds; });
    for (NodeId i = 0; i < tape.size(); ++i) tape[i].value = run[i];
    return tape;
}

RaySample::RaySample(const MendRequest& request, int rays) {
    const evaluate::TestedForm& row = request.row;
    std::optional<scene::file::Scene> thin;
    if (request.scene) thin = choice::thinned(*request.scene, rays);
    const truth::Band band = thin ? truth::Band(*thin, 0, thin->height, request.limit)
                                  : truth::Band(some_of(request.rays->sample, rays), request.limit);
    const auto inputs = band.inputs(row.format, choice::needs_of(row));
    const auto& own = inputs.rays_for(*row.form->info);
    const bool unit = row.form->info->direction == intersect::Direction::unit;
    for (std::size_t i = 0; i < band.pixels(); ++i) {
        const auto truth = band.truth(i, row.convention());
        const std::size_t solid = inputs.paired ? i : truth.is_hit() ? static_cast<std::size_t>(truth.object) : 0;
        inputs_.push_back(tape::inputs_of(own[i], inputs.solids[solid], band.range(i).tmax));
        exact_inputs_.push_back(unit ? along_axis(inputs_.back()) : inputs_.back());
    }
}

std::vector<int> RaySample::culprits(Tape tape) const {
    std::vector<int> counts(tape.nodes.size());
    for (const auto& inputs : inputs_) {
        tape = filled(std::move(tape), inputs, true);
        const auto found = blame::attribute(tape);
        if (found.culprit != no_node) ++counts[static_cast<std::size_t>(found.culprit)];
    }
    return counts;
}

bool RaySample::agree(const Tape& a, const Tape& b) const {
    for (const auto& inputs : exact_inputs_) {
        const Tape one = filled(a, inputs, false), other = filled(b, inputs, false);
        if (divides_by_zero(one) || divides_by_zero(other)) continue;
        const bool hit = one[one.outputs.hit].value != 0;
        if (hit != (other[other.outputs.hit].value != 0)) return false;
        const double t = one[one.outputs.t].value, s = other[other.outputs.t].value;
        if (hit && !(std::fabs(t - s) <= 0x1p-45 * std::fabs(t))) return false;
    }
    return true;
}

}  // namespace lostbits::measure::mend
