// The exact answer to a ray at a cylinder or a cone with caps, in fractions: the least of a parabola on an interval,
// how near to the axis the line comes between the caps beside how near it may. No span and no form computes that.
#pragma once

#include <algorithm>
#include <optional>

#include "geometry/ray.hpp"
#include "intersect/exact.hpp"

namespace lostbits::test {

/// The line against the infinite solid, P(t) = a t² + 2 h t + c, and against the caps, low ≤ t ≤ high.
struct CappedAnswer {
    Rational a, h, c;
    std::optional<Rational> low, high;  ///< nothing of a line beside the caps
    bool between = true, inner = true;  ///< of such a line: whether it is between them, and not in one

    [[nodiscard]] Rational at(const Rational& t) const { return (a * t + 2 * h) * t + c; }
    /// Where P is least between the caps and from ≤ t ≤ to; nothing where no t is.
    [[nodiscard]] std::optional<Rational> nearest(const std::optional<Rational>& from,
                                                  const std::optional<Rational>& to = {}) const {
        std::optional<Rational> least = low, most = high;
        if (from) least = least ? std::max(*least, *from) : *from;
        if (to) most = most ? std::min(*most, *to) : *to;
        if (!between || (least && most && *most < *least)) return std::nullopt;
        // A parabola that opens downwards has its least at an end, and a line that has no end does not meet one.
        if (a < 0) return at(*least) <= at(*most) ? least : most;
        if (a == 0 && least && most) return at(*least) <= at(*most) ? least : most;
        Rational t = a == 0 ? least ? *least : Rational(0) : Rational(-h / a);
        if (least && t < *least) t = *least;
        if (most && t > *most) t = *most;
        return t;
    }
    [[nodiscard]] bool meets() const {
        const auto t = nearest(Rational(0));
        return t && at(*t) <= 0;
    }
    /// Whether the line passes through the open solid, in front of the origin or behind.
    [[nodiscard]] bool goes_through() const {
        const auto t = nearest(std::nullopt);
        return inner && t && at(*t) < 0;
    }
    [[nodiscard]] bool holds(const Rational& t) const {
        return between && (!low || (*low <= t && t <= *high)) && at(t) <= 0;
    }
    [[nodiscard]] bool is_within(const Rational& t) const {
        return inner && (!low || (*low < t && t < *high)) && at(t) < 0;
    }
    /// Whether t, off by at most e, may be the first point of the surface from the origin on.
    [[nodiscard]] bool is_first(const Rational& t, const Rational& e) const {
        const bool inside = is_within(Rational(0));
        if (inside) return holds(t - e) && !is_within(t + e);
        if (holds(Rational(0))) return t - e <= 0 && 0 <= t + e;
        // No point of it before t − e, and one from there to t + e.
        const auto before = nearest(Rational(0), Rational(t - e)), there = nearest(Rational(t - e), Rational(t + e));
        return !(before && *before < t - e && at(*before) <= 0) && there && at(*there) <= 0;
    }
    /// Whether no equality is near: a rim, a tangent, the origin on the surface, a line beside the axis, the side or
    /// the caps.
    [[nodiscard]] bool is_clear() const {
        const Rational few = Rational(1) / (1 << 20);
        const auto is_near = [&](const Rational& x) { return abs(x) < few; };
        const auto t = nearest(Rational(0));
        if (!low || is_near(a) || (t && is_near(at(*t))) || holds(0) != is_within(0) || c == 0) return false;
        if (abs(Rational(h * h - a * c)) < few * h * h) return false;
        return !is_near(at(*low)) && !is_near(at(*high));
    }
};

/// From the axis between two points and the radii there: |p|² − (v·p)²/v² ≤ (r₀ + (r₁ − r₀) v·p/v²)².
inline CappedAnswer capped_answer(const Ray<double>& ray, const Vec<double>& from, const Vec<double>& to, double r0,
                                  double r1) {
    CappedAnswer answer{0, 0, 0, {}, {}};
    Rational ff = 0, fd = 0, dd = 0, vf = 0, vd = 0, vv = 0;
    for (int i = 0; i < 3; ++i) {
        const Rational base(from[i]), v = Rational(to[i]) - base;
        const Rational f = Rational(ray.origin[i]) - base, d(ray.direction[i]);
        ff += f * f, fd += f * d, dd += d * d, vf += v * f, vd += v * d, vv += v * v;
    }
    const Rational slope = (Rational(r1) - Rational(r0)) / vv, r = Rational(r0) + slope * vf, k = slope * vd;
    answer.a = dd - vd * vd / vv - k * k, answer.h = fd - vf * vd / vv - r * k;
    answer.c = ff - vf * vf / vv - r * r;
    if (vd == 0) {
        answer.between = vf >= 0 && vf <= vv, answer.inner = vf > 0 && vf < vv;
    } else {
        const Rational one = -vf / vd, other = (vv - vf) / vd;
        answer.low = std::min(one, other), answer.high = std::max(one, other);
    }
    return answer;
}

}  // namespace lostbits::test
