// Multiple: an integer multiple of a unit, held in two words. Sums and products of multiples are exact, so a zero is
// proved.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>

#include "number/tri.hpp"
#include "number/wide/running_error.hpp"

namespace lostbits::number::wide {

/// ±2^⌊log2|x|⌋ for a normal number x; 0 for other finite numbers.
inline double binade(double x) {
    return __builtin_bit_cast(double, __builtin_bit_cast(std::uint64_t, x) & std::uint64_t{0xfff} << 52);
}

/// The unit and the size of a set of numbers: a power of two that divides them all, and their largest magnitude.
template <class P>
struct UnitAndSize {
    P unit, size;

    /// Fits a grid to numbers whose bits span at most `bits` (1 to 50), from the highest bit of the largest number to
    /// the lowest bit of any. If the numbers span more bits, or if one is not finite, the size is infinite. If all are
    /// 0, there is no unit.
    template <class... Ps>
    static UnitAndSize of(int bits, const Ps&... numbers) {
        using lostbits::abs, lostbits::max, lostbits::select;
        P size(0);
        ((size = max(size, abs(numbers))), ...);
        const P unit = binade(size) * power_of_two<P>(1 - bits), rounder = unit * P(0x1.8p+52);
        // x + 1.5·2^52 U lies between 2^52 U and 2^53 U, so the rounded sum is a multiple of U.
        P remainder_sum(0);
        ((remainder_sum += abs(((numbers + rounder) - rounder) - numbers)), ...);
        return {unit, select(remainder_sum <= P(0), size, P(HUGE_VAL))};
    }
};

/// An integer multiple x of a unit U, a power of two, with |x| ≤ S. The S of a result is the sum or product of those of
/// its operands, and its U the minimum or product of theirs, so S/U never decreases. S is infinite if a product would
/// have U below 2^-1000. If S < 2^100 U, with S as rounded sums give it, the two words are x exactly, and the same
/// holds for all numbers that x was computed from:
///
///     a + b of one word   is one word if S, as rounded, is below 2^53 U; otherwise S is infinite
///     a b of one word     is two words: the rounded product and its rounding error
///     a + b               both second words and the rounding error of the sum of the first words are at most 2^-53 S
///                         each. They are three multiples of U whose sum is at most 2^50 U, so a double holds it. This
///                         sum is less than that of the first words, or both are at most 2^51 U. In either case two
///                         words hold the result
///     a b                 a.lo b.lo is at most 2^-106 S < U, so it is 0. a.hi b.lo, a.lo b.hi and the rounding error
///                         of a.hi b.hi are at most 2^-53 S each, so a double holds their sum
///     a b + c d + f g     the rounding errors of the three products, at most 3·2^-53 S, and those of both sums of
///                         their first words are such doubles, and so is the sum of all of them
///
/// A comparison of two numbers with S < 2^100 U is decided, equality included. A comparison with any other number is
/// not decided. Quotients and roots are not multiples.
template <class P>
class Multiple {
public:
    using Lanes = mask_t<P>;

    Multiple() = default;
    explicit Multiple(std::same_as<int> auto x) : w_(x), unit_(x == 0 ? 0x1p+100 : 1), size_(x < 0 ? -x : x) {}
    /// A number on the grid.
    Multiple(const P& x, const UnitAndSize<P>& grid) : w_(x), unit_(grid.unit), size_(grid.size) {}

    /// The number, with bound 0 if it is known and infinity otherwise.
    [[nodiscard]] RunningError<TwoWords<P>> running_error() const {
        using lostbits::select;
        return {w_, select(is_known(), P(0), P(HUGE_VAL))};
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
    friend Multiple operator-(const Multiple& a) { return {WordProperties<W>::negative(a.w_), a.unit_, a.size_}; }
    friend Multiple operator*(const Multiple& a, const Multiple& b) {
        return {WordProperties<W>::product(a.w_, b.w_), a.unit_ * b.unit_, size_of_product(a, b)};
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
    friend Multiple operator/(const Multiple& a, const Multiple& b) { return not_a_multiple(a.w_ / b.w_); }
    friend Multiple sqrt(const Multiple& a) { return not_a_multiple(sqrt(a.w_)); }
    Multiple& operator+=(const Multiple& b) { return *this = *this + b; }
    Multiple& operator-=(const Multiple& b) { return *this = *this - b; }
    Multiple& operator*=(const Multiple& b) { return *this = *this * b; }

    friend TriMask<Lanes> operator<(const Multiple& a, const Multiple& b) {
        const Lanes are_known = a.is_known() && b.is_known();
        if (is_known_zero(b.w_.hi)) return {are_known && a.w_.hi < P(0), are_known && a.w_.hi >= P(0)};
        if (is_known_zero(a.w_.hi)) return {are_known && b.w_.hi > P(0), are_known && b.w_.hi <= P(0)};
        return {are_known && a.w_ < b.w_, are_known && a.w_ >= b.w_};
    }
    friend TriMask<Lanes> operator<=(const Multiple& a, const Multiple& b) { return !(b < a); }
    friend TriMask<Lanes> operator>(const Multiple& a, const Multiple& b) { return b < a; }
    friend TriMask<Lanes> operator>=(const Multiple& a, const Multiple& b) { return !(a < b); }

    friend Multiple fma(const Multiple& a, const Multiple& b, const Multiple& c) { return a * b + c; }
    /// Returns a: the type represents exact numbers, which have no neighbours.
    friend Multiple next_up(const Multiple& a) { return a; }
    friend Multiple next_down(const Multiple& a) { return a; }
    friend Multiple abs(const Multiple& a) { return {abs(a.w_), a.unit_, a.size_}; }
    friend Multiple copysign(const Multiple& a, const Multiple& b) {
        const Multiple x = abs(a);
        return select(b < Multiple(0), -x, x);
    }
    friend Multiple select(const TriMask<Lanes>& mask, const Multiple& a, const Multiple& b) {
        using lostbits::max, lostbits::min, lostbits::select;
        const P size = select(mask.yes() || mask.no(), max(a.size_, b.size_), P(HUGE_VAL));
        return {select(mask.yes(), a.w_, b.w_), min(a.unit_, b.unit_), size};
    }

private:
    using W = TwoWords<P>;

    Multiple(const W& w, const P& unit, const P& size) : w_(w), unit_(unit), size_(size) {}
    static Multiple not_a_multiple(const W& w) { return {w, P(1), P(HUGE_VAL)}; }

    static P size_of_product(const Multiple& a, const Multiple& b) {
        using lostbits::select;
        return select(a.unit_ * b.unit_ >= P(0x1p-1000), a.size_ * b.size_, P(HUGE_VAL));
    }
    /// Product of the first words, and the sum of all other products and rounding errors.
    static W parts_of_product(const W& a, const W& b) {
        const W p = product_of(a.hi, b.hi);
        if (is_known_zero(a.lo) && is_known_zero(b.lo)) return p;
        if (is_known_zero(a.lo)) return {p.hi, fma(a.hi, b.lo, p.lo)};
        if (is_known_zero(b.lo)) return {p.hi, fma(a.lo, b.hi, p.lo)};
        return {p.hi, p.lo + fma(a.hi, b.lo, a.lo * b.hi)};
    }

    [[nodiscard]] Lanes is_known() const { return size_ < P(0x1p100) * unit_; }

    W w_;
    P unit_, size_;
};

static_assert(Number<Multiple<double>>);

}  // namespace lostbits::number::wide
