#include "measure/choice/obstacle.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "measure/answer/owners.hpp"
#include "measure/choice/file_rays.hpp"
#include "measure/truth/lost_bits.hpp"
#include "measure/truth/reach.hpp"

namespace lostbits::measure::choice {

using evaluate::TestedForm;
using scene::file::Scene;
using truth::Band;
using truth::Truth;

namespace {

/// Limits: each ray is tested against every primitive, in numbers of 256 bits.
constexpr std::size_t most_problems = 1 << 17, most_listed = 1024;

/// Measures the truth of the stored inputs against the truth of the ideal ones, as an answer without rounding.
RowQuality exact_quality(const Band& meant, const Band& stored, const TestedForm& row, const Requirement& requirement) {
    RowQuality quality;
    metric::Distribution lost, off;
    const bool unit = row.form->info->direction == intersect::Direction::unit;
    for (std::size_t i = 0; i < meant.pixels(); ++i) {
        const Truth is = stored.truth(i, row.convention()), should_be = meant.truth(i, row.convention());
        const auto unresolved = Truth::Decision::unresolved;
        if (is.decision == unresolved || should_be.decision == unresolved) continue;
        ++quality.rays;
        quality.hits += should_be.is_hit() ? 1 : 0;
        if (is.decision != should_be.decision ||
            (is.is_hit() && !answer::meets_first(meant, i, is.object, row.convention()))) {
            ++quality.wrong;
        } else if (is.is_hit()) {
            const auto& [x, y] = unit ? std::pair(is.distance, should_be.distance) : std::pair(is.t, should_be.t);
            const double ulps = truth::scaled_difference(x, y, ulp_exponent(binary64, y.floor_log2()));
            lost.add(truth::lost_bits(ulps, binary64.precision));
            off.add(std::fabs(truth::scaled_difference(is.distance, should_be.distance, 0)));
        }
    }
    quality.kept_bits = binary64.precision - lost.quantile(requirement.quantile);
    if (requirement.has_tolerance()) quality.distance_error = off.quantile(requirement.quantile);
    return quality;
}

/// Bits that half an ulp of a format in each input leaves, and the distance by which it moves the hit point.
struct InherentLimit {
    double kept, distance_error;
};
InherentLimit inherent(const Band& band, const TestedForm& row, const Format& format, const Requirement& requirement) {
    const intersect::Direction unit = row.form->info->direction;
    metric::Distribution lost, off;
    for (std::size_t i = 0; i < band.pixels(); ++i) {
        const Truth found = band.truth(i, row.convention());
        if (!found.is_hit()) continue;
        const double reach = band.reach(i, row.convention(), unit, {.format = format});
        const truth::Certified& t = unit == intersect::Direction::unit ? found.distance : found.t;
        lost.add(truth::inherent_bits(reach, t, format.parameters));
        // Reach is in units of the power of two of t*. Its share of t* is the same for the distance.
        off.add(t.is_zero() ? reach : reach * std::fabs(truth::scaled_difference(found.distance, {}, 0) / t.hi));
    }
    return {format.parameters.precision - lost.quantile(requirement.quantile), off.quantile(requirement.quantile)};
}

/// Bits of the inputs that a primitive has: a box has no radius.
unsigned inputs_of(const IdealRays& ideal) {
    const auto is_length = [](const Key& key) { return key.kind == Key::Kind::length; };
    const bool round = std::ranges::any_of(
        ideal.primitives, [&](const auto& s) { return std::ranges::any_of(row_of(s.shape).keys, is_length); });
    return round ? 15U : 7U;
}

class Trials {
public:
    Trials(const ChoiceRequest& request, const TestedForm& row, const IdealRays& ideal, Obstacle& found)
        : request_(request), row_(row), ideal_(ideal), meant_(ideal.band(request.limit)), found_(found) {}

    void run() {
        std::vector<unsigned> sets;
        for (unsigned wide = 0; wide <= inputs_of(ideal_); ++wide) sets.push_back(wide);
        std::ranges::stable_sort(sets, {}, [](unsigned wide) { return std::popcount(wide); });
        for (const unsigned wide : sets) found_.trials.push_back(trial(wide));
        if (found_.trials.front().exact.meets(request_.requirement)) return;
        find_enough();
        if (found_.enough) find_least_precision();
    }

private:
    [[nodiscard]] InputFormats formats(unsigned wide, const std::optional<FloatFormat>& wider) const {
        InputFormats all;
        for (std::size_t k = 0; k < all.size(); ++k) all[k] = (wide >> k & 1U) != 0 ? wider : found_.base;
        return all;
    }

