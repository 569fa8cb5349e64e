// RunningError: a number of one or two words with a bound on its error (a running error analysis), for many rays at
// once.
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "number/tri.hpp"
#include "number/wide/two_words.hpp"

namespace lostbits::number::wide {

/// True if the compiler knows that x is 0 in every lane. The bounds and second words of inputs are known to be 0, and
/// results that depend only on them need not be computed. For finite numbers the bits are the same either way, except
/// for the signs of zeros. A result that is not finite carries no information.
template <std::floating_point F>
[[gnu::always_inline]] inline bool is_known_zero(const F& x) {
    return __builtin_constant_p(x) & (x >= 0) & (x <= 0);
}
/// The test has no branch, because a branch would stay in the code of a whole shape until the compiler knows its
/// condition.
template <class P>
requires requires(const P& x) { x.words(); }
[[gnu::always_inline]] inline bool is_known_zero(const P& x) {
    const auto words = x.words();
    const auto joined_bits = [&]<std::size_t... i>(std::index_sequence<i...>) { return (words[i] | ...); }
    (std::make_index_sequence<P::lanes>());
    return __builtin_constant_p(joined_bits) & (static_cast<std::uint64_t>(joined_bits) << 1 == 0);
}

/// True if no lane of the mask is set, so that a step of a formula can end here. (While a program is recorded it
/// returns false; the program itself skips the rest.)
template <class M>
bool is_unset(const M& mask) {
    return !any_of(mask);
}

/// Properties of the words that `RunningError` needs. W is P, double or a pack of doubles, or `TwoWords<P>`.
template <class W>
struct WordProperties {
    using Word = W;
    static constexpr double error = 0x1p-53;
    static const W& first(const W& w) { return w; }
    static W second(const W&) { return W(0); }
    static W negative(const W& a) { return -a; }
    static W sum(const W& a, const W& b) { return a + b; }
    static W product(const W& a, const W& b) { return a * b; }
};
/// A sum of numbers of one word is normalised after one step: if the first words cancel, the remainder is a multiple of
/// half an ulp of the larger one, and no second word exceeds that.
template <class P>
struct WordProperties<TwoWords<P>> {
    using Word = P;
    using W = TwoWords<P>;
    static constexpr double error = word_error;
    static const P& first(const W& w) { return w.hi; }
    static const P& second(const W& w) { return w.lo; }
    static W negative(const W& a) { return {-a.hi, is_single_word(a) ? a.lo : -a.lo}; }
    static W sum(const W& a, const W& b) {
        if (!is_single_word(a) && !is_single_word(b)) return a + b;
        const W s = sum_of(a.hi, b.hi);
        if (is_single_word(a) && is_single_word(b)) return s;
        return ordered_sum<P>(s.hi, s.lo + (is_single_word(a) ? b.lo : a.lo));
    }
    static W product(const W& a, const W& b) {
        if (is_single_word(a) && is_single_word(b)) return product_of(a.hi, b.hi);
        return is_single_word(b) ? a * b.hi : is_single_word(a) ? b * a.hi : a * b;
    }

private:
    static bool is_single_word(const W& w) { return is_known_zero(w.lo); }
};

/// All real x with |x − w| ≤ e (1 + 2^-41). If e is infinite or NaN, nothing is known about x, and no comparison with
/// it is decided. For two words, w has the bits of `Ball`'s midpoint.
///
/// Let u = 2^-53, η = 2^-1075, w the words of a result, and |w| the magnitude of the first word. Let ε = u for one word
/// and 2^-102 for two; the error of an operation on two words is less than two thirds of 2^-102 (the bounds are listed
/// at `Ball`). For x enclosed by a and y enclosed by b:
///
///     w = a ± b    |x ± y − w| ≤ e_a + e_b + ε|w|
///     w = a b      |x y − w|   ≤ |a| e_b + (|b| + e_b) e_a + ε|w| + 4η
///     w = a²       |x² − w|    ≤ (2|a| + e_a) e_a + ε|w| + 4η
///     w = a/b      |x/y − w|   ≤ (e_a + |a/b| e_b + 3η)/(|b| − e_b) + ε|w| + η, |a/b| ≤ |w|(1 + 2u) + η
///     w = √a       |√x − w|    ≤ (e_a + η)/√a + ε|w|
///
/// For sums of products p_i the bounds of all steps are added up before they are multiplied by ε:
///
///     w = p₁ − p₂          ε (|p₁| + |p₂| + |w|)
///     w = (p₁ + p₂) + p₃   ε (|p₁| + |p₂| + |s| + |p₃| + |w|), s what p₁ + p₂ rounds to
///     w = (p₁ + p₂) + p₃   3ε w of squares, where p₁ + p₂ ≤ s (1 + ε) and s + p₃ ≤ w (1 + ε)
///
/// Nothing is known about a quotient if |b| ≤ e_b, nor about a root if a ≤ e_a. A sum does not underflow: an operand
/// too small for ε|w| to be normal is added exactly, or the sum rounds by no more than ε|w|. Each of the four products
/// inside a product of two words can lose an η. The remainder of a quotient loses three η before it is divided.
///
/// Each product in these bounds can lose an η too. `underflow_loss`, which is added once in an operation that
/// multiplies, is 2^75 η. Each step of these bounds loses a factor of at most 1 + 2u, including the second words that
/// |a| and |b| leave out. The only subtraction is |b| − e_b, with e_b rounded up. Up to `longest_chain` steps, one
/// after the other, lose less than the 2^-41 above: (1 + 2u)^n < exp(2nu) < 1 + 2nu + (2nu)² for 2nu < 1. A test counts
/// the steps of every shape's span, its matrix and its roots.
///
/// If a word overflows, the first word is infinite or NaN, and so is ε|w|. One kind of sum is an exception: if two
/// numbers of one word each have a sum just within the range, a difference inside 2Sum can overflow, and the result is
/// {finite, NaN}. No comparison with it is decided, because `ends` adds the second words, and every result computed
/// from it has a first word that is NaN.
template <class W>
class RunningError {
public:
    using P = typename WordProperties<W>::Word;
    using Lanes = mask_t<P>;
    static constexpr int longest_chain = 2047;
    static_assert(longest_chain * 0x1p-52 + (longest_chain * 0x1p-52) * (longest_chain * 0x1p-52) < 0x1p-41);

