// The exact answer as one formula over any enclosure: what the truth proves, and what its conditioning differentiates.
#pragma once

#include <cmath>

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
    /// The origin lies on the sphere: t = 0 is a root, and whether it counts is a matter of convention.
    bool on_surface = false;
};

/// c = f·f − r² places the origin (outside, on, inside), h = f·d the direction, and m = f × d the line:
/// aΔ = a r² − m·m. Outside, a line that leaves (h ≥ 0) misses whatever Δ; inside or on the surface it always hits.
/// No step subtracts numbers of like size that are not exact differences of the inputs: t = c/(−h + √aΔ) from outside,
/// (−h + √aΔ)/a or −c/(h + √aΔ) from inside, by the sign of h.
/// An origin on the surface (c = 0) has the roots 0 and −2h/a: t = 0, or, where that does not count, the other if it
/// is positive. From inside (c < 0) t is what the convention says.
template <class E>
Enclosed<E> enclose(const Ray<E>& ray, const Sphere<E>& sphere, intersect::Convention convention = {}) {
    const E zero(0);
    const Vec<E> f = ray.origin - sphere.centre;
    const E h = dot(f, ray.direction);
    const E r2 = square(sphere.radius);
    const E c = square(f) - r2;
    const Tri outside = c > zero;
    const Tri leaving = h >= zero;
    if ((outside && leaving).is_yes()) return {Tri::no, zero, zero};

    const E a = square(ray.direction);
    const Vec<E> m = cross(f, ray.direction);
    const E discriminant = a * r2 - square(m);
    const Tri hit = !outside || (!leaving && !(discriminant < zero));
    if (hit.is_no()) return {hit, zero, zero};
    if (hit.is_unknown() || outside.is_unknown()) return {Tri::unknown, zero, zero};
    if ((c >= zero).is_yes() && outside.is_no()) {  // the origin lies on the surface, and the discriminant is h²
        const Tri aside = h > zero || h < zero;
        if (aside.is_unknown() || leaving.is_unknown()) return {Tri::unknown, zero, zero};
        const bool touching = aside.is_no();
        // Whoever misses from inside has no exits, and so none at the origin. Of a tangent both roots are 0.
        const bool no_exits = convention.inside == intersect::Inside::miss && !touching;
        const bool counts = convention.at_origin == intersect::AtOrigin::hit ||
                            (convention.at_origin == intersect::AtOrigin::exit && leaving.is_yes());
        if (counts && !(no_exits && leaving.is_yes())) return {Tri::yes, zero, zero, touching, true};
        if (no_exits || leaving.is_yes()) return {Tri::no, zero, zero, touching, true};
        const E t = (sqrt(discriminant) - h) / a;  // and not −2h/a, whose gradient is another
        return {Tri::yes, t, t * sqrt(a), false, true};
    }
    const bool zero_inside = convention.inside == intersect::Inside::zero;
    if (outside.is_no() && (zero_inside || convention.inside == intersect::Inside::miss)) {
        if (!(c < zero).is_yes()) return {Tri::unknown, zero, zero};
        return {zero_inside ? Tri::yes : Tri::no, zero, zero};
    }
    const Tri through = outside.is_no() ? Tri::yes : discriminant > zero;
    if (through.is_unknown()) return {Tri::unknown, zero, zero};

    const E root = sqrt(discriminant);
    const E t = outside.is_yes() ? c / (root - h) : (h > zero).is_yes() ? -c / (h + root) : (root - h) / a;
    return {Tri::yes, t, t * sqrt(a), through.is_no()};
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
inline double word_of(const Real& x) { return x.convert_to<double>(); }
inline double low_word_of(const Real& x) {
    const double hi = word_of(x);
    if (!std::isfinite(hi)) return missing;
    const Real rest = x - Real(hi);
    if (rest == 0) return 0;
    return std::fabs(hi) < 0x1p-800 ? missing : rest.convert_to<double>();
}

}  // namespace lostbits::measure::truth
