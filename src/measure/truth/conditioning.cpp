#include "measure/truth/conditioning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "measure/truth/lost_bits.hpp"
#include "measure/truth/missing.hpp"
#include "number/dual.hpp"

namespace lostbits::measure::truth {

using intersect::Convention;

namespace {

/// Every number of a problem with N of them as an input of its own: origin, direction, the solid's.
template <class E, std::size_t N>
struct Problem {
    using Sensitive = Dual<E, N>;
    std::vector<E> x;
    Ray<Sensitive> ray;
    Solid<Sensitive> solid;

    template <class S>
    Problem(const Ray<S>& r, const Solid<S>& s) : x(listed(r, s)), ray{vec(0), vec(3)} {
        solid.shape = s.shape;
        for (std::size_t i = 6; i < N; ++i) solid.numbers[i - 6] = Sensitive::input(x[i], i);
    }

private:
    template <class S>
    static std::vector<E> listed(const Ray<S>& r, const Solid<S>& s) {
        std::vector<E> all;
        for (const Vec<S>& v : {r.origin, r.direction}) {
            for (int i = 0; i < 3; ++i) all.push_back(lift<E>(v[i]));
        }
        for (const S& n : s.used()) all.push_back(lift<E>(n));
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
        return find_condition<6 + row_of(shape_as<Of>).numbers>(ray, solid, convention_in(range, convention), range);
    });
}

double as_double(double x) { return x; }
double as_double(const Real& x) { return x.convert_to<double>(); }

/// Σ |xᵢ ∂f/∂xᵢ|.
template <class E, std::size_t N>
E moved(const Problem<E, N>& problem, const Dual<E, N>& f) {
    E sum(0);
    for (std::size_t i = 0; i < N; ++i) sum = sum + abs(problem.x[i] * f.derivative(i));
    return sum;
}

/// How far half an ulp in each input can move t: |Δp| + √|Δq| of t = p ± √q, and at t = 0 as far as the surface can
/// move.
template <class E, std::size_t N>
double reach_in(const Problem<E, N>& problem, const QuadraticSpan<Dual<E, N>>& s, double t, double linear,
                double relative) {
    const E half_ulp(relative);
    const E squared = half_ulp * moved(problem, s.q / (s.a * s.a));
    const double roots = as_double(E(half_ulp * moved(problem, -s.h / s.a) + sqrt(squared)));
    if (t != 0) return std::min(linear, roots);
    const E aside = half_ulp * moved(problem, s.c), slope = abs(s.h.value()) + abs(s.h.value());
    if (abs(s.c.value()) > aside) return 0;
    return slope > E(0) ? std::min(as_double(E(aside / slope)), roots) : roots;
}

template <class E, std::size_t N>
double reach_in(const Problem<E, N>& problem, const SlabSpan<Dual<E, N>>& s, double t, double linear, double relative) {
    if (t != 0) return linear;
    E most(0);
    for (const auto* side : {&s.entry, &s.exit}) {
        for (std::size_t i = 0; i < side->size(); ++i) {
            if (!s.crossed[i]) continue;
            const auto& [n, m] = (*side)[i];
            const E aside = E(relative) * moved(problem, n);
            if (abs(n.value()) <= aside) most = max(most, E(aside / m.value()));
        }
    }
    return as_double(most);
}

template <class E, std::size_t N>
double reach_in(const Problem<E, N>& problem, const FlatSpan<Dual<E, N>>& s, double t, double linear, double relative) {
    if (t != 0) return linear;
    const E aside = E(relative) * moved(problem, s.at.n);
    return abs(s.at.n.value()) <= aside ? as_double(E(aside / s.at.m.value())) : 0;
}

template <class E, class S>
double reach_with(const Ray<S>& ray, const Solid<S>& solid, double t, double linear, double relative) {
    return visit(solid, [&]<template <class> class Of>(const Of<S>&) {
        constexpr std::size_t N = 6 + row_of(shape_as<Of>).numbers;
        const Problem<E, N> problem(ray, solid);
        return reach_in<E, N>(problem, problem.solid.template as<Of>().span(problem.ray), t, linear, relative);
    });
}

template <class S>
double reach_of(const Ray<S>& ray, const Solid<S>& solid, double t, double condition, int precision) {
    const double half_ulp = std::ldexp(1.0, -precision), linear = condition * std::fabs(t) * half_ulp;
    const double quick = reach_with<double>(ray, solid, t, linear, half_ulp);
    // Beyond double's range a square is infinite, or nothing.
    return std::isfinite(quick) && quick > 0 ? quick : reach_with<Real>(ray, solid, t, linear, half_ulp);
}

}  // namespace

double condition(const Ray<double>& ray, const Solid<double>& solid, Convention convention,
                 const Range<double>& range) {
    return condition_of(ray, solid, convention, range);
}
double condition(const Ray<Real>& ray, const Solid<Real>& solid, Convention convention, const Range<double>& range) {
    return condition_of(ray, solid, convention, range);
}

double reach(const Ray<double>& ray, const Solid<double>& solid, double t, double condition, int precision) {
    return reach_of(ray, solid, t, condition, precision);
}
double reach(const Ray<Real>& ray, const Solid<Real>& solid, double t, double condition, int precision) {
    return reach_of(ray, solid, t, condition, precision);
}

double excess_bits(double t, const Certified& truth, const FloatFormat& format, double condition, double reach) {
    const int precision = format.precision;
    const double inherent = inherent_bits(condition, precision);
    if (inherent < precision || !std::isfinite(reach))
        return std::max(0.0, lost_bits(ulp_error(t, truth, format), precision) - inherent);
    if (std::isinf(t)) return may_round_to(truth, t, format) ? 0 : precision;
    const auto half_ulp = static_cast<int>(ulp_exponent(format, truth.floor_log2())) - 1;
    const double allowed = std::max(reach, std::ldexp(1.0, half_ulp));
    if (allowed == 0) return t == 0 ? 0 : precision;
    const int scale = std::ilogb(allowed);
    const double times = std::fabs(scaled_difference(exactly(t), truth, scale)) / std::ldexp(allowed, -scale);
    if (!(times > 1)) return 0;
    return std::isinf(times) ? precision : std::min(bits::log2_of(times), static_cast<double>(precision));
}

double inherent_bits(double condition, int precision) { return lost_bits(condition / 2, precision); }

}  // namespace lostbits::measure::truth
