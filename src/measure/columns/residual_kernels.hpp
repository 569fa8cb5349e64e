// The residual over columns; see kernels.hpp for what such a file may include.
#pragma once

#include "measure/columns/kernels.hpp"
#include "measure/columns/residual.hpp"
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

template <template <class> class S, bool binary32, class Width>
[[gnu::flatten]] void residuals_in(RawResiduals& batch) {
    using P = Pack<double, Width>;
    residuals_of<binary32, Width>(
        batch, [](const P* p, const auto& solid, P& value)
                   __attribute__((always_inline)) { return find_residual<S>(p, solid, value); });
}

template <class Width>
void fill_residuals(RawKernels& kernels) {
    auto* residuals = kernels.residuals;
    Solids::each([&residuals]<template <class> class S>() {
        *residuals++ = [](RawResiduals& all) {
            if (all.binary32) residuals_in<S, true, Width>(all);
            else residuals_in<S, false, Width>(all);
        };
    });
}

}  // namespace lostbits::measure::columns
