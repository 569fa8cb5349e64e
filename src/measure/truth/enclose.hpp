// Encloses the exact answer, with one formula for every type of enclosure. truth.cpp proves this answer, and
// conditioning.cpp differentiates it.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "geometry/capped_span.hpp"
#include "geometry/flat_span.hpp"
#include "geometry/joined_span.hpp"
#include "geometry/quartic_span.hpp"
#include "geometry/wall_span.hpp"
#include "intersect/info.hpp"
#include "number/ball.hpp"
#include "number/interval.hpp"
#include "shapes/lift.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::truth {

/// The point of a line at which a ray meets a primitive: the start of its range, the near root (entry) or the far root
/// (exit).
enum class Crossing : std::uint8_t { begin, near, far };

/// Answer of one precision for one primitive. The other members are valid only if `hit` is certain.
template <class E>
struct EnclosedHit {
    Tri hit;  ///< hit of the closed primitive: touching counts
    E t = E(0);
    E distance = E(0);
    /// The ray meets only the boundary of the primitive, which is a miss if touching is a miss. Tangents touch, and so
    /// do rays that end where they enter a primitive with an inside; a surface without an inside is crossed there
    /// instead. If a ray begins where it leaves, the convention for origins decides; boxes are an exception, since
    /// every point of a box counts.
    bool touching = false;
    /// The ray begins on the surface. Its start is a root, and the convention decides whether this root counts.
    bool on_surface = false;
    Crossing crossing = Crossing::begin;
    bool at_double_root = false;  ///< t is a double root of a quartic, and has no derivative
};

/// Parameter t at which a ray begins: the start of its range, or 0.
template <class E>
E begin_of(const SpanRange<E>* range) {
    return range ? range->begin : E(0);
}

/// Hit at the start of the ray. The distance of t = 0 is 0 itself, not a product with 0, whose enclosure would be
/// wider.
template <class E>
EnclosedHit<E> enclose_begin(const E& d2, const SpanRange<E>* range, bool touching = false, bool on_surface = false) {
    const E begin = begin_of(range);
    const bool begins_at_0 = (begin <= E(0)).is_yes();
    return {Tri::yes, begin, begins_at_0 ? begin : begin * sqrt(d2), touching, on_surface};
}

/// Hit at one of the roots.
template <class E>
EnclosedHit<E> enclose_root(const QuadraticSpan<E>& span, Crossing root, bool touching = false,
                            bool on_surface = false) {
    const E square_root = sqrt(span.q);
    const bool is_h_positive = (span.h > E(0)).is_yes();
    const E sum = is_h_positive ? square_root + span.h : square_root - span.h;
    const E t = root == Crossing::near ? (is_h_positive ? -sum / span.a : span.c / sum)
                                       : (is_h_positive ? -span.c / sum : sum / span.a);
    return {Tri::yes, t, t * sqrt(span.d2), touching, on_surface, root};
}

/// Answer of a convention for a ray that begins on the surface, where q = h².
template <class E>
EnclosedHit<E> enclose_from_surface(const QuadraticSpan<E>& span, const E& h, Tri leaving, const SpanRange<E>* range,
                                    intersect::Convention convention) {
    const E zero(0);
    const Tri crosses = h > zero || h < zero;
    if (crosses.is_unknown() || leaving.is_unknown()) return {Tri::unknown};
    const bool touching = crosses.is_no();
    // If rays from inside miss, exits do not count, so neither does an exit at the start. Both roots of a tangent are
    // touches, and a touch is not an exit.
    const bool ignores_exits = convention.inside == intersect::Inside::miss && !touching;
    const bool start_counts = convention.at_origin == intersect::AtOrigin::hit ||
                              (convention.at_origin == intersect::AtOrigin::exit && leaving.is_yes());
    if (start_counts && !(ignores_exits && leaving.is_yes())) {
        // A root that is not 0 also needs a gradient.
        if ((begin_of(range) <= zero).is_yes()) return enclose_begin(span.d2, range, touching, true);
        return enclose_root(span, leaving.is_yes() ? Crossing::far : Crossing::near, touching, true);
    }
    if (ignores_exits || leaving.is_yes()) return {.hit = Tri::no, .touching = touching, .on_surface = true};
    return enclose_root(span, Crossing::far, false, true);  // not −2h/a, which has another gradient
}

