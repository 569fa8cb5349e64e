// Settles rays that pass exactly through a rim, many at once. The sums are exact, so a zero is proved.
#pragma once

#include <algorithm>
#include <array>
#include <tuple>
#include <type_traits>

#include "measure/stages/span_stages.hpp"
#include "number/wide/multiple.hpp"

namespace lostbits::measure::stages {

using number::wide::Multiple;
using number::wide::UnitAndSize;

/// Largest numbers of bits of points and of directions for which two words hold the polynomials exactly. For a shape
/// that lies flat between points, every sign is that of a polynomial of degree three. With points up to S = 2^31 U,
/// directions up to D = 2^33 V and vertices relative to o, d·(b × c) is at most 24 D S² < 2^100 V U² and (a − o)·n at
/// most 48 S³ < 2^99 U³. So the exponents of binary32 numbers may spread by 7 for points and by 9 for directions. The
/// polynomials of other shapes have degree 4 and more.
inline constexpr int bits_of_points = 31, bits_of_directions = 33;
template <class S>
inline constexpr bool is_flat_between_points = false;
template <template <class> class ShapeOver, class P>
inline constexpr bool is_flat_between_points<ShapeOver<Multiple<P>>> =
    std::is_same_v<decltype(std::declval<ShapeOver<Multiple<P>>>().span(Ray<Multiple<P>>())),
                   FlatSpan<Multiple<P>>>&& std::ranges::all_of(ShapeOver<Multiple<P>>::keys, [](const Key& key) {
        return key.kind == Key::Kind::point;
    });

/// Findings of the stage for a ray. `touches` and `on_surface` are as in `Truth`: the ray touches, or begins on the
/// surface.
template <class P>
struct TieFinding {
    Finding<P> found;
    mask_t<P> touches, on_surface;
};

/// A length, and a mask of the lanes in which it is exact. A ray aimed at a point p by d = p − o meets it at t = 1
/// exactly. If this t were known only to within a bound, it might lie in the binade on either side of the power of two.
template <class P>
struct ExactLength {
    using BoundedWords = RunningError<TwoWords<P>>;

    BoundedWords length;
    mask_t<P> is_exact;

    /// The quotient t = n/m of multiples, which is exactly 2^k if n is 2^k m, word by word. m.lo is a multiple of
    /// 2^-1000, or 0, so its product with a power of two of at least 2^-60 is exact.
    ExactLength(const BoundedWords& t, const BoundedWords& n, const BoundedWords& m) {
        const P power = binade(t.first()), hi = power * m.first(), lo = power * m.second();
        is_exact = t.first() <= power && power >= P(0x1p-60) && are_equal(hi, n.first()) && are_equal(lo, n.second());
        length = select(is_exact, BoundedWords(TwoWords<P>(power)), t);
    }
    /// The length times √x, which is exact if the length is exact and √x is a double.
    [[nodiscard]] ExactLength times_root(const BoundedWords& x) const {
        const BoundedWords root = sqrt(x);
        const TwoWords<P> squared = product_of(root.first(), root.first());
        const auto exact = is_exact && are_equal(squared.hi, x.first()) && are_equal(squared.lo, x.second());
        return {select(exact, BoundedWords(TwoWords<P>(length.first() * root.first())), length * root), exact};
    }

private:
    ExactLength(const BoundedWords& x, const mask_t<P>& exact) : length(x), is_exact(exact) {}
    static mask_t<P> are_equal(const P& x, const P& y) { return x <= y && x >= y; }
};

/// Answer of `truth::enclose` for a surface with the usual convention. A surface or ray that is not valid is a
/// miss: a direction of zero crosses no plane, and no line crosses the plane of points that lie on one line. For
/// numbers that are not finite, the result is a miss, or nothing is settled.
template <template <class> class ShapeOver, class P, std::size_t count>
TieFinding<P> settle_tie(const std::array<P, 6>& ray, const std::array<P, count>& points,
                         const RequestedResults& requested) {
    using E = Multiple<P>;
    using BoundedWords = RunningError<TwoWords<P>>;

    // Exact multiples of two units, one of points and one of directions
    const UnitAndSize<P> point_grid = std::apply(
        [&](const auto&... p) { return UnitAndSize<P>::of(bits_of_points, ray[0], ray[1], ray[2], p...); }, points);
    const UnitAndSize<P> direction_grid = UnitAndSize<P>::of(bits_of_directions, ray[3], ray[4], ray[5]);
    const auto ray_number = [&](std::size_t k) { return E(ray[k], k < 3 ? point_grid : direction_grid); };
    const FlatSpan<E> span =
        primitive_from<ShapeOver, E>([&](std::size_t k) {
            return E(points[k], point_grid);
        }).span({{ray_number(0), ray_number(1), ray_number(2)}, {ray_number(3), ray_number(4), ray_number(5)}});

    const E zero(0);
    auto hit = span.closed.yes() && (span.at.n >= zero).yes();
    const auto missed = span.closed.no() || (span.at.n < zero).yes(), at_origin = (span.at.n <= zero).yes();
    const Enclosure<P> no_length{{P(0), P(0)}, P(0)};
    TieFinding<P> tie{{missed, hit, no_length, no_length}, hit && span.open.no(), hit && at_origin};
    if (!any_of(hit)) return tie;

    // Lengths of the hits; lanes that miss divide by 1.
    const BoundedWords n = span.at.n.running_error(), m = select(hit, span.at.m.running_error(), BoundedWords(1));
    const ExactLength<P> t(n / m, n, m);
    if (requested.t) tie.found.t = accept_length(t.length, at_origin, at_origin || t.is_exact, hit);
    if (requested.distance) {
        const ExactLength<P> distance = t.times_root(span.d2.running_error());
        tie.found.distance = accept_length(distance.length, at_origin, at_origin || distance.is_exact, hit);
    }

    // `accept_length` drops the hits whose lengths are not known closely enough.
    tie.found.settled = hit || missed;
    tie.found.hit = hit;
    return tie;
}

}  // namespace lostbits::measure::stages
