// On which side of a number an exact length lies: decided by signs of dyadic polynomials, without the length itself.
#pragma once

#include <optional>

#include "measure/truth/enclose.hpp"
#include "measure/truth/truth.hpp"

namespace lostbits::measure::truth {

/// What `find.operator()<E>()` finds with balls, or else with intervals of rising precision: an optional, which is
/// empty where no precision tells.
template <class Find>
auto by_rising_precision(const Find& find) {
    auto found = find.template operator()<Ball>();
    for (int bits = 192; !found && bits <= TruthLimit{}.bits; bits *= 2) {
        const Interval::Precision precision(bits);
        found = find.template operator()<Interval>();
    }
    return found;
}

/// −1, 0 or +1, or nothing where this precision does not tell.
template <class E>
std::optional<int> sign(const E& x) {
    const E zero(0);
    if ((x < zero).is_yes()) return -1;
    if ((x > zero).is_yes()) return 1;
    if ((x <= zero && x >= zero).is_yes()) return 0;
    return std::nullopt;
}

/// The sign of u + v/√a for a > 0: that of the larger of u² a and v² where u and v differ in sign.
template <class E>
std::optional<int> sign_of_sum(const E& u, const E& v, const E& a) {
    const auto of_u = sign(u), of_v = sign(v);
    if (!of_u || !of_v) return std::nullopt;
    if (*of_u == 0 || *of_v == 0 || *of_u == *of_v) return *of_u != 0 ? *of_u : *of_v;
    const auto larger = sign<E>(square(u) * a - square(v));
    if (!larger) return std::nullopt;
    return *of_u * *larger;
}

/// n/d against m > 0, or n² d·d against (m d)².
template <class E>
std::optional<int> side_of_fraction(const Fraction<E>& f, const E& d2, const E& m, Length length) {
    const E there = m * f.m;
    if (length == Length::parameter) return sign<E>(f.n - there);
    return sign<E>(square(f.n) * d2 - square(there));
}

/// Whether a root of a quadratic lies above m > 0, at it or below. With P(t) = a t² + 2 h t + c, the near root is above
/// m where P(m) > 0 and a m + h < 0, the far root where P(m) < 0 or a m + h < 0. Of a distance m the same with m/√b for
/// m, b = d·d, and times b or √b: (a m² + b c) + 2 b h m/√b, and a m + b h/√b.
template <class E>
std::optional<int> side_of_root(const QuadraticSpan<E>& s, Crossing at, const E& m, Length length) {
    const bool parameter = length == Length::parameter;
    const auto p = parameter ? sign<E>((s.a * m + s.h + s.h) * m + s.c)
                             : sign_of_sum<E>(s.a * square(m) + s.d2 * s.c, (s.h + s.h) * m * s.d2, s.d2);
    if (!p) return std::nullopt;
    if (*p < 0) return at == Crossing::near ? -1 : 1;
    // Before the middle of the roots both P(m) > 0 and the root P(m) = 0 come before the far root, past it after the
    // near one.
    const auto past = parameter ? sign<E>(s.a * m + s.h) : sign_of_sum<E>(s.a * m, s.d2 * s.h, s.d2);
    if (!past) return std::nullopt;
    if (at == Crossing::near) return *past > 0 ? -1 : *p;
    return *past < 0 ? 1 : -*p;
}

/// For a ray that hits the surface and m > 0. Where there is no range the near root is the answer from outside, the far
/// one that from inside, which no m > 0 comes before the near root of.
template <class E>
std::optional<int> side_of(const QuadraticSpan<E>& s, const E& m, Length length, const RangeOfSpan<E>* range,
                           intersect::Convention convention) {
    Crossing at = Crossing::far;
    if (range) {
        const Enclosed<E> found = enclose(s, range, convention);
        if (!found.hit.is_yes()) return std::nullopt;
        at = found.at;
    } else {
        const auto outside = sign(s.c);
        if (!outside) return std::nullopt;
        if (*outside > 0) at = Crossing::near;
    }
    if (at == Crossing::begin) return side_of_fraction<E>({begin_of(range), E(1)}, s.d2, m, length);
    return side_of_root(s, at, m, length);
}

/// Of where the line enters or leaves.
template <class E>
std::optional<int> side_at(const CappedSpan<E>& s, Crossing at, const E& m, Length length) {
    const bool near = at == Crossing::near;
    if ((near ? s.enters_by_cap() : s.leaves_by_cap()).is_yes())
        return side_of_fraction(near ? s.entry : s.exit, s.d2, m, length);
    return side_of_root(s.side, at, m, length);
}
template <class E>
std::optional<int> side_at(const JoinedSpan<E>& s, Crossing at, const E& m, Length length) {
    return side_of_root(at == Crossing::near ? s.enter : s.leave, at, m, length);
}

template <class E>
std::optional<int> side_at(const FlatSpan<E>& s, Crossing, const E& m, Length length) {
    return side_of_fraction(s.at, s.d2, m, length);
}
template <class E>
std::optional<int> side_at(const WallSpan<E>& s, Crossing at, const E& m, Length length) {
    return side_of_root(s.solid.side, at, m, length);
}

/// For a ray that hits and m > 0.
template <class E, class S>
requires(ToldSpan<S, E> || SurfaceSpan<S, E>) std::optional<int> side_of(const S& s, const E& m, Length length,
                                                                         const RangeOfSpan<E>* range,
                                                                         intersect::Convention convention) {
    const Enclosed<E> found = enclose<E>(s, range, convention);
    if (!found.hit.is_yes()) return std::nullopt;
    if (found.at == Crossing::begin) return side_of_fraction<E>({begin_of(range), E(1)}, s.d2, m, length);
    return side_at<E>(s, found.at, m, length);
}

/// For a ray that hits and m > 0: t* of where the range begins, of its first entry, or of its exit where that is the
/// answer from inside.
template <class E>
std::optional<int> side_of(const SlabSpan<E>& s, const E& m, Length length, const RangeOfSpan<E>* range,
                           intersect::Convention convention) {
    Fraction<E> first = range ? first_entry(s, *range) : first_entry(s);
    if (range) {
        const Enclosed<E> found = enclose(s, range, convention);
        if (!found.hit.is_yes()) return std::nullopt;
        if (found.at == Crossing::far) first = first_exit(s);
    } else if (convention.inside == intersect::Inside::exit && (first.n <= E(0)).is_yes()) {
        first = first_exit(s);
    }
    return side_of_fraction(first, s.d2, m, length);
}

/// x = u + v √d, and sums and products of such numbers: a distance m lies at x = b + a m/√d2, d2 times which is one.
template <class E>
struct WithRoot {
    E u, v, d;