    RunningError() = default;
    explicit RunningError(std::same_as<int> auto x) : w_(x), e_(0) {}
    explicit RunningError(const W& w) : w_(w), e_(0) {}
    RunningError(const W& w, const P& e) : w_(w), e_(e) {}

    [[nodiscard]] const W& words() const { return w_; }
    [[nodiscard]] const P& first() const { return WordProperties<W>::first(w_); }
    [[nodiscard]] P second() const { return WordProperties<W>::second(w_); }
    [[nodiscard]] const P& bound() const { return e_; }
    /// Upper bound on the distance of x from the words.
    [[nodiscard]] P radius() const { return e_ * P(1 + 0x1p-40); }

    friend RunningError operator+(const RunningError& a, const RunningError& b) {
        return with_rounding_error(Traits::sum(a.w_, b.w_), plus(a.e_, b.e_));
    }
    friend RunningError operator-(const RunningError& a, const RunningError& b) { return a + -b; }
    friend RunningError operator-(const RunningError& a) { return {Traits::negative(a.w_), a.e_}; }
    friend RunningError operator*(const RunningError& a, const RunningError& b) {
        return with_rounding_error(Traits::product(a.w_, b.w_), plus(propagated_error_of(a, b), P(underflow_loss)));
    }
    friend RunningError square(const RunningError& a) {
        return with_rounding_error(Traits::product(a.w_, a.w_), plus(propagated_error_of(a), P(underflow_loss)));
    }
    friend RunningError difference_of_products(const RunningError& a, const RunningError& b, const RunningError& c,
                                               const RunningError& d) {
        const W x = Traits::product(a.w_, b.w_), y = Traits::negative(Traits::product(c.w_, d.w_));
        const W w = Traits::sum(x, y);
        const P magnitude_sum = magnitude_of(x) + magnitude_of(y) + magnitude_of(w);
        return {w, plus(plus(propagated_error_of(a, b), propagated_error_of(c, d)),
                        P(error) * magnitude_sum + P(underflow_loss))};
    }
    friend RunningError sum_of_products(const RunningError& a, const RunningError& b, const RunningError& c,
                                        const RunningError& d, const RunningError& f, const RunningError& g) {
        const W x = Traits::product(a.w_, b.w_), y = Traits::product(c.w_, d.w_), z = Traits::product(f.w_, g.w_);
        const W s = Traits::sum(x, y), w = Traits::sum(s, z);
        const P magnitude_sum =
            (magnitude_of(x) + magnitude_of(y)) + (magnitude_of(s) + magnitude_of(z)) + magnitude_of(w);
        return {w, plus(plus(plus(propagated_error_of(a, b), propagated_error_of(c, d)), propagated_error_of(f, g)),
                        P(error) * magnitude_sum + P(underflow_loss))};
    }
    friend RunningError sum_of_squares(const RunningError& a, const RunningError& b, const RunningError& c) {
        const W x = Traits::product(a.w_, a.w_), y = Traits::product(b.w_, b.w_), z = Traits::product(c.w_, c.w_);
        const W w = Traits::sum(Traits::sum(x, y), z);
        return {w, plus(plus(plus(propagated_error_of(a), propagated_error_of(b)), propagated_error_of(c)),
                        P(3 * error) * magnitude_of(w) + P(underflow_loss))};
    }
    friend RunningError operator/(const RunningError& a, const RunningError& b) {
        const RunningError q = with_rounding_error(a.w_ / b.w_, P(underflow_loss));
        const P min_divisor = b.magnitude() * P(1 - 0x1p-50) - b.radius();
        const P propagated_error =
            (a.e_ + (q.magnitude() + P(underflow_loss)) * b.e_ + P(underflow_loss)) / min_divisor;
        return {q.w_, select(min_divisor > P(0), q.e_ + propagated_error, P(HUGE_VAL))};
    }
    RunningError& operator+=(const RunningError& b) { return *this = *this + b; }
    RunningError& operator-=(const RunningError& b) { return *this = *this - b; }
    RunningError& operator*=(const RunningError& b) { return *this = *this * b; }

