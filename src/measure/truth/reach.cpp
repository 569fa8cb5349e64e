#include "measure/truth/reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>

#include "geometry/capped_span.hpp"
#include "geometry/flat_span.hpp"
#include "geometry/joined_span.hpp"
#include "geometry/quartic_span.hpp"
#include "geometry/wall_span.hpp"
#include "measure/truth/lost_bits.hpp"
#include "number/bounded.hpp"
#include "number/dual.hpp"
#include "number/real.hpp"

namespace lostbits::measure::truth {

namespace {

/// Makes up for the roundings of the bound itself, a few dozen u.
constexpr double outward = 1 + 0x1p-40;
constexpr double anywhere = std::numeric_limits<double>::infinity();
constexpr int exponent_of_zero = -1000000;
constexpr double tiny = std::numeric_limits<double>::denorm_min();  ///< what a product that underflows may have lost

using One = Bounded<double>;
/// With room for the numbers of any problem.
using Each = Dual<One, 6 + most_stored>;

double scaled(double x, int e) { return e == 0 ? x : std::ldexp(x, e); }
double scaled(const Real& x, int e) { return Real(ldexp(x, e)).convert_to<double>(); }
int binary_exponent(double x) { return x == 0 ? exponent_of_zero : std::ilogb(x); }
int binary_exponent(const Real& x) {
    int e = 0;
    if (x != 0) static_cast<void>(frexp(x, &e));
    return x == 0 ? exponent_of_zero : e - 1;
}

/// √Σx², of numbers whose squares may underflow too.
double length_of(std::span<const double> x, std::size_t first, std::size_t end) {
    double largest = 0, squares = 0;
    for (std::size_t i = first; i < end; ++i) largest = std::max(largest, std::fabs(x[i]));
    const int e = std::clamp(binary_exponent(largest), -1000, 1000);
    for (std::size_t i = first; i < end; ++i) squares += std::ldexp(x[i], -e) * std::ldexp(x[i], -e);
    return std::ldexp(std::sqrt(squares), e);
}

/// All that a number may be.
struct Extent {
    double low, high;

    explicit Extent(const One& x)
        : low(std::nextafter(x.value() - x.error(), -anywhere)),
          high(std::nextafter(x.value() + x.error(), anywhere)) {}
    /// The largest and the least size of them.
    [[nodiscard]] double most() const { return std::max(std::fabs(low), std::fabs(high)); }
    [[nodiscard]] double least() const { return std::max({0.0, low, -high}); }
    void join(const Extent& x) { low = std::min(low, x.low), high = std::max(high, x.high); }
};

/// The numbers of a problem (origin, direction, the solid's, its matrix's), in units in which its largest length and
/// its largest component of d are about 1, and how far each may be off. Under a matrix the lengths of the solid have a
/// unit of their own, and A that of a quotient; what is a direction of the solid has one too. No number is above 1
/// then, so that nothing overflows, and what small ones lose to underflow is in the bounds.
class Numbers {
public:
    template <class S>
    Numbers(const Ray<S>& r, const Solid<S>& s, const FloatFormat& format, Perturbed perturbed, Length length)
        : matrix_(6 + row_of(s.shape).numbers),
          count_(matrix_ + (s.placed ? Affine<S>::numbers : 0)),
          shape_(s.shape),
          normwise_(perturbed == Perturbed::normwise),
          as_distance_(length == Length::distance) {
        const auto number = [&](std::size_t i) {
            return i < 3         ? r.origin[static_cast<int>(i)]
                   : i < 6       ? r.direction[static_cast<int>(i - 3)]
                   : i < matrix_ ? s.numbers[i - 6]
                                 : s.placed->matrix[place_in_matrix(i - matrix_)];
        };
        if (s.placed) placed_ = transformed(*s.placed, [](const S&) { return 0; });
        for_each_key(shape_, [&](const Key& key, std::size_t k) {
            std::fill_n(&is_direction_[6 + k], key.count(), key.kind == Key::Kind::direction);
        });
        std::array<int, room> exponents{};
        for (std::size_t i = 0; i < count_; ++i) {
            exponents[i] = binary_exponent(number(i));
            int& unit = units_[unit_place(i)];
            unit = std::max(unit, exponents[i]);
        }
        if (placed_) put_units_of_matrix();
        for (int* const unit : {&units_[0], &units_[1]}) {  // of lengths and of directions
            if (placed_) break;
            *unit = std::abs(*unit) < 32 ? 0 : std::max(*unit, format.emin);  // that of zeros
        }
        for (std::size_t i = 0; i < count_; ++i) {
            x_[i] = scaled(number(i), -unit_of(i));
            step_[i] = scaled(1, std::max(exponents[i], format.emin) - format.precision - unit_of(i)) + tiny;
        }
        if (normwise_)
            for_each_vector([&](std::size_t first, std::size_t end) {
                std::fill(&step_[first], &step_[first] + (end - first),
                          scaled(length_of(x_, first, end), -format.precision) + tiny);
            });
        for (std::size_t i = 0; i < count_; ++i) {
            const double stored = std::is_same_v<S, double> ? 0 : std::fabs(x_[i]) * 0x1p-53;
            off_[i] = (step_[i] + stored) * outward + tiny;
        }
    }

