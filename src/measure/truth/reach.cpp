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
#include "measure/truth/perturbed_problem.hpp"

namespace lostbits::measure::truth {

namespace {

/// Bounds of the quadratic P near t. `B` bounds |P(t)|, `slope` is half of the slope at t, and |P''|/2 lies between
/// `least` and `most` on the way to t'.
struct LocalQuadratic {
    double B;
    ValueInterval slope;
    double least, most;
    double parabola_ratio = 1;  ///< √(most/least) if P'' may change on the way

    LocalQuadratic(const PerturbedProblem& problem, const QuadraticSpan<DualNumber>& span)
        : B(problem.bound_at_root(span.c)),
          slope(span.h.value()),
          least(ValueInterval(span.a.value()).min_magnitude()),
          most(ValueInterval(span.a.value()).largest_magnitude()) {}
};

/// Bound on |δ|, δ = t' − t. The ray begins at t here, so that all numbers are of the size of the primitive, however
/// far away the primitive is. Let P', a', s' belong to the problem with errors: P'(0) = c', and s' = h' is half of the
/// slope at 0. Then δ is a root of a'δ² + 2s'δ + P'(0), so δ = −P'(0)/(s' ± √(s'² − a'P'(0))). It is the same root if
/// the sign is that of s. Since P(0) = 0, |P'(0)| ≤ B. Let σ ≤ |s'| on the side of s. P and −P have the same roots, so
/// let a' > 0.
///
///     |δ| ≤ B/(σ + √(σ² − a'B))   if σ² ≥ a'B for the largest |a'|
///     |δ| ≤ √(B/a')               otherwise, for the smallest |a'|; plus 2|s'|/a' if s' may have the other sign
///
/// To first order the first bound is B/(2|s|), as for κ. The second bound is for rays so close to a tangent that t
/// moves like a square root of the errors (the law of Hölder with exponent ½). The ray may then miss, and κ is not
/// valid.
///
/// If P'' changes on the way, P must be convex, with a slope that has no jump. Then P lies between the parabolas with
/// the least and the largest a', and the first bound holds. Near a tangent, the root comes no later than the minimum of
/// P. The minimum is at most |s'|/a' away for the smallest a', and s'² < a'B for the largest a'. So the bound is
/// √(B/a') for the smallest a', times √(most/least).
double bound_root(const LocalQuadratic& local) {
    if (local.B == 0) return 0;
    const double sigma = std::max(local.slope.low, -local.slope.high),
                 aB = local.most * local.B * rounding_factor + underflow_loss;
    if (sigma > 0 && sigma * sigma >= aB) return local.B / (sigma + std::sqrt(sigma * sigma - aB));
    if (!(local.least > 0)) return unbounded;
    return std::sqrt(local.B / local.least) * local.parabola_ratio + 2 * std::max(0.0, -sigma) / local.least;
}

double bound_root(const PerturbedProblem& problem, const QuadraticSpan<DualNumber>& span) {
    return bound_root(LocalQuadratic(problem, span));
}

/// Bound on |δ|. δ = t' − t is a root of f'(b' + a' δ) = Σ cₖ δᵏ with |c₀| ≤ B. If |cₖ| ρᵏ > Σ |cⱼ| ρʲ over all other
/// j, the circle |δ| = ρ encloses k roots, whatever the errors are (Rouché), and t' is one of them. To first order,
/// this is B/|f'| for k = 1. For k = 2 it is the bound that holds at a tangent, a square root of the errors; and so on
/// for larger k.
double bound_root(const PerturbedProblem& problem, const QuarticSpan<DualNumber>& span) {
    const double B = problem.bound_at_root(span.f.at(span.b));
    if (B == 0) return 0;

    // Bounds of |cₖ| = |aᵏ f⁽ᵏ⁾(b)|/k!
    std::array<double, 5> most{B}, least{};
    Polynomial<DualNumber> f = span.f;
    DualNumber power = span.a;
    for (int k = 1, factorial = 1; k <= 4; ++k) {
        f = f.derivative();
        factorial *= k;
        const auto c = (power * f.at(span.b) / DualNumber(factorial)).value();
        power = power * span.a;
        most[k] = std::fabs(c.value()) + c.error() * rounding_factor;
        least[k] = std::fabs(c.value()) * (1 - 0x1p-40) - c.error() * rounding_factor;
    }

    const auto sum_of_others = [&most](std::size_t k, double rho) {
        double sum = 0;
        for (std::size_t j = 5; j-- > 0;) sum = sum * rho + (j == k ? 0 : most[j]);
        return sum * rounding_factor;
    };

    // For each k, starts from the radius that c₀ alone needs, and grows it until the circle encloses k roots.
    double best = unbounded;
    for (std::size_t k = 1; k <= 4; ++k) {
        if (!(least[k] > 0)) continue;
        double rho = std::pow(B / least[k], 1.0 / static_cast<double>(k)) * rounding_factor;
        for (int i = 0; i < 64 && rho < best; ++i) {
            const double sum = sum_of_others(k, rho);
            if (least[k] * std::pow(rho, static_cast<double>(k)) > sum) best = rho;
            else
                rho = std::max(rho * (1 + 0x1p-20),
                               std::pow(sum / least[k], 1.0 / static_cast<double>(k)) * rounding_factor);
        }
    }
    return best;
}

/// Bound on |t' − t| = |n'/m'| for t = n/m, where n is 0 because the ray begins at t. If the ray is known to begin on
/// the inner side of a plane (n > 0), that plane comes no nearer.
double bound_quotient(const PerturbedProblem& problem, const DualNumber& n, const DualNumber& m) {
    const double B = problem.bound_at_root(n);
    if (B == 0) return 0;
    const double least = ValueInterval(m.value()).min_magnitude();
    return least > 0 ? B / least : unbounded;
}

double bound_root(const PerturbedProblem& problem, const FlatSpan<DualNumber>& span) {
    return bound_quotient(problem, span.at.n, span.at.m);
}

double bound_root(const PerturbedProblem& problem, const WallSpan<DualNumber>& span) {
    return bound_root(problem, span.primitive.side);
}

/// Bound on |t' − t| for slabs. t lies on one of their planes, and moves at most as far as any plane that can come to
/// this point of the line. If the line does not cross a slab, the quotients of its planes are 1/0, which no error
/// moves.
[[maybe_unused]] double bound_root(const PerturbedProblem& problem, const SlabSpan<DualNumber>& span) {
    double most = 0;
    for (std::size_t i = 0; i < span.entry.size(); ++i)
        for (const auto& plane : {span.entry[i], span.exit[i]})
            most = std::max(most, bound_quotient(problem, plane.n, plane.m));
    return most;
}

/// Two planes with a primitive between them, seen from the start of a ray: the distance of this point from each plane
/// (above 0 between the planes), and the speed of the ray across the planes. A line that runs along the planes meets
/// neither.
struct Slab {
    DualNumber from_low, from_high, across;
    bool is_along = false;

