// The residual over columns; see kernels.hpp for what such a file may include.
#pragma once

#include "measure/columns/kernels.hpp"
#include "measure/stages/binary32.hpp"

namespace lostbits::measure::columns {

/// o + t·d as the format computes it. A product of two floats is exact in double; their sum rounded to double and then
/// to float is rounded as if once, since 53 ≥ 2·24 + 2.
template <bool binary32, class P, class Width>
[[gnu::always_inline]] inline P along(const P& origin, const P& t, const P& direction) {
    if constexpr (binary32) {
        return stages::nearest_binary32(origin + stages::nearest_binary32(t * direction));
    } else {
        return origin + t * direction;
    }
}

template <bool binary32, class Width, class Residual>
[[gnu::always_inline]] inline void residuals_of(RawResiduals& batch, const Residual& residual) {
    using P = Pack<double, Width>;
    const double* in[RawResiduals::columns_in];
    for (int k = 0; k < RawResiduals::columns_in; ++k) in[k] = batch.in[k];
    double* const out = batch.out;
    const P none(std::numeric_limits<double>::quiet_NaN());
    RawLeft left = batch.left;
    for_each_pack<P>(
        batch.size, [&](const auto& pass) __attribute__((always_inline)) {
            const auto at = [&](int column) __attribute__((always_inline)) { return pass.load(in[column]); };
            const P t = at(RawResiduals::answer);
            const auto wanted = t >= t;
            const P p[3] = {along<binary32, P, Width>(at(RawResiduals::ox), t, at(RawResiduals::dx)),
                            along<binary32, P, Width>(at(RawResiduals::oy), t, at(RawResiduals::dy)),
                            along<binary32, P, Width>(at(RawResiduals::oz), t, at(RawResiduals::dz))};
            P value;
            const auto proved =
                wanted &&
                residual(
                    p, [&](int k) __attribute__((always_inline)) { return at(RawResiduals::solid + k); }, value);
            pass.leave(wanted && !proved, left);
            pass.store(select(proved, value, none), out);
        });
    batch.left = left;
}

/// (|v|² − r²)/(r(|v| + r)) by `Ball`'s midpoints (sums and products of doubles whose low part is 0 come out the same
/// by the rule for two words each), v = P − G, where `Ball` is sure to say that this is good enough: its radius ρ ≤
/// max(2^-40 |q|, 2^-90).
///
/// v is exact, ρ = 0. Each square, sum and root adds at most 2^-100 of itself (`dd_error`), so ρ(|v|²) ≤ 3.01·2^-100
/// |v|² and ρ of the divisor is at most 2^-97 of it. With |v|²/(r(|v| + r)) ≤ |v|/r = 1 + q,
///     ρ(q) ≤ 3.1·2^-100 (1 + |q|) + 1.1 |q| (2^-97 + 2·2^-100) ≤ 2^-98 + 2^-96 |q|.
/// The absolute 2^-960 of every step counts for nothing beside 2^-98 where r ≥ 2^-200: the divisor is at least 2^-400.
/// And none of the steps leaves [2^-900, 2^900] where |P|, |G|, r ≤ 2^200 and each component of v, |v|² − r² and q are
/// at least 2^-400 (a component may be 0).
template <bool binary32, class Width>
[[gnu::flatten]] void residuals_in(RawResiduals& batch, const Sphere<double>* /*shape*/) {
    using P = Pack<double, Width>;
    residuals_of<binary32, Width>(
        batch, [](const P* p, const auto& solid, P& value) __attribute__((always_inline)) {
            const P most(0x1p+200), least(0x1p-400);
            const P r = solid(3);
            auto proved = r >= P(0x1p-200) && r <= most;
            const auto square_along = [&](int k) __attribute__((always_inline)) {
                const P centre = solid(k);
                const TwoWords<P> v = stages::sum_of<P>(p[k], -centre);
                const P far = abs(v.hi);
                proved = proved && abs(p[k]) <= most && abs(centre) <= most && (far >= least || far <= P(0));
                return v * v;
            };
            const TwoWords<P> x2 = square_along(0), y2 = square_along(1), z2 = square_along(2);
            const TwoWords<P> v2 = stages::sum_of_three(x2, y2, z2);
            const TwoWords<P> radius{r, P(0)}, above = v2 - radius * radius;
            value = (above / (radius * (sqrt(v2) + radius))).hi;
            return proved && v2.hi >= P(0x1p-800) && abs(above.hi) >= least && abs(value) >= least;
        });
}

/// The larger of two differences of doubles, each exactly hi + lo and hi nearest to that: they stand in the order of
/// their his, and where those are equal, of their los.
template <class P>
[[gnu::always_inline]] inline TwoWords<P> larger(const TwoWords<P>& a, const TwoWords<P>& b) {
    const auto first = a.hi > b.hi || (a.hi >= b.hi && a.lo > b.lo);
    return {select(first, a.hi, b.hi), select(first, a.lo, b.lo)};
}

/// The largest of lo − P and P − hi over the longest side, by `Ball`'s midpoints. All differences are exact and `Ball`
/// tells any two of them apart or finds them equal (their difference is 0 or at least 2^-400·2^-106), so only the
/// quotient has a radius: 2^-100 of itself. In range where |P|, |lo|, |hi| ≤ 2^200 and the differences are 0 or at
/// least 2^-400; the longest side is not 0. A point in a face has the residual 0.
template <bool binary32, class Width>
[[gnu::flatten]] void residuals_in(RawResiduals& batch, const Box<double>* /*shape*/) {
    using P = Pack<double, Width>;
    residuals_of<binary32, Width>(batch, [](const P* p, const auto& solid, P& value) {
        const P most(0x1p+200), least(0x1p-400);
        auto proved = abs(p[0]) <= most;
        const auto in_range = [&](const TwoWords<P>& d) {
            proved = proved && (abs(d.hi) >= least || abs(d.hi) <= P(0));
            return d;
        };
        TwoWords<P> beyond[3], side[3];
        for (int k = 0; k < 3; ++k) {
            const P lo = solid(k), hi = solid(k + 3);
            proved = proved && abs(p[k]) <= most && abs(lo) <= most && abs(hi) <= most;
            beyond[k] = larger(in_range(stages::sum_of<P>(lo, -p[k])), in_range(stages::sum_of<P>(p[k], -hi)));
            side[k] = in_range(stages::sum_of<P>(hi, -lo));
        }
        const TwoWords<P> farthest = larger(larger(beyond[0], beyond[1]), beyond[2]);
        const TwoWords<P> longest = larger(larger(side[0], side[1]), side[2]);
        const auto in_face = abs(farthest.hi) <= P(0);
        value = select(in_face, P(0), (farthest / longest).hi);
        return proved && longest.hi >= least && (in_face || abs(value) >= least);
    });
}

/// Those of a shape that has none by hand stay null.
template <class Width>
void fill_residuals(RawKernels& kernels) {
    auto* residuals = kernels.residuals;
    Solids::each([&residuals]<template <class> class S>() {
        constexpr const S<double>* shape = nullptr;
        RawResiduals* batch = nullptr;
        if constexpr (requires { residuals_in<true, Width>(*batch, shape); })
            *residuals = [](RawResiduals& all) {
                if (all.binary32) residuals_in<true, Width>(all, shape);
                else residuals_in<false, Width>(all, shape);
            };
        ++residuals;
    });
}

}  // namespace lostbits::measure::columns
