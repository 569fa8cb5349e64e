#include "measure/truth/conditioning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "measure/truth/missing.hpp"
#include "number/dual.hpp"

namespace lostbits::measure::truth {

using intersect::Convention;

namespace {

/// A problem, its numbers one after another: origin, direction, the solid's, its matrix's.
struct Given {
    Shape shape;
    std::variant<std::vector<double>, std::vector<Real>> numbers;
    std::optional<Placement<int>> placed;  ///< without its numbers

    template <class S>
    Given(const Ray<S>& ray, const Solid<S>& solid) : shape(solid.shape) {
        auto& all = numbers.emplace<std::vector<S>>();
        for (const Vec<S>& v : {ray.origin, ray.direction}) all.insert(all.end(), {v.x, v.y, v.z});
        all.insert(all.end(), solid.used().begin(), solid.used().end());
        if (!solid.placed) return;
        all.insert(all.end(), solid.placed->matrix.begin(), solid.placed->matrix.end());
        placed = transformed(*solid.placed, [](const S&) { return 0; });
    }
};

/// Each of its numbers, of which there are at most N, as an input of its own.
template <class E, std::size_t N>
struct Problem {
    using Sensitive = Dual<E, N>;
    std::vector<E> x;
    Ray<Sensitive> ray;
    Solid<Sensitive> solid;

    explicit Problem(const Given& given) : solid(given.shape) {
        const auto lift_all = [&](const auto& numbers) {
            for (const auto& n : numbers) x.push_back(lift<E>(n));
        };
        std::visit(lift_all, given.numbers);
        std::size_t i = 0;
        const auto next = [&] { return ++i, Sensitive::input(x[i - 1], i - 1); };
        for (Vec<Sensitive>* const v : {&ray.origin, &ray.direction}) v->x = next(), v->y = next(), v->z = next();
        for (Sensitive& number : solid.used()) number = next();
        if (!given.placed) return;
        solid.placed = transformed(*given.placed, [](int) { return Sensitive(0); });
        for (Sensitive& number : solid.placed->matrix) number = next();
    }
};

constexpr double tightness = 0x1p-20;

std::optional<double> close_enough(const Ball& k) {
    if (!k.is_bounded() || !(k.radius() <= tightness * std::fabs(k.hi()))) return std::nullopt;
    return k.hi();
}

std::optional<double> close_enough(const Interval& k) {
    if (!k.is_bounded()) return std::nullopt;
    const double low = mpfr_get_d(k.lower(), MPFR_RNDD), high = mpfr_get_d(k.upper(), MPFR_RNDU);
    if (std::isinf(low)) return low;
    if (!(high - low <= tightness * high)) return std::nullopt;
    return mpfr_get_d(k.lower(), MPFR_RNDN);
}

/// What `Asked` makes of t and its derivatives at one precision; nothing where that is too low. The solid is of that
/// shape.
template <class Asked, class E, std::size_t N, template <class> class Of>
std::optional<typename Asked::Answer> asked_in(const Given& given, Convention convention, const Range<double>& of_ray) {
    const Problem<E, N> problem(given);
    const auto range = range_over<Dual<E, N>, E>(of_ray);
    const auto span = span_of<Of>(problem.ray, problem.solid);
    const auto found = enclose<Dual<E, N>>(span, range ? &*range : nullptr, convention);
    if (found.hit.is_no()) return Asked::none();
    if (!found.hit.is_yes()) return std::nullopt;
    const bool at_double_root = may_touch_before<std::remove_const_t<decltype(span)>> && found.touching;
    if (at_double_root || (found.t.value().is_exact() && (found.t.value() <= E(0)).is_yes())) return Asked::endless();
    return Asked::of(found.t, problem.x);
}

struct OfCondition {
    using Answer = double;
    static double none() { return missing; }
    static double endless() { return std::numeric_limits<double>::infinity(); }
    template <class T, class E>
    static std::optional<double> of(const T& t, const std::vector<E>& x) {
        E sum(0);
        for (std::size_t i = 0; i < x.size(); ++i) sum = sum + abs(x[i] * t.derivative(i));
        return close_enough(sum / t.value());
    }
};

double middle_of(const Ball& x) { return x.hi(); }
double middle_of(const Interval& x) { return mpfr_get_d(x.lower(), MPFR_RNDN); }
double width_of(const Ball& x) { return x.is_bounded() ? x.radius() : HUGE_VAL; }
double width_of(const Interval& x) {
    return x.is_bounded() ? mpfr_get_d(x.upper(), MPFR_RNDU) - mpfr_get_d(x.lower(), MPFR_RNDD) : HUGE_VAL;
}

struct OfGradient {
    using Answer = std::vector<double>;
    static Answer none() { return {}; }
    static Answer endless() { return {}; }
    template <class T, class E>
    static std::optional<Answer> of(const T& t, const std::vector<E>& x) {
        Answer all;
        double largest = 0, width = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            all.push_back(middle_of(t.derivative(i)));
            largest = std::max(largest, std::fabs(all.back()));
            width = std::max(width, width_of(t.derivative(i)));
        }
        const bool near = std::isfinite(largest) && width <= 0x1p-40 * largest;
        return near ? std::optional(std::move(all)) : std::nullopt;
    }
};

/// Intervals are asked seldom, so that one function serves solids with and without a matrix.
template <class Asked, template <class> class Of>
typename Asked::Answer find_in(const Given& given, Convention convention, const Range<double>& range) {
    constexpr std::size_t N = 6 + row_of(shape_as<Of>).numbers, under_matrix = N + Affine<double>::numbers;
    const auto quick = given.placed ? asked_in<Asked, Ball, under_matrix, Of>(given, convention, range)
                                    : asked_in<Asked, Ball, N, Of>(given, convention, range);
    if (quick) return *quick;
    for (int bits = 384; bits <= 24576; bits *= 4) {
        const Interval::Precision precision(bits);
        if (const auto found = asked_in<Asked, Interval, under_matrix, Of>(given, convention, range)) return *found;
    }
    // What no precision settles is a division by a root that is exactly zero: a tangent.
    return Asked::endless();
}

template <class Asked, class S>
typename Asked::Answer answer_of(const Ray<S>& ray, const Solid<S>& solid, Convention convention, Range<double> range) {
    if (convention.endless) range.tmax = HUGE_VAL;
    convention = convention_in(range, convention);
    convention.touching = intersect::Touching::hit;
    const Given given(ray, solid);
    return visit_shape(solid,
                       [&]<template <class> class Of>() { return find_in<Asked, Of>(given, convention, range); });
}

}  // namespace

double condition(const Ray<double>& ray, const Solid<double>& solid, Convention convention,
                 const Range<double>& range) {
    return answer_of<OfCondition>(ray, solid, convention, range);
}
double condition(const Ray<Real>& ray, const Solid<Real>& solid, Convention convention, const Range<double>& range) {
    return answer_of<OfCondition>(ray, solid, convention, range);
}
std::vector<double> gradient(const Ray<double>& ray, const Solid<double>& solid, Convention convention,
                             const Range<double>& range) {
    return answer_of<OfGradient>(ray, solid, convention, range);
}

}  // namespace lostbits::measure::truth