    [[nodiscard]] double bound_movement(const PerturbedProblem& problem,
                                        AnswerFaces answer_faces = AnswerFaces::every_face) const {
        if (is_along) return 0;
        const ValueInterval speed(across.value());
        const bool all_faces = answer_faces == AnswerFaces::every_face;
        const double by_low = all_faces || speed.high > 0 ? bound_quotient(problem, from_low, across) : 0,
                     by_high = all_faces || speed.low < 0 ? bound_quotient(problem, from_high, across) : 0;
        return std::max(by_low, by_high);
    }
};

/// Slab between the ends of an axis, with all numbers multiplied by the length of the axis.
Slab slab_of(const Vec<DualNumber>& base, const Vec<DualNumber>& top, const Ray<DualNumber>& ray) {
    const Vec<DualNumber> axis = top - base;
    return {dot(axis, Vec<DualNumber>(ray.origin - base)), dot(axis, Vec<DualNumber>(top - ray.origin)),
            dot(axis, ray.direction)};
}

/// For each slab: true if the line of the stored ray runs along its planes. The slabs of a box are in the order of the
/// axes; the slab of a capped primitive is the first. A speed counts as 0 only if it is exactly 0: in units of the
/// largest component, 2^300, a component of 2^-900 also underflows to 0, with a bound above 0.
using AlongSlabs = std::array<bool, 3>;

AlongSlabs along_slabs(const PerturbedProblem& problem) {
    const auto is_zero = [](const BoundedDouble& speed) { return speed.value() == 0 && speed.error() == 0; };
    return problem.in_object_space_as_stored(
        [&]<class Shape>(const Shape& s, const Ray<BoundedDouble>& ray) -> AlongSlabs {
            const Vec<BoundedDouble>& d = ray.direction;
            if constexpr (requires { s.lo; }) return {is_zero(d.x), is_zero(d.y), is_zero(d.z)};
            else if constexpr (requires { s.base; }) return {is_zero(dot(Vec<BoundedDouble>(s.top - s.base), d))};
            else return {};
        });
}

/// Bound on |t' − t| for a primitive between planes across the axes. t is the largest or smallest parameter of a plane,
/// so it moves at most as far as any plane that can become this largest or smallest one.
template <class Shape>
double bound_between_corners(const PerturbedProblem& problem, const Shape& s, const Ray<DualNumber>& ray,
                             AnswerFaces answer_faces) {
    const AlongSlabs along = along_slabs(problem);
    double most = 0;
    for (int i = 0; i < 3; ++i) {
        const Slab slab{ray.origin[i] - s.lo[i], s.hi[i] - ray.origin[i], ray.direction[i], along[i]};
        most = std::max(most, slab.bound_movement(problem, answer_faces));
    }
    return most;
}

/// P = |p − q|² − r² for a capsule, where q is the point of the axis nearest to p. P has three pieces: the ball around
/// one end, the side, and the other ball, as p lies before the axis, beside it or behind it. It is convex, and its
/// slope has no jump where the pieces meet. Its second derivative has such a jump, so all pieces count that the ray may
/// pass through on the way to t'.
class PiecesAlongAxis {
public:
    template <class Shape>
    PiecesAlongAxis(const PerturbedProblem& problem, const Shape& s, const Ray<DualNumber>& ray)
        : slab_(slab_of(s.start, s.end, ray)),
          quadratics_{LocalQuadratic(problem, ball(s.start, s.radius, ray)), LocalQuadratic(problem, side(s, ray)),
                      LocalQuadratic(problem, ball(s.end, s.radius, ray))} {}