    [[nodiscard]] bool is_placed() const { return placed_.has_value(); }
    [[nodiscard]] Shape shape() const { return shape_; }
    /// All that number i may be.
    [[nodiscard]] One at(std::size_t i) const { return {x_[i], off_[i]}; }
    /// log2 of the unit of t, or of the distance.
    [[nodiscard]] int time() const { return as_distance_ ? units_[0] : units_[0] - units_[1]; }
    [[nodiscard]] One of(const Certified& t) const {
        const auto e = std::clamp<std::int64_t>(t.exponent - time(), -5000, 5000);
        const double value = std::ldexp(t.hi, static_cast<int>(e));
        return One(value, t.is_zero() ? 0 : std::fabs(value) * 0x1p-51 + tiny);
    }

    /// |f(x') − f(x)| ≤ Σ hᵢ |∂f/∂xᵢ|, each derivative the largest within the errors (the mean value theorem); of
    /// vectors Σ hᵥ |∇ᵥ f|.
    [[nodiscard]] double moved(const Each& f) const {
        std::array<double, room> by;
        for (std::size_t i = 0; i < count_; ++i) {
            const double most = Extent(f.derivative(i)).most();
            by[i] = most == 0 ? 0 : step_[i] * most + tiny;
        }
        double sum = 0;
        if (!normwise_)
            for (std::size_t i = 0; i < count_; ++i) sum += by[i];
        else for_each_vector([&](std::size_t first, std::size_t end) { sum += length_of(by, first, end); });
        return sum * outward;
    }

    /// How far f(x') can be from 0, of an f that is 0 where t is its root. Where it is not (the range begins there, or
    /// another face is met), what the enclosure of f(x') leaves beyond 0 bounds it too, and is often nothing.
    [[nodiscard]] double aside(const Each& f) const {
        const One& all = f.value();
        return std::min(moved(f), std::max(0.0, all.error() * outward - std::fabs(all.value())));
    }

    /// Both points of the solid that are met, X = o + t d and X' = o' + t' d', lie within a ball of radius R, X' but
    /// for what the solid itself moves: |t' − t| (|d| − |Δd|) ≤ |X' − X| + |Δo| + |t| |Δd|. Of distances with e =
    /// d/|d| for d, where |e| = 1 and |Δe| ≤ 2|Δd|/(2|d| − |Δd|) (Dunkl and Williams, A simple norm inequality, 1964).
    [[nodiscard]] double across(const One& t) const {
        if (placed_) return anywhere;
        Solid<double> plain(shape_);
        std::copy_n(x_.begin() + 6, plain.used().size(), plain.numbers.begin());
        // Of a radius the roundings, and what its squares lose to underflow.
        double away = 2 * ball_around(plain).radius + 0x1p-48 * length_of(x_, 6, count_) + 0x1p-500;
        for_each_vector([&](std::size_t first, std::size_t end) {
            if (first != 3) away += length_of(step_, first, end);
        });
        const double turn = length_of(step_, 3, 6), d = length_of(x_, 3, 6) - turn;
        if (!(d > 0)) return anywhere;
        const double turned = as_distance_ ? 2 * turn / (2 * d + turn) : turn;
        return (away + std::fabs(t.value()) * turned) * (1 + 0x1p-30) / (as_distance_ ? 1 : d);
    }

protected:
    std::size_t matrix_, count_;            ///< where those of a matrix begin, and how many there are
    std::optional<Placement<int>> placed_;  ///< without its numbers
    [[nodiscard]] bool is_as_distance() const { return as_distance_; }

private:
    static constexpr std::size_t room = 6 + most_stored;

