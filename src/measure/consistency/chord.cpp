// Compares a segment from either end: p to q with the direction q − p as it rounds, and q to p with exactly the
// opposite.
#include <algorithm>
#include <cmath>

#include "measure/consistency/segments.hpp"
#include "measure/offset/ball_of.hpp"
#include "measure/truth/side.hpp"
#include "measure/truth/unit_direction.hpp"
#include "number/with_number.hpp"

namespace lostbits::measure::consistency {

using scene::rays::RayBlock;
using truth::Truth;

namespace {

template <class E>
std::optional<Ends<E>> chord_of(const Ray<double>& ray, const Primitive<double>& primitive) {
    return with_span(lift_ray<E>(ray), lift_primitive<E>(primitive), [](const auto& span) { return ends_of(span); });
}

/// A double with an error of at most `error`.
std::optional<double> within(const Ball& x, double error) {
    if (!x.is_bounded() || x.radius() > error / 2) return std::nullopt;
    return x.hi() + x.lo();
}
std::optional<double> within(const Interval& x, double error) {
    if (!x.is_bounded()) return std::nullopt;
    const double low = mpfr_get_d(x.lower(), MPFR_RNDD), high = mpfr_get_d(x.upper(), MPFR_RNDU);
    if (!(high - low <= error)) return std::nullopt;
    return low + (high - low) / 2;
}

template <class E>
std::optional<ChordError> error_of(const ReversedRays& ends, const ChordAnswer& answer, bool distances, double ulp) {
    const auto forth = chord_of<E>(ends.forth, ends.primitive), back = chord_of<E>(ends.back, ends.primitive);
    if (!forth || !back) return std::nullopt;
    const E size = distances ? length(lift_vec<E>(ends.forth.direction)) : E(1);
    ChordError most;
    const auto take = [&](const E& exact, double one, double other) {
        const E sum = E(one) + E(other);
        const auto apart = within(sum - size, ulp * 0x1p-10);
        const auto excess = within(sum - exact * size, ulp * 0x1p-10);
        if (!apart || !excess) return false;
        most.apart = std::max(most.apart, std::fabs(*apart / ulp));
        most.excess = std::max(most.excess, std::fabs(*excess / ulp));
        return true;
    };
    // A near side that may lie behind the origin is not compared.
    const bool ahead = (forth->near > E(0)).is_yes(), ahead_back = (back->near > E(0)).is_yes();
    if (ahead && !take(forth->near + back->far, answer.near, answer.far_back)) return std::nullopt;
    if (ahead_back && !take(forth->far + back->near, answer.far, answer.near_back)) return std::nullopt;
    return most;
}

/// A ball around a primitive, seen along a ray, in doubles. It only decides where the segment ends.
struct BallOnRay {
    double middle, half;  ///< t of the point nearest to its centre, and its radius in lengths of the direction
    double aside;         ///< distance of the line from the centre, in radii, squared

    BallOnRay(const Ray<double>& ray, const Primitive<double>& primitive) {
        const auto [centre, radius] = offset::ball_of(primitive);
        const Vec<double> f = centre - ray.origin;
        const double a = square(ray.direction);
        middle = dot(f, ray.direction) / a;
        half = radius / std::sqrt(a);
        aside = square(cross<double>(f, ray.direction)) / (a * radius * radius);
    }
    [[nodiscard]] bool is_ahead() const { return middle + half > 0; }
    /// The end lies as far behind the primitive as p lies in front of it, and behind it by at least half of its size.
    [[nodiscard]] double end() const { return middle + std::max(middle, 2 * half); }
};

/// The primitive at the pixel. If there is none, the one ahead that the ray passes nearest to; of a large mesh, only if
/// it comes near its box.
std::optional<std::size_t> primitive_of(const FormOnBand& band_form, std::size_t i) {
    const Truth truth = band_form.band.truth(i, band_form.row.convention());
    if (truth.is_hit()) return static_cast<std::size_t>(truth.object);
    std::optional<std::size_t> nearest;
    double least = HUGE_VAL;
    const FormOnBand::Candidates near = band_form.candidates(band_form.inputs.rays[i]);
    for (std::size_t k = 0; k < near.indices.size(); ++k) {
        const BallOnRay around(band_form.inputs.rays[i], near.primitives[k]);
        if (around.is_ahead() && around.aside < least) least = around.aside, nearest = near.indices[k];
    }
    return nearest;
}

/// The segment of a pixel; q is its end, rounded to the format. Nothing if there is no primitive.
std::optional<ReversedRays> segment_of(const FormOnBand& band_form, std::size_t i) {
    const auto k = primitive_of(band_form, i);
    if (!k) return std::nullopt;
    const Ray<double> ray = band_form.inputs.rays[i];
    const BallOnRay around(ray, band_form.inputs.primitives[*k]);
    if (!around.is_ahead()) return std::nullopt;
    const Vec<double> p = ray.origin;
    Vec<double> q{0, 0, 0}, way{0, 0, 0};
    with_number(band_form.row.format, [&]<class T>() {
        for (int axis = 0; axis < 3; ++axis) {
            const T end = static_cast<T>(std::fma(around.end(), ray.direction[axis], p[axis]));
            q[axis] = as_double(end);
            way[axis] = as_double(end - static_cast<T>(p[axis]));
        }
    });
    const ReversedRays ends{{p, way}, {q, Vec<double>(-way.x, -way.y, -way.z)}, band_form.inputs.primitives[*k]};
    if (!truth::is_proper(ends.forth) || !truth::is_proper(ends.back)) return std::nullopt;
    return ends;
}

RayBlock as_unit(RayBlock rays, const FloatFormat& format) {
    truth::make_unit({rays.dx, rays.dy, rays.dz}, format);
    return rays;
}

/// Segments of a band seen from one end: their truth, and the form's answers.
struct SegmentsFromEnd {
    truth::Band band;
    AllAnswers answers;

