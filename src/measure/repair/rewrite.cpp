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
#include "measure/choose/candidates.hpp"
#include "measure/tape/tape_form.hpp"

namespace lostbits::measure::repair {

using identity::Rewrite;
using identity::Terms;
using identity::Triple;

namespace {

/// Inputs with the direction replaced by the unit vector of the axis that it is nearest to.
std::vector<double> turn_to_axis(std::vector<double> numbers) {
    const auto d = numbers.begin() + 3;
    const auto largest = std::max_element(d, d + 3, [](double a, double b) { return std::fabs(a) < std::fabs(b); });
    const double unit = std::copysign(1, *largest);
    std::fill(d, d + 3, 0.0);
    *largest = unit;
    return numbers;
}

/// Form that the search has reached, with the rules that lead to it.
struct CandidateForm {
    TapeOutputs outputs;
    std::vector<const Rule*> rules = {};
    FormQuality quality{};
    std::size_t work = 0;
    bool is_expanded = false;
};

class RewriteSearch {
public:
    RewriteSearch(const RepairRequest& request, const Tape& form, const FormQuality& own_quality,
                  QualityMeasurer& measurer, const SearchLimit& limit)
        : request_(request), limit_(limit), form_(form), terms_(form), measurer_(measurer), sample_(request) {
        if (request.tested_form.form->info->direction == intersect::Direction::unit) unit_ = direction_of(terms_);
        candidates_.push_back({.outputs = terms_.outputs(), .quality = own_quality, .work = estimate_work(form)});
        seen_.insert(identity::output_nodes(terms_.outputs()));
    }

    RewritingResult run() {
        for (std::size_t round = 0; round < limit_.rounds; ++round)
            if (!run_round()) break;
        return {.forms = best_candidates(),
                .tried_count = measurer_.tried_count() - tried_count_before_,
                .untried_count = untried_count_};
    }

private:
    /// Rewrites the promising candidates. Returns false if no new candidate is found.
    bool run_round() {
        std::vector<CandidateForm> new_candidates;
        for (const std::size_t k : select_promising()) {
            candidates_[k].is_expanded = true;
            for (CandidateForm& candidate : rewrite_candidate(candidates_[k]))
                new_candidates.push_back(std::move(candidate));
        }

        // Drops those that differ from the form in real arithmetic.
        std::vector<Tape> tapes;
        std::erase_if(new_candidates, [&](CandidateForm& candidate) {
            const Tape tape = terms_.tape(candidate.outputs);
            candidate.work = estimate_work(tape);
            const bool is_refused = !sample_.have_same_answers(form_, tape);
            if (is_refused) ++untried_count_;
            else tapes.push_back(tape);
            return is_refused;
        });

        const auto quality = measurer_.measure_quality(tapes);
        for (std::size_t k = 0; k < new_candidates.size(); ++k) new_candidates[k].quality = quality[k];
        std::ranges::move(new_candidates, std::back_inserter(candidates_));
        return !new_candidates.empty();
    }

    [[nodiscard]] bool meets(const CandidateForm& candidate) const {
        return candidate.quality.meets(request_.requirement);
    }
    static bool is_better(const CandidateForm& a, const CandidateForm& b) {
        if (is_more_accurate(a.quality, b.quality) || is_more_accurate(b.quality, a.quality))
            return is_more_accurate(a.quality, b.quality);
        return a.work < b.work;
    }

