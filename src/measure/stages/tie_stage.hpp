// Settles rays that pass exactly through a rim, many at once, by sums that are exact, so that a zero is proved.
#pragma once

#include <algorithm>
#include <array>
#include <tuple>
#include <type_traits>

#include "measure/stages/span_stages.hpp"
#include "number/wide/multiple.hpp"

namespace lostbits::measure::stages {

using number::wide::Grid;
using number::wide::Multiple;

/// Largest numbers of bits, of points and of directions, with which two words hold the polynomials exactly. For a shape
/// that lies flat between points, every sign is that of a polynomial of degree three. With points up to S = 2^31 U,
/// directions up to D = 2^33 V and vertices relative to o, d·(b × c) is at most 24 D S² < 2^100 V U² and (a − o)·n at
/// most 48 S³ < 2^99 U³. So the exponents of binary32 numbers may spread by 7 for points and by 9 for directions. The
/// polynomials of other shapes have degree 4 and more.
inline constexpr int bits_of_points = 31, bits_of_directions = 33;
template <class S>
inline constexpr bool is_flat_between_points = false;
template <template <class> class Of, class P>
inline constexpr bool is_flat_between_points<Of<Multiple<P>>> =
    std::is_same_v<decltype(std::declval<Of<Multiple<P>>>().span(Ray<Multiple<P>>())),
                   FlatSpan<Multiple<P>>>&& std::ranges::all_of(Of<Multiple<P>>::keys, [](const Key& key) {
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
/// exactly. If that were known only to within a bound, it might lie in either binade around the power of two.
template <class P>
struct Exactly {
    using Known = Running<TwoWords<P>>;

    Known length;
    mask_t<P> is_exact;

    /// The quotient t = n/m of multiples: exactly 2^k if n is 2^k m, word by word. m.lo is a multiple of 2^-1000, or 0,
    /// so its product with a power of two of at least 2^-60 is exact.
    Exactly(const Known& t, const Known& n, const Known& m) {
        const P power = binade(t.first()), hi = power * m.first(), lo = power * m.second();
        is_exact = t.first() <= power && power >= P(0x1p-60) && same(hi, n.first()) && same(lo, n.second());
        length = select(is_exact, Known(TwoWords<P>(power)), t);
    }
    /// 2^k √x, exact if the root is a double.
    [[nodiscard]] Exactly times_root(const Known& x) const {
        const Known root = sqrt(x);
        const TwoWords<P> squared = product_of(root.first(), root.first());
        const auto exact = is_exact && same(squared.hi, x.first()) && same(squared.lo, x.second());
        return {select(exact, Known(TwoWords<P>(length.first() * root.first())), length * root), exact};
    }

private:
    Exactly(const Known& x, const mask_t<P>& exact) : length(x), is_exact(exact) {}
    static mask_t<P> same(const P& x, const P& y) { return x <= y && x >= y; }
};

/// The answer of `truth::enclose` for a surface with the usual convention. A surface or ray that is not valid meets
/// nothing: a direction of zero crosses no plane, and no line crosses the plane of points on one line. For numbers that
/// are not finite, the result is a miss, or nothing is settled.
template <template <class> class Of, class P, std::size_t count>
TieFinding<P> settle_tie(const std::array<P, 6>& ray, const std::array<P, count>& points,
                         const RequestedResults& asked) {
    using E = Multiple<P>;
    using Known = Running<TwoWords<P>>;
    const Grid<P> grid =
        std::apply([&](const auto&... p) { return Grid<P>::of(bits_of_points, ray[0], ray[1], ray[2], p...); }, points);
    const Grid<P> of_direction = Grid<P>::of(bits_of_directions, ray[3], ray[4], ray[5]);
    const auto at = [&](std::size_t k) { return E(ray[k], k < 3 ? grid : of_direction); };
    const FlatSpan<E> span = primitive_from<Of, E>([&](std::size_t k) {
                                 return E(points[k], grid);
                             }).span({{at(0), at(1), at(2)}, {at(3), at(4), at(5)}});
    const E zero(0);
    auto hit = span.closed.yes() && (span.at.n >= zero).yes();
    const auto missed = span.closed.no() || (span.at.n < zero).yes(), at_origin = (span.at.n <= zero).yes();
    const Enclosure<P> nothing{{P(0), P(0)}, P(0)};
    TieFinding<P> tie{{missed, hit, nothing, nothing}, hit && span.open.no(), hit && at_origin};
    if (!any_of(hit)) return tie;
    const Known n = span.at.n.running(), m = select(hit, span.at.m.running(), Known(1));
    const Exactly<P> t(n / m, n, m);
    if (asked.t) tie.found.t = kept_length(t.length, at_origin, at_origin || t.is_exact, hit);
    if (asked.distance) {
        const Exactly<P> distance = t.times_root(span.d2.running());
        tie.found.distance = kept_length(distance.length, at_origin, at_origin || distance.is_exact, hit);
    }
    tie.found.settled = hit || missed;
    tie.found.hit = hit;
    return tie;
}

}  // namespace lostbits::measure::stages
