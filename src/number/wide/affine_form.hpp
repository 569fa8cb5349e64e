// AffineForm: a number with its first-order dependence on each input and a bound on the rest. It encloses the results
// of all problems near a given one.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "number/concept.hpp"
#include "number/wide/running_error.hpp"

namespace lostbits::number::wide {

/// All real x = x₀ + Σ sᵢ ηᵢ + r with |r| ≤ `rest`, where every number of a problem has the same ηᵢ: affine arithmetic
/// (Stolfi and de Figueiredo, Self-Validated Numerical Methods and Applications, 1997, chapter 3). Each ηᵢ lies between
/// −1 and 1, or the ηᵢ form vectors of length at most 1 (`Vectors`). The centre x₀ has two words with a running bound,
/// so that numbers that cancel to 100 bits are distinguished from 0. The sᵢ are doubles, and their rounding errors are
/// in `rest`.
///
/// Products of deviations are of second order and are added to `rest`. With |x − x₀| ≤ D:
///     x y:    terms x₀ sᵢ(y) + y₀ sᵢ(x),   |x₀| r_y + |y₀| r_x + D_x D_y
///     1/y:    terms −sᵢ/y₀²,               r/y₀² + D²/(y₀² (|y₀| − D)),     where |y₀| > D
///     √x:     terms sᵢ/(2 √x₀),            r/(2 √x₀) + D²/(2 x₀ √x₀),       where x₀ > D
///     x²:     terms 2 x₀ sᵢ,               2 |x₀| r + D²/2, about x₀² + D²/2
/// A `rest` of infinity means that nothing is known.
template <std::size_t N>
class AffineForm {
public:
    using Centre = RunningError<TwoWords<double>>;
    /// Index after the last component of each vector, in ascending order, up to N. If empty, each ηᵢ is bounded by
    /// itself.
    using Vectors = std::span<const std::size_t>;
    /// A value of ηᵢ for each input.
    using Deviations = std::array<double, N>;
    /// Decides comparisons that the enclosures leave open. To cover all cases, a formula is run once for each outcome.
    struct OpenComparisons {
        virtual ~OpenComparisons() = default;
        /// Decides x < 0, or x ≤ 0 if `or_equal`.
        virtual Tri is_below(const AffineForm& x, bool or_equal) = 0;
    };
    /// Decides the open comparisons of this thread. If null, they stay unknown.
    static inline thread_local OpenComparisons* open_comparisons = nullptr;
    /// Set while only signs of sums and products are needed. Quotients and roots are then unknown and take no time.
    static inline thread_local bool computes_signs_only = false;

    AffineForm() = default;
    AffineForm(const AffineForm& x) { *this = x; }
    AffineForm& operator=(const AffineForm& x) {
        centre_ = x.centre_;
        term_count_ = x.term_count_;
        sum_ = x.sum_;
        rest_ = x.rest_;
        vectors_ = x.vectors_;
        std::copy_n(x.terms_.begin(), term_count_, terms_.begin());
        return *this;
    }
    explicit AffineForm(int x) : centre_(x) {}
    explicit AffineForm(double x) : centre_(TwoWords<double>(x)) {}
    /// Input i: x + step ηᵢ, with a bound `centre_error` on the error of x itself. `vectors` must outlive every number
    /// that is computed from this one.
    AffineForm(double x, std::size_t i, double step, double centre_error, Vectors vectors) : AffineForm(x) {
        rest_ = centre_error;
        std::fill_n(terms_.begin(), i, 0);
        terms_[i] = step;
        sum_ = std::fabs(step);
        term_count_ = i + 1;
        vectors_ = vectors;
    }

