#include "measure/truth.hpp"

#include <cmath>
#include <limits>

#include "number/error.hpp"

namespace lostbits {
namespace {

/// What one precision can say about one sphere. `t` and `distance` mean something only where `hit` is certain.
template <class E>
struct Enclosed {
    Tri hit;
    E t;
    E distance;
};

/// c = f·f − r² places the origin (outside, on, inside), h = f·d the direction, and m = f × d the line:
/// aΔ = a r² − m·m. Outside, a line that leaves (h ≥ 0) misses whatever Δ; inside or on the surface it always hits.
/// No step subtracts numbers of like size that are not exact differences of the inputs: t = c/(−h + √aΔ) from outside,
/// (−h + √aΔ)/a or −c/(h + √aΔ) from inside, by the sign of h.
template <class E>
Enclosed<E> enclose(const Ray<E>& ray, const Sphere<E>& sphere) {
    const E zero(0);
    const Vec<E> f = ray.origin - sphere.centre;
    const E h = dot(f, ray.direction);
    const E r2 = sphere.radius * sphere.radius;
    const E c = dot(f, f) - r2;
    const Tri outside = c > zero;
    const Tri leaving = h >= zero;
    if ((outside && leaving).is_yes()) return {Tri::no, zero, zero};

    const E a = dot(ray.direction, ray.direction);
    const Vec<E> m = cross(f, ray.direction);
    const E discriminant = a * r2 - dot(m, m);
    const Tri hit = !outside || (!leaving && !(discriminant < zero));
    if (hit.is_no()) return {hit, zero, zero};
    if (hit.is_unknown() || outside.is_unknown()) return {Tri::unknown, zero, zero};
    if ((c >= zero).is_yes() && outside.is_no()) return {Tri::yes, zero, zero};  // the origin lies on the surface

    const E root = sqrt(discriminant);
    const E t = outside.is_yes()         ? c / (root - h)
                : (h > zero).is_yes() ? -c / (h + root)
                                      : (root - h) / a;
    return {Tri::yes, t, t * sqrt(a)};
}

template <class E, class S>
E lift(const S& x) {
    return E(x);
}
/// A 256-bit number as a ball: two words and what they leave.
template <>
Ball lift<Ball, Real>(const Real& x) {
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
Sphere<E> lift_sphere(const Sphere<S>& sphere) {
    return {lift_vec<E>(sphere.centre), lift<E>(sphere.radius)};
}

/// Fills in a miss or a tightly enclosed hit; false where this precision does not settle it.
template <class E>
bool settle(const Enclosed<E>& e, Truth& truth) {
    if (e.hit.is_no()) {
        truth.decision = Truth::Decision::miss;
        return true;
    }
    if (!e.hit.is_yes()) return false;
    const auto t = certify(e.t);
    if (!t) return false;
    const auto distance = certify(e.distance);
    if (!distance) return false;
    truth.decision = Truth::Decision::hit;
    truth.t = *t;
    truth.distance = *distance;
    return true;
}

template <class S>
Truth escalate(const Ray<S>& ray, const Sphere<S>& sphere, TruthLimit limit) {
    Truth truth;
    for (int bits = std::is_same_v<S, Real> ? 384 : 192; bits <= limit.bits; bits *= 2) {
        const Interval::Precision precision(bits);
        truth.bits = bits;
        if (settle(enclose(lift_ray<Interval>(ray), lift_sphere<Interval>(sphere)), truth)) return truth;
    }
    truth.decision = Truth::Decision::unresolved;
    return truth;
}

template <class S>
Truth find(const Ray<S>& ray, std::span<const Sphere<S>> spheres, TruthLimit limit) {
    const Ray<Ball> quick = lift_ray<Ball>(ray);
    Truth best;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        Truth one;
        one.bits = 106;
        if (!settle(enclose(quick, lift_sphere<Ball>(spheres[i])), one)) one = escalate(ray, spheres[i], limit);
        const int bits = std::max(best.bits, one.bits);
        one.object = static_cast<int>(i);
        if (one.decision == Truth::Decision::unresolved || best.decision == Truth::Decision::unresolved) {
            best.decision = Truth::Decision::unresolved;
        } else if (one.is_hit() && !best.is_hit()) {
            best = one;
        } else if (one.is_hit() && compare(one.t, best.t) < 0) {
            best = one;
        } else if (one.is_hit() && compare(one.t, best.t) == 0) {
            best.t = nearer(best.t, one.t);
            best.distance = nearer(best.distance, one.distance);
        }
        best.bits = bits;
    }
    return best;
}

/// −1, 0, +1 as t* lies below, at or above the dyadic number m > 0, or nothing where this precision does not tell: with P(t) = a t² + 2 h t + c, the near root (from
/// outside) is above m where P(m) > 0 and a m + h < 0; the far root (from inside) is above m where P(m) < 0. From
/// outside P is positive before the near root, from inside negative before the far one.
std::optional<int> side_of(const Ray<Interval>& ray, const Sphere<Interval>& sphere, const Interval& m) {
    const Interval zero(0);
    const Vec<Interval> f = ray.origin - sphere.centre;
    const Interval a = dot(ray.direction, ray.direction);
    const Interval h = dot(f, ray.direction);
    const Interval c = dot(f, f) - sphere.radius * sphere.radius;
    const Interval p = (a * m + h + h) * m + c;
    const Interval past = a * m + h;
    if ((c > zero).is_unknown()) return std::nullopt;
    const bool outside = (c > zero).is_yes();
    if ((p < zero).is_yes()) return outside ? -1 : 1;
    if (!(p > zero).is_yes() && !p.is_exact()) return std::nullopt;
    if (!outside) return p.is_exact() && !(p > zero).is_yes() ? 0 : -1;
    // Past the middle both P(m) > 0 and the root P(m) = 0 lie beyond the near root.
    if ((past > zero).is_unknown()) return std::nullopt;
    if ((past > zero).is_yes()) return -1;
    return (p > zero).is_yes() ? 1 : 0;
}

template <class S>
double round_exactly(const Truth& truth, const Ray<S>& ray, const Sphere<S>& sphere, const FloatFormat& format) {
    const auto [lower, upper] = round_ends(truth.t, format);
    if (lower == upper) return lower;
    for (int bits = std::is_same_v<S, Real> ? 384 : 192; bits <= TruthLimit{}.bits; bits *= 2) {
        const Interval::Precision precision(bits);
        // The boundary that the bound straddles: midway between the two, or half a last place above the largest number.
        const Interval middle = std::isinf(upper) ? Interval(lower) + Interval(std::ldexp(1.0, format.emax - format.precision))
                                                  : (Interval(lower) + Interval(upper)) / Interval(2);
        const auto side = side_of(lift_ray<Interval>(ray), lift_sphere<Interval>(sphere), middle);
        if (!side) continue;
        if (*side != 0) return *side < 0 ? lower : upper;
        return ordinal(lower, format) % 2 == 0 ? lower : upper;
    }
    throw Error(Exit::internal, "no precision told the side of a rounding boundary");
}

}  // namespace

Truth find_truth(const Ray<double>& ray, std::span<const Sphere<double>> spheres, TruthLimit limit) { return find(ray, spheres, limit); }
Truth find_truth(const Ray<Real>& ray, std::span<const Sphere<Real>> spheres, TruthLimit limit) { return find(ray, spheres, limit); }

double round_truth(const Truth& truth, const Ray<double>& ray, const Sphere<double>& sphere, const FloatFormat& format) {
    return round_exactly(truth, ray, sphere, format);
}
double round_truth(const Truth& truth, const Ray<Real>& ray, const Sphere<Real>& sphere, const FloatFormat& format) {
    return round_exactly(truth, ray, sphere, format);
}

}  // namespace lostbits