    SegmentsFromEnd(const FormOnBand& band_form, const RayBlock& rays, const std::vector<Primitive<double>>& primitives)
        : band(scene::rays::RayGroup{.rays = rays, .primitives = primitives, .paired = true}),
          answers(
              answers_of(band_form.form, band_form.is_unit() ? as_unit(rays, band_form.format()) : rays, primitives)) {}
};

CheckResult check_result_of_numbers(const FormOnBand& band_form, const ReversedRays& ends, const ChordAnswer& answer,
                                    double& apart, double& excess) {
    const double size = band_form.is_unit() ? length(ends.forth.direction) : 1;
    const double ulp = std::ldexp(1.0, static_cast<int>(ulp_exponent(band_form.format(), std::ilogb(size))));
    const auto error = chord_error(ends, answer, band_form.is_unit(), ulp);
    if (!error) return CheckResult::unresolved;
    apart = error->apart;
    excess = error->excess;
    // Each t is at most L. Rounded correctly, it is off by at most half an ulp of L, and two of them by at most one.
    constexpr double most = 1;
    return error->excess > most  ? CheckResult::other_number
           : error->apart > most ? CheckResult::by_inputs
                                 : CheckResult::agree;
}

}  // namespace

std::optional<ChordError> chord_error(const ReversedRays& ends, const ChordAnswer& answer, bool distances, double ulp) {
    for (const double t : {answer.near, answer.far, answer.near_back, answer.far_back}) {
        if (!std::isfinite(t)) return ChordError{HUGE_VAL, HUGE_VAL};
    }
    return truth::by_rising_precision([&]<class E>() { return error_of<E>(ends, answer, distances, ulp); });
}

void check_reverse(const FormOnBand& band_form, PixelCheckResults& out) {
    out.apart.assign(band_form.pixels(), truth::missing);
    out.excess.assign(band_form.pixels(), truth::missing);
    std::vector<std::size_t> pixels;
    std::vector<ReversedRays> segments;
    std::vector<Primitive<double>> primitives;
    RayBlock there, back;
    for (std::size_t i = 0; i < band_form.pixels(); ++i) {
        const auto ends = segment_of(band_form, i);
        if (!ends) continue;
        pixels.push_back(i);
        segments.push_back(*ends);
        primitives.push_back(ends->primitive);
        there.push(ends->forth);
        back.push(ends->back);
    }
    if (pixels.empty()) return;
    const SegmentsFromEnd from_p(band_form, there, primitives), from_q(band_form, back, primitives);
    const bool numbers = band_form.row.form->info->roots == intersect::Roots::both;
    const AllAnswers &a = from_p.answers, &b = from_q.answers;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const std::size_t i = pixels[k];
        const auto p = from_p.band.truth(k, band_form.row.convention()).decision;
        const auto q = from_q.band.truth(k, band_form.row.convention()).decision;
        CheckResult how =
            check_result_of(a.hit[k] != 0, b.hit[k] != 0, p == Truth::Decision::hit, q == Truth::Decision::hit);
        if (p == Truth::Decision::unresolved || q == Truth::Decision::unresolved) how = CheckResult::unresolved;
        const bool all_hit = a.hit[k] != 0 && b.hit[k] != 0 && p == Truth::Decision::hit && q == Truth::Decision::hit;
        if (numbers && all_hit)
            how = check_result_of_numbers(band_form, segments[k], {a.near[k], a.far[k], b.near[k], b.far[k]},
                                          out.apart[i], out.excess[i]);
        out.set(i, how, [&] {
            TwoRays two{i, scene::rays::group_of(segments[k].forth), scene::rays::group_of(segments[k].back)};
            two.first.primitives = two.second.primitives = {segments[k].primitive};
            return two;
        });
    }
}

}  // namespace lostbits::measure::consistency
