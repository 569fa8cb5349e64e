// The exact answer for a ray and a box, as comparisons of fractions over any enclosure; and for any solid.
#pragma once

#include <array>
#include <optional>

#include "intersect/info.hpp"
#include "measure/truth/enclose.hpp"

namespace lostbits::measure::truth {

/// n/m with m > 0 for certain. Fractions are compared by n₁ m₂ against n₂ m₁: of equal fractions these become the same
/// number at some precision, which the quotients need not.
template <class E>
struct Fraction {
    E n;
    E m;
};

/// What the slabs leave of the line o + t d: those t that are at least every `entry` and at most every `exit`, one of
/// each for every axis with d ≠ 0. And what no t changes, for the closed and the open box.
template <class E>
struct Slabs {
    std::array<std::optional<Fraction<E>>, 3> entry, exit;
    Tri closed = Tri::yes;  ///< lo ≤ o ≤ hi wherever d = 0
    Tri open = Tri::yes;    ///< lo < o < hi wherever d = 0, and lo < hi everywhere
};

/// entry = (lo − o)/d and exit = (hi − o)/d where d > 0, the other way round where d < 0, both scaled to a denominator
/// of |d|. Nothing where this precision does not tell a sign of d (a double's is always told).
template <class E>
std::optional<Slabs<E>> slabs_of(const Ray<E>& ray, const Box<E>& box) {
    const E zero(0);
    Slabs<E> slabs;
    for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        const E &o = ray.origin[axis], &d = ray.direction[axis], &lo = box.lo[axis], &hi = box.hi[axis];
        const Tri ahead = d > zero, back = d < zero;
        slabs.open = slabs.open && lo < hi;
        if (ahead.is_yes()) {
            slabs.entry[i] = Fraction<E>{lo - o, d};
            slabs.exit[i] = Fraction<E>{hi - o, d};
        } else if (back.is_yes()) {
            slabs.entry[i] = Fraction<E>{o - hi, -d};
            slabs.exit[i] = Fraction<E>{o - lo, -d};
        } else if (ahead.is_no() && back.is_no()) {
            slabs.closed = slabs.closed && lo <= o && o <= hi;
            slabs.open = slabs.open && lo < o && o < hi;
        } else {
            return std::nullopt;
        }
    }
    return slabs;
}

/// Whether some t in [0, tmax] lies in the closed and in the open box. With a the largest entry and b the smallest
/// exit, the line is in the closed box for a ≤ t ≤ b and in the open one for a < t < b, so that for tmax ≥ 0
///     closed:  a ≤ b,  0 ≤ b,  a ≤ tmax          open:  a < b,  0 < b,  a < tmax
/// (where a < 0 = tmax the origin is inside). Each inequality between a largest and a smallest is the conjunction of
/// those between all, so neither needs to be known; entry and exit of one axis are in the order of lo and hi.
struct InBox {
    Tri closed;
    Tri open;
};

template <class E>
InBox in_box(const Slabs<E>& slabs, const E* tmax) {
    InBox in{slabs.closed, slabs.open};
    const auto in_order = [&in](const E& a, const E& b) {
        in.closed = in.closed && a <= b;
        in.open = in.open && a < b;
    };
    for (std::size_t i = 0; i < 3; ++i) {
        if (!slabs.entry[i]) continue;
        const Fraction<E>&entry = *slabs.entry[i], &exit = *slabs.exit[i];
        in_order(E(0), exit.n);
        if (tmax) in_order(entry.n, *tmax * entry.m);
        for (std::size_t j = 0; j < 3; ++j) {
            if (j != i && slabs.exit[j]) in_order(entry.n * slabs.exit[j]->m, slabs.exit[j]->n * entry.m);
        }
    }
    if (tmax) in.closed = in.closed && *tmax >= E(0);
    return {in.closed, in.closed && in.open};
}

/// The largest entry, or 0/1 where none is positive; of equal ones the first. Nothing where this precision does not
/// tell.
template <class E>
std::optional<Fraction<E>> first_entry(const Slabs<E>& slabs) {
    const E zero(0);
    std::optional<Fraction<E>> first;
    for (const auto& entry : slabs.entry) {
        if (!entry) continue;
        const Tri later = entry->n > zero && (first ? first->n * entry->m < entry->n * first->m : Tri(Tri::yes));
        if (later.is_unknown()) return std::nullopt;
        if (later.is_yes()) first = *entry;
    }
    return first ? *first : Fraction<E>{zero, E(1)};
}

/// The smallest exit; of equal ones the first. Nothing where this precision does not tell.
template <class E>
std::optional<Fraction<E>> first_exit(const Slabs<E>& slabs) {
    std::optional<Fraction<E>> first;
    for (const auto& exit : slabs.exit) {
        if (!exit) continue;
        const Tri sooner = first ? exit->n * first->m < first->n * exit->m : Tri(Tri::yes);
        if (sooner.is_unknown()) return std::nullopt;
        if (sooner.is_yes()) first = *exit;
    }
    return first;
}

