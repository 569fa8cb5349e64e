// The steps of `box.filtered`, and the inequalities that let a ray stop at one.
#pragma once

#include "intersect/box/slab.hpp"
#include "intersect/way.hpp"
#include "number/wide/exact_sum.hpp"
#include "number/wide/ladder.hpp"

namespace lostbits::intersect::box {
namespace filtered {

/// What a step says of a ray: the decision where it is proved, nothing where not.
template <Number T>
struct SlabDecision {
    mask_t<T> proved, hit;

    /// `first` where it is proved, `second` where not.
    friend SlabDecision joined(const SlabDecision& first, const SlabDecision& second) {
        return {first.proved || second.proved, (first.proved && first.hit) || (!first.proved && second.hit)};
    }
};

/// By tmin and tmax alone. Each is zero, the ray's end, or a t = (plane − o)·(1/d) that is off by three roundings,
/// 3.1u of itself, with the sign of the exact one. So tmin (1 + 3.1u) ≤ tmax (1 − 3.1u) proves a hit and
/// tmin (1 − 3.1u) > tmax (1 + 3.1u) a miss, which 8u on one side cover with the rounding of the test; tmin ≤ 0 ≤ tmax
/// is a hit and tmax < 0 a miss by signs alone. A slab that the ray is parallel to and outside of has tmin = ∞, inside
/// of −∞ and ∞; in one of its planes 0·∞, which leaves tmin and tmax as they were.
///
/// No step may over- or underflow: of float that is sure while no plane is closer to the origin than 2^-60 or farther
/// than 2^60, unless it contains it, and each |d| is 0 or within 2^±60.
template <Number T>
SlabDecision<T> by_bound(const T& tmin, const T& tmax) {
    const T slack = T(8) * unit_roundoff<T>();
    const mask_t<T> hit = tmin <= tmax * (T(1) - slack) || (tmin <= T(0) && tmax >= T(0));
    return {hit || tmin > tmax * (T(1) + slack), hit};
}

/// A box's planes in the order in which the line meets them, and whether the line runs down the axis.
template <Number T>
struct OrderedSlabs {
    std::array<Planes<T>, 3> of;
};

template <Number T, class B>
OrderedSlabs<T> planes_of(const Ray<T>& ray, const B& box) {
    const auto of = [&](int axis) { return planes_by_sign<T>(box, axis, T(1) / ray.direction[axis]); };
    return {{of(0), of(1), of(2)}};
}

/// `limit` where it is a number that products can be made of; no t of a box is beyond 2^500, nor is any of floats.
template <Number W>
W as_factor(const W& limit) {
    const W largest = W(1) / number::wide::power_of_two<W>(-500);
    return min(limit, largest);
}

/// n_i/m_i ≤ f_j/m_j for each pair of axes, as n_i m_j ≤ f_j m_i, where n and f are the ways to the first and the
/// second plane and m = |d|, all with the sign of d taken out: that stays true of m = 0, where it says n_i ≤ 0 ≤ f_i,
/// so that a ray in a plane is inside. Of one axis n ≤ f holds in any case. And the ray's own ends: f_j ≥ 0, n_i ≤
/// limit m_i.
///
/// `below(n, m, f, g)` answers n m ≤ f g in whatever way; `join` puts answers together.
template <class V, class Below, class Join>
V every_pair(const Below& below, const Join& join, V all) {
    for (int i = 0; i < 3; ++i) {
        all = join(all, below(i, (i + 1) % 3));
        all = join(all, below(i, (i + 2) % 3));
    }
    return all;
}

/// In W, to nearest. v is its unit roundoff: n and f round once, the products once more, so n m and f g are right to
/// 2.1v of themselves, and n m ≤ f g where n m + 3v(|n m| + |f g|) ≤ f g: where both are zero, too.
///
/// `static`: what is compiled for wide registers alone must not be what the linker gives to others.
template <class W, Number T>
static SlabDecision<T> widely(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const T& limit) {
    using number::wide::taken_back, number::wide::taken_to;
    const auto wide = [](const T& x) { return taken_to<W>(x); };
    std::array<W, 3> m{W(0), W(0), W(0)}, n = m, f = m;
    for (int axis = 0; axis < 3; ++axis) {
        const W d = wide(ray.direction[axis]), o = wide(ray.origin[axis]);
        const W sign = copysign(W(1), d);
        m[static_cast<std::size_t>(axis)] = abs(d);
        n[static_cast<std::size_t>(axis)] = sign * (wide(slabs.of[static_cast<std::size_t>(axis)].bmin) - o);
        f[static_cast<std::size_t>(axis)] = sign * (wide(slabs.of[static_cast<std::size_t>(axis)].bmax) - o);
    }
    const W v = unit_roundoff<W>(), end = as_factor(wide(limit));
    // Least over all: positive where every comparison holds for certain, negative where one fails for certain.
    const auto room = [&](const W& less, const W& more) {
        const W apart = more - less, slack = W(3) * v * (abs(less) + abs(more));
        return select(apart >= slack, W(1), select(apart <= -slack, W(-1), W(0)));
    };
    const auto exactly = [](const W& x) { return select(x >= W(0), W(1), W(-1)); };
    W least = exactly(end);
    for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(i);
        least = min(least, exactly(f[at]));
        least = min(least, room(n[at], end * m[at]));
    }
    least = every_pair<W>(
        [&](int i, int j) {
            const auto at = static_cast<std::size_t>(i), to = static_cast<std::size_t>(j);
            return room(n[at] * m[to], f[to] * m[at]);
        },
        [](const W& a, const W& b) { return min(a, b); }, least);
    const T told = taken_back<T>(least);
    return {told > T(0) || told < T(0), told >= T(0)};
}

/// Exactly, as signs of sums of words: 1 where every comparison holds, −1 where one fails.
template <Number T>
[[gnu::noinline]] static SlabDecision<T> exactly(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const T& limit) {
    using B = number::wide::OneWord<T>;
    using number::wide::ExactSum, number::wide::sum_of, number::wide::TwoWords;
    const auto word = [](const T& x) { return number::wide::taken_to<B>(x); };
    const TwoWords<B> none(0);
    std::array<B, 3> m{B(0), B(0), B(0)};
    std::array<TwoWords<B>, 3> n{none, none, none}, f = n;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::size_t>(axis);
        const B d = word(ray.direction[axis]), o = word(ray.origin[axis]), sign = copysign(B(1), d);
        const TwoWords<B> first = sum_of<B>(word(slabs.of[at].bmin), -o),
                          second = sum_of<B>(word(slabs.of[at].bmax), -o);
        m[at] = abs(d);
        n[at] = {sign * first.hi, sign * first.lo};
        f[at] = {sign * second.hi, sign * second.lo};
    }
    const B end = as_factor(word(limit));
    const auto yes = [](const B& x) { return select(x >= B(0), B(1), B(-1)); };
    B all = yes(end);
    for (std::size_t i = 0; i < 3; ++i) {
        all = min(all, yes(f[i].hi));
        ExactSum<B, 4> before_end;
        before_end.add_product(end, m[i]);
        before_end.add(-n[i]);
        all = min(all, yes(before_end.value()));
    }
    all = every_pair<B>(
        [&](int i, int j) {
            const auto at = static_cast<std::size_t>(i), to = static_cast<std::size_t>(j);
            ExactSum<B, 8> apart;
            apart.add_product(f[to].hi, m[at]);
            apart.add_product(f[to].lo, m[at]);
            apart.add_product(-n[at].hi, m[to]);
            apart.add_product(-n[at].lo, m[to]);
            return yes(apart.value());
        },
        [](const B& a, const B& b) { return min(a, b); }, all);
    return {T(0) <= T(0), number::wide::taken_back<T>(all) > T(0)};
}

