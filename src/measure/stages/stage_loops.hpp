// The loops around the stages, for packs of any width and for single doubles. They see plain pointers only, as
// intersect/simd/packed_batch.hpp does and for the same reason.
#pragma once

#include <cstring>
#include <type_traits>

#include "measure/stages/problem.hpp"
#include "measure/stages/raw_stages.hpp"
#include "measure/stages/span_stages.hpp"
#include "measure/stages/tie_stage.hpp"
#include "number/pack.hpp"

namespace lostbits::measure::stages {

/// A direction's components, rounded; nothing unless `settled`.
template <class P>
struct UnitDirection {
    mask_t<P> settled;
    P components[3];
};

/// The lemma, ε = 2^-102 (`word_error`), for components that are 0 or within [2^-200, 2^200]: their squares are exact,
/// the two sums add 2ε of d·d, the root ε and half of that, the quotient ε:
///     |q̂ − d_i/|d|| ≤ 4ε |q̂|
/// In binary64 hi is nearest to d_i/|d| if it is nearest to hi + (lo ± 8ε|hi|). In binary32 the float nearest to
/// hi ± 2^-50|hi| is, if both have the same: 2^-53 + 4ε < 2^-51. Quotients below 2^-120 are left, for a float of them
/// may be subnormal. What `scale` multiplies is 8ε and 2^-50.
template <class P>
UnitDirection<P> settle_unit_direction(const P (&d)[3], bool binary32, const P& scale) {
    using lostbits::abs;
    const P zero(0);
    const TwoWords<P> a = sum_of_three(product_of<P>(d[0], d[0]), product_of<P>(d[1], d[1]), product_of<P>(d[2], d[2]));
    const TwoWords<P> length = sqrt(a);
    UnitDirection<P> unit{length.hi > zero, {}};
    for (int i = 0; i < 3; ++i) {
        const P size = abs(d[i]);
        const auto none = size <= zero;
        const TwoWords<P> q = TwoWords<P>{d[i], zero} / length;
        const P slack = abs(q.hi) * (P(8 * word_error) * scale), wide = abs(q.hi) * (P(0x1p-50) * scale);
        const P below = binary32 ? nearest_binary32(q.hi - wide) : q.hi + (q.lo - slack);
        const P above = binary32 ? nearest_binary32(q.hi + wide) : q.hi + (q.lo + slack);
        unit.components[i] = select(none, d[i], above);  // keeps the sign of a zero
        unit.settled = unit.settled && (none || (below <= above && below >= above && size >= P(least_length) &&
                                                 size <= P(largest_length) && abs(q.hi) >= P(0x1p-120)));
    }
    return unit;
}

/// How a number of the stages is loaded and stored: one double, or a pack of them.
template <class P>
struct Lanes {
    static constexpr std::size_t count = P::lanes;
    template <class S>
    static P load(const S* from) {
        return P::load(from);
    }
    static void store(const P& x, double* to) { x.store(to); }
    static void store(const mask_t<P>& x, std::uint8_t* to) {
        bool lanes[count];
        x.store(lanes);
        std::memcpy(to, lanes, count);
    }
};
template <>
struct Lanes<double> {
    static constexpr std::size_t count = 1;
    template <class S>
    static double load(const S* from) {
        return static_cast<double>(*from);
    }
    static void store(double x, double* to) { *to = x; }
    static void store(bool x, std::uint8_t* to) { *to = x; }
};

/// The pack of problems at `i`. What is `plain` has no second words, no matrix and no range: its numbers are exact,
/// which the compiler sees then.
template <bool plain, class S, class W>
struct PackOfProblems {
    using E = Running<W>;
    using P = typename E::P;

    const RawProblems<S>& p;
    std::size_t i;

