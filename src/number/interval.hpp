// Interval: an enclosure of the exact value at any precision. MPFI endpoints, outward rounding, unbounded exponents.
//
// It uses MPFI directly, not through Boost.Multiprecision: in version 1.74 the working precision of `mpfi_float` is one
// variable of the whole process, so two threads that escalate to different precisions would disturb each other.
#pragma once

#include <mpfi.h>

#include "number/concept.hpp"
#include "number/error_free.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// A closed interval [lower, upper] of reals, and whether the exact value can be undefined. The precision of every
/// result is the thread's current one (`Interval::Precision`); operands may have any.
///
/// A point that two doubles hold stays such a point as long as its sums and products are exact, and allocates nothing.
/// Its MPFI ends are made on demand. Exact zeros, which rays through edges and along tangents give, are proved this
/// way. For a triangle in floats, with t, this takes a sixth of the time that MPFI took.
class Interval {
public:
    /// Sets the working precision of this thread, in bits, for the lifetime of the scope.
    class Precision {
    public:
        explicit Precision(long bits) : before_(working_) { working_ = bits; }
        ~Precision() { working_ = before_; }
        Precision(const Precision&) = delete;
        Precision& operator=(const Precision&) = delete;

    private:
        long before_;
    };

    Interval();
    explicit Interval(int x);
    /// Exact when the working precision is 53 or more.
    explicit Interval(double x);
    explicit Interval(mpfr_srcptr x);
    /// A `Real` of any width: exact when the working precision is at least as much. A template, since the header of
    /// `Real` takes a compiler three seconds.
    template <class R>
    requires requires(const R& x) { x.backend().data(); }
    explicit Interval(const R& x) : Interval(static_cast<mpfr_srcptr>(x.backend().data())) {}
    Interval(const Interval& other);
    Interval(Interval&& other) noexcept;
    Interval& operator=(const Interval& other);
    Interval& operator=(Interval&& other) noexcept;
    ~Interval();

    static Interval unknown(Undefined u = Undefined::maybe);
    static Interval between(double lower, double upper);

    /// The ends of an interval are made on demand, so only one thread at a time may use it.
    [[nodiscard]] mpfr_srcptr lower() const { return &ends()->left; }
    [[nodiscard]] mpfr_srcptr upper() const { return &ends()->right; }
    [[nodiscard]] Undefined undefined() const { return undefined_; }
    [[nodiscard]] bool is_bounded() const {
        return is_point_ || (undefined_ == Undefined::never && mpfi_bounded_p(value_) != 0);
    }
    /// True when both endpoints are the same number: the enclosure is the value.
    [[nodiscard]] bool is_exact() const { return is_bounded() && mpfr_equal_p(lower(), upper()) != 0; }

    friend Interval operator+(const Interval& a, const Interval& b);
    friend Interval operator-(const Interval& a, const Interval& b);
    friend Interval operator*(const Interval& a, const Interval& b);
    friend Interval operator/(const Interval& a, const Interval& b);
    friend Interval operator-(const Interval& a);
    Interval& operator+=(const Interval& b) { return *this = *this + b; }
    Interval& operator-=(const Interval& b) { return *this = *this - b; }
    Interval& operator*=(const Interval& b) { return *this = *this * b; }

    friend Tri operator<(const Interval& a, const Interval& b);
    friend Tri operator<=(const Interval& a, const Interval& b);
    friend Tri operator>(const Interval& a, const Interval& b) { return b < a; }
    friend Tri operator>=(const Interval& a, const Interval& b) { return b <= a; }

    friend Interval sqrt(const Interval& a);
    friend Interval fma(const Interval& a, const Interval& b, const Interval& c);
    /// [0, …] if a contains zero: otherwise the root of x² + y² would be undefined if x and y may be zero.
    friend Interval square(const Interval& a);
    friend Interval fma_square(const Interval& a, const Interval& c) { return square(a) + c; }
    friend Interval abs(const Interval& a);
    friend Interval copysign(const Interval& a, const Interval& b);
    /// The smallest interval that holds both sides if the mask is undecided.
    friend Interval select(Tri mask, const Interval& a, const Interval& b);

    /// Root searches in enclosures need these: a point of an interval, the interval from one to another, the largest
    /// magnitude in one as a point, and its number of bits.
    friend Interval middle(const Interval& a);
    friend Interval between(const Interval& low, const Interval& high);
    friend Interval largest(const Interval& a);
    friend int precision_of(const Interval& a) { return static_cast<int>(a.bits_); }
    /// Double nearest to the lower end.
    friend double nearest_double(const Interval& a) { return mpfr_get_d(a.lower(), MPFR_RNDN); }

private:
    /// Selects the constructor whose ends are still to be set, at the working precision.
    struct Ends {};
    explicit Interval(Ends);
    explicit Interval(const DoubleDouble& point) : point_(point), bits_(working_), is_point_(true) {}
    void settle(Undefined u);
    /// True if the result may be kept as a point.
    static bool are_points(const Interval& a, const Interval& b);
    [[nodiscard]] mpfi_srcptr ends() const {
        if (!has_ends_) make_ends();
        return value_;
    }
    void make_ends() const;

    static thread_local long working_;
    mutable mpfi_t value_{};
    DoubleDouble point_{0, 0};
    long bits_;
    bool is_point_ = false;
    mutable bool has_ends_ = false;  ///< always true if it is not a point
    Undefined undefined_ = Undefined::never;
};

template <>
inline constexpr bool is_exact<Interval> = true;

static_assert(Number<Interval>);

}  // namespace lostbits
