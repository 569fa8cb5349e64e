#include "measure/truth/conditioning.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "measure/truth/missing.hpp"
#include "number/dual.hpp"

namespace lostbits::measure::truth {

using intersect::Convention;

namespace {

/// Every number of a problem with N of them as an input of its own: origin, direction, the solid's, its matrix's.
template <class E, std::size_t N>
struct Problem {
    using Sensitive = Dual<E, N>;
    std::vector<E> x;
    Ray<Sensitive> ray;
    Solid<Sensitive> solid;

    template <class S>
    Problem(const Ray<S>& r, const Solid<S>& s) : x(listed(r, s)), ray{vec(0), vec(3)} {
        solid.shape = s.shape;
        std::size_t i = 6;
        const auto next = [&] { return Sensitive::input(x[i], i); };
        for (Sensitive& number : solid.used()) number = next(), ++i;
        if (!s.placed) return;
        solid.placed = transformed(*s.placed, [](const S&) { return Sensitive(0); });
        for (Sensitive& number : solid.placed->matrix) number = next(), ++i;
    }

private:
    template <class S>
    static std::vector<E> listed(const Ray<S>& r, const Solid<S>& s) {
        std::vector<E> all;
        for (const Vec<S>& v : {r.origin, r.direction}) {
            for (int i = 0; i < 3; ++i) all.push_back(lift<E>(v[i]));
        }
        for (const S& n : s.used()) all.push_back(lift<E>(n));
        if (s.placed)
            for (const S& n : s.placed->matrix) all.push_back(lift<E>(n));
        return all;
    }
    [[nodiscard]] Vec<Sensitive> vec(std::size_t i) const {
        return {Sensitive::input(x[i], i), Sensitive::input(x[i + 1], i + 1), Sensitive::input(x[i + 2], i + 2)};
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

/// κ at one precision; nothing where it is too low.
template <class E, std::size_t N, class S>
std::optional<double> condition_in(const Ray<S>& ray, const Solid<S>& solid, Convention convention,
                                   const Range<double>& given) {
    const Problem<E, N> problem(ray, solid);
    const auto range = range_over<Dual<E, N>, E>(given);
    const auto found = enclose(problem.ray, problem.solid, range ? &*range : nullptr, convention);
    if (found.hit.is_no()) return missing;
    if (!found.hit.is_yes()) return std::nullopt;
    if (found.t.value().is_exact() && (found.t.value() <= E(0)).is_yes())
        return std::numeric_limits<double>::infinity();
    E sum(0);
    for (std::size_t i = 0; i < N; ++i) sum = sum + abs(problem.x[i] * found.t.derivative(i));
    return close_enough(sum / found.t.value());
}

template <std::size_t N, class S>
double find_condition(const Ray<S>& ray, const Solid<S>& solid, Convention convention, const Range<double>& range) {
    if (const auto quick = condition_in<Ball, N>(ray, solid, convention, range)) return *quick;
    for (int bits = 384; bits <= 24576; bits *= 4) {
        const Interval::Precision precision(bits);
        if (const auto k = condition_in<Interval, N>(ray, solid, convention, range)) return *k;
    }
    // What no precision settles is a division by a root that is exactly zero: a tangent.
    return std::numeric_limits<double>::infinity();
}

template <class S>
double condition_of(const Ray<S>& ray, const Solid<S>& solid, Convention convention, Range<double> range) {
    if (convention.endless) range.tmax = HUGE_VAL;
    return visit(solid, [&]<template <class> class Of>(const Of<S>&) {
        constexpr std::size_t N = 6 + row_of(shape_as<Of>).numbers;
        convention = convention_in(range, convention);
        return solid.placed ? find_condition<N + Affine<S>::numbers>(ray, solid, convention, range)
                            : find_condition<N>(ray, solid, convention, range);
    });
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