/// First hit of a quadratic surface by a ray without an end. At the start of the ray, the sign of c = P(t) tells
/// whether it is outside, on the surface or inside, and h tells the direction. From outside, a line that leaves (h ≥ 0)
/// misses for any q; from inside or from the surface it always hits. t = c/(−h + √q) from outside, and (−h + √q)/a or
/// −c/(h + √q) from inside, chosen by the sign of h, with c and h at t = 0. From the surface (c = 0), one root is the
/// start of the ray. It is the answer if it counts; otherwise the answer is the other root if that lies ahead. From
/// inside (c < 0), the convention defines t.
template <class E>
EnclosedHit<E> enclose_ahead(const QuadraticSpan<E>& span, const QuadraticAt<E>& start, const SpanRange<E>* range,
                             intersect::Convention convention) {
    const auto& [c, h] = start;
    const E zero(0);
    const Tri outside = c > zero;
    const Tri leaving = h >= zero;
    if ((outside && leaving).is_yes()) return {Tri::no};

    const Tri hit = !outside || (!leaving && !(span.q < zero));
    if (hit.is_no()) return {hit};
    if (hit.is_unknown() || outside.is_unknown()) return {Tri::unknown};
    if ((c >= zero).is_yes() && outside.is_no()) return enclose_from_surface(span, h, leaving, range, convention);
    const bool inside_returns_zero = convention.inside == intersect::Inside::zero;
    if (outside.is_no() && (inside_returns_zero || convention.inside == intersect::Inside::miss)) {
        if (!(c < zero).is_yes()) return {Tri::unknown};
        return inside_returns_zero ? enclose_begin(span.d2, range) : EnclosedHit<E>{Tri::no};
    }
    const Tri crosses = outside.is_no() ? Tri::yes : span.q > zero;
    if (crosses.is_unknown()) return {Tri::unknown};
    return enclose_root(span, outside.is_yes() ? Crossing::near : Crossing::far, crosses.is_no());
}

/// First hit of a quadratic surface by a ray with a range (null: everything ahead): the root that a ray from tmin
/// meets, if that root comes no later than tmax.
template <class E>
EnclosedHit<E> enclose(const QuadraticSpan<E>& span, const SpanRange<E>* range = nullptr,
                       intersect::Convention convention = {}) {
    if (!range) return enclose_ahead<E>(span, {span.c, span.h}, range, convention);
    EnclosedHit<E> found = enclose_ahead(span, quadratic_at(span, range->begin), range, convention);
    if (!found.hit.is_yes()) return found;
    const QuadraticAt<E> end = quadratic_at(span, range->end);
    const Order<Tri> entry = end.order_of_near_root();
    if (found.crossing != Crossing::begin)
        found.hit = is_before_range_end(found.crossing == Crossing::near ? entry : end.order_of_far_root(), *range);
    if (found.hit.is_yes() && entry.less.is_unknown()) found.hit = Tri::unknown;
    found.touching = found.hit.is_yes() && (found.touching || entry.less.is_no());
    return found;
}

/// Answer of a convention for a ray that begins in the closed box (largest entry a ≤ tmin ≤ smallest exit b). If a <
/// tmin < b, the ray begins inside or, if it touches, on a face along which it runs. If a = tmin, it enters at its
/// start; if b = tmin, it leaves there; if both, it touches in one point. An exit beyond tmax does not count.
template <class E>
EnclosedHit<E> enclose_from_inside(const SlabSpan<E>& slabs, const SpanRange<E>* range,
                                   intersect::Convention convention, bool touching) {
    using intersect::AtOrigin, intersect::Inside;
    const E zero(0);
    const EnclosedHit<E> miss{Tri::no};
    Tri entered = Tri::yes;
    if (range) entered = compare_entries_with_begin(slabs, *range).less;
    else
        for (const auto& entry : slabs.entry) entered = entered && entry.n < zero;
    const Fraction<E> exit = smallest_exit(slabs);
    const Tri leaving = range ? order_of(exit, Fraction<E>{range->begin, E(1)}).at_most : exit.n <= zero;
    if (entered.is_unknown() || leaving.is_unknown()) return {Tri::unknown};

    // Hits at the start of the ray
    const auto hit_at_begin = [&] { return enclose_begin(slabs.d2, range); };
    const bool runs_along = touching && leaving.is_no();
    if ((entered.is_no() || runs_along) && convention.at_origin == AtOrigin::hit) return hit_at_begin();
    const bool exit_counts = convention.inside == Inside::exit || entered.is_no();
    if (leaving.is_yes()) return exit_counts && convention.at_origin != AtOrigin::miss ? hit_at_begin() : miss;
    if (convention.inside != Inside::exit && !runs_along) return miss;

    // Hit at the exit
    if (range) {
        const Tri in_range = is_before_range_end(order_of(exit, range->end), *range);
        if (!in_range.is_yes()) return {in_range};
    }
    const E t = exit.n / exit.m;
    return {Tri::yes, t, t * sqrt(slabs.d2), false, false, Crossing::far};
}

