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

/// For a ray that hits the surface and m > 0. With P(t) = a t² + 2 h t + c, the near root (from outside) is above m
/// where P(m) > 0 and a m + h < 0, the far root (from inside) where P(m) < 0. Of a distance m the same with m/√b for m,
/// b = d·d, and times b or √b: (a m² + b c) + 2 b h m/√b, and a m + b h/√b.
template <class E>
std::optional<int> side_of(const QuadraticSpan<E>& s, const E& m, Length length, intersect::Inside) {
    const bool parameter = length == Length::parameter;
    const auto outside = sign(s.c);
    const auto p = parameter ? sign<E>((s.a * m + s.h + s.h) * m + s.c)
                             : sign_of_sum<E>(s.a * square(m) + s.d2 * s.c, (s.h + s.h) * m * s.d2, s.d2);
    if (!outside || !p) return std::nullopt;
    if (*outside <= 0) return -*p;
    if (*p < 0) return -1;
    // Past the middle both P(m) > 0 and the root P(m) = 0 lie beyond the near root.
    const auto past = parameter ? sign<E>(s.a * m + s.h) : sign_of_sum<E>(s.a * m, s.d2 * s.h, s.d2);
    if (!past) return std::nullopt;
    return *past > 0 ? -1 : *p;
}

/// t* = n/d against m, or n² d·d against (m d)².
template <class E>
std::optional<int> side_of_fraction(const Fraction<E>& at, const E& m, Length length, const E& d2) {
    const E there = m * at.m;
    if (length == Length::parameter) return sign<E>(at.n - there);
    return sign<E>(square(at.n) * d2 - square(there));
}

/// For a ray that hits and m > 0: t* of its first entry, or of its exit where that is the answer from inside.
template <class E>
std::optional<int> side_of(const SlabSpan<E>& s, const E& m, Length length, intersect::Inside inside) {
    Fraction<E> first = first_entry(s);
    if (inside == intersect::Inside::exit && (first.n <= E(0)).is_yes()) first = first_exit(s);
    return side_of_fraction(first, m, length, s.d2);
}

/// For a ray that crosses and m > 0: the same of the one t.
template <class E>
std::optional<int> side_of(const FlatSpan<E>& s, const E& m, Length length, intersect::Inside) {
    return side_of_fraction(s.at, m, length, s.d2);
}

template <class E>
std::optional<int> side_of(const Ray<E>& ray, const Solid<E>& solid, const E& m, Length length,
                           intersect::Inside inside = intersect::Inside::usual) {
    return with_span(ray, solid, [&](const auto& span) { return side_of(span, m, length, inside); });
}

}  // namespace lostbits::measure::truth
