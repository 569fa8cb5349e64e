#include "measure/truth/conditioning.hpp"

#include <cmath>
#include <limits>
#include <optional>
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

/// κ at one precision; nothing where it is too low. The solid is of that shape.
template <class E, std::size_t N, template <class> class Of>
std::optional<double> condition_in(const Given& given, Convention convention, const Range<double>& of_ray) {
    const Problem<E, N> problem(given);
    const auto range = range_over<Dual<E, N>, E>(of_ray);
    const auto span = span_of<Of>(problem.ray, problem.solid);
    const auto found = enclose<Dual<E, N>>(span, range ? &*range : nullptr, convention);
    if (found.hit.is_no()) return missing;
    if (!found.hit.is_yes()) return std::nullopt;
    const bool at_double_root = may_touch_before<std::remove_const_t<decltype(span)>> && found.touching;
    if (at_double_root || (found.t.value().is_exact() && (found.t.value() <= E(0)).is_yes()))
        return std::numeric_limits<double>::infinity();
    E sum(0);
    for (std::size_t i = 0; i < problem.x.size(); ++i) sum = sum + abs(problem.x[i] * found.t.derivative(i));
    return close_enough(sum / found.t.value());
}

/// Intervals are asked seldom, so that one function serves solids with and without a matrix.
template <template <class> class Of>
double find_condition(const Given& given, Convention convention, const Range<double>& range) {
    constexpr std::size_t N = 6 + row_of(shape_as<Of>).numbers, under_matrix = N + Affine<double>::numbers;
    const auto quick = given.placed ? condition_in<Ball, under_matrix, Of>(given, convention, range)
                                    : condition_in<Ball, N, Of>(given, convention, range);
    if (quick) return *quick;
    for (int bits = 384; bits <= 24576; bits *= 4) {
        const Interval::Precision precision(bits);
        if (const auto k = condition_in<Interval, under_matrix, Of>(given, convention, range)) return *k;
    }
    // What no precision settles is a division by a root that is exactly zero: a tangent.
    return std::numeric_limits<double>::infinity();
}

template <class S>
double condition_of(const Ray<S>& ray, const Solid<S>& solid, Convention convention, Range<double> range) {
    if (convention.endless) range.tmax = HUGE_VAL;
    convention = convention_in(range, convention);
    convention.touching = intersect::Touching::hit;
    const Given given(ray, solid);
    return visit_shape(solid,
                       [&]<template <class> class Of>() { return find_condition<Of>(given, convention, range); });
}

}  // namespace

double condition(const Ray<double>& ray, const Solid<double>& solid, Convention convention,
                 const Range<double>& range) {
    return condition_of(ray, solid, convention, range);
}
double condition(const Ray<Real>& ray, const Solid<Real>& solid, Convention convention, const Range<double>& range) {
    return condition_of(ray, solid, convention, range);
}

}  // namespace lostbits::measure::truth
