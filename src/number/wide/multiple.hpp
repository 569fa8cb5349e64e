// Multiple: integer multiples of a unit, held in two words, whose sums and products are exact, so that zeros are
// proved.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>

#include "number/tri.hpp"
#include "number/wide/running.hpp"

namespace lostbits::number::wide {

/// ±2^⌊log2|x|⌋ for a normal number x; 0 for other finite numbers.
inline double binade(double x) {
    return __builtin_bit_cast(double, __builtin_bit_cast(std::uint64_t, x) & std::uint64_t{0xfff} << 52);
}

/// Largest magnitude of some numbers, and a power of two of which all are integer multiples.
template <class P>
struct Grid {
    P unit, size;

    /// Fits numbers whose bits span at most `bits` (1 to 50), from the highest bit of the largest to the lowest bit of
    /// any. If they span more, if one is not finite, or if all are 0, the size is infinite or there is no unit.
    template <class... Ps>
    static Grid of(int bits, const Ps&... numbers) {
        using lostbits::abs, lostbits::max, lostbits::select;
        P size(0);
        ((size = max(size, abs(numbers))), ...);
        const P unit = binade(size) * power_of_two<P>(1 - bits), rounder = unit * P(0x1.8p+52);
        // x + 1.5·2^52 U lies between 2^52 U and 2^53 U, so what the sum rounds to is a multiple of U.
        P left(0);
        ((left += abs(((numbers + rounder) - rounder) - numbers)), ...);
        return {unit, select(left <= P(0), size, P(HUGE_VAL))};
    }
};

/// A whole multiple x of a unit U, a power of two, with |x| ≤ S. Both are products and sums of those of the inputs, and
/// S/U never becomes less, nor is U of a product below 2^-1000: else S is infinite. Where S < 2^100 U (with what sums
/// of S round to) x is the two words, and so is all that it was made from:
///
///     a + b of one word   is one word, where S < 2^53 U as it rounds; else S is infinite
///     a b of one word     is a product and what it rounds off, two words
///     a + b               of the second words each is at most 2^-53 S, as is what the sum of the first leaves: with
///                         that they are three multiples of U whose sum is at most 2^50 U, a double. It is less than
///                         the sum of the first, or both are at most 2^51 U: either way two words are left
///     a b                 a.lo b.lo is at most 2^-106 S < U, and so is 0; a.hi b.lo, a.lo b.hi and what a.hi b.hi
///                         rounds off are at most 2^-53 S each: their sum is a double
///     a b + c d + f g     what the three products leave, at most 3·2^-53 S, and what both sums of their first words do
///                         are such doubles, and so is the sum of all
///
/// A comparison of such numbers is decided, equality too; of others none is. Quotients and roots are no multiples.
template <class P>
class Multiple {
public:
    using Lanes = mask_t<P>;

    Multiple() = default;
    explicit Multiple(std::same_as<int> auto x) : w_(x), unit_(x == 0 ? 0x1p+100 : 1), size_(x < 0 ? -x : x) {}
    /// A number on the grid.
    Multiple(const P& x, const Grid<P>& grid) : w_(x), unit_(grid.unit), size_(grid.size) {}

    /// The number, if it is known; otherwise its bound is infinity.
    [[nodiscard]] Running<TwoWords<P>> running() const {
        using lostbits::select;
        return {w_, select(is_held(), P(0), P(HUGE_VAL))};
    }

