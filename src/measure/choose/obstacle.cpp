#include "measure/choose/obstacle.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "measure/answer/owners.hpp"
#include "measure/choose/file_rays.hpp"
#include "measure/truth/lost_bits.hpp"
#include "measure/truth/reach.hpp"

namespace lostbits::measure::choose {

using evaluate::TestedForm;
using scene::file::Scene;
using truth::Band;
using truth::Truth;

namespace {

/// Limits: each ray is tested against every primitive, in arithmetic of 256 bits.
constexpr std::size_t max_trial_pairs = 1 << 17, max_primitives = 1024;

/// Measures the truth of the stored inputs against the truth of the ideal ones, as an answer without rounding.
FormQuality exact_quality(const Band& ideal, const Band& stored, const TestedForm& tested_form,
                          const Requirement& requirement) {
    FormQuality quality;
    metric::Distribution lost_bits, distances;
    const bool is_unit = tested_form.form->info->direction == intersect::Direction::unit;
    for (std::size_t i = 0; i < ideal.pixel_count(); ++i) {
        const Truth stored_truth = stored.truth(i, tested_form.convention()),
                    ideal_truth = ideal.truth(i, tested_form.convention());

        // Counts only rays whose truth is known for both inputs.
        const auto unresolved = Truth::Decision::unresolved;
        if (stored_truth.decision == unresolved || ideal_truth.decision == unresolved) continue;
        ++quality.ray_count;
        quality.true_hit_count += ideal_truth.is_hit() ? 1 : 0;

        if (stored_truth.decision != ideal_truth.decision ||
            (stored_truth.is_hit() &&
             !answer::meets_first(ideal, i, stored_truth.primitive, tested_form.convention()))) {
            ++quality.wrong_count;
        } else if (stored_truth.is_hit()) {
            const auto& [x, y] = is_unit ? std::pair(stored_truth.distance, ideal_truth.distance)
                                         : std::pair(stored_truth.t, ideal_truth.t);
            const double ulps = truth::scaled_difference(x, y, ulp_exponent(binary64, y.floor_log2()));
            lost_bits.add(truth::lost_bits(ulps, binary64.precision));
            distances.add(std::fabs(truth::scaled_difference(stored_truth.distance, ideal_truth.distance, 0)));
        }
    }

    quality.kept_bits = binary64.precision - lost_bits.quantile(requirement.quantile);
    if (requirement.has_tolerance()) quality.distance_error = distances.quantile(requirement.quantile);
    return quality;
}

/// Bits that remain if each input is off by half an ulp of a format, and the distance by which that moves the hit
/// point.
struct InherentLimit {
    double kept_bits, distance_error;
};
InherentLimit inherent(const Band& band, const TestedForm& tested_form, const Format& format,
                       const Requirement& requirement) {
    const intersect::Direction direction = tested_form.form->info->direction;
    metric::Distribution lost_bits, distances;
    for (std::size_t i = 0; i < band.pixel_count(); ++i) {
        const Truth ray_truth = band.truth(i, tested_form.convention());
        if (!ray_truth.is_hit()) continue;
        const double reach = band.reach(i, tested_form.convention(), direction, {.format = format});
        const truth::CertifiedNumber& t = direction == intersect::Direction::unit ? ray_truth.distance : ray_truth.t;
        lost_bits.add(truth::inherent_bits(reach, t, format.parameters));
        // `reach` is in units of the power of two of t*. Its ratio to t* is the same for the distance.
        distances.add(t.is_zero() ? reach
                                  : reach * std::fabs(truth::scaled_difference(ray_truth.distance, {}, 0) / t.hi));
    }
    return {format.parameters.precision - lost_bits.quantile(requirement.quantile),
            distances.quantile(requirement.quantile)};
}

/// Bit mask of the inputs that the primitives have: a box has no radius.
unsigned inputs_of(const IdealRays& ideal) {
    const auto is_length = [](const Key& key) { return key.kind == Key::Kind::length; };
    const bool has_length = std::ranges::any_of(
        ideal.primitives, [&](const auto& s) { return std::ranges::any_of(row_of(s.shape).keys, is_length); });
    return has_length ? 15U : 7U;
}

/// Measures trials in which some inputs are in a wider format, and records them in an obstacle.
class Trials {
public:
    Trials(const ChoiceRequest& request, const TestedForm& tested_form, const IdealRays& ideal, Obstacle& obstacle)
        : request_(request),
          row_(tested_form),
          ideal_(ideal),
          ideal_band_(ideal.band(request.limit)),
          obstacle_(obstacle) {}

