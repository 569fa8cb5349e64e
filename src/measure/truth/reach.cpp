#include "measure/truth/reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "geometry/capped_span.hpp"
#include "geometry/flat_span.hpp"
#include "geometry/joined_span.hpp"
#include "geometry/quartic_span.hpp"
#include "geometry/wall_span.hpp"
#include "measure/truth/perturbable.hpp"

namespace lostbits::measure::truth {

namespace {

/// The quadratic P as seen from t. `B` bounds how far P(t) can be from 0, `slope` is half of the slope there, and
/// |P''|/2 lies between `least` and `most` on the way to t'.
struct LocalQuadratic {
    double B;
    AllValues slope;
    double least, most;
    double unevenness = 1;  ///< √(most/least) if P'' may change on the way

    LocalQuadratic(const Perturbable& problem, const QuadraticSpan<Differentiated>& s)
        : B(problem.aside(s.c)),
          slope(s.h.value()),
          least(AllValues(s.a.value()).least()),
          most(AllValues(s.a.value()).most()) {}
};

/// Bound on |δ|, δ = t' − t. The ray begins at t here, so that all numbers are of the size of the primitive, however
/// far away it is. Let P', a', s' belong to the problem with errors: P'(0) = c', and s' = h' is half of the slope
/// there. Then δ is a root of a'δ² + 2s'δ + P'(0), so δ = −P'(0)/(s' ± √(s'² − a'P'(0))). It is the same root if the
/// sign is that of s. Since P(0) = 0, |P'(0)| ≤ B. Let σ ≤ |s'| on the side of s. P and −P have the same roots, so let
/// a' > 0.
///
///     |δ| ≤ B/(σ + √(σ² − a'B))   if σ² ≥ a'B for the largest |a'|
///     |δ| ≤ √(B/a')               otherwise, for the smallest |a'|; plus 2|s'|/a' if s' may have the other sign
///
/// To first order the first bound is B/(2|s|), as for κ. The second one is for rays so near to a tangent that t moves
/// like a square root of the errors (the law of Hölder with exponent ½). The ray may then miss, and κ is not valid.
///
/// If P'' changes on the way, P must be convex, with a slope that has no jump. Then P lies between the parabolas with
/// the least and the largest a', and the first bound holds. Near a tangent, the root comes no later than the minimum of
/// P. That is at most |s'|/a' away for the smallest a', and s'² < a'B for the largest a': √(B/a') for the smallest a',
/// times √(most/least).
double moved_root(const LocalQuadratic& bend) {
    if (bend.B == 0) return 0;
    const double sigma = std::max(bend.slope.low, -bend.slope.high), aB = bend.most * bend.B * outward + tiny;
    if (sigma > 0 && sigma * sigma >= aB) return bend.B / (sigma + std::sqrt(sigma * sigma - aB));
    if (!(bend.least > 0)) return anywhere;
    return std::sqrt(bend.B / bend.least) * bend.unevenness + 2 * std::max(0.0, -sigma) / bend.least;
}

double moved_root(const Perturbable& problem, const QuadraticSpan<Differentiated>& s) {
    return moved_root(LocalQuadratic(problem, s));
}

/// Bound on |δ|. δ = t' − t is a root of f'(b' + a' δ) = Σ cₖ δᵏ with |c₀| ≤ B. If |cₖ| ρᵏ > Σ |cⱼ| ρʲ over all other
/// j, the circle |δ| = ρ encloses k roots, whatever the errors are (Rouché), and t' is one of them. To first order,
/// this is B/|f'| for k = 1. For k = 2 it is the bound that is left at a tangent, a square root of the errors; and so
/// on.
double moved_root(const Perturbable& problem, const QuarticSpan<Differentiated>& s) {
    const double B = problem.aside(s.f.at(s.b));
    if (B == 0) return 0;
    std::array<double, 5> most{B}, least{};
    Polynomial<Differentiated> f = s.f;
    Differentiated power = s.a;
    for (int k = 1, factorial = 1; k <= 4; ++k) {
        f = f.slope(), factorial *= k;
        const auto c = (power * f.at(s.b) / Differentiated(factorial)).value();
        power = power * s.a;
        most[static_cast<std::size_t>(k)] = std::fabs(c.value()) + c.error() * outward;
        least[static_cast<std::size_t>(k)] = std::fabs(c.value()) * (1 - 0x1p-40) - c.error() * outward;
    }
    const auto others = [&most](std::size_t k, double rho) {
        double sum = 0;
        for (std::size_t j = 5; j-- > 0;) sum = sum * rho + (j == k ? 0 : most[j]);
        return sum * outward;
    };
    double best = anywhere;
    for (std::size_t k = 1; k <= 4; ++k) {
        if (!(least[k] > 0)) continue;
        double rho = std::pow(B / least[k], 1.0 / static_cast<double>(k)) * outward;
        for (int i = 0; i < 64 && rho < best; ++i) {
            const double sum = others(k, rho);
            if (least[k] * std::pow(rho, static_cast<double>(k)) > sum) best = rho;
            else rho = std::max(rho * (1 + 0x1p-20), std::pow(sum / least[k], 1.0 / static_cast<double>(k)) * outward);
        }
    }
    return best;
}

/// Bound on |t' − t| = |n'/m'| for t = n/m, where n is 0 because the ray begins at t. If the ray is known to begin on
/// the inner side of a plane (n > 0), that plane comes no nearer.
double moved_quotient(const Perturbable& problem, const Differentiated& n, const Differentiated& m) {
    const double B = problem.aside(n);
    if (B == 0) return 0;
    const double least = AllValues(m.value()).least();
    return least > 0 ? B / least : anywhere;
}

double moved_root(const Perturbable& problem, const FlatSpan<Differentiated>& s) {
    return moved_quotient(problem, s.at.n, s.at.m);
}

double moved_root(const Perturbable& problem, const WallSpan<Differentiated>& s) {
    return moved_root(problem, s.primitive.side);
}

/// Bound for slabs. t lies on one of their planes, and moves at most as far as any plane can come to where it is. A
/// slab that the line does not cross has 1/0 there, which no error moves.
[[maybe_unused]] double moved_root(const Perturbable& problem, const SlabSpan<Differentiated>& s) {
    double most = 0;
    for (std::size_t i = 0; i < s.entry.size(); ++i)
        for (const auto& plane : {s.entry[i], s.exit[i]})
            most = std::max(most, moved_quotient(problem, plane.n, plane.m));
    return most;
}

/// Two planes with a primitive between them, seen from the start of a ray: its distance from each plane (above 0
/// between the planes), and its speed across them. A line that runs along the planes meets neither.
struct Slab {
    Differentiated from_low, from_high, across;
    bool is_along = false;