    friend Multiple operator+(const Multiple& a, const Multiple& b) {
        using lostbits::min, lostbits::select;
        const P unit = min(a.unit_, b.unit_), size = a.size_ + b.size_;
        if (is_known_zero(a.w_.lo) && is_known_zero(b.w_.lo))
            return {W(a.w_.hi + b.w_.hi), unit, select(size < P(0x1p53) * unit, size, P(HUGE_VAL))};
        const W s = sum_of(a.w_.hi, b.w_.hi);
        return {ordered_sum<P>(s.hi, s.lo + (a.w_.lo + b.w_.lo)), unit, size};
    }
    friend Multiple operator-(const Multiple& a, const Multiple& b) { return a + -b; }
    friend Multiple operator-(const Multiple& a) { return {Words<W>::negative(a.w_), a.unit_, a.size_}; }
    friend Multiple operator*(const Multiple& a, const Multiple& b) {
        return {Words<W>::product(a.w_, b.w_), a.unit_ * b.unit_, size_of_product(a, b)};
    }
    friend Multiple sum_of_products(const Multiple& a, const Multiple& b, const Multiple& c, const Multiple& d,
                                    const Multiple& f, const Multiple& g) {
        using lostbits::min;
        const W x = parts_of_product(a.w_, b.w_), y = parts_of_product(c.w_, d.w_), z = parts_of_product(f.w_, g.w_);
        const W s = sum_of(x.hi, y.hi), w = sum_of(s.hi, z.hi);
        return {ordered_sum<P>(w.hi, (s.lo + w.lo) + ((x.lo + y.lo) + z.lo)),
                min(min(a.unit_ * b.unit_, c.unit_ * d.unit_), f.unit_ * g.unit_),
                (size_of_product(a, b) + size_of_product(c, d)) + size_of_product(f, g)};
    }
    friend Multiple operator/(const Multiple& a, const Multiple& b) { return no_multiple(a.w_ / b.w_); }
    friend Multiple sqrt(const Multiple& a) { return no_multiple(sqrt(a.w_)); }
    Multiple& operator+=(const Multiple& b) { return *this = *this + b; }
    Multiple& operator-=(const Multiple& b) { return *this = *this - b; }
    Multiple& operator*=(const Multiple& b) { return *this = *this * b; }

    friend Tris<Lanes> operator<(const Multiple& a, const Multiple& b) {
        const Lanes held = a.is_held() && b.is_held();
        if (is_known_zero(b.w_.hi)) return {held && a.w_.hi < P(0), held && a.w_.hi >= P(0)};
        if (is_known_zero(a.w_.hi)) return {held && b.w_.hi > P(0), held && b.w_.hi <= P(0)};
        return {held && a.w_ < b.w_, held && a.w_ >= b.w_};
    }
    friend Tris<Lanes> operator<=(const Multiple& a, const Multiple& b) { return !(b < a); }
    friend Tris<Lanes> operator>(const Multiple& a, const Multiple& b) { return b < a; }
    friend Tris<Lanes> operator>=(const Multiple& a, const Multiple& b) { return !(a < b); }

    friend Multiple fma(const Multiple& a, const Multiple& b, const Multiple& c) { return a * b + c; }
    /// Represents exact numbers, which have no neighbours.
    friend Multiple next_up(const Multiple& a) { return a; }
    friend Multiple next_down(const Multiple& a) { return a; }
    friend Multiple abs(const Multiple& a) { return {abs(a.w_), a.unit_, a.size_}; }
    friend Multiple copysign(const Multiple& a, const Multiple& b) {
        const Multiple x = abs(a);
        return select(b < Multiple(0), -x, x);
    }
    friend Multiple select(const Tris<Lanes>& mask, const Multiple& a, const Multiple& b) {
        using lostbits::max, lostbits::min, lostbits::select;
        const P size = select(mask.yes() || mask.no(), max(a.size_, b.size_), P(HUGE_VAL));
        return {select(mask.yes(), a.w_, b.w_), min(a.unit_, b.unit_), size};
    }

private:
    using W = TwoWords<P>;

    Multiple(const W& w, const P& unit, const P& size) : w_(w), unit_(unit), size_(size) {}
    static Multiple no_multiple(const W& w) { return {w, P(1), P(HUGE_VAL)}; }

    static P size_of_product(const Multiple& a, const Multiple& b) {
        using lostbits::select;
        return select(a.unit_ * b.unit_ >= P(0x1p-1000), a.size_ * b.size_, P(HUGE_VAL));
    }
    /// Product of the first words, and everything that it leaves.
    static W parts_of_product(const W& a, const W& b) {
        const W p = product_of(a.hi, b.hi);
        if (is_known_zero(a.lo) && is_known_zero(b.lo)) return p;
        if (is_known_zero(a.lo)) return {p.hi, fma(a.hi, b.lo, p.lo)};
        if (is_known_zero(b.lo)) return {p.hi, fma(a.lo, b.hi, p.lo)};
        return {p.hi, p.lo + fma(a.hi, b.lo, a.lo * b.hi)};
    }

    [[nodiscard]] Lanes is_held() const { return size_ < P(0x1p100) * unit_; }

    W w_;
    P unit_, size_;
};

static_assert(Number<Multiple<double>>);

}  // namespace lostbits::number::wide