    friend TriMask<Lanes> operator<(const RunningError& a, const RunningError& b) {
        const DifferenceRange d = enclose_difference(a, b);
        return {d.high < P(0), d.low >= P(0)};
    }
    friend TriMask<Lanes> operator<=(const RunningError& a, const RunningError& b) {
        const DifferenceRange d = enclose_difference(a, b);
        return {d.high <= P(0), d.low > P(0)};
    }
    friend TriMask<Lanes> operator>(const RunningError& a, const RunningError& b) { return !(a <= b); }
    friend TriMask<Lanes> operator>=(const RunningError& a, const RunningError& b) { return !(a < b); }

    friend RunningError sqrt(const RunningError& a) {
        using lostbits::sqrt;
        const RunningError root = with_rounding_error(sqrt(a.w_), P(0));
        const P propagated_error = (a.e_ + P(underflow_loss)) / root.first();
        const auto is_positive = a.first() * P(1 - 0x1p-50) > a.radius();
        return {root.w_, select(is_positive, root.e_ + propagated_error, P(HUGE_VAL))};
    }
    friend RunningError fma(const RunningError& a, const RunningError& b, const RunningError& c) { return a * b + c; }
    /// Returns a: the type represents exact numbers, which have no neighbours.
    friend RunningError next_up(const RunningError& a) { return a; }
    friend RunningError next_down(const RunningError& a) { return a; }
    friend RunningError abs(const RunningError& a) {
        using lostbits::abs;
        return {abs(a.w_), a.e_};
    }
    friend RunningError copysign(const RunningError& a, const RunningError& b) {
        const RunningError x = abs(a), zero(0);
        return select(TriMask<Lanes>((b < zero).yes(), (b > zero).yes()), -x, x);  // the sign of a zero is not known
    }
    friend RunningError select(const Lanes& mask, const RunningError& a, const RunningError& b) {
        using lostbits::select;
        return {select(mask, a.w_, b.w_), select(mask, a.e_, b.e_)};
    }
    /// The result is unknown if the mask is undecided.
    friend RunningError select(const TriMask<Lanes>& mask, const RunningError& a, const RunningError& b) {
        using lostbits::select;
        const RunningError x = select(mask.yes(), a, b);
        return {x.w_, select(mask.yes() || mask.no(), x.e_, P(HUGE_VAL))};
    }

private:
    using Traits = WordProperties<W>;
    static constexpr double underflow_loss = 0x1p-1000, error = WordProperties<W>::error;

    static P magnitude_of(const W& w) {
        using lostbits::abs;
        return abs(WordProperties<W>::first(w));
    }
    [[nodiscard]] P magnitude() const { return magnitude_of(w_); }
    static RunningError with_rounding_error(const W& w, const P& propagated_error) {
        return {w, plus(propagated_error, P(error) * magnitude_of(w))};
    }

    /// Contribution of the bounds of a and b to the bound of a b, or of the bound of a to that of a².
    static P propagated_error_of(const RunningError& a, const RunningError& b) {
        return plus(times(a.magnitude(), b.e_), times(plus(b.magnitude(), b.e_), a.e_));
    }
    static P propagated_error_of(const RunningError& a) { return times(a.magnitude() + a.magnitude() + a.e_, a.e_); }

    static P plus(const P& x, const P& y) { return is_known_zero(x) ? y : is_known_zero(y) ? x : x + y; }
    static P times(const P& x, const P& e) { return is_known_zero(e) ? P(0) : x * e; }

    /// Lowest and highest a − b. The midpoint h + l has an error of at most u of h, of l and of their sum; it is exact
    /// if h = l = 0.
    struct DifferenceRange {
        P low, high;
    };
    static DifferenceRange enclose_difference(const RunningError& a, const RunningError& b) {
        using lostbits::abs;
        const P h = a.first() - b.first(), l = a.second() - b.second(), d = plus(h, l);
        const P e = plus(plus(a.e_, b.e_) * P(1 + 0x1p-40), P(0x1p-51) * plus(abs(h), abs(l)));
        return {d - e, d + e};
    }

    W w_;
    P e_;
};

static_assert(Number<RunningError<double>> && Number<RunningError<TwoWords<double>>>);

}  // namespace lostbits::number::wide