    [[nodiscard]] double bound_movement() const {
        const auto start_pieces = pieces_within(0);
        const double first_bound = bound_root(bounds_over(start_pieces, start_pieces));
        const auto passed_pieces = pieces_within(first_bound);
        return passed_pieces == start_pieces ? first_bound : bound_root(bounds_over(start_pieces, {true, true, true}));
    }

private:
    using Pieces = std::array<bool, 3>;

    static QuadraticSpan<DualNumber> ball(const Vec<DualNumber>& centre, const DualNumber& radius,
                                          const Ray<DualNumber>& ray) {
        const Vec<DualNumber> f = ray.origin - centre;
        const DualNumber zero(0);
        return {dot(f, ray.direction), square(f) - square(radius), square(ray.direction), zero, zero};
    }
    /// The quadratic of the side over v², which equals P.
    template <class Shape>
    static QuadraticSpan<DualNumber> side(const Shape& s, const Ray<DualNumber>& ray) {
        const Vec<DualNumber> v = s.end - s.start, m = cross(v, Vec<DualNumber>(ray.origin - s.start)),
                              n = cross(v, ray.direction);
        const DualNumber v2 = square(v), zero(0);
        return {dot(m, n) / v2, square(m) / v2 - square(s.radius), square(n) / v2, zero, zero};
    }
    /// Pieces in which the ray may be at any t between −`max_t` and `max_t`.
    [[nodiscard]] Pieces pieces_within(double max_t) const {
        const double path =
            max_t == 0 ? 0 : max_t * ValueInterval(slab_.across.value()).largest_magnitude() * rounding_factor;
        const ValueInterval low(slab_.from_low.value()), high(slab_.from_high.value());
        return {!(low.low - path > 0), !(low.high + path < 0) && !(high.high + path < 0), !(high.low - path > 0)};
    }
    /// Bounds of P(t) and its slope over `start_pieces`, and of its second derivative over `passed_pieces`.
    [[nodiscard]] LocalQuadratic bounds_over(const Pieces& start_pieces, const Pieces& passed_pieces) const {
        std::optional<LocalQuadratic> bounds;
        for (std::size_t i = 0; i < 3; ++i) {
            if (!start_pieces[i]) continue;
            if (!bounds) bounds = quadratics_[i];
            bounds->B = std::max(bounds->B, quadratics_[i].B);
            bounds->slope.extend(quadratics_[i].slope);
        }
        for (std::size_t i = 0; i < 3; ++i) {
            if (!passed_pieces[i]) continue;
            bounds->least = std::min(bounds->least, quadratics_[i].least);
            bounds->most = std::max(bounds->most, quadratics_[i].most);
        }
        const auto pieces = std::ranges::count(passed_pieces, true);
        if (pieces > 1) bounds->parabola_ratio = std::sqrt(bounds->most / bounds->least) * rounding_factor;
        return *bounds;
    }

