#include "measure/evaluate/row_parts.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "measure/answer/owners.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::evaluate {

using answer::Outcome;
using truth::missing;
using truth::Truth;

void find_outcomes(const answer::BandAnswers& band_answers, const columns::TrueLengths& truth, bool returns_t,
                   const OutcomeColumns& out, FormSummary& summary) {
    const answer::Answers& answers = band_answers.answers;
    const std::size_t n = truth.decision.size();
    const answer::OutcomeTable table(returns_t);
    out.correct_t.resize(n);

    // Compares the decisions, then the primitives.
    Outcome* const outcomes = out.outcomes.data();
    double* const correct_t = out.correct_t.data();
    for (std::size_t i = 0; i < n; ++i)
        outcomes[i] = table[answer::OutcomeTable::case_index(truth.decision[i], answers.hit[i] != 0,
                                                             answers.t[i] != answers.t[i])];
    for (std::size_t i = 0; i < n; ++i) {
        const bool is_wrong_primitive =
            returns_t & (outcomes[i] == Outcome::agree_hit) & (answers.primitive[i] != truth.primitive[i]);
        outcomes[i] = is_wrong_primitive ? Outcome::wrong_primitive : outcomes[i];
    }
    if (returns_t) refine_outcomes(band_answers, truth, out.outcomes);

    // Only the t of correct hits have errors.
    for (std::size_t i = 0; i < n; ++i) {
        correct_t[i] = (returns_t & (outcomes[i] == Outcome::agree_hit)) ? answers.t[i] : missing;
    }

    // Counts the rays of the band.
    std::uint64_t true_hit_count = 0;
    for (const Truth::Decision decision : truth.decision)
        true_hit_count += static_cast<std::uint64_t>(decision == Truth::Decision::hit);
    for (std::size_t o = 0; o < summary.outcomes.size(); ++o)
        summary.outcomes[o] += static_cast<std::uint64_t>(std::ranges::count(out.outcomes, static_cast<Outcome>(o)));
    summary.true_hit_count += true_hit_count;
    summary.ray_count += n;
}

FormStatements::FormStatements(const TestedForm& tested_form, unsigned needs, const truth::FormatInputs& inputs,
                               const Ray<double>& ray, std::size_t i, std::size_t primitive,
                               std::int32_t true_primitive) {
    const intersect::table::Intersector& form = *tested_form.form;
    const auto& rays = inputs.rays_for(*form.info);
    const double tmax = rays.tmax.empty() ? HUGE_VAL : rays.tmax[i];

    // The bound, and the arithmetic of the filter.
    if ((needs & metric::needs_bound) && form.bounded)
        bounded_ = form.bounded(tested_form.format, ray, inputs.target_for(form, primitive), tmax);
    if ((needs & metric::needs_deciding_arithmetic) && form.deciding_arithmetic)
        deciding_arithmetic_ =
            form.deciding_arithmetic(tested_form.format, ray, inputs.target_for(form, primitive), tmax);

    // The levels of the boxes around the primitive that the ray truly meets.
    if ((needs & metric::needs_levels) && true_primitive >= 0) {
        const Primitive<double> hit_primitive = inputs.primitives[true_primitive];
        const intersect::table::Intersector& part_form = form.form_for(hit_primitive.shape);
        if (intersect::bounding_box::has_box(part_form))
            levels_ = answer::find_lost_level(part_form, tested_form.format, ray, hit_primitive, rays.range(i));
    }

    // The margin at the end of the ray, and the steps, for the tested primitive.
    if (!(needs & (metric::needs_steps | metric::needs_end_margin))) return;
    const Primitive<double> tested_primitive = inputs.primitives[primitive];
    const intersect::table::Intersector& part_form = form.form_for(tested_primitive.shape);
    if ((needs & metric::needs_end_margin) && intersect::bounding_box::has_box(part_form))
        end_margin_ = answer::find_end_margin(part_form, tested_form.format, ray, tested_primitive, rays.range(i));
    if (!(needs & metric::needs_steps)) return;
    if (!tested_primitive.transform || !part_form.has_transform_method) return;
    // A box in the world is not a transform step.
    steps_ = answer::measure_steps(intersect::bounding_box::without_world_boxes(part_form), tested_form.format, ray,
                                   tested_primitive, rays.range(i));
}

void FormStatements::fill(metric::Sample& sample) const {
    if (bounded_) sample.bounded_answer = &*bounded_;
    if (deciding_arithmetic_) sample.deciding_arithmetic = &*deciding_arithmetic_;
    if (steps_) sample.steps = &*steps_;
    sample.end_margin = end_margin_;
    if (levels_) sample.levels = &*levels_;
}

