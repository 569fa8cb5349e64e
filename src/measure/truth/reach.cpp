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

double length_of(std::span<const double> x, std::size_t first, std::size_t end) {
    double squares = 0;
    for (std::size_t i = first; i < end; ++i) squares += x[i] * x[i];
    return std::sqrt(squares);
}

/// The numbers of a problem (origin, direction, the solid's, its matrix's), in units in which its largest length and
/// its largest component of d are about 1, and how far each may be off. Under a matrix the lengths of the solid have a
/// unit of their own, and A that of a quotient; no number is above 1 then, so that nothing overflows, and what small
/// ones lose to underflow is in the bounds.
class Numbers {
public:
    template <class S>
    Numbers(const Ray<S>& r, const Solid<S>& s, const FloatFormat& format, Perturbed perturbed)
        : matrix_(6 + row_of(s.shape).numbers),
          count_(matrix_ + (s.placed ? Affine<S>::numbers : 0)),
          shape_(s.shape),
          normwise_(perturbed == Perturbed::normwise) {
        const auto number = [&](std::size_t i) {
            return i < 3         ? r.origin[static_cast<int>(i)]
                   : i < 6       ? r.direction[static_cast<int>(i - 3)]
                   : i < matrix_ ? s.numbers[i - 6]
                                 : s.placed->matrix[place_in_matrix(i - matrix_)];
        };
        if (s.placed) placed_ = transformed(*s.placed, [](const S&) { return 0; });
        std::array<int, room> exponents{};
        for (std::size_t i = 0; i < count_; ++i) {
            exponents[i] = binary_exponent(number(i));
            int& unit = units_[unit_place(i)];
            unit = std::max(unit, exponents[i]);
        }
        if (placed_) put_units_of_matrix();
        // Within these nothing that decides underflows: a triangle multiplies four numbers.
        for (int* const unit : {&units_[0], &units_[1]})  // of lengths and of directions
            if (std::abs(*unit) < 32 && !placed_) *unit = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            x_[i] = scaled(number(i), -unit_of(i));
            const int exponent = exponents[i] - unit_of(i);
            spread_ |= exponents[i] > exponent_of_zero && exponent < -600;
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
    /// Whether beside the largest of its numbers others are so small that what is made of them underflows.
    [[nodiscard]] bool is_spread() const { return spread_; }
    /// log2 of the unit of t.
    [[nodiscard]] int time() const { return units_[0] - units_[1]; }
    [[nodiscard]] One of(const Certified& t) const {
        const auto e = std::clamp<std::int64_t>(t.exponent - time(), -5000, 5000);
        const double value = std::ldexp(t.hi, static_cast<int>(e));
        return One(value, std::fabs(value) * 0x1p-51);
    }

    /// |f(x') − f(x)| ≤ Σ hᵢ |∂f/∂xᵢ|, each derivative the largest within the errors (the mean value theorem); of
    /// vectors Σ hᵥ |∇ᵥ f|.
    [[nodiscard]] double moved(const Each& f) const {
        double sum = 0;
        const auto by = [&](std::size_t i) {
            const One slope = f.derivative(i);
            const double most = std::fabs(slope.value()) + slope.error();
            return most == 0 ? 0 : step_[i] * most + tiny;
        };
        if (!normwise_)
            for (std::size_t i = 0; i < count_; ++i) sum += by(i);
        else
            for_each_vector([&](std::size_t first, std::size_t end) {
                double squares = 0;
                for (std::size_t i = first; i < end; ++i) squares += by(i) * by(i);
                sum += std::sqrt(squares);
            });
        return sum * outward;
    }

    /// How far f(x') can be from 0, of an f that is 0 where t is its root. Where it is not (the range begins there, or
    /// another face is met), what the enclosure of f(x') leaves beyond 0 bounds it too, and is often nothing.
    [[nodiscard]] double aside(const Each& f) const {
        const One& all = f.value();
        return std::min(moved(f), std::max(0.0, all.error() * outward - std::fabs(all.value())));
    }

    /// Both points of the solid that are met, X = o + t d and X' = o' + t' d', lie within a ball of radius R, X' but
    /// for what the solid itself moves: |t' − t| (|d| − |Δd|) ≤ |X' − X| + |Δo| + |t| |Δd|.
    [[nodiscard]] double across(const One& t) const {
        if (placed_) return anywhere;
        Solid<double> plain(shape_);
        std::copy_n(x_.begin() + 6, plain.used().size(), plain.numbers.begin());
        double away = 2 * ball_around(plain).radius + 0x1p-48 * length_of(x_, 6, count_);
        for_each_vector([&](std::size_t first, std::size_t end) {
            if (first != 3) away += length_of(step_, first, end);
        });
        const double turn = length_of(step_, 3, 6);
        away += std::fabs(t.value()) * turn;
        const double d = length_of(x_, 3, 6) - turn;
        return d > 0 ? away * (1 + 0x1p-30) / d : anywhere;
    }

protected:
    std::size_t matrix_, count_;            ///< where those of a matrix begin, and how many there are
    std::optional<Placement<int>> placed_;  ///< without its numbers

private:
    static constexpr std::size_t room = 6 + most_stored;

    /// Of the world's lengths, directions, the solid's lengths under a matrix, its linear part.
    [[nodiscard]] std::size_t unit_place(std::size_t i) const {
        if (i >= 3 && i < 6) return 1;
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
    bool normwise_, spread_ = false;
    std::array<int, 4> units_{exponent_of_zero, exponent_of_zero, exponent_of_zero, exponent_of_zero};
    std::array<double, room> x_, step_, off_;
};

/// A problem as functions of its numbers: f(x') of any x' within the errors is in f(ray, solid).
struct Perturbable : Numbers {
    Ray<Each> ray;
    Solid<Each> solid;

    explicit Perturbable(const Numbers& numbers) : Numbers(numbers), solid(numbers.shape()) {
        const auto input = [&](std::size_t i) { return Each::input(at(i), i, count_); };
        ray = {{input(0), input(1), input(2)}, {input(3), input(4), input(5)}};
        for (std::size_t i = 6; i < matrix_; ++i) solid.numbers[i - 6] = input(i);
        if (!placed_) return;
        solid.placed = transformed(*placed_, [](int) { return Each(0); });
        for (std::size_t i = matrix_; i < count_; ++i) solid.placed->matrix[place_in_matrix(i - matrix_)] = input(i);
    }

    /// `act` on where the ray from its point at t on is inside of the solid.
    template <class Act>
    [[nodiscard]] auto with_span_from(const One& t, const Act& act) const {
        return with_span(Ray<Each>{ray.origin + Each(t) * ray.direction, ray.direction}, solid, act);
    }
};

/// The ray begins at t here, so that all is of the size of the solid, however far away it is. With P' and s' of the
/// problem with errors, P'(0) = c' and half of its slope there, h': t' − t is a root of a'δ² + 2s'δ + P'(0), which is
/// −P'(0)/(s' ± √(s'² − a'P'(0))), and the same root where the sign is that of s. With |P'(0)| ≤ B, as P(0) = 0, and
/// σ ≤ |s'| on the side of s,
///     |δ| ≤ B/(σ + √(σ² − a'B))  where σ² ≥ a'B for the largest |a'|: B/(2|s|) to first order, which is κ's;
///     |δ| ≤ √(B/a')              where not, for the smallest |a'|: as near to a tangent t goes as a square root (the
///                                law of Hölder with exponent ½), the ray may miss, and κ says nothing any more;
/// and |s'|/a' twice more where s' may have the other sign. P and −P have the same roots: a' > 0 is no loss.
double moved_root(const Perturbable& problem, const QuadraticSpan<Each>& s) {
    const double B = problem.aside(s.c);
    if (B == 0) return 0;
    const auto &slope = s.h.value(), &a = s.a.value();
    const double sigma = std::fabs(slope.value()) - slope.error() * outward;
    const double aB = (std::fabs(a.value()) + a.error()) * B * outward;
    if (sigma > 0 && sigma * sigma >= aB) return B / (sigma + std::sqrt(sigma * sigma - aB));
    const double least = std::fabs(a.value()) * (1 - 0x1p-40) - a.error();
    return least > 0 ? std::sqrt(B / least) + 2 * std::max(0.0, -sigma) / least : anywhere;
}

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

/// t' − t = n'/m' of t = n/m, where n is 0 as the ray begins at t.
double moved_quotient(const Perturbable& problem, const Fraction<Each>& at) {
    const double B = problem.aside(at.n);
    if (B == 0) return 0;
    const double least = at.m.value().value() * (1 - 0x1p-40) - at.m.value().error();
    return least > 0 ? B / least : anywhere;
}

/// t is one of these, the largest or the smallest: it moves as far as any that can come to where it is.
double moved_root(const Perturbable& problem, const SlabSpan<Each>& s) {
    double most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!s.crossed[i].value()) continue;
        for (const auto* side : {&s.entry, &s.exit}) most = std::max(most, moved_quotient(problem, (*side)[i]));
    }
    return most;
}