    friend AffineForm operator-(const AffineForm& a) { return a.scaled(-a.centre_, -1, a.rest_); }
    friend AffineForm operator+(const AffineForm& a, const AffineForm& b) {
        return combine(a.centre_ + b.centre_, a, 1, b, 1, a.rest_ + b.rest_);
    }
    friend AffineForm operator-(const AffineForm& a, const AffineForm& b) {
        return combine(a.centre_ - b.centre_, a, 1, b, -1, a.rest_ + b.rest_);
    }
    friend AffineForm operator*(const AffineForm& a, const AffineForm& b) {
        if (a.is_zero() || b.is_zero()) return AffineForm(0);
        if (&a == &b && !a.is_constant()) return a.squared();
        const double x = a.largest_centre(), y = b.largest_centre(), centre_error_x = a.centre_error(),
                     centre_error_y = b.centre_error();
        const double second_order = a.is_constant() || b.is_constant() ? 0 : a.deviation() * b.deviation();
        const double rest =
            x * b.rest_ + y * a.rest_ + second_order + centre_error_x * b.sum() + centre_error_y * a.sum();
        return combine(a.centre_ * b.centre_, a, b.centre_.first(), b, a.centre_.first(), rest);
    }
    friend AffineForm operator/(const AffineForm& a, const AffineForm& b) {
        return computes_signs_only ? all_reals() : a * inverse(b);
    }
    AffineForm& operator+=(const AffineForm& b) { return *this = *this + b; }
    AffineForm& operator-=(const AffineForm& b) { return *this = *this - b; }
    AffineForm& operator*=(const AffineForm& b) { return *this = *this * b; }

    friend AffineForm sqrt(const AffineForm& x) {
        if (x.is_constant() && x.centre_.first() == 0 && x.centre_error() == 0) return x;
        if (computes_signs_only) return all_reals();
        const double min_centre = x.min_centre(), deviation = x.deviation();
        if (!(x.centre_.first() > 0 && min_centre > deviation)) return all_reals();
        const double slope = 0.5 / std::sqrt(x.centre_.first()), largest_slope = 0.5 / std::sqrt(min_centre);
        const double rest = largest_slope * (x.rest_ + deviation * deviation / min_centre) +
                            x.centre_error() / min_centre * slope * x.sum();
        return x.scaled(sqrt(x.centre_), slope, rest);
    }
    friend AffineForm fma(const AffineForm& a, const AffineForm& b, const AffineForm& c) { return a * b + c; }
    /// Returns x: the form represents exact numbers, which have no neighbours.
    friend AffineForm next_up(const AffineForm& x) { return x; }
    friend AffineForm next_down(const AffineForm& x) { return x; }
    friend AffineForm abs(const AffineForm& x) { return select(x < AffineForm(0), -x, x); }
    friend AffineForm copysign(const AffineForm& a, const AffineForm& b) {
        const AffineForm magnitude = abs(a);
        return select(b < AffineForm(0), -magnitude, magnitude);
    }
    /// The result is unknown if the mask is undecided.
    friend AffineForm select(Tri mask, const AffineForm& a, const AffineForm& b) {
        return mask.is_yes() ? a : mask.is_no() ? b : all_reals();
    }

    friend Tri operator<(const AffineForm& a, const AffineForm& b) {
        return b.is_zero() ? a.is_below(false) : (a - b).is_below(false);
    }
    friend Tri operator<=(const AffineForm& a, const AffineForm& b) {
        return b.is_zero() ? a.is_below(true) : (a - b).is_below(true);
    }
    friend Tri operator>(const AffineForm& a, const AffineForm& b) { return b < a; }
    friend Tri operator>=(const AffineForm& a, const AffineForm& b) { return b <= a; }

    /// Upper bound of |x − x₀| for any x.
    [[nodiscard]] double deviation() const {
        double first_order = 0;
        if (vectors_.empty()) {
            first_order = sum();
        } else {
            std::size_t i = 0;
            for (const std::size_t end : vectors_) {
                double sum_of_squares = 0;
                for (; i < std::min(end, term_count_); ++i) sum_of_squares += terms_[i] * terms_[i];
                first_order += std::sqrt(sum_of_squares) * inflation + underflow_bound;
            }
        }
        return (first_order + rest_) * inflation;
    }

