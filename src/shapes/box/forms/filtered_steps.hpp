// The steps of `box.filtered`, and the inequalities that let a ray stop at a step.
#pragma once

#include "geometry/vec.hpp"
#include "intersect/filter_arithmetic.hpp"
#include "number/wide/dyadic_slabs.hpp"
#include "shapes/box/forms/filtered_words.hpp"

namespace lostbits::intersect::box {
namespace filtered {

/// The first step's decision; `in_range` says whether its tmin and tmax are accurate.
template <Number T>
struct Decided : SlabDecision<T> {
    mask_t<T> in_range;
};

/// Decides by tmin and tmax alone. Each is zero, the ray's end, or a t = (plane − o)·(1/d) that is off by three
/// roundings. With L the least normal number and M = 1/L:
///
///     plane − o     no sum underflows
///     1/d           3.1u of t altogether where 1/d is normal. It is subnormal for |d| > M, no less than M^-1/4 and off
///                   by at most 4u of itself: 6.1u of t altogether
///     the product   uL more where it underflows, which is u of everything ≥ L; it keeps its sign or gives ±0
///     overflow      of plane − o, of 1/d or of the product: dmax, the later of the two t, is ±∞. −∞ has the right
///                   sign, so the ray is missed. dmin = −∞ has the right sign too, and is not examined. +∞, and NaN
///                   from 0·∞, show in `way`, the sum of all dmax, or in `longest_way` where d = 0 causes them
///
/// So where way < ∞, tmin (1 + 6.1u) + uL ≤ tmax (1 − 6.1u) − uL proves a hit and tmin (1 − 6.1u) − uL >
/// tmax (1 + 6.1u) + uL a miss. 16u and L on one side cover both, with the roundings of the test, whatever the sign of
/// tmax. A slab that the ray is parallel to has tmin = ∞ if the ray is outside, and −∞ and ∞ if it is inside. A ray in
/// one of its planes makes 0·∞, which leaves tmin and tmax as they were. (∞ < ∞ is false, so a direction of zeros is
/// left undecided.) tmin and tmax are right to 6.1u of themselves, or to the distance between subnormal numbers.
template <Number T>
Decided<T> by_bound(const T& tmin, const T& tmax, const T& way) {
    if constexpr (traces_operations<T>) {
        using number::wide::value_of, number::wide::constant_mask;
        const auto plain = by_bound(value_of(tmin), value_of(tmax), value_of(way));
        return {{constant_mask<T>(plain.proved), tmin <= tmax}, constant_mask<T>(plain.in_range)};
    } else {
        const T slack = T(16) * unit_roundoff<T>(), least = number::wide::least_normal<T>();
        const mask_t<T> in_range = way < T(1) / T(0);
        const mask_t<T> hit = in_range && tmin < tmax * (T(1) - slack) - least;
        const mask_t<T> missed = in_range && tmin > tmax * (T(1) + slack) + least;
        return {{hit || missed, hit}, in_range};
    }
}

template <Number T, class B>
OrderedSlabs<T> planes_of(const Ray<T>& ray, const B& box) {
    const auto of = [&](int axis) { return planes_by_sign<T>(box, axis, T(1) / ray.direction[axis]); };
    return {{of(0), of(1), of(2)}};
}

/// The result of the first step, and the ray's end.
template <Number T>
struct Found {
    Segment<T> segment;
    T limit;
};

/// The largest of dmax |d| and (1/d) d, which are plane − o and 1 to 7u where nothing overflows. It is ∞ if a sum, the
/// product or 1/d overflowed (0·∞ shows by the latter). A slab with d = 0 makes NaN, which max leaves out.
template <Number T>
T longest_way(const Ray<T>& ray, const OrderedSlabs<T>& slabs) {
    T way(0);
    for (int axis = 0; axis < 3; ++axis) {
        const T d = ray.direction[axis], inv = T(1) / d;
        const T dmax = (slabs.planes[static_cast<std::size_t>(axis)].bmax - ray.origin[axis]) * inv;
        way = max(inv * d, max(dmax * abs(d), way));
    }
    return way;
}

/// True if every number is 0 or between 2^-450 and 2^500 in size, so that the products of two, and those of their last
/// places, are doubles. Floats always fit.
template <Number T>
mask_t<T> fits(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const T& limit) {
    if constexpr (traces_operations<T>) {
        using number::wide::value_of;
        return number::wide::constant_mask<T>(fits<decltype(value_of(limit))>(
            {value_of(ray.origin), value_of(ray.direction)}, value_of(slabs), value_of(limit)));
    }
    mask_t<T> all = T(0) <= T(0);
    if constexpr (number::wide::has_whole_range<T>) {
        using B = number::wide::OneWord<T>;
        const B least = number::wide::power_of_two<B>(-450), most = B(1) / number::wide::power_of_two<B>(-500);
        const auto add = [&](const T& x) {
            const B size = abs(number::wide::widen<B>(x));
            all = all && size <= most && (size >= least || size <= B(0));
        };
        for (int axis = 0; axis < 3; ++axis) {
            add(ray.origin[axis]);
            add(ray.direction[axis]);
            add(slabs.planes[static_cast<std::size_t>(axis)].bmin);
            add(slabs.planes[static_cast<std::size_t>(axis)].bmax);
        }
        const mask_t<B> endless = number::wide::widen<B>(limit) >= far_away<B>();
        add(select(endless, T(0), limit));
    }
    return all;
}

/// Decides in W, rounded to nearest. With v the unit roundoff of W, n and f round once and the products once more, so
/// n m and f g are right to 2.1v of themselves. Then n m ≤ f g is proved where n m + 3v(|n m| + |f g|) ≤ f g, also
/// where both are zero. Infinite planes make NaN, which decides nothing.
///
/// It is `static`: the linker must not use code that is compiled for wide registers in other files.
template <class W, Number T>
static SlabDecision<T> widely(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const T& limit) {
    using number::wide::narrow, number::wide::widen;
    const auto wide = [](const T& x) { return widen<W>(x); };
    std::array<W, 3> m{W(0), W(0), W(0)}, n = m, f = m;
    for (int axis = 0; axis < 3; ++axis) {
        const W d = wide(ray.direction[axis]), o = wide(ray.origin[axis]);
        const W sign = copysign(W(1), d);
        m[static_cast<std::size_t>(axis)] = abs(d);
        n[static_cast<std::size_t>(axis)] = sign * (wide(slabs.planes[static_cast<std::size_t>(axis)].bmin) - o);
        f[static_cast<std::size_t>(axis)] = sign * (wide(slabs.planes[static_cast<std::size_t>(axis)].bmax) - o);
    }
    const W v = unit_roundoff<W>(), end = min(wide(limit), far_away<W>());
    // The least of all comparisons: positive where every one is proved to hold, negative where one is proved to fail.
    const auto certain_sign = [&](const W& less, const W& more) {
        const W apart = more - less, slack = W(3) * v * (abs(less) + abs(more));
        return select(apart >= slack, W(1), select(apart <= -slack, W(-1), W(0)));
    };
    const auto exactly = [](const W& x) { return select(x >= W(0), W(1), W(-1)); };
    W least = exactly(end);
    for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(i);
        least = min(least, exactly(f[at]));
        least = min(least, certain_sign(n[at], end * m[at]));
    }
    least = every_pair<W>(
        [&](int i, int j) {
            const auto at = static_cast<std::size_t>(i), to = static_cast<std::size_t>(j);
            return certain_sign(n[at] * m[to], f[to] * m[at]);
        },
        [](const W& a, const W& b) { return min(a, b); }, least);
    const T told = narrow<T>(least);
    return {told > T(0) || told < T(0), told >= T(0)};
}

/// Computes tmin and tmax in W, where nothing overflows or underflows. They are accurate to u when narrowed to T.
template <class W, Number T>
static Segment<T> segment_in(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const T& limit) {
    using number::wide::narrow, number::wide::widen;
    W tmin(0), tmax = widen<W>(limit);
    for (int axis = 0; axis < 3; ++axis) {
        const Planes<T>& planes = slabs.planes[static_cast<std::size_t>(axis)];
        const W d = widen<W>(ray.direction[axis]), o = widen<W>(ray.origin[axis]);
        const mask_t<W> runs = abs(d) > W(0);
        tmin = select(runs, max((widen<W>(planes.bmin) - o) / d, tmin), tmin);
        tmax = select(runs, min((widen<W>(planes.bmax) - o) / d, tmax), tmax);
    }
    return {narrow<T>(tmin), narrow<T>(tmax)};
}

/// Returns `known`, decided over the whole range where `known` proves nothing. t comes from the whole range where
/// `good` does not say that the found t is accurate.
template <Number T>
Hit<T> in_every_range(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const Found<T>& found,
                      const SlabDecision<T>& known, const mask_t<T>& good) {
    const Vec<T>&o = ray.origin, &d = ray.direction;
    const auto& [x, y, z] = slabs.planes;
    const std::array<T, 13> in{o.x,    o.y,    o.z,    d.x,    d.y,    d.z,        x.bmin,
                               y.bmin, z.bmin, x.bmax, y.bmax, z.bmax, found.limit};
    const std::array<T, 3> all = number::wide::masked_lanes<T, 13, 3>(
        select(known.proved, T(0), T(1)), in, {select(known.hit, T(1), -T(1)), found.segment.tmin, found.segment.tmax},
        number::wide::meet_slabs<T>);
    const Segment<T>& own = found.segment;
    return entered<T>(all[0] > T(0), {select(good, own.tmin, all[1]), select(good, own.tmax, all[2])});
}

/// Decides without rounding what `known` leaves open. t comes from the whole range where `known` does not say that the
/// found t is accurate.
template <Number T>
Hit<T> to_the_last_digit(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const Found<T>& found,
                         const Decided<T>& before) {
    using B = number::wide::OneWord<T>;
    SlabDecision<T> known = before;
    const mask_t<T> fit = fits(ray, slabs, found.limit);
    if (any_of(!known.proved && fit)) {
        const Ways<B> ways = ways_of<T>(ray, slabs, found.limit);
        SlabDecision<T> products = by_products<T>(ways);
        products.proved = products.proved && fit;
        known = joined(known, products);
        if (any_of(!known.proved && fit)) known = joined(known, exactly<T>(ways, fit));
    }
    if constexpr (number::wide::has_whole_range<T>)
        if (any_of(!known.proved)) return in_every_range<T>(ray, slabs, found, known, before.in_range);
    return entered<T>(known.hit, found.segment);
}

/// The same for number types that record operations. They have no operation for it, so it is recorded as a call.
template <Number T>
Hit<T> in_a_call(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const Found<T>& found, const mask_t<T>& in_range) {
    using number::wide::record_call, number::wide::value_of;
    using P = decltype(value_of(found.limit));
    const P none(0), tmin = value_of(found.segment.tmin), tmax = value_of(found.segment.tmax);
    const Hit<P> end =
        to_the_last_digit<P>({value_of(ray.origin), value_of(ray.direction)}, value_of(slabs),
                             {{tmin, tmax}, value_of(found.limit)}, {{none < none, none < none}, in_range.value()});
    const Vec<T>&o = ray.origin, &d = ray.direction;
    const auto plane = [&](int axis, const auto& back) {
        const Planes<T>& planes = slabs.planes[static_cast<std::size_t>(axis)];
        return select(back(d[axis]), planes.bmax, planes.bmin);
    };
    const auto low = [&](int axis) { return plane(axis, [](const T& x) { return copysign(T(1), x) < T(0); }); };
    const auto high = [&](int axis) { return plane(axis, [](const T& x) { return copysign(T(1), x) > T(0); }); };
    const std::array<T, 13> of{o.x,    o.y,    o.z,     d.x,     d.y,     d.z,        low(0),
                               low(1), low(2), high(0), high(1), high(2), found.limit};
    const auto told = [&of](CallAnswer answer, const P& value) {
        return record_call<T>({"box.filtered", answer}, of, value);
    };
    const mask_t<T> hit = told(CallAnswer::decision, select(end.hit, P(1), P(-1))) > T(0);
    const auto same = [](const P& a, const P& b) { return a == b && copysign(P(1), a) == copysign(P(1), b); };
    if (any_of(in_range.value() || (same(end.near, tmin) && same(end.far, tmax))))
        return entered<T>(hit, found.segment);
    return entered<T>(hit, {told(CallAnswer::near, end.near), told(CallAnswer::far, end.far)});
}

/// Decides by the planes what `cheap` leaves open: in the wider arithmetic of one word if there is one, then without
/// rounding.
template <Number T, class Watch>
Hit<T> beyond(const Ray<T>& ray, const OrderedSlabs<T>& slabs, Found<T> found, const Decided<T>& cheap, Watch& watch) {
    const Part<T> part("by planes");
    Decided<T> known = cheap;
    if (any_of(!cheap.in_range)) {
        const Decided<T> again = by_bound<T>(found.segment.tmin, found.segment.tmax, longest_way(ray, slabs));
        known = {joined(cheap, again), cheap.in_range || again.in_range};
        if (!any_of(!known.proved)) return entered<T>(known.hit, found.segment);
    }
    if constexpr (number::wide::has_wider_word<T>) {
        if (number::wide::widens<T>()) {
            using B = number::wide::OneWord<T>;
            watch(FilterArithmetic::wider);
            SlabDecision<T> wide = widely<B, T>(ray, slabs, found.limit);
            wide.proved = wide.proved && fits(ray, slabs, found.limit);
            known = {joined(known, wide), known.in_range};
            if (any_of(!known.in_range)) {
                const Segment<T> other = segment_in<B, T>(ray, slabs, found.limit);
                found.segment = {select(known.in_range, found.segment.tmin, other.tmin),
                                 select(known.in_range, found.segment.tmax, other.tmax)};
            }
            if (!any_of(!known.proved)) return entered<T>(known.hit, found.segment);
        }
    }
    watch(FilterArithmetic::exact);
    if constexpr (traces_operations<T>) return in_a_call<T>(ray, slabs, found, known.in_range);
    else return to_the_last_digit<T>(ray, slabs, found, known);
}

/// The same as a function of its own that takes its arguments by value, so that the loops over packs keep their
/// registers.
template <Number T, class Watch>
[[gnu::noinline]] Hit<T> by_planes(Ray<T> ray, OrderedSlabs<T> slabs, Found<T> found, Decided<T> cheap, Watch& watch) {
    return beyond<T>(ray, slabs, found, cheap, watch);
}
template <Number T, class Watch>
requires number::wide::InRegisters<T>
[[gnu::noinline, gnu::flatten]] Hit<T> by_planes(Ray<T> ray, OrderedSlabs<T> slabs, Found<T> found, Decided<T> cheap,
                                                 Watch& watch) {
    return beyond<T>(ray, slabs, found, cheap, watch);
}

}  // namespace filtered
}  // namespace lostbits::intersect::box