WorstRay RowSums::worst_hit(std::size_t i) const {
    WorstRay w = ray_with_inputs(i, Outcome::agree_hit);
    w.ulps = ulps_[i];
    w.size = std::fabs(ulps_[i]);
    return w;
}

void RowSums::keep_worst(FormSummary& summary, double largest) const {
    if (!(largest > summary.worst.size)) return;
    const auto is_worst = [largest](double ulps) { return std::fabs(ulps) == largest; };
    const double* const end = ulps_ + result_.outcomes.size();
    const double* const found = std::find_if(ulps_, end, is_worst);
    if (found != end)
        summary.worst = worst_hit(static_cast<std::size_t>(found - ulps_));  // otherwise no hit is correct
}

void RowSums::keep_faults(FormSummary& summary) const {
    for (std::size_t kind = 0; kind < wrong_decisions.size(); ++kind) {
        auto& fault = summary.faults.at(kind);
        if (fault || summary.count(wrong_decisions[kind]) == 0) continue;
        const auto i = std::ranges::find(result_.outcomes, wrong_decisions[kind]) - result_.outcomes.begin();
        fault = std::make_unique<WorstRay>(ray_with_inputs(static_cast<std::size_t>(i), wrong_decisions[kind]));
    }
}

void RowSums::add(const RaySubset& part) const {
    FormSummary& summary = *part.summary;

    // Outcomes, and the ray with the largest error.
    std::optional<std::size_t> worst_index;
    double largest = summary.worst.size;
    summary.ray_count += part.rays.size();
    for (const std::uint32_t i : part.rays) {
        ++summary.outcomes[static_cast<std::size_t>(result_.outcomes[i])];
        summary.true_hit_count += static_cast<std::uint64_t>(truth_.decision[i] == Truth::Decision::hit);
        if (!(std::fabs(ulps_[i]) > largest)) continue;
        worst_index = i;
        largest = std::fabs(ulps_[i]);
    }
    if (worst_index) summary.worst = worst_hit(*worst_index);

    std::vector<double> values(part.rays.size());
    for (std::size_t m = 0; m < request_.metrics.size(); ++m) {
        std::ranges::transform(part.rays, values.begin(), [&](std::uint32_t i) { return result_.metrics[m][i]; });
        summary.add(m, *request_.metrics[m], values);
    }

    // The first ray of each wrong decision.
    for (std::size_t kind = 0; kind < wrong_decisions.size(); ++kind) {
        if (summary.faults.at(kind) || summary.count(wrong_decisions[kind]) == 0) continue;
        const auto has_decision = [&](std::uint32_t i) { return result_.outcomes[i] == wrong_decisions[kind]; };
        const auto i = *std::ranges::find_if(part.rays, has_decision);
        summary.faults[kind] = std::make_unique<WorstRay>(ray_with_inputs(i, wrong_decisions[kind]));
    }
}

WorstRay RowSums::ray_with_inputs(std::size_t i, Outcome outcome) const {
    const bool hit = result_.answers->hit[i] != 0, returns_t = row_.form->info->roots != intersect::Roots::none;
    const Truth ray_truth = result_.truth(i);
    const int primitive_index = hit ? result_.answers->primitive[i] : ray_truth.primitive;
    const std::size_t primitive = answer::measured_primitive(*result_.inputs, i, primitive_index);

    // Index of the band's first ray among all rays.
    const std::int64_t first = request_.first + std::int64_t{result_.y0} * result_.width;
    WorstRay w{.x = request_.first + static_cast<std::int64_t>(i % static_cast<std::size_t>(result_.width)),
               .y = result_.y0 + static_cast<int>(i / static_cast<std::size_t>(result_.width)),
               .group = request_.group,
               .primitive_index =
                   result_.inputs->is_paired && primitive_index >= 0 ? first + primitive_index : primitive_index,
               .size = 0,
               .ray = result_.inputs->rays[i],
               .primitive = result_.inputs->primitives[primitive],
               .t = hit && returns_t ? result_.answers->t[i] : missing,
               .outcome = outcome,
               .touching = row_.touching};
    if (ray_truth.is_hit())
        w.truth = result_.band->rounded_truth(i, binary64, row_.form->info->direction, row_.convention());

    // Two primitives decide which hit is nearest: the form's and the true one. A distance field depends on all
    // primitives.
    std::set<int> deciding;
    if (is_primitive(row_.form->shape)) {
        if (hit) deciding.insert(primitive_index);
        if (ray_truth.is_hit()) deciding.insert(ray_truth.primitive);
    }
    w.given = result_.band->make_original_group(i, deciding);
    return w;
}

}  // namespace lostbits::measure::evaluate
