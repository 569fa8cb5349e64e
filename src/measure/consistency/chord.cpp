// Compares a segment from either end. The ray from p has the direction q − p, rounded; the ray from q has exactly the
// opposite direction.
#include <algorithm>
#include <cmath>

#include "measure/consistency/segments.hpp"
#include "measure/offset/ball_of.hpp"
#include "measure/truth/compare_hit.hpp"
#include "measure/truth/unit_direction.hpp"
#include "number/with_number.hpp"

namespace lostbits::measure::consistency {

using scene::rays::RayBlock;
using truth::Truth;

namespace {

template <class E>
std::optional<Ends<E>> enclose_chord(const Ray<double>& ray, const Primitive<double>& primitive) {
    return with_span(lift_ray<E>(ray), lift_primitive<E>(primitive), [](const auto& span) { return ends_of(span); });
}

/// Returns a double within `error` of x; nothing if x is not known to that accuracy.
std::optional<double> to_double_within(const Ball& x, double error) {
    if (!x.is_bounded() || x.radius() > error / 2) return std::nullopt;
    return x.hi() + x.lo();
}
std::optional<double> to_double_within(const Interval& x, double error) {
    if (!x.is_bounded()) return std::nullopt;
    const double low = mpfr_get_d(x.lower(), MPFR_RNDD), high = mpfr_get_d(x.upper(), MPFR_RNDU);
    if (!(high - low <= error)) return std::nullopt;
    return low + (high - low) / 2;
}

template <class E>
std::optional<ChordError> chord_error_in(const ReversedRays& rays, const ChordAnswer& answer, bool are_distances,
                                         double ulp) {
    const auto forth = enclose_chord<E>(rays.forth, rays.primitive), back = enclose_chord<E>(rays.back, rays.primitive);
    if (!forth || !back) return std::nullopt;
    const E segment_length = are_distances ? length(lift_vec<E>(rays.forth.direction)) : E(1);

    ChordError largest;
    const auto add_sum = [&](const E& exact, double t, double t_back) {
        const E sum = E(t) + E(t_back);
        const auto apart = to_double_within(sum - segment_length, ulp * 0x1p-10);
        const auto excess = to_double_within(sum - exact * segment_length, ulp * 0x1p-10);
        if (!apart || !excess) return false;
        largest.apart = std::max(largest.apart, std::fabs(*apart / ulp));
        largest.excess = std::max(largest.excess, std::fabs(*excess / ulp));
        return true;
    };

    // A near side that may lie behind the origin is not compared.
    const bool near_is_ahead = (forth->near > E(0)).is_yes(), near_back_is_ahead = (back->near > E(0)).is_yes();
    if (near_is_ahead && !add_sum(forth->near + back->far, answer.near, answer.far_back)) return std::nullopt;
    if (near_back_is_ahead && !add_sum(forth->far + back->near, answer.far, answer.near_back)) return std::nullopt;
    return largest;
}

/// A ball around a primitive, relative to a ray, in doubles. It only decides where the segment ends.
struct BallOnRay {
    double middle, half;      ///< t of the point nearest to the centre; radius in lengths of the direction
    double centre_distance2;  ///< squared distance of the line from the centre, in radii²

    BallOnRay(const Ray<double>& ray, const Primitive<double>& primitive) {
        const auto [centre, radius] = offset::bounding_ball_of(primitive);
        const Vec<double> f = centre - ray.origin;
        const double a = square(ray.direction);
        middle = dot(f, ray.direction) / a;
        half = radius / std::sqrt(a);
        centre_distance2 = square(cross<double>(f, ray.direction)) / (a * radius * radius);
    }
    [[nodiscard]] bool is_ahead() const { return middle + half > 0; }
    /// Returns the t at which the segment ends: as far behind the primitive as p lies in front of it, but at least half
    /// of its size behind it.
    [[nodiscard]] double end() const { return middle + std::max(middle, 2 * half); }
};

/// Returns the primitive that the ray of the pixel truly meets. If the ray misses all, returns the primitive ahead that
/// the ray passes nearest to, in units of its radius. Of a large mesh, only primitives whose box the ray comes near are
/// considered.
std::optional<std::size_t> find_primitive(const FormOnBand& band_form, std::size_t i) {
    const Truth ray_truth = band_form.band.truth(i, band_form.tested_form.convention());
    if (ray_truth.is_hit()) return static_cast<std::size_t>(ray_truth.primitive);
    std::optional<std::size_t> nearest;
    double least = HUGE_VAL;
    const FormOnBand::Candidates candidates = band_form.candidates(band_form.inputs.rays[i]);
    for (std::size_t k = 0; k < candidates.indices.size(); ++k) {
        const BallOnRay ball(band_form.inputs.rays[i], candidates.primitives[k]);
        if (ball.is_ahead() && ball.centre_distance2 < least) {
            least = ball.centre_distance2;
            nearest = candidates.indices[k];
        }
    }
    return nearest;
}

/// Returns the segment of a pixel from p, the origin of its ray, to q, its end, rounded to the format. Returns nothing
/// if there is no primitive.
std::optional<ReversedRays> make_segment(const FormOnBand& band_form, std::size_t i) {
    const auto k = find_primitive(band_form, i);
    if (!k) return std::nullopt;
    const Ray<double> ray = band_form.inputs.rays[i];
    const BallOnRay ball(ray, band_form.inputs.primitives[*k]);
    if (!ball.is_ahead()) return std::nullopt;

    // The direction is q − p, rounded once in each component.
    const Vec<double> p = ray.origin;
    Vec<double> q{0, 0, 0}, difference{0, 0, 0};
    with_number(band_form.tested_form.format, [&]<class T>() {
        for (int axis = 0; axis < 3; ++axis) {
            const T end = static_cast<T>(std::fma(ball.end(), ray.direction[axis], p[axis]));
            q[axis] = as_double(end);
            difference[axis] = as_double(end - static_cast<T>(p[axis]));
        }
    });

    const ReversedRays rays{{p, difference},
                            {q, Vec<double>(-difference.x, -difference.y, -difference.z)},
                            band_form.inputs.primitives[*k]};
    if (!truth::is_valid(rays.forth) || !truth::is_valid(rays.back)) return std::nullopt;
    return rays;
}

RayBlock with_unit_directions(RayBlock rays, const FloatFormat& format) {
    truth::make_unit({rays.dx, rays.dy, rays.dz}, format);
    return rays;
}

/// Segments of a band from one end: their truth, and the form's answers.
struct SegmentsFromEnd {
    truth::Band band;
    AllAnswers answers;