    /// Lower and upper end of the enclosure.
    [[nodiscard]] double lowest() const { return enclosure().middle - enclosure().radius * inflation; }
    [[nodiscard]] double highest() const { return enclosure().middle + enclosure().radius * inflation; }
    /// The ηᵢ for which x is largest, to first order.
    [[nodiscard]] Deviations steepest_deviations() const {
        Deviations deviations{};
        if (vectors_.empty())
            for (std::size_t i = 0; i < term_count_; ++i) deviations[i] = terms_[i] > 0 ? 1 : terms_[i] < 0 ? -1 : 0;
        std::size_t i = 0;
        for (const std::size_t end : vectors_) {
            double sum_of_squares = 0;
            for (std::size_t k = i; k < std::min(end, term_count_); ++k) sum_of_squares += terms_[k] * terms_[k];
            for (; i < std::min(end, term_count_); ++i)
                deviations[i] = sum_of_squares > 0 ? terms_[i] / std::sqrt(sum_of_squares) : 0;
        }
        return deviations;
    }
    /// Returns 1 if this is the same function of the inputs as x, −1 if it is the same as −x, and 0 otherwise.
    [[nodiscard]] int compare_up_to_sign(const AffineForm& x) const {
        if (rest_ != x.rest_ || term_count_ != x.term_count_ || !std::isfinite(rest_)) return 0;
        const auto equals_multiple = [&](double k) {
            if (centre_.first() != k * x.centre_.first() || centre_.second() != k * x.centre_.second()) return false;
            for (std::size_t i = 0; i < term_count_; ++i)
                if (terms_[i] != k * x.terms_[i]) return false;
            return true;
        };
        return equals_multiple(1) ? 1 : equals_multiple(-1) ? -1 : 0;
    }

    /// Functions for root searches in enclosures. `middle` is a point of an enclosure, `between` an enclosure of two
    /// others, `largest_magnitude` the largest magnitude in an enclosure, as a point, and `precision_of` the number of
    /// bits of a number.
    friend AffineForm middle(const AffineForm& x) {
        AffineForm result;
        result.centre_ = Centre(x.centre_.words());
        return result;
    }
    friend AffineForm enclose_between(const AffineForm& low, const AffineForm& high) {
        AffineForm result = middle(AffineForm(0.5) * (low + high));
        const double above = largest_magnitude(high - result).hi(), below = largest_magnitude(result - low).hi();
        result.rest_ = !(above <= below) ? above : below;
        return result;
    }
    friend AffineForm largest_magnitude(const AffineForm& x) {
        return AffineForm((x.largest_centre() + x.deviation()) * inflation);
    }
    friend int precision_of(const AffineForm&) { return 100; }
    [[nodiscard]] double hi() const { return centre_.first(); }
    [[nodiscard]] bool is_bounded() const { return deviation() + centre_error() < HUGE_VAL; }

private:
    /// Factor that compensates the roundings of a bound: fewer than 2^10 of them, 2^-53 each.
    static constexpr double inflation = 1 + 0x1p-42;
    static constexpr double underflow_bound = 0x1p-500;  ///< above the square root of the loss of a square to underflow

    static AffineForm all_reals() {
        AffineForm x(0);
        x.rest_ = HUGE_VAL;
        return x;
    }
    static AffineForm inverse(const AffineForm& y) {
        const double min_centre = y.min_centre(), deviation = y.deviation();
        if (!(min_centre > deviation)) return all_reals();
        const double q = 1 / y.centre_.first(), largest_inverse = 1 / min_centre * inflation;
        const double rest = largest_inverse * largest_inverse *
                            (y.rest_ + deviation * deviation / (min_centre - deviation) * inflation);
        return y.scaled(AffineForm(1).centre_ / y.centre_, -(q * q),
                        rest + 4 * y.centre_error() * largest_inverse * largest_inverse * largest_inverse * y.sum());
    }

