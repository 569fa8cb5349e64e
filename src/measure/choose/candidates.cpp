#include "measure/choose/candidates.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>

#include "intersect/simd/packed.hpp"
#include "measure/choose/file_rays.hpp"
#include "measure/evaluate/map.hpp"
#include "number/error.hpp"

namespace lostbits::measure::choose {

using evaluate::TestedForm;

double parse_quantile(const std::string& text) {
    if (text == "max") return 1;
    double percent = 0;
    const char* const end = text.data() + text.size();
    const bool is_number = text.starts_with("p") && std::from_chars(text.data() + 1, end, percent).ptr == end;
    if (!is_number || !(percent > 0 && percent < 100))
        throw InputError(
            text +
            ": is not a quantile; write max, or a percentile such as p50, p99 or p99.9 (p99: 99 of 100 hits "
            "keep the bits)");
    return percent / 100;
}

std::vector<const metric::Metric*> Requirement::metrics() const {
    std::vector<const metric::Metric*> metrics_to_measure{metric::find_metric("lost_bits")};
    if (has_tolerance()) metrics_to_measure.push_back(metric::find_metric("distance_error"));
    return metrics_to_measure;
}

std::vector<FormQuality> measure_quality(const ChoiceRequest& request) {
    evaluate::MapStudy study{
        .scene = request.scene, .tested_forms = request.tested_forms, .metrics = request.requirement.metrics()};
    study.limit = request.limit;
    study.progress = request.progress;
    const auto summaries = evaluate::run_map(study, request.show);
    std::vector<FormQuality> qualities;
    for (std::size_t r = 0; r < summaries.size(); ++r)
        qualities.push_back(to_quality(summaries[r], request.tested_forms[r], request.requirement));
    return qualities;
}

const std::string& ChoiceRequest::id() const { return scene ? scene->id : rays->result_name; }

FormQuality to_quality(const evaluate::FormSummary& summary, const TestedForm& tested_form,
                       const Requirement& requirement) {
    return {.ray_count = summary.ray_count - summary.count(answer::Outcome::unresolved),
            .wrong_count = summary.wrong_count(),
            .main_fault = summary.most_frequent_wrong_decision(),
            .main_fault_count =
                summary.most_frequent_wrong_decision() ? summary.count(*summary.most_frequent_wrong_decision()) : 0,
            .kept_bits = tested_form.format.parameters.precision - summary.metrics[0].quantile(requirement.quantile),
            .true_hit_count = summary.true_hit_count,
            .distance_error =
                requirement.has_tolerance() ? summary.metrics[1].quantile(requirement.quantile) : truth::missing};
}

FormQuality measure_quality_on(const truth::Band& band, const TestedForm& tested_form, const Requirement& requirement) {
    return measure_quality_on(band, band.inputs_for(tested_form.format, *tested_form.form->info), tested_form,
                              requirement);
}

FormQuality measure_quality_on(const truth::Band& band, const truth::FormatInputs& inputs,
                               const TestedForm& tested_form, const Requirement& requirement) {
    const std::vector<const metric::Metric*> metrics = requirement.metrics();
    evaluate::FormSummary summary(metrics);
    evaluate::measure_form({tested_form, metrics}, band, inputs, summary);
    return to_quality(summary, tested_form, requirement);
}

std::vector<Candidate> measure_candidates(const ChoiceRequest& request, TimedRays& timed) {
    const auto quality = request.scene ? measure_quality(request) : request.rays->quality;

    // Plans the kernel of each row: for a register of rays where the form has one, else for single rays.
    std::vector<Candidate> candidates;
    auto scene_work = request.scene ? trade::SceneWork(*request.scene, request.limit)
                                    : trade::SceneWork(request.rays->sample, request.limit);
    timed = {scene_work.ray_count(), scene_work.primitive_count()};
    std::vector<trade::TimedWork> work;
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        const TestedForm& tested_form = request.tested_forms[r];
        const intersect::simd::Isa isa =
            request.times_single_rays || !is_packed(*tested_form.form, intersect::simd::current_isa())
                ? intersect::simd::Isa::scalar
                : intersect::simd::current_isa();
        candidates.push_back({tested_form, name_of(isa), {}, quality[r]});
        work.push_back(scene_work.work_for(tested_form, packed_kernels(*tested_form.form, isa)));
    }