    SegmentsFromEnd(const FormOnBand& band_form, const RayBlock& rays, const std::vector<Primitive<double>>& primitives)
        : band(scene::rays::RayGroup{.rays = rays, .primitives = primitives, .is_paired = true}),
          answers(evaluate_all(
              band_form.kernels,
              band_form.takes_unit_directions() ? with_unit_directions(rays, band_form.format()) : rays, primitives)) {}
};

CheckResult check_result_of_numbers(const FormOnBand& band_form, const ReversedRays& rays, const ChordAnswer& answer,
                                    double& apart, double& excess) {
    const double segment_length = band_form.takes_unit_directions() ? length(rays.forth.direction) : 1;
    const double ulp = std::ldexp(1.0, static_cast<int>(ulp_exponent(band_form.format(), std::ilogb(segment_length))));
    const auto error = compute_chord_error(rays, answer, band_form.takes_unit_directions(), ulp);
    if (!error) return CheckResult::unresolved;
    apart = error->apart;
    excess = error->excess;
    // Each t is at most the length L. If it is correctly rounded, its error is at most half an ulp of L, so that of a
    // sum of two is at most one ulp.
    constexpr double largest_excess = 1;
    return error->excess > largest_excess  ? CheckResult::other_number
           : error->apart > largest_excess ? CheckResult::by_inputs
                                           : CheckResult::agree;
}

/// The segments of a band that have a primitive, and their rays from either end.
struct BandSegments {
    std::vector<std::size_t> pixels;
    std::vector<ReversedRays> segments;
    std::vector<Primitive<double>> primitives;
    RayBlock from_p_rays, from_q_rays;
};

BandSegments collect_segments(const FormOnBand& band_form) {
    BandSegments found;
    for (std::size_t i = 0; i < band_form.pixel_count(); ++i) {
        const auto segment = make_segment(band_form, i);
        if (!segment) continue;
        found.pixels.push_back(i);
        found.segments.push_back(*segment);
        found.primitives.push_back(segment->primitive);
        found.from_p_rays.push(segment->forth);
        found.from_q_rays.push(segment->back);
    }
    return found;
}

/// Compares the answers for segment k from either end: the decisions and, if all of them are hits, the numbers.
CheckResult compare_chords(const FormOnBand& band_form, const ReversedRays& segment, std::size_t k,
                           const SegmentsFromEnd& forth, const SegmentsFromEnd& back, double& apart, double& excess) {
    const AllAnswers &a = forth.answers, &b = back.answers;
    const auto p_decision = forth.band.truth(k, band_form.tested_form.convention()).decision;
    const auto q_decision = back.band.truth(k, band_form.tested_form.convention()).decision;
    if (p_decision == Truth::Decision::unresolved || q_decision == Truth::Decision::unresolved)
        return CheckResult::unresolved;

    const bool p_hits = p_decision == Truth::Decision::hit, q_hits = q_decision == Truth::Decision::hit;
    const bool has_numbers = band_form.tested_form.form->info->roots == intersect::Roots::both;
    if (has_numbers && a.hit[k] != 0 && b.hit[k] != 0 && p_hits && q_hits)
        return check_result_of_numbers(band_form, segment, {a.near[k], a.far[k], b.near[k], b.far[k]}, apart, excess);
    return check_result_of(a.hit[k] != 0, b.hit[k] != 0, p_hits, q_hits);
}

}  // namespace

std::optional<ChordError> compute_chord_error(const ReversedRays& rays, const ChordAnswer& answer, bool are_distances,
                                              double ulp) {
    for (const double t : {answer.near, answer.far, answer.near_back, answer.far_back}) {
        if (!std::isfinite(t)) return ChordError{HUGE_VAL, HUGE_VAL};
    }
    return truth::find_at_rising_precision(
        [&]<class E>() { return chord_error_in<E>(rays, answer, are_distances, ulp); });
}

void check_reverse(const FormOnBand& band_form, PixelCheckResults& out) {
    out.apart.assign(band_form.pixel_count(), truth::missing);
    out.excess.assign(band_form.pixel_count(), truth::missing);
    const BandSegments found = collect_segments(band_form);
    if (found.pixels.empty()) return;
    const SegmentsFromEnd forth(band_form, found.from_p_rays, found.primitives);
    const SegmentsFromEnd back(band_form, found.from_q_rays, found.primitives);

    for (std::size_t k = 0; k < found.pixels.size(); ++k) {
        const std::size_t i = found.pixels[k];
        const ReversedRays& segment = found.segments[k];
        const CheckResult result = compare_chords(band_form, segment, k, forth, back, out.apart[i], out.excess[i]);
        out.set(i, result, [&] {
            RayPair two_rays{i, scene::rays::make_group(segment.forth), scene::rays::make_group(segment.back)};
            two_rays.first.primitives = two_rays.second.primitives = {segment.primitive};
            return two_rays;
        });
    }
}

}  // namespace lostbits::measure::consistency