    Slab slab_;
    std::array<LocalQuadratic, 3> quadratics_;
};

/// Bound on how far the answer moves, for a ray that begins at its answer. The bound depends on the shape:
///
/// - between corners: from the planes across the axes;
/// - along an axis with round ends: from the three pieces;
/// - along an axis with caps: t is on a root or a cap, so the larger of the bounds for both;
/// - other shapes: from the span alone.
template <class Shape>
double bound_answer(const PerturbedProblem& problem, const Shape& s, const Ray<DualNumber>& ray,
                    AnswerFaces answer_faces) {
    if constexpr (requires { s.lo; }) return bound_between_corners(problem, s, ray, answer_faces);
    else if constexpr (requires { s.start; }) return PiecesAlongAxis(problem, s, ray).bound_movement();
    else if constexpr (requires { s.base; }) {
        Slab caps = slab_of(s.base, s.top, ray);
        caps.is_along = along_slabs(problem)[0];
        return std::max(bound_root(problem, s.span(ray).side), caps.bound_movement(problem));
    } else return bound_root(problem, s.span(ray));
}

double find_reach(const ProblemNumbers& numbers, const CertifiedNumber& answer, AnswerFaces answer_faces) {
    const PerturbedProblem problem(numbers);
    const BoundedDouble t = problem.in_units(answer);
    const double root = problem.in_object_space_from(t, [&](const auto& shape, const Ray<DualNumber>& ray) {
        return bound_answer(problem, shape, ray, answer_faces);
    });
    if (root == 0) return 0;
    const double ball_bound = problem.ball_bound(t), min_bound = root < ball_bound ? root : ball_bound;
    const auto e = std::clamp<std::int64_t>(problem.unit_exponent() - exponent_of_unit(answer), -5000, 5000);
    return std::ldexp(min_bound * rounding_factor, static_cast<int>(e)) + underflow_loss;
}

}  // namespace

double reach(const Ray<double>& ray, const Primitive<double>& primitive, const CertifiedNumber& answer, Length length,
             const FloatFormat& format, Perturbation perturbation, AnswerFaces answer_faces) {
    return find_reach(ProblemNumbers(ray, primitive, format, perturbation, length), answer, answer_faces);
}
double reach(const Ray<Real>& ray, const Primitive<Real>& primitive, const CertifiedNumber& answer, Length length,
             const FloatFormat& format, Perturbation perturbation, AnswerFaces answer_faces) {
    return find_reach(ProblemNumbers(ray, primitive, format, perturbation, length), answer, answer_faces);
}

}  // namespace lostbits::measure::truth