    /// Selects the candidates to rewrite next, by index. Among the candidates that are not rewritten yet, these are the
    /// most accurate ones and those that meet the requirement with least work.
    [[nodiscard]] std::vector<std::size_t> select_promising() const {
        std::vector<std::size_t> unexpanded;
        for (std::size_t k = 0; k < candidates_.size(); ++k)
            if (!candidates_[k].is_expanded) unexpanded.push_back(k);
        std::ranges::stable_sort(unexpanded, [&](auto a, auto b) { return is_better(candidates_[a], candidates_[b]); });

        // The most accurate ones.
        std::vector<std::size_t> selected(
            unexpanded.begin(),
            unexpanded.begin() + static_cast<std::ptrdiff_t>(std::min(limit_.beam_width, unexpanded.size())));

        // Keeps the forms that meet the requirement with least work.
        std::ranges::stable_sort(unexpanded, [&](auto a, auto b) {
            return std::pair(!meets(candidates_[a]), candidates_[a].work) <
                   std::pair(!meets(candidates_[b]), candidates_[b].work);
        });
        for (std::size_t k = 0; k < std::min(limit_.beam_width, unexpanded.size()); ++k)
            if (meets(candidates_[unexpanded[k]]) && std::ranges::find(selected, unexpanded[k]) == selected.end())
                selected.push_back(unexpanded[k]);
        return selected;
    }

    /// Candidates that are one rewrite away from this one. Rewrites of the operations that lose most bits come first.
    std::vector<CandidateForm> rewrite_candidate(const CandidateForm& parent) {
        std::vector<NodeId> origins;
        const Tape tape = terms_.tape(parent.outputs, &origins);
        const std::vector<int> culprits = sample_.count_culprits(tape);
        std::map<NodeId, int> losses;
        for (std::size_t k = 0; k < origins.size(); ++k) losses[origins[k]] = culprits[k];

        auto rewrites = find_rewrites(terms_, parent.outputs, unit_);
        std::vector<std::pair<int, std::size_t>> order;
        for (std::size_t k = 0; k < rewrites.size(); ++k) order.emplace_back(-largest_loss(rewrites[k], losses), k);
        std::ranges::stable_sort(order, {}, [](const auto& x) { return x.first; });

        std::vector<CandidateForm> children;
        for (const auto& [loss, k] : order) {
            if (children.size() == limit_.max_children) break;
            const TapeOutputs outputs = terms_.replace_nodes(parent.outputs, rewrites[k].replacements);
            if (!seen_.insert(identity::output_nodes(outputs)).second) continue;
            children.push_back({.outputs = outputs, .rules = parent.rules});
            children.back().rules.push_back(rewrites[k].rule);
        }
        return children;
    }
    [[nodiscard]] int largest_loss(const Rewrite& rewrite, const std::map<NodeId, int>& losses) const {
        int loss = 0;
        for (const auto& [node, replacement] : rewrite.replacements)
            for (const NodeId i : terms_.nodes_of({node, node, node, node}))
                if (const auto found = losses.find(i); found != losses.end()) loss = std::max(loss, found->second);
        return loss;
    }

    /// Candidates that meet the requirement and that no other candidate beats in both accuracy and work. If no
    /// candidate meets the requirement, the most accurate one.
    [[nodiscard]] std::vector<RewrittenForm> best_candidates() const {
        std::vector<const CandidateForm*> order;
        for (const CandidateForm& candidate : candidates_) order.push_back(&candidate);
        std::ranges::stable_sort(order, [](auto a, auto b) { return is_better(*a, *b); });
        std::vector<RewrittenForm> best;
        std::size_t min_work = SIZE_MAX;
        for (const CandidateForm* candidate : order) {
            // No candidate after the form itself, which has no rules, is more accurate, or as accurate with less work.
            if (candidate->rules.empty() || best.size() == limit_.max_proposals ||
                (!best.empty() && !meets(*candidate)))
                break;
            if (candidate->work >= min_work) continue;
            min_work = candidate->work;
            const Tape tape = terms_.tape(candidate->outputs);
            best.push_back({.tape = tape,
                            .rules = candidate->rules,
                            .quality = candidate->quality,
                            .rounding_operation_count = tape::find_widenable_operations(tape).size()});
        }
        return best;
    }