    void run() {
        std::vector<unsigned> sets;
        for (unsigned wide_inputs = 0; wide_inputs <= inputs_of(ideal_); ++wide_inputs) sets.push_back(wide_inputs);
        std::ranges::stable_sort(sets, {}, [](unsigned wide_inputs) { return std::popcount(wide_inputs); });
        for (const unsigned wide_inputs : sets) obstacle_.trials.push_back(trial(wide_inputs));
        if (obstacle_.trials.front().exact.meets(request_.requirement)) return;
        find_enough();
        if (obstacle_.sufficient_trial) find_least_precision();
    }

private:
    [[nodiscard]] InputFormats formats(unsigned wide_inputs, const std::optional<FloatFormat>& wider) const {
        InputFormats input_formats;
        for (std::size_t k = 0; k < input_formats.size(); ++k)
            input_formats[k] = (wide_inputs >> k & 1U) != 0 ? wider : obstacle_.base_format;
        return input_formats;
    }

    [[nodiscard]] InputTrial trial(unsigned wide_inputs) const {
        const std::optional<FloatFormat> wider =
            obstacle_.wide_inputs_are_exact ? std::nullopt : std::optional(binary64);
        const Band stored = round_inputs(ideal_, formats(wide_inputs, wider)).band(request_.limit);
        request_.progress(0);
        InputTrial trial{.wide_inputs = wide_inputs,
                         .exact = exact_quality(ideal_band_, stored, row_, request_.requirement)};
        const TestedForm in_f64{row_.form, *find_format("f64")};
        if (row_.form->exists_in(in_f64.format) && !(obstacle_.wide_inputs_are_exact && wide_inputs != 0))
            trial.form = measure_quality_on(ideal_band_, stored.inputs_for(in_f64.format, *in_f64.form->info), in_f64,
                                            request_.requirement);
        return trial;
    }

    /// Finds the fewest inputs that are enough; among equally few, those that keep the most bits.
    void find_enough() {
        const auto is_better = [](const InputTrial& a, const InputTrial& b) {
            const int difference = std::popcount(a.wide_inputs) - std::popcount(b.wide_inputs);
            return difference != 0 ? difference < 0 : a.exact.kept_bits > b.exact.kept_bits;
        };
        for (std::size_t k = 0; k < obstacle_.trials.size(); ++k) {
            if (!obstacle_.trials[k].exact.meets(request_.requirement)) continue;
            if (!obstacle_.sufficient_trial ||
                is_better(obstacle_.trials[k], obstacle_.trials[*obstacle_.sufficient_trial]))
                obstacle_.sufficient_trial = k;
        }
    }

    /// Finds the least precision by bisection, which assumes that more bits are not worse.
    void find_least_precision() {
        int failing = obstacle_.base_format.precision,
            sufficient = obstacle_.wide_inputs_are_exact ? 256 : binary64.precision;
        while (sufficient - failing > 1) {
            const int precision = (failing + sufficient) / 2;
            const FloatFormat format{precision, binary64.emin, binary64.emax};
            const Band stored =
                round_inputs(ideal_, formats(obstacle_.trials[*obstacle_.sufficient_trial].wide_inputs, format))
                    .band(request_.limit);
            (exact_quality(ideal_band_, stored, row_, request_.requirement).meets(request_.requirement) ? sufficient
                                                                                                        : failing) =
                precision;
        }
        obstacle_.min_precision = sufficient;
    }

