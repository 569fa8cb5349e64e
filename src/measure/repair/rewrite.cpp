#include "measure/repair/repair.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "measure/answer/owners.hpp"
#include "measure/attribution/attribution.hpp"
#include "measure/attribution/rerun.hpp"
#include "measure/choice/candidates.hpp"
#include "measure/tape/tape_form.hpp"

namespace lostbits::measure::repair {

using identity::Rewrite;
using identity::Terms;
using identity::Triple;

namespace {

/// Inputs with the direction replaced by the unit vector of the axis that it is nearest to.
std::vector<double> along_axis(std::vector<double> numbers) {
    const auto d = numbers.begin() + 3;
    const auto largest = std::max_element(d, d + 3, [](double a, double b) { return std::fabs(a) < std::fabs(b); });
    const double one = std::copysign(1, *largest);
    std::fill(d, d + 3, 0.0);
    *largest = one;
    return numbers;
}

struct Candidate {
    TapeOutputs outputs;
    std::vector<const Rule*> rules = {};
    RowQuality quality{};
    std::size_t work = 0;
    bool expanded = false;
};

class RewriteSearch {
public:
    RewriteSearch(const RepairRequest& request, const Tape& form, const RowQuality& own, Judge& judge,
                  const SearchLimit& limit)
        : request_(request), limit_(limit), form_(form), terms_(form), judge_(judge), sample_(request) {
        if (request.row.form->info->direction == intersect::Direction::unit) unit_ = direction_of(terms_);
        all_.push_back({.outputs = terms_.outputs(), .quality = own, .work = work_of(form)});
        seen_.insert(identity::all_of(terms_.outputs()));
    }

    Rewriting done() {
        for (std::size_t round = 0; round < limit_.rounds; ++round)
            if (!next_round()) break;
        return {.found = front(), .tried = judge_.tried() - before_, .refused = refused_};
    }

private:
    bool next_round() {
        std::vector<Candidate> fresh;
        for (const std::size_t k : promising()) {
            all_[k].expanded = true;
            for (Candidate& one : candidates_from(all_[k])) fresh.push_back(std::move(one));
        }
        std::vector<Tape> tapes;
        std::erase_if(fresh, [&](Candidate& one) {
            const Tape tape = terms_.tape(one.outputs);
            one.work = work_of(tape);
            if (!sample_.agree(form_, tape)) return ++refused_, true;
            tapes.push_back(tape);
            return false;
        });
        const auto quality = judge_.quality_of(tapes);
        for (std::size_t k = 0; k < fresh.size(); ++k) fresh[k].quality = quality[k];
        std::ranges::move(fresh, std::back_inserter(all_));
        return !fresh.empty();
    }

    [[nodiscard]] bool meets(const Candidate& one) const { return one.quality.meets(request_.requirement); }
    static bool is_better(const Candidate& a, const Candidate& b) {
        if (is_more_accurate(a.quality, b.quality) || is_more_accurate(b.quality, a.quality))
            return is_more_accurate(a.quality, b.quality);
        return a.work < b.work;
    }

    /// Indices of the candidates to rewrite next: of those not rewritten yet, the most accurate ones, and those that
    /// meet the requirement with least work.
    [[nodiscard]] std::vector<std::size_t> promising() const {
        std::vector<std::size_t> open;
        for (std::size_t k = 0; k < all_.size(); ++k)
            if (!all_[k].expanded) open.push_back(k);
        std::ranges::stable_sort(open, [&](auto a, auto b) { return is_better(all_[a], all_[b]); });
        std::vector<std::size_t> chosen(open.begin(),
                                        open.begin() + static_cast<std::ptrdiff_t>(std::min(limit_.beam, open.size())));
        std::ranges::stable_sort(open, [&](auto a, auto b) {
            return std::pair(!meets(all_[a]), all_[a].work) < std::pair(!meets(all_[b]), all_[b].work);
        });
        for (std::size_t k = 0; k < std::min(limit_.beam, open.size()); ++k)
            if (meets(all_[open[k]]) && std::ranges::find(chosen, open[k]) == chosen.end()) chosen.push_back(open[k]);
        return chosen;
    }

    /// Candidates that are one rewrite away from this one. Rewrites of what loses most bits come first.
    std::vector<Candidate> candidates_from(const Candidate& from) {
        std::vector<NodeId> origins;
        const Tape tape = terms_.tape(from.outputs, &origins);
        const std::vector<int> culprits = sample_.culprits(tape);
        std::map<NodeId, int> losses;
        for (std::size_t k = 0; k < origins.size(); ++k) losses[origins[k]] = culprits[k];
        auto rewrites = rewrites_of(terms_, from.outputs, unit_);
        std::vector<std::pair<int, std::size_t>> order;
        for (std::size_t k = 0; k < rewrites.size(); ++k) order.emplace_back(-lost_in(rewrites[k], losses), k);
        std::ranges::stable_sort(order, {}, [](const auto& x) { return x.first; });
        std::vector<Candidate> made;
        for (const auto& [loss, k] : order) {
            if (made.size() == limit_.places) break;
            const TapeOutputs outputs = terms_.with_replaced(from.outputs, rewrites[k].replaced);
            if (!seen_.insert(identity::all_of(outputs)).second) continue;
            made.push_back({.outputs = outputs, .rules = from.rules});
            made.back().rules.push_back(rewrites[k].rule);
        }
        return made;
    }
    [[nodiscard]] int lost_in(const Rewrite& rewrite, const std::map<NodeId, int>& losses) const {
        int lost = 0;
        for (const auto& [old, now] : rewrite.replaced)
            for (const NodeId i : terms_.needed({old, old, old, old}))
                if (const auto found = losses.find(i); found != losses.end()) lost = std::max(lost, found->second);
        return lost;
    }