    /// Of the world's lengths, directions, the solid's lengths under a matrix, its linear part, the solid's directions.
    [[nodiscard]] std::size_t unit_place(std::size_t i) const {
        if (i >= 3 && i < 6) return 1;
        if (i >= 6 && i < matrix_ && is_direction_[i]) return 4;
        if (!placed_ || i < 3) return 0;
        if (i < matrix_) return 2;
        return i < matrix_ + 9 ? 3 : placed_->is_inverse ? 2 : 0;
    }
    [[nodiscard]] int unit_of(std::size_t i) const { return units_[unit_place(i)]; }
    /// x of the world is A x' + τ of the solid, or the other way: A's unit is the quotient of both, and where A is
    /// larger the unit of what it makes grows.
    void put_units_of_matrix() {
        const bool inverse = placed_->is_inverse;
        int &made = units_[inverse ? 2 : 0], &from = units_[inverse ? 0 : 2], &linear = units_[3];
        from = std::max(from, -1000);  // of zeros
        made = std::max(made, linear + from);
        linear = made - from;
    }
    template <class Act>
    void for_each_vector(const Act& act) const {
        act(0, 3), act(3, 6);
        for_each_key(shape_, [&](const Key& key, std::size_t k) { act(6 + k, 6 + k + key.count()); });
        if (placed_) act(matrix_, matrix_ + 9), act(matrix_ + 9, count_);
    }

    Shape shape_;
    bool normwise_, as_distance_;
    std::array<int, 5> units_{exponent_of_zero, exponent_of_zero, exponent_of_zero, exponent_of_zero, exponent_of_zero};
    std::array<bool, room> is_direction_{};
    std::array<double, room> x_, step_, off_;
};

/// A problem as functions of its numbers: f(x') of any x' within the errors is in f(ray, solid). Of distances the
/// direction is d/|d|, a function of its numbers too, so that t is the distance.
struct Perturbable : Numbers {
    Ray<Each> ray;
    Solid<Each> solid;

    explicit Perturbable(const Numbers& numbers) : Numbers(numbers), solid(numbers.shape()) {
        const auto input = [&](std::size_t i) { return Each::input(at(i), i, count_); };
        ray = {{input(0), input(1), input(2)}, {input(3), input(4), input(5)}};
        if (is_as_distance()) {
            const Each size = sqrt(square(ray.direction));
            ray.direction = {ray.direction.x / size, ray.direction.y / size, ray.direction.z / size};
        }
        for (std::size_t i = 6; i < matrix_; ++i) solid.numbers[i - 6] = input(i);
        if (!placed_) return;
        solid.placed = transformed(*placed_, [](int) { return Each(0); });
        for (std::size_t i = matrix_; i < count_; ++i) solid.placed->matrix[place_in_matrix(i - matrix_)] = input(i);
    }

    /// `act(shape, ray)` in the space of the solid, the ray from its point at t on.
    template <class Act>
    [[nodiscard]] auto with_ray_from(const One& t, const Act& act) const {
        const Ray<Each> from{ray.origin + Each(t) * ray.direction, ray.direction};
        return visit_shape(solid, [&]<template <class> class Of>() { return in_its_space<Of>(from, solid, act); });
    }
};

/// P as seen from t: how far P(t) can be from 0, half of the slope there, and half of the second derivative on the way
/// to t', |P''|/2 from `least` to `most`.
struct Bend {
    double B;
    Extent slope;
    double least, most;
    double unevenness = 1;  ///< √(most/least) where it may change on the way

