// Steps from the discriminant to the answer that forms of several shapes share.
#pragma once

#include "intersect/info.hpp"

namespace lostbits::intersect {

template <Number T>
T half() {
    return T(1) / T(2);
}

template <Number T>
struct RootPair {
    T near;
    T far;

    friend RootPair select(const mask_t<T>& mask, const RootPair& a, const RootPair& b) {
        return {select(mask, a.near, b.near), select(mask, a.far, b.far)};
    }
};

/// The first root with t ≥ 0: near, or far if near is negative. `missed` is the form's own test of the discriminant, as
/// its source writes it (`disc < 0`, …). A NaN fails every test, so the answer is a hit at NaN, as in the published
/// code.
template <Number T>
Hit<T> hit_unless(mask_t<T> missed, const RootPair<T>& roots) {
    // t is not a local variable: GCC 12 stored it in every round of the packed loops, where nothing read it.
    Hit<T> hit{missed, named("t", select(roots.near < T(0), roots.far, roots.near)), roots.near, roots.far};
    hit.hit = !(missed || hit.t < T(0));
    return hit;
}

/// A hit at the near root only: a ray from inside misses.
template <Number T>
Hit<T> near_hit(mask_t<T> missed, const T& near) {
    return Hit<T>{!(missed || near < T(0)), near, near, near};
}

/// Equation (3), the plain roots (−b ± √disc)/(2a) with root = √disc. One of the two subtracts |b| from √disc.
template <Number T>
RootPair<T> plain_roots(const T& a, const T& b, const T& root) {
    return {(-b - root) / (T(2) * a), (-b + root) / (T(2) * a)};
}

/// Plain roots with half b: (−h ± root)/a, root = √(h² − ac).
template <Number T>
RootPair<T> plain_half_roots(const T& a, const T& h, const T& root) {
    return {(-h - root) / a, (-h + root) / a};
}

/// Equation (6), Press et al.: q = −½(b + sign(b) root), roots c/q and q/a, so that numbers of similar size
/// are never subtracted. sign(0) = +1 as in the published code (the text of Ray Tracing Gems ch. 7 says −1); c/q is the
/// near root if b < 0.
template <Number T>
RootPair<T> press_roots(const T& a, const T& b, const T& c, const T& root) {
    return decide(b < T(0), [&](const mask_t<T>& is_b_negative) {
        const T q = named("q", -half<T>() * (b + select(is_b_negative, -root, root)));
        const T q_over_a = q / a;
        const T c_over_q = c / q;
        return RootPair<T>{select(is_b_negative, c_over_q, q_over_a), select(is_b_negative, q_over_a, c_over_q)};
    });
}

/// Equation (10), the Press roots without the factor 2: q = b' + sign(b') root, b' = −f·d, root = √(aΔ), roots c/q and
/// q/a. `minus_b` is b'. sign(0) = +1; c/q is the near root if b' ≥ 0. A tangent ray that starts on the surface has q =
/// 0, hence 0/0.
template <Number T>
RootPair<T> unified_roots(const T& a, const T& minus_b, const T& c, const T& root) {
    return decide(minus_b < T(0), [&](const mask_t<T>& is_b_negative) {
        const T q = named("q", minus_b + select(is_b_negative, -root, root));
        const T q_over_a = q / a;
        const T c_over_q = c / q;
        return RootPair<T>{select(is_b_negative, q_over_a, c_over_q), select(is_b_negative, c_over_q, q_over_a)};
    });
}

}  // namespace lostbits::intersect
