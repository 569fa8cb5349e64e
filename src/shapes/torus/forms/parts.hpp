// Functions that several torus forms share: the quartic in t, its roots by a resolvent cubic, and the first of them.
#pragma once

#include "intersect/info.hpp"
#include "shapes/torus/torus.hpp"

namespace lostbits::intersect::torus {

/// A ray relative to a torus: the origin p relative to the centre, the direction d, and their components along the unit
/// axis.
template <Number T>
struct TorusRay {
    Vec<T> p, d;
    T pz, dz;

    TorusRay(const Ray<T>& ray, const Torus<T>& torus)
        : TorusRay(ray.origin - torus.centre, ray.direction, (T(1) / length(torus.axis)) * torus.axis) {}

private:
    TorusRay(const Vec<T>& f, const Vec<T>& direction, const Vec<T>& n)
        : p(f), d(direction), pz(named("pz", dot(n, f))), dz(named("dz", dot(n, direction))) {}
};

/// The polynomial t⁴ + a t³ + b t² + c t + d.
template <Number T>
struct Quartic {
    T a, b, c, d;
};

/// Returns the quartic in t for a direction of length one, as in most code.
template <Number T>
Quartic<T> quartic_in_t(const Vec<T>& p, const Vec<T>& d, const T& pz, const T& dz, const Torus<T>& torus) {
    const T R2 = square(torus.major_radius), r2 = square(torus.minor_radius);
    const T k1 = named("k1", square(p) - R2 - r2), k2 = named("k2", dot(p, d));
    return {T(4) * k2, T(2) * (k1 + T(2) * (square(k2) + R2 * square(dz))), T(4) * (k2 * k1 + T(2) * R2 * (pz * dz)),
            square(k1) + T(4) * R2 * (square(pz) - r2)};
}

/// Widens a ray or a torus to the wider arithmetic. `narrow_hit` converts the answer back.
template <Number T>
auto to_wider(const Vec<T>& v) {
    return Vec<typename Wider<T>::type>(Wider<T>::widen(v.x), Wider<T>::widen(v.y), Wider<T>::widen(v.z));
}
template <Number T>
auto to_wider(const Ray<T>& ray) {
    return Ray<typename Wider<T>::type>{to_wider(ray.origin), to_wider(ray.direction)};
}
template <Number T>
auto to_wider(const Torus<T>& torus) {
    return Torus<typename Wider<T>::type>{to_wider(torus.centre), to_wider(torus.axis),
                                          Wider<T>::widen(torus.major_radius), Wider<T>::widen(torus.minor_radius)};
}
template <Number T>
Hit<T> narrow_hit(const Hit<typename Wider<T>::type>& wide) {
    return {wide.hit, Wider<T>::narrow(wide.t), Wider<T>::narrow(wide.near), Wider<T>::narrow(wide.far)};
}

/// The first t ≥ 0 of the roots that are passed to it.
template <Number T>
class FirstHit {
public:
    void add_root(const mask_t<T>& is_root, const T& t) {
        const auto is_first = is_root && t >= T(0) && (!hit_ || t < t_);
        t_ = select(is_first, t, t_);
        hit_ = hit_ || is_first;
    }
    [[nodiscard]] Hit<T> answer() const {
        const T t = named("t", t_);
        return {hit_, t, t, t};
    }

private:
    T t_ = T(0);
    mask_t<T> hit_ = T(0) < T(0);
};

/// Finds a real root of y³ + b y² + c y + d between two points. The polynomial must be ≤ 0 at the first and ≥ 0 at the
/// second. The function takes Newton's steps, and halves the interval if a step leads out of it. The sources of the
/// forms compute the same number by a cube root, or by the cosine of a third of an angle.
template <Number T>
T cubic_root_between(const T& negative_end, const T& positive_end, const T& b, const T& c, const T& d) {
    const T zero(0), half = T(1) / T(2);
    T low = negative_end, high = positive_end, y = high;
    auto is_moving = low < high;
    for (int i = 0; i < 100 && any_of(is_moving); ++i) {
        const T value = ((y + b) * y + c) * y + d, slope = (T(3) * y + T(2) * b) * y + c;
        const auto is_below = value < zero;
        low = select(is_below, y, low);
        high = select(is_below, high, y);
        const T newton = y - value / slope, middle = half * (low + high);
        // A Newton step below the interval ends at the lower end of the interval, because the root may be there.
        const T fallback = select(newton < low && low < y, low, middle);
        const T next = select(low <= newton && newton <= high, newton, fallback);
        is_moving = is_moving && (next < y || next > y);
        y = select(is_moving, next, y);
    }
    return y;
}

/// Finds all real roots of x⁴ + p x² + q x + r by two quadratics. With z > p/2 a root of z³ − p z²/2 − r z + r p/2 −
/// q²/8, u² = z² − r and v² = 2z − p, the quadratics are x² ± v x + z ∓ u. Squares that rounding makes negative are
/// replaced by 0. Calls `take_root(is_root, x)` four times; x is a real root if `is_root`.
template <Number T, class TakeRoot>
void take_depressed_roots(const T& p, const T& q, const T& r, const TakeRoot& take_root) {
    const T half = T(1) / T(2), zero(0);
    // For z > s the cubic is more than z² (3z − q²/s²)/4.
    const T s = max(abs(p), T(2) * sqrt(abs(r))), upper_end = max(s, square(q) / square(s));
    const T z =
        named("z", cubic_root_between<T>(half * p, upper_end, -half * p, -r, half * (r * p) - square(q) / T(8)));
    const T u2 = named("u2", square(z) - r), v2 = named("v2", T(2) * z - p);
    const T u = sqrt(max(u2, zero)), v = select(q < zero, -T(1), T(1)) * sqrt(max(v2, zero));
    const auto add_roots = [&](const T& b, const T& c) {
        const T disc = named("disc", square(half * b) - c), root = sqrt(disc);
        const auto is_root = disc >= zero;
        take_root(is_root, -half * b - root);
        take_root(is_root, root - half * b);
    };
    add_roots(v, z - u);
    add_roots(-v, z + u);
}

/// Finds the roots of a quartic. x = t + a/4 removes the cubic term. Calls `take_root(is_root, t)` as
/// `take_depressed_roots` does.
template <Number T, class TakeRoot>
void take_quartic_roots(const Quartic<T>& f, const TakeRoot& take_root) {
    const T a2 = square(f.a), quarter = f.a / T(4);
    const T p = named("p", T(-3) * a2 / T(8) + f.b), q = named("q", a2 * f.a / T(8) - f.a * f.b / T(2) + f.c);
    const T r = named("r", T(-3) * square(a2) / T(256) + a2 * f.b / T(16) - f.a * f.c / T(4) + f.d);
    take_depressed_roots<T>(p, q, r, [&](const auto& is_root, const T& x) { take_root(is_root, x - quarter); });
}

}  // namespace lostbits::intersect::torus