    Bend(const Perturbable& problem, const QuadraticSpan<Each>& s)
        : B(problem.aside(s.c)),
          slope(s.h.value()),
          least(Extent(s.a.value()).least()),
          most(Extent(s.a.value()).most()) {}
};

/// The ray begins at t here, so that all is of the size of the solid, however far away it is. With P' and s' of the
/// problem with errors, P'(0) = c' and half of its slope there, h': t' − t is a root of a'δ² + 2s'δ + P'(0), which is
/// −P'(0)/(s' ± √(s'² − a'P'(0))), and the same root where the sign is that of s. With |P'(0)| ≤ B, as P(0) = 0, and
/// σ ≤ |s'| on the side of s,
///     |δ| ≤ B/(σ + √(σ² − a'B))  where σ² ≥ a'B for the largest |a'|: B/(2|s|) to first order, which is κ's;
///     |δ| ≤ √(B/a')              where not, for the smallest |a'|: as near to a tangent t goes as a square root (the
///                                law of Hölder with exponent ½), the ray may miss, and κ says nothing any more;
/// and |s'|/a' twice more where s' may have the other sign. P and −P have the same roots: a' > 0 is no loss.
///
/// Where P is convex, its slope has no jump, and P'' changes on the way, a'δ² + 2s'δ + P'(0) with the least a' lies
/// below P and with the largest above, so that the first bound holds; near a tangent the root comes no later than the
/// least P does, at no more than s'/a' with s'² < a'B for the largest: √(B/a') of the smallest, √(most/least) times.
double moved_root(const Bend& bend) {
    if (bend.B == 0) return 0;
    const double sigma = std::max(bend.slope.low, -bend.slope.high), aB = bend.most * bend.B * outward + tiny;
    if (sigma > 0 && sigma * sigma >= aB) return bend.B / (sigma + std::sqrt(sigma * sigma - aB));
    if (!(bend.least > 0)) return anywhere;
    return std::sqrt(bend.B / bend.least) * bend.unevenness + 2 * std::max(0.0, -sigma) / bend.least;
}

double moved_root(const Perturbable& problem, const QuadraticSpan<Each>& s) { return moved_root(Bend(problem, s)); }

/// δ = t' − t is a root of f'(b' + a' δ) = Σ cₖ δᵏ with |c₀| ≤ B. Where |cₖ| ρᵏ > Σ |cⱼ| ρʲ over all other j, the
/// circle |δ| = ρ goes around k roots whatever the errors are (Rouché), of which t' is one: for k = 1 that is B/|f'| to
/// first order, for k = 2 what a tangent leaves, as a square root of the errors, and so on.
double moved_root(const Perturbable& problem, const QuarticSpan<Each>& s) {
    const double B = problem.aside(s.f.at(s.b));
    if (B == 0) return 0;
    std::array<double, 5> most{B}, least{};
    Polynomial<Each> f = s.f;
    Each power = s.a;
    for (int k = 1, factorial = 1; k <= 4; ++k) {
        f = f.slope(), factorial *= k;
        const auto c = (power * f.at(s.b) / Each(factorial)).value();
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

/// t' − t = n'/m' of t = n/m, where n is 0 as the ray begins at t. A plane of which the ray is known to begin on the
/// inner side, n > 0, comes no nearer.
double moved_quotient(const Perturbable& problem, const Each& n, const Each& m) {
    const double B = problem.aside(n);
    if (B == 0) return 0;
    const double least = Extent(m.value()).least();
    return least > 0 ? B / least : anywhere;
}

double moved_root(const Perturbable& problem, const FlatSpan<Each>& s) {
    return moved_quotient(problem, s.at.n, s.at.m);
}

double moved_root(const Perturbable& problem, const WallSpan<Each>& s) { return moved_root(problem, s.solid.side); }

/// Two planes between which a solid lies, seen from where a ray begins: how far it is from each, n > 0 between them,
/// and how fast it goes across.
struct Slab {
    Each from_low, from_high, across;

    [[nodiscard]] double moved(const Perturbable& problem) const {
        if (across.value().value() == 0) return 0;
        return std::max(moved_quotient(problem, from_low, across), moved_quotient(problem, from_high, across));
    }
};

/// The slab between the ends of an axis; all of it times the length of the axis.
Slab slab_of(const Vec<Each>& from, const Vec<Each>& to, const Ray<Each>& ray) {
    const Vec<Each> axis = to - from;
    return {dot(axis, Vec<Each>(ray.origin - from)), dot(axis, Vec<Each>(to - ray.origin)), dot(axis, ray.direction)};
}

/// How far the answer of a ray that begins there moves at a shape.
template <class Shape>
double moved_at(const Perturbable& problem, const Shape& shape, const Ray<Each>& ray) {
    return moved_root(problem, shape.span(ray));
}

/// t is where one of these is met, the largest or the smallest: it moves as far as any that can come to where it is.
double moved_at(const Perturbable& problem, const Box<Each>& box, const Ray<Each>& ray) {
    double most = 0;
    for (int i = 0; i < 3; ++i)
        most =
            std::max(most, Slab{ray.origin[i] - box.lo[i], box.hi[i] - ray.origin[i], ray.direction[i]}.moved(problem));
    return most;
}

/// t is a root or on a cap: as far as either can come to where it is.
double moved_at(const Perturbable& problem, const Cylinder<Each>& s, const Ray<Each>& ray) {
    return std::max(moved_root(problem, s.span(ray).side), slab_of(s.base, s.top, ray).moved(problem));
}
double moved_at(const Perturbable& problem, const Cone<Each>& s, const Ray<Each>& ray) {
    return std::max(moved_root(problem, s.span(ray).side), slab_of(s.base, s.top, ray).moved(problem));
}

/// P = |p − q|² − r², q the point of the axis nearest to p: that of the ball around one end, of the side or of the
/// other ball, as p lies before the axis, beside it or behind. It is convex, its slope has no jump where the pieces
/// meet, and its second derivative does, so that all pieces count that the ray may pass through on the way to t'.
class CapsulePieces {
public:
    CapsulePieces(const Perturbable& problem, const Capsule<Each>& s, const Ray<Each>& ray)
        : slab_(slab_of(s.start, s.end, ray)),
          bends_{Bend(problem, Sphere<Each>{s.start, s.radius}.span(ray)), Bend(problem, side(s, ray)),
                 Bend(problem, Sphere<Each>{s.end, s.radius}.span(ray))} {}

    [[nodiscard]] double moved() const {
        const auto here = within(0);
        const double first = moved_root(joined(here, here));
        const auto passed = within(first);
        return passed == here ? first : moved_root(joined(here, {true, true, true}));
    }

private:
    using Pieces = std::array<bool, 3>;

    /// The quadratic of the side over v², which is P.
    static QuadraticSpan<Each> side(const Capsule<Each>& s, const Ray<Each>& ray) {
        const Vec<Each> v = s.end - s.start, m = cross(v, Vec<Each>(ray.origin - s.start)), n = cross(v, ray.direction);
        const Each v2 = square(v), zero(0);
        return {dot(m, n) / v2, square(m) / v2 - square(s.radius), square(n) / v2, zero, zero};
    }
    /// The pieces in which the ray may be within this time, before or after.
    [[nodiscard]] Pieces within(double time) const {
        const double way = time == 0 ? 0 : time * Extent(slab_.across.value()).most() * outward;
        const Extent low(slab_.from_low.value()), high(slab_.from_high.value());
        return {!(low.low - way > 0), !(low.high + way < 0) && !(high.high + way < 0), !(high.low - way > 0)};
    }
    /// P(t) and its slope in any of those pieces, and its second derivative in any of these.
    [[nodiscard]] Bend joined(const Pieces& here, const Pieces& passed) const {
        std::optional<Bend> all;
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
    std::array<Bend, 3> bends_;
};

double moved_at(const Perturbable& problem, const Capsule<Each>& s, const Ray<Each>& ray) {
    return CapsulePieces(problem, s, ray).moved();
}

double reach_of(const Numbers& numbers, const Certified& answer) {
    const Perturbable problem(numbers);
    const One at = problem.of(answer);
    const double root = problem.with_ray_from(
        at, [&](const auto& shape, const Ray<Each>& ray) { return moved_at(problem, shape, ray); });
    if (root == 0) return 0;
    const double across = problem.across(at), most = root < across ? root : across;
    const auto e = std::clamp<std::int64_t>(problem.time() - exponent_of_unit(answer), -5000, 5000);
    return std::ldexp(most * outward, static_cast<int>(e)) + tiny;
}

}  // namespace

double reach(const Ray<double>& ray, const Solid<double>& solid, const Certified& answer, Length length,
             const FloatFormat& format, Perturbed perturbed) {
    return reach_of(Numbers(ray, solid, format, perturbed, length), answer);
}
double reach(const Ray<Real>& ray, const Solid<Real>& solid, const Certified& answer, Length length,
             const FloatFormat& format, Perturbed perturbed) {
    return reach_of(Numbers(ray, solid, format, perturbed, length), answer);
}

}  // namespace lostbits::measure::truth