    [[nodiscard]] InputTrial trial(unsigned wide) const {
        const std::optional<FloatFormat> wider = found_.wider_than_f64 ? std::nullopt : std::optional(binary64);
        const Band stored = rounded(ideal_, formats(wide, wider)).band(request_.limit);
        request_.progress(0);
        InputTrial trial{.wide = wide, .exact = exact_quality(meant_, stored, row_, request_.requirement)};
        const TestedForm in_f64{row_.form, *find_format("f64")};
        if (row_.form->exists_in(in_f64.format) && !(found_.wider_than_f64 && wide != 0))
            trial.form =
                quality_on(meant_, stored.inputs_for(in_f64.format, *in_f64.form->info), in_f64, request_.requirement);
        return trial;
    }

    /// Finds the fewest inputs that are enough; among equally few, those that keep the most bits.
    void find_enough() {
        const auto is_better = [](const InputTrial& a, const InputTrial& b) {
            const int more = std::popcount(a.wide) - std::popcount(b.wide);
            return more != 0 ? more < 0 : a.exact.kept_bits > b.exact.kept_bits;
        };
        for (std::size_t k = 0; k < found_.trials.size(); ++k) {
            if (!found_.trials[k].exact.meets(request_.requirement)) continue;
            if (!found_.enough || is_better(found_.trials[k], found_.trials[*found_.enough])) found_.enough = k;
        }
    }

    /// Finds the least precision by bisection, which assumes that more bits are not worse.
    void find_least_precision() {
        int fails = found_.base.precision, meets = found_.wider_than_f64 ? 256 : binary64.precision;
        while (meets - fails > 1) {
            const int middle = (fails + meets) / 2;
            const FloatFormat format{middle, binary64.emin, binary64.emax};
            const Band stored =
                rounded(ideal_, formats(found_.trials[*found_.enough].wide, format)).band(request_.limit);
            (exact_quality(meant_, stored, row_, request_.requirement).meets(request_.requirement) ? meets : fails) =
                middle;
        }
        found_.least_precision = meets;
    }

    const ChoiceRequest& request_;
    const TestedForm& row_;
    const IdealRays& ideal_;
    Band meant_;
    Obstacle& found_;
};

Obstacle::Cause cause_of(const Obstacle& found, const TestedForm& row, const Requirement& requirement,
                         const RowQuality& reached) {
    using Cause = Obstacle::Cause;
    if (reached.hits == 0) return Cause::no_hit;
    if (requirement.bits > row.format.parameters.precision) return Cause::width;
    if (!found.exact.meets(requirement)) return Cause::inputs;
    // Within the envelope the problem is hard; beyond it the formula is bad.
    const bool hard = (found.inherent_kept < requirement.bits && !(reached.kept_bits < found.inherent_kept)) ||
                      (found.inherent_off > requirement.tolerance && !(reached.distance_error > found.inherent_off));
    return reached.decides(requirement) && hard ? Cause::inherent : Cause::formula;
}

}  // namespace

Obstacle find_obstacle(const ChoiceRequest& request, const TestedForm& row, int pixels) {
    Obstacle found;
    std::optional<Scene> thin;
    IdealRays ideal;
    std::optional<Band> given;
    if (request.scene) {
        const std::size_t primitives = std::max<std::size_t>(1, request.scene->primitive_count());
        const bool few = primitives <= most_listed && !request.scene->flake;
        const auto affordable = static_cast<int>(std::clamp<std::size_t>(most_problems / primitives, 64, 65536));
        thin = with_smaller_picture(*request.scene, std::min(pixels, affordable));
        given.emplace(*thin, 0, thin->height, request.limit);
        if (few) ideal = ideal_of(*thin);
        found.rounded_before = thin->inputs == scene::file::Inputs::shared;
    } else {
        const auto& sample = request.rays->sample;
        const std::size_t primitives = sample.paired ? 1 : sample.primitives.size();
        const auto few = some_of(sample, std::min<std::size_t>(static_cast<std::size_t>(pixels),
                                                               std::max<std::size_t>(64, most_problems / primitives)));
        given.emplace(few, request.limit);
        ideal = ideal_of(few);
    }
    const InherentLimit own = inherent(*given, row, row.format, request.requirement);
    found.inherent_kept = own.kept;
    found.inherent_off = own.distance_error;
    found.inherent_kept_f64 = inherent(*given, row, *find_format("f64"), request.requirement).kept;
    const RowQuality reached = quality_on(*given, row, request.requirement);
    found.base = found.rounded_before ? binary32 : row.format.parameters;
    found.wider_than_f64 = found.base == binary64;
    if (!ideal.primitives.empty() && reached.hits > 0) Trials(request, row, ideal, found).run();
    // If every format gets the same stored inputs, they are exact for the requirement. Otherwise the first trial, in
    // which no input is wide, has what the row gets.
    if (found.rounded_before || found.trials.empty())
        found.exact = exact_quality(*given, *given, row, request.requirement);
    else found.exact = found.trials.front().exact;
    found.cause = cause_of(found, row, request.requirement, reached);
    return found;
}

}  // namespace lostbits::measure::choice
