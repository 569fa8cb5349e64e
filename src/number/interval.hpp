// Interval: an enclosure of the exact value at any precision. It has MPFI endpoints, outward rounding, and unbounded
// exponents.
//
// It uses MPFI directly, not through Boost.Multiprecision: in version 1.74 the working precision of `mpfi_float` is one
// variable of the whole process, so two threads that escalate to different precisions would disturb each other.
#pragma once

#include <mpfi.h>

#include "number/concept.hpp"
#include "number/error_free.hpp"
#include "number/tri.hpp"

namespace lostbits {

/// A closed interval [lower, upper] of reals, and whether the exact value can be undefined. Every result has the
/// thread's current precision (`Interval::Precision`); operands may have any precision.
///
/// An interval that is a single number is kept as two doubles as long as they hold it and its sums and products are
/// exact. It allocates nothing, and its MPFI endpoints are made on demand. This proves the exact zeros of rays through
/// edges and along tangents. For a triangle in floats, with t, it takes a sixth of the time that MPFI took.
class Interval {
public:
    /// Sets the working precision of this thread, in bits, for the lifetime of the scope.
    class Precision {
    public:
        explicit Precision(long bits) : previous_bits_(working_bits_) { working_bits_ = bits; }
        ~Precision() { working_bits_ = previous_bits_; }
        Precision(const Precision&) = delete;
        Precision& operator=(const Precision&) = delete;

    private:
        long previous_bits_;
    };

    Interval();
    explicit Interval(int x);
    /// Exact when the working precision is 53 or more.
    explicit Interval(double x);
    explicit Interval(mpfr_srcptr x);
    /// A `Real` of any width. The interval is exact if the working precision is at least that of x. This constructor is
    /// a template, because the header of `Real` takes a compiler three seconds.
    template <class R>
    requires requires(const R& x) { x.backend().data(); }
    explicit Interval(const R& x) : Interval(static_cast<mpfr_srcptr>(x.backend().data())) {}
    Interval(const Interval& other);
    Interval(Interval&& other) noexcept;
    Interval& operator=(const Interval& other);
    Interval& operator=(Interval&& other) noexcept;
    ~Interval();

    /// Interval of all reals, whose exact value may be undefined.
    static Interval all_reals(Undefined u = Undefined::maybe);
    static Interval between(double lower, double upper);

    /// The endpoints of a point are made on demand, so only one thread at a time may use an interval.
    [[nodiscard]] mpfr_srcptr lower() const { return &ends()->left; }
    [[nodiscard]] mpfr_srcptr upper() const { return &ends()->right; }
    [[nodiscard]] Undefined undefined() const { return undefined_; }
    [[nodiscard]] bool is_bounded() const {
        return is_point_ || (undefined_ == Undefined::never && mpfi_bounded_p(value_) != 0);
    }
    /// True if both endpoints are the same number, which is then the exact value.
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
    /// The square, whose lower end is 0 if a contains zero. The product a·a could have a lower end below 0, and then
    /// the root of x² + y² might be undefined.
    friend Interval square(const Interval& a);
    friend Interval fma_square(const Interval& a, const Interval& c) { return square(a) + c; }
    friend Interval abs(const Interval& a);
    friend Interval copysign(const Interval& a, const Interval& b);
    /// The smallest interval that holds both a and b if the mask is undecided.
    friend Interval select(Tri mask, const Interval& a, const Interval& b);

    // Functions for root searches in enclosures

    /// Point in the middle of an interval.
    friend Interval middle(const Interval& a);
    /// Interval from the lower end of `low` to the upper end of `high`.
    friend Interval enclose_between(const Interval& low, const Interval& high);
    /// Largest magnitude in an interval, as a point.
    friend Interval largest_magnitude(const Interval& a);
    /// Number of bits of an interval.
    friend int precision_of(const Interval& a) { return static_cast<int>(a.bits_); }
    /// Double nearest to the lower end.
    friend double nearest_double(const Interval& a) { return mpfr_get_d(a.lower(), MPFR_RNDN); }

private:
    /// Selects the constructor that does not set the endpoints. They have the working precision.
    struct UninitialisedTag {};
    explicit Interval(UninitialisedTag);
    explicit Interval(const DoubleDouble& point) : point_(point), bits_(working_bits_), is_point_(true) {}
    void set_undefined(Undefined u);
    /// True if an operation on a and b may try its result as a point: both are points, and the working precision holds
    /// every point.
    static bool can_compute_as_points(const Interval& a, const Interval& b);
    [[nodiscard]] mpfi_srcptr ends() const {
        if (!has_ends_) ensure_ends();
        return value_;
    }
    void ensure_ends() const;

    static thread_local long working_bits_;
    mutable mpfi_t value_{};
    DoubleDouble point_{0, 0};
    long bits_;
    bool is_point_ = false;
    mutable bool has_ends_ = false;  ///< always true if the interval is not a point
    Undefined undefined_ = Undefined::never;
};

template <>
inline constexpr bool is_exact<Interval> = true;

static_assert(Number<Interval>);

}  // namespace lostbits