    const RepairRequest& request_;
    SearchLimit limit_;
    const Tape& form_;
    Terms terms_;
    QualityMeasurer& measurer_;
    const std::uint64_t tried_count_before_ = measurer_.tried_count();
    RaySample sample_;
    std::optional<Triple> unit_;
    std::vector<CandidateForm> candidates_;
    std::set<std::array<NodeId, 4>> seen_;
    std::uint64_t untried_count_ = 0;
};

}  // namespace

bool divides_by_zero(const Tape& tape) {
    return std::ranges::any_of(
        tape.nodes, [&](const TapeNode& node) { return node.op == TapeOp::div && tape[node.operands[1]].value == 0; });
}

Tape run_with_inputs(Tape tape, const std::vector<double>& inputs, bool rounds) {
    for (TapeNode& node : tape.nodes)
        if (node.op == TapeOp::input) node.value = inputs.at(node.operands[0]);
    const attribution::Rerun run(tape, [rounds](NodeId) { return rounds; });
    for (NodeId i = 0; i < tape.size(); ++i) tape[i].value = run[i];
    return tape;
}

RaySample::RaySample(const RepairRequest& request, int ray_count)
    : tested_form_(request.tested_form), requirement_(request.requirement), limit_(request.limit) {
    const evaluate::TestedForm& tested_form = request.tested_form;
    std::optional<scene::file::Scene> smaller_scene;
    if (request.scene) smaller_scene = choose::with_smaller_picture(*request.scene, ray_count);
    const truth::Band band =
        smaller_scene
            ? truth::Band(*smaller_scene, 0, smaller_scene->height, request.limit)
            : truth::Band(sample_rays(request.rays->sample, static_cast<std::size_t>(ray_count)), request.limit);
    const auto inputs = band.inputs_for(tested_form.format, *tested_form.form->info);
    const auto& form_rays = inputs.rays_for(*tested_form.form->info);
    const bool takes_unit_directions = tested_form.form->info->direction == intersect::Direction::unit;
    for (std::size_t i = 0; i < band.pixel_count(); ++i) {
        const auto truth = band.truth(i, tested_form.convention());
        const std::size_t primitive = answer::measured_primitive(inputs, i, truth.primitive);
        inputs_.push_back(tape::inputs_of(form_rays[i], inputs.primitives[primitive], band.range(i).tmax));
        exact_inputs_.push_back(takes_unit_directions ? turn_to_axis(inputs_.back()) : inputs_.back());
        const double t = truth.is_hit() ? band.rounded_truth(i, binary64, tested_form.form->info->direction,
                                                             tested_form.convention())
                                        : truth::missing;
        correct_answers_.push_back({truth.decision, t, band.range(i)});
    }
}

std::vector<int> RaySample::count_culprits(Tape tape) const {
    std::vector<int> counts(tape.nodes.size());
    for (const auto& inputs : inputs_) {
        tape = run_with_inputs(std::move(tape), inputs, true);
        const auto attributed = attribution::attribute(tape);
        if (attributed.culprit != no_node) ++counts[attributed.culprit];
    }
    return counts;
}

bool RaySample::have_same_answers(const Tape& a, const Tape& b) const {
    for (const auto& inputs : exact_inputs_) {
        const Tape tape_a = run_with_inputs(a, inputs, false), tape_b = run_with_inputs(b, inputs, false);
        if (divides_by_zero(tape_a) || divides_by_zero(tape_b)) continue;
        const bool hit = tape_a[tape_a.outputs.hit].value != 0;
        if (hit != (tape_b[tape_b.outputs.hit].value != 0)) return false;
        const double t_a = tape_a[tape_a.outputs.t].value, t_b = tape_b[tape_b.outputs.t].value;
        if (hit && !(std::fabs(t_a - t_b) <= 0x1p-45 * std::fabs(t_a))) return false;
    }
    return true;
}

std::size_t estimate_work(const Tape& tape) {
    std::size_t work = 0;
    for (const NodeId i : tape::find_widenable_operations(tape))
        work += tape[i].op == TapeOp::div || tape[i].op == TapeOp::sqrt ? 8 : 1;
    return work;
}

RewritingResult rewrite(const RepairRequest& request, const Tape& form, const FormQuality& own_quality,
                        QualityMeasurer& measurer, const SearchLimit& limit) {
    return RewriteSearch(request, form, own_quality, measurer, limit).run();
}

}  // namespace lostbits::measure::repair