    const ChoiceRequest& request_;
    const TestedForm& row_;
    const IdealRays& ideal_;
    Band ideal_band_;
    Obstacle& obstacle_;
};

Obstacle::Cause cause_of(const Obstacle& obstacle, const TestedForm& tested_form, const Requirement& requirement,
                         const FormQuality& reached) {
    using Cause = Obstacle::Cause;
    if (reached.true_hit_count == 0) return Cause::no_hit;
    if (requirement.bits > tested_form.format.parameters.precision) return Cause::width;
    if (!obstacle.exact.meets(requirement)) return Cause::inputs;
    // Within what half an ulp in each input can cost, the problem is hard; beyond it, the formula is bad.
    const bool is_hard =
        (obstacle.inherent_kept < requirement.bits && !(reached.kept_bits < obstacle.inherent_kept)) ||
        (obstacle.inherent_distance > requirement.tolerance && !(reached.distance_error > obstacle.inherent_distance));
    return reached.decides_as_required(requirement) && is_hard ? Cause::inherent : Cause::formula;
}

/// The rays on which an obstacle is sought: few enough for exact arithmetic.
struct TrialRays {
    std::optional<Scene> scene;  ///< a smaller picture of the request's scene; absent for rays of files
    std::optional<Band> band;
    IdealRays ideal;  ///< empty if wider inputs are not tried
};

void take_smaller_picture(const ChoiceRequest& request, int pixels, TrialRays& rays) {
    const std::size_t primitive_count = std::max<std::size_t>(1, request.scene->primitive_count());
    const auto affordable_pixels =
        static_cast<int>(std::clamp<std::size_t>(max_trial_pairs / primitive_count, 64, 65536));
    rays.scene = with_smaller_picture(*request.scene, std::min(pixels, affordable_pixels));
    rays.band.emplace(*rays.scene, 0, rays.scene->height, request.limit);
    if (primitive_count <= max_primitives && !request.scene->flake) rays.ideal = make_ideal_rays(*rays.scene);
}

void take_sample_of_files(const ChoiceRequest& request, int pixels, TrialRays& rays) {
    const auto& sample = request.rays->sample;
    const std::size_t primitive_count = sample.is_paired ? 1 : sample.primitives.size();
    const auto affordable_rays = std::max<std::size_t>(64, max_trial_pairs / primitive_count);
    const auto smaller_sample =
        sample_rays(sample, std::min<std::size_t>(static_cast<std::size_t>(pixels), affordable_rays));
    rays.band.emplace(smaller_sample, request.limit);
    rays.ideal = make_ideal_rays(smaller_sample);
}

}  // namespace

Obstacle find_obstacle(const ChoiceRequest& request, const TestedForm& tested_form, int pixels) {
    Obstacle obstacle;
    TrialRays rays;
    if (request.scene) take_smaller_picture(request, pixels, rays);
    else take_sample_of_files(request, pixels, rays);
    const Band& band = *rays.band;
    obstacle.rounds_to_binary32_first = rays.scene && rays.scene->inputs == scene::file::InputRounding::shared;

    // Bits that the inputs allow in the form's own format and in f64, and bits that the form keeps.
    const InherentLimit row_limit = inherent(band, tested_form, tested_form.format, request.requirement);
    obstacle.inherent_kept = row_limit.kept_bits;
    obstacle.inherent_distance = row_limit.distance_error;
    obstacle.inherent_kept_f64 = inherent(band, tested_form, *find_format("f64"), request.requirement).kept_bits;
    const FormQuality reached = measure_quality_on(band, tested_form, request.requirement);

    // Tries wider inputs with exact arithmetic.
    obstacle.base_format = obstacle.rounds_to_binary32_first ? binary32 : tested_form.format.parameters;
    obstacle.wide_inputs_are_exact = obstacle.base_format == binary64;
    if (!rays.ideal.primitives.empty() && reached.true_hit_count > 0)
        Trials(request, tested_form, rays.ideal, obstacle).run();

    // If every format gets the same stored inputs, those inputs are compared with themselves. Otherwise the first
    // trial, in which no input is wide, has the inputs that the row gets.
    if (obstacle.rounds_to_binary32_first || obstacle.trials.empty())
        obstacle.exact = exact_quality(band, band, tested_form, request.requirement);
    else obstacle.exact = obstacle.trials.front().exact;
    obstacle.cause = cause_of(obstacle, tested_form, request.requirement, reached);
    return obstacle;
}

}  // namespace lostbits::measure::choose