    [[nodiscard]] double moved(const Perturbable& problem, AnswerFaces moved_by = AnswerFaces::every_face) const {
        if (is_along) return 0;
        const AllValues speed(across.value());
        const bool all = moved_by == AnswerFaces::every_face;
        const double low = all || speed.high > 0 ? moved_quotient(problem, from_low, across) : 0,
                     high = all || speed.low < 0 ? moved_quotient(problem, from_high, across) : 0;
        return std::max(low, high);
    }
};

/// Slab between the ends of an axis, with all numbers multiplied by the length of the axis.
Slab slab_of(const Vec<Differentiated>& from, const Vec<Differentiated>& to, const Ray<Differentiated>& ray) {
    const Vec<Differentiated> axis = to - from;
    return {dot(axis, Vec<Differentiated>(ray.origin - from)), dot(axis, Vec<Differentiated>(to - ray.origin)),
            dot(axis, ray.direction)};
}

/// The slabs along which the line of the stored ray runs: those of a box by axis, that of a capped primitive first. A
/// speed is 0 only if that is exact: in units of the largest component, a component of 2^-900 beside 2^300 is 0 too.
using AlongSlabs = std::array<bool, 3>;

AlongSlabs along_slabs(const Perturbable& problem) {
    const auto is_zero = [](const WithinErrors& speed) { return speed.value() == 0 && speed.error() == 0; };
    return problem.with_stored([&]<class Shape>(const Shape& s, const Ray<WithinErrors>& ray) -> AlongSlabs {
        const Vec<WithinErrors>& d = ray.direction;
        if constexpr (requires { s.lo; }) return {is_zero(d.x), is_zero(d.y), is_zero(d.z)};
        else if constexpr (requires { s.base; }) return {is_zero(dot(Vec<WithinErrors>(s.top - s.base), d))};
        else return {};
    });
}

/// Movement of t for a primitive between planes along the axes. t is the largest or smallest parameter of a plane, so
/// it moves at most as far as any plane that can become that one.
template <class Shape>
double moved_between_corners(const Perturbable& problem, const Shape& s, const Ray<Differentiated>& ray,
                             AnswerFaces moved_by) {
    const AlongSlabs along = along_slabs(problem);
    double most = 0;
    for (int i = 0; i < 3; ++i) {
        const Slab slab{ray.origin[i] - s.lo[i], s.hi[i] - ray.origin[i], ray.direction[i],
                        along[static_cast<std::size_t>(i)]};
        most = std::max(most, slab.moved(problem, moved_by));
    }
    return most;
}

/// P = |p − q|² − r² for a capsule, where q is the point of the axis nearest to p. P has three pieces: the ball around
/// one end, the side, and the other ball, as p lies before the axis, beside it or behind it. It is convex, and its
/// slope has no jump where the pieces meet. Its second derivative has one, so all pieces count that the ray may pass
/// through on the way to t'.
class PiecesAlongAxis {
public:
    template <class Shape>
    PiecesAlongAxis(const Perturbable& problem, const Shape& s, const Ray<Differentiated>& ray)
        : slab_(slab_of(s.start, s.end, ray)),
          bends_{LocalQuadratic(problem, ball(s.start, s.radius, ray)), LocalQuadratic(problem, side(s, ray)),
                 LocalQuadratic(problem, ball(s.end, s.radius, ray))} {}