/// What `cheap` leaves open by the planes themselves: in the wider arithmetic of one word where there is one, then
/// exactly; over numbers that tell of operations in double-double.
template <Number T, class Watch>
mask_t<T> beyond(const Ray<T>& ray, const OrderedSlabs<T>& slabs, const T& limit, const SlabDecision<T>& cheap,
                 Watch& watch) {
    using B = number::wide::OneWord<T>;
    const Part<T> part("by planes");
    if constexpr (tells_of_operations<T>) {
        watch(Way::two_words);
        return joined(cheap, widely<number::wide::TwoWords<B>, T>(ray, slabs, limit)).hit;
    } else {
        SlabDecision<T> known = cheap;
        if constexpr (number::wide::has_wider_word<T>) {
            watch(Way::wider);
            known = joined(known, widely<B, T>(ray, slabs, limit));
            if (!any_of(!known.proved)) return known.hit;
        }
        watch(Way::exact);
        return joined(known, exactly<T>(ray, slabs, limit)).hit;
    }
}

/// The same as a function of its own, by value: the loops over packs keep their registers to themselves.
template <Number T, class Watch>
[[gnu::noinline]] mask_t<T> by_planes(Ray<T> ray, OrderedSlabs<T> slabs, T limit, SlabDecision<T> cheap, Watch& watch) {
    return beyond<T>(ray, slabs, limit, cheap, watch);
}
template <Number T, class Watch>
requires number::wide::InRegisters<T>
[[gnu::noinline, gnu::flatten]] mask_t<T> by_planes(Ray<T> ray, OrderedSlabs<T> slabs, T limit, SlabDecision<T> cheap,
                                                    Watch& watch) {
    return beyond<T>(ray, slabs, limit, cheap, watch);
}

}  // namespace filtered
}  // namespace lostbits::intersect::box