double moved_root(const Perturbable& problem, const FlatSpan<Each>& s) { return moved_quotient(problem, s.at); }

/// t is a root or on a cap: as far as either can come to where it is.
double moved_root(const Perturbable& problem, const CappedSpan<Each>& s) {
    double most = moved_root(problem, s.side);
    if (!s.crossed.value()) return most;
    for (const auto* cap : {&s.entry, &s.exit}) most = std::max(most, moved_quotient(problem, *cap));
    return most;
}

double moved_root(const Perturbable& problem, const WallSpan<Each>& s) { return moved_root(problem, s.solid.side); }

double moved_root(const Perturbable& problem, const JoinedSpan<Each>& s) {
    return std::max(moved_root(problem, s.enter), moved_root(problem, s.leave));
}

double reach_of(const Numbers& numbers, const Certified& t) {
    const Perturbable problem(numbers);
    const One at = problem.of(t);
    const double root = problem.is_spread()
                            ? anywhere
                            : problem.with_span_from(at, [&](const auto& span) { return moved_root(problem, span); });
    const double most = root == 0 ? 0 : std::min(root, problem.across(at));
    const double in_time = std::ldexp(most * outward, problem.time());
    return most > 0 && in_time < 0x1p-980 ? in_time + tiny : in_time;
}

}  // namespace

double reach(const Ray<double>& ray, const Solid<double>& solid, const Certified& t, const FloatFormat& format,
             Perturbed perturbed) {
    return reach_of(Numbers(ray, solid, format, perturbed), t);
}
double reach(const Ray<Real>& ray, const Solid<Real>& solid, const Certified& t, const FloatFormat& format,
             Perturbed perturbed) {
    return reach_of(Numbers(ray, solid, format, perturbed), t);
}

}  // namespace lostbits::measure::truth