    [[nodiscard]] P at(const RawColumn<S>& c) const { return Lanes<P>::load(c.from + i * c.step); }
    [[nodiscard]] E number(const RawColumn<S>& first, const RawColumn<S>& second) const {
        using lostbits::abs;
        const P x = at(first);
        if constexpr (!plain && !std::is_same_v<W, P>) {
            if (p.two_words) return E(W(x, at(second)), P(input_error) * abs(x));
        }
        return E(W(x), P(0));
    }
    [[nodiscard]] E of_ray(std::size_t k) const { return number(p.ray[k], p.ray_low[k]); }
    [[nodiscard]] E of_solid(std::size_t k) const { return number(p.solid[k], p.solid_low[k]); }
    [[nodiscard]] Ray<E> ray() const { return {{of_ray(0), of_ray(1), of_ray(2)}, {of_ray(3), of_ray(4), of_ray(5)}}; }
    template <std::size_t... k>
    [[nodiscard]] std::array<E, sizeof...(k)> solid(std::index_sequence<k...>) const {
        return {of_solid(k)...};
    }
    [[nodiscard]] Affine<E> map() const {
        return Affine<E>::of([*this](std::size_t k) { return of_solid(most_numbers + k); });
    }
    /// Where the range has more than one t: else, by `proper`, nothing is said.
    [[nodiscard]] RangeOfSpan<E> operator()(mask_t<P>& proper) const {
        return range_of<E>(at(p.tmin), at(p.tmax), p.open, proper);
    }
};

template <class P>
[[gnu::always_inline]] inline void store(const Finding<P>& found, const RawFindings& out, std::size_t i) {
    Lanes<P>::store(found.settled, out.settled + i);
    Lanes<P>::store(found.hit, out.hit + i);
    // A miss has zeros; so has a lane that says nothing.
    const auto store = [&](const Enclosure<P>& x, const RawLength& to) {
        if (!to.hi) return;
        Lanes<P>::store(select(found.hit, x.middle.hi, P(0)), to.hi + i);
        Lanes<P>::store(select(found.hit, x.middle.lo, P(0)), to.lo + i);
        Lanes<P>::store(select(found.hit, x.bound, P(0)), to.bound + i);
    };
    store(found.t, out.t);
    store(found.distance, out.distance);
}

/// Of is the shape, of numbers of W, one word or two, which are stored as one or two of S.
template <template <class> class Of, bool plain, class S, class W>
[[gnu::flatten]] void settle_some(const RawProblems<S>& raw) {
    using E = Running<W>;
    using P = typename E::P;
    using Shape = Of<E>;
    constexpr auto numbers = std::make_index_sequence<numbers_of<Shape>>();
    const RawProblems<S> p = raw;  // a copy: the stores below could reach it, and everything would be read again
    const Asked asked{!plain && p.ranged, p.out.t.hi != nullptr, p.out.distance.hi != nullptr};
    bool one_solid = true;
    for (const RawColumn<S>& column : p.solid) one_solid = one_solid && column.step == 0;
    Entrance<Shape, E> entrance;
    for (std::size_t i = 0; i < p.size; i += Lanes<P>::count) {
        const PackOfProblems<plain, S, W> pack{p, i};
        InSpace<Shape, E> in;
        in.ray = pack.ray();
        in.d2 = square(in.ray.direction);
        if (!plain && p.matrix.placed) {
            if (i == 0 || !one_solid) entrance = Entrance<Shape, E>::of(pack.solid(numbers), pack.map(), p.matrix);
            in.ray = entrance.ray(in.ray);
            in.solid = entrance.solid;
            in.proper = entrance.proper;
        } else {
            in.solid = pack.solid(numbers);
            in.proper = is_proper<Shape>(in.solid);
        }
        store(settle_shape(in, asked, pack), p.out, i);
    }
}
/// Plain problems, which most are, have a loop of their own, twice as fast; not in the narrowest registers, which
/// processors of today do not use: a loop is two seconds of compiling a shape.
template <template <class> class Of, class S, class W>
void settle_all(const RawProblems<S>& raw) {
    if constexpr (Lanes<typename Running<W>::P>::count > 2) {
        if (!raw.two_words && !raw.matrix.placed && !raw.ranged) return settle_some<Of, true, S, W>(raw);
    }
    settle_some<Of, false, S, W>(raw);
}

template <template <class> class Of, class P>
[[gnu::flatten]] void settle_ties(const RawProblems<double>& raw) {
    using Shape = Of<Multiple<P>>;
    const RawProblems<double> p = raw;  // as above
    const Asked asked{false, p.out.t.hi != nullptr, p.out.distance.hi != nullptr};
    for (std::size_t i = 0; i < p.size; i += Lanes<P>::count) {
        const auto load = [&](const RawColumn<double>& c) { return Lanes<P>::load(c.from + i * c.step); };
        const auto load_all = [&]<std::size_t... k>(const RawColumn<double>* c, std::index_sequence<k...>) {
            return std::array<P, sizeof...(k)>{load(c[k])...};
        };
        const auto tie = settle_tie<Of>(load_all(p.ray, std::make_index_sequence<6>()),
                                        load_all(p.solid, std::make_index_sequence<numbers_of<Shape>>()), asked);
        store(tie.found, p.out, i);
        Lanes<P>::store(tie.touches, p.out.touches + i);
        Lanes<P>::store(tie.on_surface, p.out.on_surface + i);
    }
}

template <class P>
[[gnu::flatten]] void settle_unit_directions(const RawDirections& raw) {
    const RawDirections p = raw;
    for (std::size_t i = 0; i < p.size; i += Lanes<P>::count) {
        const P d[3] = {Lanes<P>::load(p.in[0] + i), Lanes<P>::load(p.in[1] + i), Lanes<P>::load(p.in[2] + i)};
        const UnitDirection<P> unit = settle_unit_direction<P>(d, p.binary32, P(p.scale));
        Lanes<P>::store(unit.settled, p.settled + i);
        for (int k = 0; k < 3; ++k) Lanes<P>::store(unit.components[k], p.out[k] + i);
    }
}

template <class P>
void fill_stages(RawStages* of_shape) {
    Solids::each([&]<template <class> class Of>() {
        RawStages& stages = of_shape[static_cast<std::size_t>(shape_as<Of>)];
        stages = {settle_all<Of, float, P>, settle_all<Of, double, TwoWords<P>>, settle_unit_directions<P>};
        if constexpr (is_flat_between_points<Of<Multiple<P>>>) stages.ties = settle_ties<Of, P>;
    });
}

}  // namespace lostbits::measure::stages