/// What a convention says of a ray that starts in the closed box (largest entry a ≤ 0 ≤ smallest exit b). With a < 0 <
/// b it is inside; a = 0 is an entry at the origin, and b = 0 an exit there. An exit beyond tmax is none.
template <class E>
Enclosed<E> enclose_from_inside(const Ray<E>& ray, const Slabs<E>& slabs, const E* tmax, intersect::Convention asked) {
    using intersect::AtOrigin, intersect::Inside;
    const E zero(0);
    const Enclosed<E> unknown{Tri::unknown, zero, zero}, at_once{Tri::yes, zero, zero}, none{Tri::no, zero, zero};
    Tri entered = Tri::yes;
    for (const auto& entry : slabs.entry)
        if (entry) entered = entered && entry->n < zero;
    const auto exit = first_exit(slabs);
    if (entered.is_unknown() || !exit) return unknown;
    const Tri leaving = exit->n <= zero;
    if (leaving.is_unknown()) return unknown;
    if (entered.is_no() && asked.at_origin == AtOrigin::hit) return at_once;
    if (leaving.is_yes()) return asked.at_origin == AtOrigin::miss || asked.inside != Inside::exit ? none : at_once;
    if (asked.inside != Inside::exit) return none;
    if (tmax) {
        const Tri in_reach = exit->n <= *tmax * exit->m;
        if (!in_reach.is_yes()) return in_reach.is_no() ? none : unknown;
    }
    const E t = exit->n / exit->m;
    return {Tri::yes, t, t * length(ray.direction)};
}

/// The first t in [0, tmax] (no end where `tmax` is null) for which o + t d lies in the closed box (`Touching::hit`),
/// or the infimum of those for which it lies in the open one (`Touching::miss`). For either, t* = max(0, largest
/// entry):
///
///   - an origin inside gives t = 0 exactly; so does one on the boundary if the ray goes in (or, closed, along it or
///   out);
///   - an entry exactly at tmax is a hit of the closed box and a miss of the open one, whose points all come later;
///   - a box of zero thickness has an empty inside; a negative tmax leaves no ray.
///
/// All decisions are signs of dyadic polynomials of degree two in the inputs (differences times a direction or tmax),
/// so for doubles an interval of 2·(1024 + 1074) + 3 < 4200 bits decides every one. The direction must not be zero, and
/// lo ≤ hi. From inside the answer is 0 unless the convention says another. `touching` says that the two conventions
/// differ; it is known, like everything else, only where `hit` is. A Dual's gradient is that of the axis that was
/// chosen: where two entries are equal t has a kink, and the gradient is one-sided.
template <class E>
Enclosed<E> enclose(const Ray<E>& ray, const Box<E>& box, const E* tmax, intersect::Convention convention) {
    const E zero(0);
    const Enclosed<E> unknown{Tri::unknown, zero, zero};
    const auto slabs = slabs_of(ray, box);
    if (!slabs) return unknown;
    const InBox in = in_box(*slabs, tmax);
    if (in.closed.is_no()) return {Tri::no, zero, zero};
    if (in.closed.is_unknown() || in.open.is_unknown()) return unknown;
    const bool touching = in.open.is_no();
    if (touching && convention.touching == intersect::Touching::miss) return {Tri::no, zero, zero, touching};

    const auto first = first_entry(*slabs);
    if (!first) return unknown;
    if ((first->n <= zero).is_yes()) {
        const bool usual =
            convention.inside == intersect::Inside::usual || convention.inside == intersect::Inside::zero;
        Enclosed<E> found =
            usual ? Enclosed<E>{Tri::yes, zero, zero} : enclose_from_inside(ray, *slabs, tmax, convention);
        found.touching = touching;
        return found;
    }
    const E t = first->n / first->m;
    return {Tri::yes, t, t * length(ray.direction), touching};
}

/// The closed solid, whatever its shape. `tmax` (null: nowhere) ends the ray for boxes; a sphere's problem has no end.
/// What the convention says of touching is left to whoever asks.
template <class E>
Enclosed<E> enclose(const Ray<E>& ray, const Solid<E>& solid, const E* tmax = nullptr,
                    intersect::Convention convention = {}) {
    return visit(solid, [&]<template <class> class S>(const S<E>& shape) {
        if constexpr (!S<E>::told_end) return enclose(ray, shape, convention);
        else {
            convention.touching = intersect::Touching::hit;
            return enclose(ray, shape, tmax, convention);
        }
    });
}

}  // namespace lostbits::measure::truth
