// The exact answer as one formula over any enclosure: what the truth proves, and what its conditioning differentiates.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "geometry/flat_span.hpp"
#include "intersect/info.hpp"
#include "measure/truth/missing.hpp"
#include "number/ball.hpp"
#include "number/interval.hpp"
#include "shapes/solid.hpp"

namespace lostbits::measure::truth {

/// What one precision can say about one solid, all of it only where `hit` is certain.
template <class E>
struct Enclosed {
    Tri hit;  ///< of the closed solid: touching counts
    E t;
    E distance;
    /// The line meets the solid's boundary alone (a tangent): a miss where touching does not count.
    bool touching = false;
    /// The origin lies on the surface: t = 0 is a root, and whether it counts is a matter of convention.
    bool on_surface = false;
};

/// The origin lies on the surface, and q is h².
template <class E>
Enclosed<E> enclose_from_surface(const QuadraticSpan<E>& s, Tri leaving, intersect::Convention convention) {
    const E zero(0);
    const Tri aside = s.h > zero || s.h < zero;
    if (aside.is_unknown() || leaving.is_unknown()) return {Tri::unknown, zero, zero};
    const bool touching = aside.is_no();
    // Whoever misses from inside has no exits, and so none at the origin. Of a tangent both roots are 0.
    const bool no_exits = convention.inside == intersect::Inside::miss && !touching;
    const bool counts = convention.at_origin == intersect::AtOrigin::hit ||
                        (convention.at_origin == intersect::AtOrigin::exit && leaving.is_yes());
    if (counts && !(no_exits && leaving.is_yes())) return {Tri::yes, zero, zero, touching, true};
    if (no_exits || leaving.is_yes()) return {Tri::no, zero, zero, touching, true};
    const E t = (sqrt(s.q) - s.h) / s.a;  // and not −2h/a, whose gradient is another
    return {Tri::yes, t, t * sqrt(s.d2), false, true};
}

/// The line against the surface of a quadratic: c places the origin (outside, on, inside), h the direction. Outside, a
/// line that leaves (h ≥ 0) misses whatever q; inside or on the surface it always hits. t = c/(−h + √q) from outside,
/// (−h + √q)/a or −c/(h + √q) from inside, by the sign of h.
/// An origin on the surface (c = 0) has the roots 0 and −2h/a: t = 0, or, where that does not count, the other if it
/// is positive. From inside (c < 0) t is what the convention says. The problem has no end, whatever `tmax`.
template <class E>
Enclosed<E> enclose(const QuadraticSpan<E>& s, const E* = nullptr, intersect::Convention convention = {}) {
    const E zero(0);
    const Tri outside = s.c > zero;
    const Tri leaving = s.h >= zero;
    if ((outside && leaving).is_yes()) return {Tri::no, zero, zero};

    const Tri hit = !outside || (!leaving && !(s.q < zero));
    if (hit.is_no()) return {hit, zero, zero};
    if (hit.is_unknown() || outside.is_unknown()) return {Tri::unknown, zero, zero};
    if ((s.c >= zero).is_yes() && outside.is_no()) return enclose_from_surface(s, leaving, convention);
    const bool zero_inside = convention.inside == intersect::Inside::zero;
    if (outside.is_no() && (zero_inside || convention.inside == intersect::Inside::miss)) {
        if (!(s.c < zero).is_yes()) return {Tri::unknown, zero, zero};
        return {zero_inside ? Tri::yes : Tri::no, zero, zero};
    }
    const Tri through = outside.is_no() ? Tri::yes : s.q > zero;
    if (through.is_unknown()) return {Tri::unknown, zero, zero};

    const E root = sqrt(s.q);
    const E t = outside.is_yes()        ? s.c / (root - s.h)
                : (s.h > zero).is_yes() ? -s.c / (s.h + root)
                                        : (root - s.h) / s.a;
    return {Tri::yes, t, t * sqrt(s.d2), through.is_no()};
}

/// What a convention says of a ray that starts in the closed box (largest entry a ≤ 0 ≤ smallest exit b). With a < 0 <
/// b it is inside; a = 0 is an entry at the origin, and b = 0 an exit there. An exit beyond tmax is none.
template <class E>
Enclosed<E> enclose_from_inside(const SlabSpan<E>& slabs, const E* tmax, intersect::Convention asked) {
    using intersect::AtOrigin, intersect::Inside;
    const E zero(0);
    const Enclosed<E> unknown{Tri::unknown, zero, zero}, at_once{Tri::yes, zero, zero}, none{Tri::no, zero, zero};
    Tri entered = Tri::yes;
    for (const auto& entry : slabs.entry) entered = entered && entry.n < zero;
    const Fraction<E> exit = first_exit(slabs);
    const Tri leaving = exit.n <= zero;
    if (entered.is_unknown()) return unknown;
    if (leaving.is_unknown()) return unknown;
    if (entered.is_no() && asked.at_origin == AtOrigin::hit) return at_once;
    if (leaving.is_yes()) return asked.at_origin == AtOrigin::miss || asked.inside != Inside::exit ? none : at_once;
    if (asked.inside != Inside::exit) return none;
    if (tmax) {
        const Tri in_reach = exit.n <= *tmax * exit.m;
        if (!in_reach.is_yes()) return in_reach.is_no() ? none : unknown;
    }
    const E t = exit.n / exit.m;
    return {Tri::yes, t, t * sqrt(slabs.d2)};
}

/// The line against what slabs leave of it. The first t in [0, tmax] (no end where `tmax` is null) for which o + t d
/// lies in the closed solid (`Touching::hit`), or the infimum of those for which it lies in the open one
/// (`Touching::miss`). For either, t* = max(0, largest entry):
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
Enclosed<E> enclose(const SlabSpan<E>& slabs, const E* tmax, intersect::Convention convention) {
    const E zero(0);
    const Enclosed<E> unknown{Tri::unknown, zero, zero};
    const InSlabs<E> in = tmax ? in_slabs(slabs, *tmax) : in_slabs(slabs);
    if (in.closed.is_no()) return {Tri::no, zero, zero};
    if (in.closed.is_unknown() || in.open.is_unknown()) return unknown;
    const bool touching = in.open.is_no();
    if (touching && convention.touching == intersect::Touching::miss) return {Tri::no, zero, zero, touching};

    const Fraction<E> first = first_entry(slabs);
    const Tri at_once = first.n <= zero;
    if (at_once.is_unknown()) return unknown;
    if (at_once.is_yes()) {
        const bool usual =
            convention.inside == intersect::Inside::usual || convention.inside == intersect::Inside::zero;
        Enclosed<E> found = usual ? Enclosed<E>{Tri::yes, zero, zero} : enclose_from_inside(slabs, tmax, convention);
        found.touching = touching;
        return found;
    }
    const E t = first.n / first.m;
    return {Tri::yes, t, t * sqrt(slabs.d2), touching};
}

/// The line against a surface without thickness. On the rim it touches; a surface at the origin is a root at t = 0, as
/// entry and exit at once, and counts by the convention. There is no inside, and no end, whatever `tmax`.
template <class E>
Enclosed<E> enclose(const FlatSpan<E>& s, const E*, intersect::Convention convention) {
    const E zero(0);
    const Tri hit = s.closed && s.at.n >= zero;
    if (hit.is_no()) return {Tri::no, zero, zero};
    const Tri ahead = s.at.n > zero;
    if (hit.is_unknown() || ahead.is_unknown() || Tri(s.open).is_unknown()) return {Tri::unknown, zero, zero};
    const bool touching = Tri(s.open).is_no();
    if (ahead.is_no())
        return {convention.at_origin == intersect::AtOrigin::miss ? Tri::no : Tri::yes, zero, zero, touching, true};
    const E t = s.at.n / s.at.m;
    return {Tri::yes, t, t * sqrt(s.d2), touching};
}

/// The closed solid, whatever its shape: what the convention says of touching is left to whoever asks. `tmax` (null:
/// nowhere) ends the ray where the shape's forms are told its end.
template <class E>
Enclosed<E> enclose(const Ray<E>& ray, const Solid<E>& solid, const E* tmax = nullptr,
                    intersect::Convention convention = {}) {
    convention.touching = intersect::Touching::hit;
    return with_span(ray, solid, [&](const auto& span) { return enclose(span, tmax, convention); });
}

template <class E, class S>
E lift(const S& x) {
    return E(x);
}
/// A 256-bit number as a ball: two words and what they leave.
template <>
inline Ball lift<Ball, Real>(const Real& x) {
    const auto hi = x.convert_to<double>();
    if (!std::isfinite(hi)) return Ball::unknown();
    const auto lo = Real(x - Real(hi)).convert_to<double>();
    const Real rest = Real(x - Real(hi)) - Real(lo);
    if (rest == 0) return Ball(hi, lo, 0);
    return std::fabs(hi) < 0x1p-800 ? Ball::unknown() : Ball(hi, lo, std::fabs(hi) * 0x1p-104);
}

template <class E, class S>
Vec<E> lift_vec(const Vec<S>& v) {
    return Vec<E>(lift<E>(v.x), lift<E>(v.y), lift<E>(v.z));
}

template <class E, class S>
Ray<E> lift_ray(const Ray<S>& ray) {
    return {lift_vec<E>(ray.origin), lift_vec<E>(ray.direction)};
}

template <class E, class S>
Solid<E> lift_solid(const Solid<S>& solid) {
    return transformed(solid, [](const S& x) { return lift<E>(x); });
}

/// The double nearest to a number, and the double nearest to what that leaves: NaN where the two do not enclose the
/// number to 2^-104 of itself, as `lift` has it.
inline double word_of(double x) { return x; }
inline double low_word_of(double) { return 0; }
inline double word_of(const Real& x) { return x.convert_to<double>(); }
inline double low_word_of(const Real& x) {
    const double hi = word_of(x);
    if (!std::isfinite(hi)) return missing;
    const Real rest = x - Real(hi);
    if (rest == 0) return 0;
    return std::fabs(hi) < 0x1p-800 ? missing : rest.convert_to<double>();
}

}  // namespace lostbits::measure::truth