    /// Candidates that meet the requirement and that no other beats in both accuracy and work; where none meets it, the
    /// most accurate one.
    [[nodiscard]] std::vector<Rewritten> front() const {
        std::vector<const Candidate*> order;
        for (const Candidate& one : all_) order.push_back(&one);
        std::ranges::stable_sort(order, [](auto a, auto b) { return is_better(*a, *b); });
        std::vector<Rewritten> found;
        std::size_t least = SIZE_MAX;
        for (const Candidate* one : order) {
            // The list is in order: nothing after the form itself is more accurate, or as accurate with less work.
            if (one->rules.empty() || found.size() == limit_.proposals || (!found.empty() && !meets(*one))) break;
            if (one->work >= least) continue;
            least = one->work;
            const Tape tape = terms_.tape(one->outputs);
            found.push_back({.tape = tape,
                             .rules = one->rules,
                             .quality = one->quality,
                             .operations = tape::rounded_operations(tape).size()});
        }
        return found;
    }

    const RepairRequest& request_;
    SearchLimit limit_;
    const Tape& form_;
    Terms terms_;
    Judge& judge_;
    const std::uint64_t before_ = judge_.tried();
    RaySample sample_;
    std::optional<Triple> unit_;
    std::vector<Candidate> all_;
    std::set<std::array<NodeId, 4>> seen_;
    std::uint64_t refused_ = 0;
};

}  // namespace

bool divides_by_zero(const Tape& tape) {
    return std::ranges::any_of(
        tape.nodes, [&](const TapeNode& n) { return n.op == TapeOp::div && tape[n.operands[1]].value == 0; });
}

Tape filled(Tape tape, const std::vector<double>& inputs, bool rounds) {
    for (TapeNode& n : tape.nodes)
        if (n.op == TapeOp::input) n.value = inputs.at(static_cast<std::size_t>(n.operands[0]));
    const attribution::Rerun run(tape, [rounds](NodeId) { return rounds; });
    for (NodeId i = 0; i < tape.size(); ++i) tape[i].value = run[i];
    return tape;
}

RaySample::RaySample(const RepairRequest& request, int rays)
    : row_(request.row), requirement_(request.requirement), limit_(request.limit) {
    const evaluate::TestedForm& row = request.row;
    std::optional<scene::file::Scene> thin;
    if (request.scene) thin = choice::with_smaller_picture(*request.scene, rays);
    const truth::Band band =
        thin ? truth::Band(*thin, 0, thin->height, request.limit)
             : truth::Band(some_of(request.rays->sample, static_cast<std::size_t>(rays)), request.limit);
    const auto inputs = band.inputs_for(row.format, *row.form->info);
    const auto& own = inputs.rays_for(*row.form->info);
    const bool unit = row.form->info->direction == intersect::Direction::unit;
    for (std::size_t i = 0; i < band.pixels(); ++i) {
        const auto truth = band.truth(i, row.convention());
        const std::size_t primitive = answer::measured_primitive(inputs, i, truth.object);
        inputs_.push_back(tape::inputs_of(own[i], inputs.primitives[primitive], band.range(i).tmax));
        exact_inputs_.push_back(unit ? along_axis(inputs_.back()) : inputs_.back());
        const double t = truth.is_hit() ? band.rounded_truth(i, binary64, row.form->info->direction, row.convention())
                                        : truth::missing;
        right_.push_back({truth.decision, t, band.range(i)});
    }
}

std::vector<int> RaySample::culprits(Tape tape) const {
    std::vector<int> counts(tape.nodes.size());
    for (const auto& inputs : inputs_) {
        tape = filled(std::move(tape), inputs, true);
        const auto found = attribution::attribute(tape);
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

std::size_t work_of(const Tape& tape) {
    std::size_t work = 0;
    for (const NodeId i : tape::rounded_operations(tape))
        work += tape[i].op == TapeOp::div || tape[i].op == TapeOp::sqrt ? 8 : 1;
    return work;
}

Rewriting rewrite(const RepairRequest& request, const Tape& form, const RowQuality& own, Judge& judge,
                  const SearchLimit& limit) {
    return RewriteSearch(request, form, own, judge, limit).done();
}

}  // namespace lostbits::measure::repair