    const auto timings = time_interleaved(work, request.plan);
    for (std::size_t c = 0; c < candidates.size(); ++c) candidates[c].time = timings[c];
    return candidates;
}

Format computing_format(const TestedForm& tested_form) {
    if (tested_form.format.engine != Format::Engine::native32 || tested_form.form->count == nullptr ||
        !is_primitive(tested_form.form->shape))
        return tested_form.format;
    const Primitive<float> primitive = primitive_around<float>(tested_form.form->shape, {0, 0, 0}, 1);
    const OperationCounts counts = tested_form.form->count({{0, 0, -5}, {0, 0, 1}}, intersect::Target<float>(primitive),
                                                           std::numeric_limits<float>::infinity());
    return counts[Operation::convert] > 0 ? *find_format("f64") : tested_form.format;
}

std::vector<std::size_t> order_by_price(const std::vector<Candidate>& candidates) {
    std::vector<std::size_t> order(candidates.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&candidates](std::size_t c) { return candidates[c].time.median; });
    return order;
}

namespace {

/// Index of the least eligible candidate by `is_less`.
template <class IsEligible, class IsLess>
std::optional<std::size_t> least_of(const std::vector<Candidate>& candidates, const IsEligible& is_eligible,
                                    const IsLess& is_less) {
    std::optional<std::size_t> best;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        if (is_eligible(candidates[c]) && (!best || is_less(candidates[c], candidates[*best]))) best = c;
    }
    return best;
}

bool is_faster(const Candidate& a, const Candidate& b) { return a.time.median < b.time.median; }

/// Correct bits of a candidate; -1 if they are NaN.
double bits_of(const Candidate& candidate) {
    return std::isnan(candidate.quality.kept_bits) ? -1 : candidate.quality.kept_bits;
}

bool is_more_accurate(const Candidate& a, const Candidate& b) {
    const double wrong_a = a.quality.wrong_fraction(), wrong_b = b.quality.wrong_fraction();
    return wrong_a != wrong_b ? wrong_a < wrong_b : bits_of(a) > bits_of(b);
}

/// Nearness to a requirement, as a key to compare: the bits. With a tolerance, the bits up to the required number, and
/// then the distance error.
std::pair<double, double> nearness(const Candidate& candidate, const Requirement& requirement) {
    if (!requirement.has_tolerance()) return {bits_of(candidate), 0};
    return {std::min(bits_of(candidate), requirement.bits),
            std::isnan(candidate.quality.distance_error) ? -HUGE_VAL : -candidate.quality.distance_error};
}

}  // namespace

std::optional<std::size_t> find_cheapest(const std::vector<Candidate>& candidates, const Requirement& requirement) {
    return least_of(
        candidates, [&requirement](const Candidate& candidate) { return candidate.quality.meets(requirement); },
        is_faster);
}

std::optional<std::size_t> find_fastest(const std::vector<Candidate>& candidates) {
    return least_of(
        candidates, [](const Candidate&) { return true; }, is_faster);
}

std::optional<std::size_t> find_most_accurate(const std::vector<Candidate>& candidates) {
    return least_of(
        candidates, [](const Candidate&) { return true; }, is_more_accurate);
}

std::optional<std::size_t> find_nearest_candidate(const std::vector<Candidate>& candidates,
                                                  const Requirement& requirement) {
    const auto nearest_deciding = least_of(
        candidates,
        [&requirement](const Candidate& candidate) { return candidate.quality.decides_as_required(requirement); },
        [&requirement](const Candidate& a, const Candidate& b) {
            return nearness(a, requirement) > nearness(b, requirement);
        });
    return nearest_deciding ? nearest_deciding : find_most_accurate(candidates);
}

}  // namespace lostbits::measure::choose