    friend WithRoot operator*(const WithRoot& a, const WithRoot& b) {
        return {a.u * b.u + a.v * b.v * a.d, a.u * b.v + a.v * b.u, a.d};
    }
    [[nodiscard]] std::optional<int> sign() const { return sign_of_sum<E>(u, v * d, d); }
};

/// Of the root of a quartic that the ray meets: where it stands to the place of m. `simple` at a distance is told
/// by d2 to the power of its degree times it.
template <class E>
std::optional<int> side_of(const QuarticSpan<E>& s, const E& m, Length length, const RangeOfSpan<E>* range,
                           intersect::Convention convention) {
    const auto met = met_root(s, range, convention);
    if (!met.hit.is_yes()) return std::nullopt;
    if (met.at == Crossing::begin) return side_of_fraction<E>({begin_of(range), E(1)}, s.d2, m, length);
    const EnclosedRoots<E>& roots = met.roots;
    if (length == Length::parameter) return roots.order(met.root, s.place(m));
    const WithRoot<E> x{s.b * s.d2, s.a * m, s.d2};
    return roots.order(
        met.root, [&](const E& p) { return sign_of_sum<E>(p - s.b, -(s.a * m), s.d2); },
        [&] {
            WithRoot<E> y{roots.simple.leading(), E(0), s.d2};
            E power(1);
            for (int i = roots.simple.degree - 1; i >= 0; --i) {
                power = power * s.d2;
                y = y * x;
                y.u = y.u + power * roots.simple.of(i);
            }
            return y.sign();
        });
}

template <class E>
std::optional<int> side_of(const Ray<E>& ray, const Solid<E>& solid, const E& m, Length length,
                           const RangeOfSpan<E>* range = nullptr, intersect::Convention convention = {}) {
    return with_span(ray, solid, [&](const auto& span) { return side_of(span, m, length, range, convention); });
}

}  // namespace lostbits::measure::truth