    [[nodiscard]] double moved() const {
        const auto here = within(0);
        const double first = moved_root(joined(here, here));
        const auto passed = within(first);
        return passed == here ? first : moved_root(joined(here, {true, true, true}));
    }

private:
    using Pieces = std::array<bool, 3>;

    static QuadraticSpan<Differentiated> ball(const Vec<Differentiated>& centre, const Differentiated& radius,
                                              const Ray<Differentiated>& ray) {
        const Vec<Differentiated> f = ray.origin - centre;
        const Differentiated zero(0);
        return {dot(f, ray.direction), square(f) - square(radius), square(ray.direction), zero, zero};
    }
    /// The quadratic of the side over v², which equals P.
    template <class Shape>
    static QuadraticSpan<Differentiated> side(const Shape& s, const Ray<Differentiated>& ray) {
        const Vec<Differentiated> v = s.end - s.start, m = cross(v, Vec<Differentiated>(ray.origin - s.start)),
                                  n = cross(v, ray.direction);
        const Differentiated v2 = square(v), zero(0);
        return {dot(m, n) / v2, square(m) / v2 - square(s.radius), square(n) / v2, zero, zero};
    }
    /// Pieces in which the ray may be at any moment within `time` of now, before or after.
    [[nodiscard]] Pieces within(double time) const {
        const double way = time == 0 ? 0 : time * AllValues(slab_.across.value()).most() * outward;
        const AllValues low(slab_.from_low.value()), high(slab_.from_high.value());
        return {!(low.low - way > 0), !(low.high + way < 0) && !(high.high + way < 0), !(high.low - way > 0)};
    }
    /// Bounds of P(t) and its slope over the pieces `here`, and of its second derivative over the pieces `passed`.
    [[nodiscard]] LocalQuadratic joined(const Pieces& here, const Pieces& passed) const {
        std::optional<LocalQuadratic> all;
        for (std::size_t i = 0; i < 3; ++i) {
            if (!here[i]) continue;
            if (!all) all = bends_[i];
            all->B = std::max(all->B, bends_[i].B), all->slope.join(bends_[i].slope);
        }
        for (std::size_t i = 0; i < 3; ++i) {
            if (!passed[i]) continue;
            all->least = std::min(all->least, bends_[i].least), all->most = std::max(all->most, bends_[i].most);
        }
        const auto pieces = std::ranges::count(passed, true);
        if (pieces > 1) all->unevenness = std::sqrt(all->most / all->least) * outward;
        return *all;
    }

    Slab slab_;
    std::array<LocalQuadratic, 3> bends_;
};

/// Bound on how far the answer moves, for a ray that begins at its answer. By shape:
///
/// - between corners: by the planes along the axes;
/// - along an axis with round ends: by the three pieces;
/// - along an axis with caps: t is on a root or a cap, and moves as far as either can come to where it is;
/// - other shapes: by the span alone.
template <class Shape>
double moved_at(const Perturbable& problem, const Shape& s, const Ray<Differentiated>& ray, AnswerFaces moved_by) {
    if constexpr (requires { s.lo; }) return moved_between_corners(problem, s, ray, moved_by);
    else if constexpr (requires { s.start; }) return PiecesAlongAxis(problem, s, ray).moved();
    else if constexpr (requires { s.base; }) {
        Slab caps = slab_of(s.base, s.top, ray);
        caps.is_along = along_slabs(problem)[0];
        return std::max(moved_root(problem, s.span(ray).side), caps.moved(problem));
    } else return moved_root(problem, s.span(ray));
}

double reach_of(const ProblemNumbers& numbers, const Certified& answer, AnswerFaces moved_by) {
    const Perturbable problem(numbers);
    const WithinErrors at = problem.of(answer);
    const double root = problem.with_ray_from(
        at, [&](const auto& shape, const Ray<Differentiated>& ray) { return moved_at(problem, shape, ray, moved_by); });
    if (root == 0) return 0;
    const double across = problem.across(at), most = root < across ? root : across;
    const auto e = std::clamp<std::int64_t>(problem.time() - exponent_of_unit(answer), -5000, 5000);
    return std::ldexp(most * outward, static_cast<int>(e)) + tiny;
}

}  // namespace

double reach(const Ray<double>& ray, const Primitive<double>& primitive, const Certified& answer, Length length,
             const FloatFormat& format, Perturbed perturbed, AnswerFaces moved_by) {
    return reach_of(ProblemNumbers(ray, primitive, format, perturbed, length), answer, moved_by);
}
double reach(const Ray<Real>& ray, const Primitive<Real>& primitive, const Certified& answer, Length length,
             const FloatFormat& format, Perturbed perturbed, AnswerFaces moved_by) {
    return reach_of(ProblemNumbers(ray, primitive, format, perturbed, length), answer, moved_by);
}

}  // namespace lostbits::measure::truth