    [[nodiscard]] AffineForm squared() const {
        const double x = largest_centre(), d = deviation(), second_order = d * d / 2;
        if (!(second_order < HUGE_VAL)) return all_reals();
        const double rest = 2 * x * rest_ + second_order * inflation + 2 * centre_error() * sum();
        return combine(centre_ * centre_ + Centre(TwoWords<double>(second_order)), *this, 2 * centre_.first(),
                       AffineForm(0), 0, rest);
    }
    /// Decides whether this is below 0, or at most 0 if `or_equal`.
    [[nodiscard]] Tri is_below(bool or_equal) const {
        const auto [middle, radius] = enclosure();
        if (or_equal ? middle <= -radius : middle < -radius) return Tri::yes;
        if (or_equal ? middle > radius : middle >= radius) return Tri::no;
        return open_comparisons ? open_comparisons->is_below(*this, or_equal) : Tri::unknown;
    }
    [[nodiscard]] bool is_zero() const {
        return centre_.first() == 0 && centre_error() == 0 && rest_ == 0 && sum() == 0;
    }
    [[nodiscard]] bool is_constant() const { return vectors_.data() == nullptr && rest_ == 0 && sum() == 0; }
    /// Bound on the distance of x₀ from its first word.
    [[nodiscard]] double centre_error() const { return std::fabs(centre_.first()) * 0x1p-52 + centre_.radius(); }
    [[nodiscard]] double largest_centre() const { return std::fabs(centre_.first()) + centre_error(); }
    [[nodiscard]] double min_centre() const {
        return std::fabs(centre_.first()) * (1 - 0x1p-50) - centre_.radius() * inflation;
    }
    /// Σ |sᵢ|, rounded up.
    [[nodiscard]] double sum() const { return sum_; }
    struct Enclosure {
        double middle, radius;
    };
    /// A number within `radius` of `middle`. An exact 0 has radius 0.
    [[nodiscard]] Enclosure enclosure() const { return {centre_.first(), (deviation() + centre_error()) * inflation}; }

    /// This number times k, with another centre. Each product of a term with k is rounded, by at most 2^-53 of itself.
    [[nodiscard]] AffineForm scaled(const Centre& centre, double k, double rest) const {
        return combine(centre, *this, k, AffineForm(0), 0, rest);
    }
    static AffineForm combine(const Centre& centre, const AffineForm& a, double factor_a, const AffineForm& b,
                              double factor_b, double rest) {
        AffineForm x;
        x.centre_ = centre;
        x.term_count_ = std::max(a.term_count_, b.term_count_);
        double sum = 0;
        const std::size_t common_count = std::min(a.term_count_, b.term_count_);
        for (std::size_t i = 0; i < common_count; ++i) {
            x.terms_[i] = a.terms_[i] * factor_a + b.terms_[i] * factor_b;
            sum += std::fabs(x.terms_[i]);
        }

        // The longer form has its last terms alone.
        const auto& [longer, k] = a.term_count_ > common_count ? std::pair(&a, factor_a) : std::pair(&b, factor_b);
        for (std::size_t i = common_count; i < x.term_count_; ++i) {
            x.terms_[i] = longer->terms_[i] * k;
            sum += std::fabs(x.terms_[i]);
        }

        x.sum_ = sum * inflation;
        const double magnitude = std::fabs(factor_a) * a.sum_ + std::fabs(factor_b) * b.sum_;
        x.vectors_ = a.vectors_.empty() ? b.vectors_ : a.vectors_;
        // Rounding of the two products and their sum, 3 · 2^-53 of their magnitude, and the loss of a product to
        // underflow.
        x.rest_ = rest == 0 && magnitude == 0
                      ? 0
                      : (rest + magnitude * 0x1p-51 + underflow_bound * underflow_bound) * inflation;
        return x;
    }

    Centre centre_{0};
    std::array<double, N> terms_;
    std::size_t term_count_ = 0;  ///< number of stored terms; all further terms are 0
    double sum_ = 0, rest_ = 0;
    Vectors vectors_{};
};

static_assert(Number<AffineForm<4>>);

}  // namespace lostbits::number::wide
