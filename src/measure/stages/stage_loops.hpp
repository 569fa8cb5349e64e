// Loops around the stages, for packs of any width and for single doubles. The loops see plain pointers only;
// intersect/simd/packed_batch.hpp gives the reason.
#pragma once

#include <cstring>
#include <type_traits>

#include "measure/stages/column_kernels.hpp"
#include "measure/stages/problem.hpp"
#include "measure/stages/raw_stages.hpp"
#include "measure/stages/span_stages.hpp"
#include "measure/stages/start_stage.hpp"
#include "measure/stages/tie_stage.hpp"
#include "number/pack.hpp"

namespace lostbits::measure::stages {

/// Components of a direction, rounded; valid only where `settled` is set.
template <class P>
struct UnitDirection {
    mask_t<P> settled;
    P components[3];
};

/// Normalises directions. Let ε = 2^-102 (`word_error`), and let each component be 0 or within [2^-200, 2^200]. The
/// squares are exact, the two sums add errors of 2ε of d·d, the square root half of their sum and another ε, and the
/// quotient ε. So
///
///     |q̂ − d_i/|d|| ≤ 4ε |q̂|
///
/// In binary64, hi is nearest to d_i/|d| if it is nearest to both hi + (lo ± 8ε|hi|). In binary32, the float nearest to
/// d_i/|d| is the float nearest to hi ± 2^-50|hi|, if it is the same for both signs: 2^-53 + 4ε < 2^-51. Quotients
/// below 2^-120 are left open, because their floats may be subnormal. `scale` multiplies 8ε and 2^-50.
template <class P>
UnitDirection<P> settle_unit_direction(const P (&d)[3], bool binary32, const P& scale) {
    using lostbits::abs;
    const P zero(0);
    const TwoWords<P> a = sum_of_three(product_of<P>(d[0], d[0]), product_of<P>(d[1], d[1]), product_of<P>(d[2], d[2]));
    const TwoWords<P> length = sqrt(a);
    UnitDirection<P> unit{length.hi > zero, {}};
    for (int i = 0; i < 3; ++i) {
        const P size = abs(d[i]);
        const auto is_zero = size <= zero;
        const TwoWords<P> q = TwoWords<P>{d[i], zero} / length;
        const P margin = abs(q.hi) * (P(8 * word_error) * scale), float_margin = abs(q.hi) * (P(0x1p-50) * scale);
        const P below = binary32 ? nearest_binary32(q.hi - float_margin) : q.hi + (q.lo - margin);
        const P above = binary32 ? nearest_binary32(q.hi + float_margin) : q.hi + (q.lo + margin);
        unit.components[i] = select(is_zero, d[i], above);  // keeps the sign of a zero
        unit.settled = unit.settled && (is_zero || (below <= above && below >= above && size >= P(min_length) &&
                                                    size <= P(largest_length) && abs(q.hi) >= P(0x1p-120)));
    }
    return unit;
}

template <class P>
void store_lanes(const mask_t<P>& x, std::uint8_t* to) {
    bool lanes[P::lanes];
    x.store(lanes);
    std::memcpy(to, lanes, P::lanes);
}

template <class P>
[[gnu::always_inline]] inline void store(const Finding<P>& found, const RawFindings& out, std::size_t i) {
    store_lanes<P>(found.settled, out.settled + i);
    store_lanes<P>(found.hit, out.hit + i);
    // The lengths of a miss, and of a lane in which nothing is settled, are 0.
    const auto store_length = [&](const Enclosure<P>& x, const RawLength& length) {
        if (!length.hi) return;
        select(found.hit, x.middle.hi, P(0)).store(length.hi + i);
        select(found.hit, x.middle.lo, P(0)).store(length.lo + i);
        select(found.hit, x.bound, P(0)).store(length.bound + i);
    };
    store_length(found.t, out.t);
    store_length(found.distance, out.distance);
}

template <template <class> class ShapeOver, class P, auto settle_pack>
[[gnu::flatten]] void settle_ties(const RawProblems<double>& raw) {
    const RawProblems<double> p = raw;  // a copy, whose pointers no store can change
    const RequestedResults requested{false, p.out.t.hi != nullptr, p.out.distance.hi != nullptr};
    for (std::size_t i = 0; i < p.size; i += P::lanes) {
        const auto load = [&](const RawColumn<double>& c) { return P::load(c.from + i * c.step); };
        const auto load_all = [&]<std::size_t... k>(const RawColumn<double>* c, std::index_sequence<k...>) {
            return std::array<P, sizeof...(k)>{load(c[k])...};
        };
        const auto tie =
            settle_pack(load_all(p.ray, std::make_index_sequence<6>()),
                        load_all(p.primitive, std::make_index_sequence<number_count<ShapeOver<P>>>()), requested);
        store(tie.found, p.out, i);
        store_lanes<P>(tie.touches, p.out.touches + i);
        store_lanes<P>(tie.on_surface, p.out.on_surface + i);
    }
}

template <class P>
[[gnu::flatten]] void settle_unit_directions(const RawDirections& raw) {
    const RawDirections p = raw;
    for (std::size_t i = 0; i < p.size; i += P::lanes) {
        const P d[3] = {P::load(p.in[0] + i), P::load(p.in[1] + i), P::load(p.in[2] + i)};
        const UnitDirection<P> unit = settle_unit_direction<P>(d, p.binary32, P(p.scale));
        store_lanes<P>(unit.settled, p.settled + i);
        for (int k = 0; k < 3; ++k) unit.components[k].store(p.out[k] + i);
    }
}

template <class P>
void fill_stages(RawStages& kernels) {
    kernels = {make_column_kernels<P>(), settle_unit_directions<P>, {}};
    Primitives::each([&]<template <class> class ShapeOver>() {
        constexpr std::size_t count = number_count<ShapeOver<P>>;
        auto& ties = kernels.ties[static_cast<std::size_t>(shape_as<ShapeOver>)];
        if constexpr (is_flat_between_points<ShapeOver<Multiple<P>>>)
            ties = settle_ties<ShapeOver, P, settle_tie<ShapeOver, P, count>>;
        else if constexpr (is_quartic_along<ShapeOver<RunningError<TwoWords<P>>>>)
            ties = settle_ties<ShapeOver, P, settle_start<ShapeOver, P, count>>;
    });
}

}  // namespace lostbits::measure::stages