/// First hit of a box. For `Touching::hit` it is the first t of the range (null: everything ahead) for which o + t d
/// lies in the closed box, for `Touching::miss` the infimum of all t for which it lies in the open box. Either way, t*
/// = max(tmin, largest entry):
///
///   - a ray that begins inside gives t = tmin exactly, whether the range is open at tmin or not; so does a ray that
///     begins on the boundary if it goes in (or, if the box is closed and the range is not open at tmin, along the
///     boundary or out);
///   - an entry exactly at tmax is a hit of the closed box and a miss of the open one, whose points all come later;
///   - a box of zero thickness has an empty inside.
///
/// All decisions are signs of dyadic polynomials of degree two in the inputs (differences times a direction or tmax),
/// so for doubles an interval of 2·(1024 + 1074) + 3 < 4200 bits decides every sign. The direction must not be zero,
/// and lo ≤ hi. From inside the answer is tmin unless the convention states another. `touching` means that the two
/// conventions differ; like every other member, it is known only if `hit` is. For a Dual, the gradient is that of the
/// chosen axis: if two entries are equal, t has a kink, and the gradient is one-sided.
template <class E>
EnclosedHit<E> enclose(const SlabSpan<E>& slabs, const SpanRange<E>* range, intersect::Convention convention) {
    const E zero(0);
    const SlabHit<E> overlap = range ? slab_hit(slabs, *range) : slab_hit(slabs);
    if (overlap.closed.is_no()) return {Tri::no};
    if (overlap.closed.is_unknown() || overlap.open.is_unknown()) return {Tri::unknown};
    const bool touching = overlap.open.is_no();
    if (touching && convention.touching == intersect::Touching::miss) return {.hit = Tri::no, .touching = touching};

    const Fraction<E> first = range ? largest_entry(slabs, *range) : largest_entry(slabs);
    const Tri begins_inside = range ? compare_entries_with_begin(slabs, *range).at_most : first.n <= zero;
    if (begins_inside.is_unknown()) return {Tri::unknown};
    if (begins_inside.is_yes()) {
        const bool answers_begin =
            convention.inside == intersect::Inside::usual || convention.inside == intersect::Inside::zero;
        EnclosedHit<E> found =
            answers_begin ? enclose_begin(slabs.d2, range) : enclose_from_inside(slabs, range, convention, touching);
        found.touching = touching;
        return found;
    }
    const E t = first.n / first.m;
    return {Tri::yes, t, t * sqrt(slabs.d2), touching, false, Crossing::near};
}

/// Hit at one of the crossings of a surface, by its index.
template <class E>
EnclosedHit<E> enclose_crossing(const FlatSpan<E>& span, int, bool touching, bool on_surface) {
    const E t = span.at.n / span.at.m;
    return {Tri::yes, t, t * sqrt(span.d2), touching, on_surface, Crossing::near};
}
template <class E>
EnclosedHit<E> enclose_crossing(const WallSpan<E>& span, int i, bool touching, bool on_surface) {
    return enclose_root(span.primitive.side, i == 0 ? Crossing::near : Crossing::far, touching, on_surface);
}

/// True if the ray meets the surface from a side that counts.
template <class E>
Tri faces(const FlatSpan<E>& span, intersect::Facing facing) {
    if (facing == intersect::Facing::both) return Tri::yes;
    return facing == intersect::Facing::front ? Tri(span.is_front) : !Tri(span.is_front);
}
template <class E>
Tri faces(const WallSpan<E>&, intersect::Facing) {
    return Tri::yes;
}

/// First crossing that counts, for a surface without an inside. A line that meets a rim or runs along the surface
/// touches it. A crossing at the start of the ray is a root, and the convention decides whether this root counts. If
/// there are two crossings, the near one is an entry and the far one an exit; a single crossing is both.
template <class E, SurfaceSpan<E> S>
EnclosedHit<E> enclose(const S& s, const SpanRange<E>* range, intersect::Convention convention) {
    using intersect::AtOrigin, intersect::Touching;
    const E zero(0);
    const Fraction<E> begin{begin_of(range), E(1)};
    EnclosedHit<E> miss{Tri::no};
    for (int i = 0; i < S::crossing_count; ++i) {
        const auto crossing = s.crossing(i);
        const auto to_begin = s.compare_crossing(i, begin);
        const Tri in_range = range ? is_before_range_end(s.compare_crossing(i, range->end), *range) : Tri::yes;
        const Tri ahead = crossing.closed && faces(s, convention.facing) && !to_begin.less && in_range;
        const Tri at_begin = to_begin.at_most;
        if (ahead.is_no()) continue;
        if (ahead.is_unknown() || at_begin.is_unknown() || Tri(crossing.open).is_unknown()) return {Tri::unknown};

        // The convention may ignore a touch, or a crossing at the start.
        const bool touching = Tri(crossing.open).is_no(), is_exit = i + 1 == S::crossing_count;
        const bool is_ignored_start = at_begin.is_yes() && (convention.at_origin == AtOrigin::miss ||
                                                            (convention.at_origin == AtOrigin::exit && !is_exit));
        if (is_ignored_start || (touching && convention.touching == Touching::miss)) {
            miss.touching |= touching;
            miss.on_surface |= at_begin.is_yes();
            continue;
        }

        if (at_begin.is_yes() && (begin.n <= zero).is_yes()) return enclose_begin(s.d2, range, touching, true);
        return enclose_crossing<E>(s, i, touching, at_begin.is_yes());
    }
    return miss;
}

/// Hit at the entry (`Crossing::near`) or exit of the line, through a cap or at a root.
template <class E>
EnclosedHit<E> enclose_crossing(const CappedSpan<E>& span, Crossing crossing, bool touching, bool on_surface) {
    const bool is_entry = crossing == Crossing::near;
    const Tri by_cap = is_entry ? span.enters_by_cap() : span.leaves_by_cap();
    if (by_cap.is_unknown()) return {Tri::unknown};
    if (by_cap.is_no()) return enclose_root(span.side, crossing, touching, on_surface);
    const Fraction<E>& cap = is_entry ? span.planes_entry : span.planes_exit;
    const E t = cap.n / cap.m;
    return {Tri::yes, t, t * sqrt(span.d2), touching, on_surface, crossing};
}
template <class E>
EnclosedHit<E> enclose_crossing(const JoinedSpan<E>& span, Crossing crossing, bool touching, bool on_surface) {
    return enclose_root(crossing == Crossing::near ? span.enter : span.leave, crossing, touching, on_surface);
}

/// Answer of a convention for a ray that begins inside a primitive or on its surface.
template <class E, ComparableSpan<E> S>
EnclosedHit<E> enclose_from_inside(const S& s, const Fraction<E>& begin, const SpanRange<E>* range,
                                   intersect::Convention convention, bool touching) {
    using intersect::AtOrigin, intersect::Inside;
    const Tri entered = s.compare_entry(begin).less, leaving = s.compare_exit(begin).at_most;
    if (entered.is_unknown() || leaving.is_unknown()) return {Tri::unknown};
    const bool on_surface = touching || entered.is_no() || leaving.is_yes();
    const EnclosedHit<E> miss{.hit = Tri::no, .touching = touching, .on_surface = on_surface};
    const bool ignores_exits = convention.inside == Inside::miss && !touching;

    if (on_surface) {
        const bool start_counts =
            convention.at_origin == AtOrigin::hit || (convention.at_origin == AtOrigin::exit && leaving.is_yes());
        if (start_counts && !(ignores_exits && leaving.is_yes())) return enclose_begin(s.d2, range, touching, true);
        if (ignores_exits || leaving.is_yes()) return miss;
    } else if (convention.inside == Inside::zero) {
        return enclose_begin(s.d2, range);
    } else if (ignores_exits) {
        return miss;
    }

    if (range) {
        const Tri in_range = is_before_range_end(s.compare_exit(range->end), *range);
        if (!in_range.is_yes()) return in_range.is_no() ? miss : EnclosedHit<E>{Tri::unknown};
    }
    return enclose_crossing<E>(s, Crossing::far, touching, on_surface);
}

/// t* is the entry for a ray from outside and the exit for a ray from inside. A line touches if it runs along the
/// surface or meets only a rim, and so does a ray that ends where it enters.
template <class E, ComparableSpan<E> S>
EnclosedHit<E> enclose(const S& s, const SpanRange<E>* range, intersect::Convention convention) {
    const Fraction<E> begin{begin_of(range), E(1)};
    Order<Tri> to_end{Tri::yes, Tri::yes};
    if (range) {
        to_end = s.compare_entry(range->end);
        to_end.less = to_end.less || range->end.m <= E(0);  // along a side of a cone no root comes before 1/0
    }
    const Tri closed =
        s.meets_closed() && !s.compare_exit(begin).less && (range ? is_before_range_end(to_end, *range) : Tri::yes);
    if (closed.is_no()) return {Tri::no};
    if (closed.is_unknown()) return {Tri::unknown};
    const Tri begins_inside = s.compare_entry(begin).at_most, crosses = s.meets_open() && to_end.less;
    if (begins_inside.is_unknown() || crosses.is_unknown()) return {Tri::unknown};
    const bool touching = crosses.is_no();
    if (touching && convention.touching == intersect::Touching::miss) return {.hit = Tri::no, .touching = touching};
    if (begins_inside.is_yes()) return enclose_from_inside<E>(s, begin, range, convention, touching);
    return enclose_crossing<E>(s, Crossing::near, touching, false);
}

/// Defined in compare_hit.hpp.
template <class E>
EnclosedHit<E> enclose(const QuarticSpan<E>& span, const SpanRange<E>* range, intersect::Convention convention);

/// Convention by which to enclose a span. If a span cannot be hit behind a touch, touching counts here, and the caller
/// decides whether it is a hit.
template <class Span>
intersect::Convention convention_for_span(intersect::Convention convention) {
    if (!Span::may_hit_beyond_touch) convention.touching = intersect::Touching::hit;
    return convention;
}

/// First hit of a primitive of any shape. `range` (null: everything ahead) is not empty.
template <class E>
EnclosedHit<E> enclose(const Ray<E>& ray, const Primitive<E>& primitive, const SpanRange<E>* range = nullptr,
                       intersect::Convention convention = {}) {
    return with_span(ray, primitive, [&]<class Span>(const Span& span) {
        return enclose<E>(span, range, convention_for_span<Span>(convention));
    });
}

/// Range for spans over E, whose ends are converted by way of F; nullopt if the range is everything ahead. The range
/// must not be empty. An infinite end is not open: along a side of a cone, P(t) has degree one, and at 1/0 no root
/// comes before the end.
template <class E, class F = E>
std::optional<SpanRange<E>> range_over(const Range<double>& range) {
    if (range.is_whole()) return std::nullopt;
    const bool is_bounded = !std::isinf(range.tmax);
    const OpenEnds open_ends{range.open_ends.tmin, range.open_ends.tmax && is_bounded};
    return SpanRange<E>{E(F(range.tmin)), {is_bounded ? E(F(range.tmax)) : E(1), E(is_bounded ? 1 : 0)}, open_ends};
}

/// Convention for a ray that begins at tmin. If tmin > 0, or if the range is open there, the range itself decides
/// whether a hit at its start counts, in place of the convention for t = 0.
inline intersect::Convention convention_in(const Range<double>& range, intersect::Convention convention) {
    using intersect::AtOrigin;
    if (range.open_ends.tmin) convention.at_origin = AtOrigin::miss;
    else if (range.tmin > 0) convention.at_origin = AtOrigin::hit;
    return convention;
}

}  // namespace lostbits::measure::truth

#include "measure/truth/compare_hit.hpp"
