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
#include "number/wide/running.hpp"

namespace lostbits::number::wide {

/// All real x = x₀ + Σ sᵢ ηᵢ + r with |r| ≤ `rest`, where the same ηᵢ stand in every number of a problem: affine
/// arithmetic (Stolfi and de Figueiredo, Self-Validated Numerical Methods and Applications, 1997, chapter 3). Each ηᵢ
/// lies between −1 and 1, or they form vectors of length at most 1 (`Vectors`). x₀ has two words with a running bound,
/// so that numbers that cancel to 100 bits are distinguished from 0. The sᵢ are doubles, and their rounding errors are
/// in `rest`.
///
/// Products of deviations are of second order and go to `rest`. With |x − x₀| ≤ D:
///     x y:    terms x₀ sᵢ(y) + y₀ sᵢ(x),   |x₀| r_y + |y₀| r_x + D_x D_y
///     1/y:    terms −sᵢ/y₀²,               r/y₀² + D²/(y₀² (|y₀| − D)),     where |y₀| > D
///     √x:     terms sᵢ/(2 √x₀),            r/(2 √x₀) + D²/(2 x₀ √x₀),       where x₀ > D
///     x²:     terms 2 x₀ sᵢ,               2 |x₀| r + D²/2, about x₀² + D²/2
/// A `rest` of infinity means that nothing is known.
template <std::size_t N>
class AffineForm {
public:
    using Centre = Running<TwoWords<double>>;
    /// Index behind the last component of each vector, in ascending order, up to N. Empty: each ηᵢ stands alone.
    using Vectors = std::span<const std::size_t>;
    /// An ηᵢ for each input.
    using Deviations = std::array<double, N>;
    /// Answers comparisons that the enclosures leave open. To cover all cases, a formula is run once for each answer.
    struct Open {
        virtual ~Open() = default;
        /// Decides x < 0, or x ≤ 0 if `or_equal`.
        virtual Tri is_below(const AffineForm& x, bool or_equal) = 0;
    };
    /// Answers comparisons of this thread; null: they stay unknown.
    static inline thread_local Open* open = nullptr;
    /// Set while only signs of sums and products are needed. Quotients and roots are then unknown, and cost nothing.
    static inline thread_local bool signs_only = false;

    AffineForm() = default;
    AffineForm(const AffineForm& x) { *this = x; }
    AffineForm& operator=(const AffineForm& x) {
        centre_ = x.centre_, used_ = x.used_, sum_ = x.sum_, rest_ = x.rest_, vectors_ = x.vectors_;
        std::copy_n(x.terms_.begin(), used_, terms_.begin());
        return *this;
    }
    explicit AffineForm(int x) : centre_(x) {}
    explicit AffineForm(double x) : centre_(TwoWords<double>(x)) {}
    /// Input number i: x + step ηᵢ, with a bound `off` on the error of x itself. `vectors` must outlive every number
    /// that is computed from it.
    AffineForm(double x, std::size_t i, double step, double off, Vectors vectors) : AffineForm(x) {
        rest_ = off;
        std::fill_n(terms_.begin(), i, 0);
        terms_[i] = step;
        sum_ = std::fabs(step);
        used_ = i + 1;
        vectors_ = vectors;
    }

    friend AffineForm operator-(const AffineForm& a) { return a.linear(-a.centre_, -1, a.rest_); }
    friend AffineForm operator+(const AffineForm& a, const AffineForm& b) {
        return joined(a.centre_ + b.centre_, a, 1, b, 1, a.rest_ + b.rest_);
    }
    friend AffineForm operator-(const AffineForm& a, const AffineForm& b) {
        return joined(a.centre_ - b.centre_, a, 1, b, -1, a.rest_ + b.rest_);
    }
    friend AffineForm operator*(const AffineForm& a, const AffineForm& b) {
        if (a.is_zero() || b.is_zero()) return AffineForm(0);
        if (&a == &b && !a.is_constant()) return a.squared();
        const double x = a.most(), y = b.most(), off_x = a.off(), off_y = b.off();
        const double second = a.is_constant() || b.is_constant() ? 0 : a.deviation() * b.deviation();
        const double rest = x * b.rest_ + y * a.rest_ + second + off_x * b.sum() + off_y * a.sum();
        return joined(a.centre_ * b.centre_, a, b.centre_.first(), b, a.centre_.first(), rest);
    }
    friend AffineForm operator/(const AffineForm& a, const AffineForm& b) {
        return signs_only ? unknown() : a * inverse(b);
    }
    AffineForm& operator+=(const AffineForm& b) { return *this = *this + b; }
    AffineForm& operator-=(const AffineForm& b) { return *this = *this - b; }
    AffineForm& operator*=(const AffineForm& b) { return *this = *this * b; }

    friend AffineForm sqrt(const AffineForm& x) {
        if (x.is_constant() && x.centre_.first() == 0 && x.off() == 0) return x;
        if (signs_only) return unknown();
        const double least = x.least(), deviation = x.deviation();
        if (!(x.centre_.first() > 0 && least > deviation)) return unknown();
        const double slope = 0.5 / std::sqrt(x.centre_.first()), most_slope = 0.5 / std::sqrt(least);
        const double rest = most_slope * (x.rest_ + deviation * deviation / least) + x.off() / least * slope * x.sum();
        return x.linear(sqrt(x.centre_), slope, rest);
    }
    friend AffineForm fma(const AffineForm& a, const AffineForm& b, const AffineForm& c) { return a * b + c; }
    /// Returns x: the form represents exact numbers, which have no neighbours.
    friend AffineForm next_up(const AffineForm& x) { return x; }
    friend AffineForm next_down(const AffineForm& x) { return x; }
    friend AffineForm abs(const AffineForm& x) { return select(x < AffineForm(0), -x, x); }
    friend AffineForm copysign(const AffineForm& a, const AffineForm& b) {
        const AffineForm size = abs(a);
        return select(b < AffineForm(0), -size, size);
    }
    /// The result is unknown if the mask is undecided.
    friend AffineForm select(Tri mask, const AffineForm& a, const AffineForm& b) {
        return mask.is_yes() ? a : mask.is_no() ? b : unknown();
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
                double squares = 0;
                for (; i < std::min(end, used_); ++i) squares += terms_[i] * terms_[i];
                first_order += std::sqrt(squares) * up + tiny;
            }
        }
        return (first_order + rest_) * up;
    }

    /// Ends of the enclosure.
    [[nodiscard]] double lowest() const { return ends().middle - ends().size * up; }
    [[nodiscard]] double highest() const { return ends().middle + ends().size * up; }
    /// The ηᵢ in whose direction x grows fastest, to first order.
    [[nodiscard]] Deviations steepest() const {
        Deviations by{};
        if (vectors_.empty())
            for (std::size_t i = 0; i < used_; ++i) by[i] = terms_[i] > 0 ? 1 : terms_[i] < 0 ? -1 : 0;
        std::size_t i = 0;
        for (const std::size_t end : vectors_) {
            double squares = 0;
            for (std::size_t k = i; k < std::min(end, used_); ++k) squares += terms_[k] * terms_[k];
            for (; i < std::min(end, used_); ++i) by[i] = squares > 0 ? terms_[i] / std::sqrt(squares) : 0;
        }
        return by;
    }
    /// 1 if this is the same function of the inputs as x, −1 if it is the same as −x, otherwise 0.
    [[nodiscard]] int is_multiple_of(const AffineForm& x) const {
        if (rest_ != x.rest_ || used_ != x.used_ || !std::isfinite(rest_)) return 0;
        const auto is = [&](double k) {
            if (centre_.first() != k * x.centre_.first() || centre_.second() != k * x.centre_.second()) return false;
            for (std::size_t i = 0; i < used_; ++i)
                if (terms_[i] != k * x.terms_[i]) return false;
            return true;
        };
        return is(1) ? 1 : is(-1) ? -1 : 0;
    }

    /// Root searches in enclosures need these: a point of an enclosure, an enclosure of two others, the largest
    /// magnitude in an enclosure, as a point, and the number of bits of a number.
    friend AffineForm middle(const AffineForm& x) {
        AffineForm point;
        point.centre_ = Centre(x.centre_.words());
        return point;
    }
    friend AffineForm between(const AffineForm& low, const AffineForm& high) {
        AffineForm all = middle(AffineForm(0.5) * (low + high));
        const double up_to = largest(high - all).hi(), down_to = largest(all - low).hi();
        all.rest_ = !(up_to <= down_to) ? up_to : down_to;
        return all;
    }
    friend AffineForm largest(const AffineForm& x) { return AffineForm((x.most() + x.deviation()) * up); }
    friend int precision_of(const AffineForm&) { return 100; }
    [[nodiscard]] double hi() const { return centre_.first(); }
    [[nodiscard]] bool is_bounded() const { return deviation() + off() < HUGE_VAL; }

private:
    /// Compensates the roundings of a bound: fewer than 2^10 of them, 2^-53 each.
    static constexpr double up = 1 + 0x1p-42;
    static constexpr double tiny = 0x1p-500;  ///< above the square root of the loss of a square to underflow

    static AffineForm unknown() {
        AffineForm x(0);
        x.rest_ = HUGE_VAL;
        return x;
    }
    static AffineForm inverse(const AffineForm& y) {
        const double least = y.least(), deviation = y.deviation();
        if (!(least > deviation)) return unknown();
        const double q = 1 / y.centre_.first(), most = 1 / least * up;
        const double rest = most * most * (y.rest_ + deviation * deviation / (least - deviation) * up);
        return y.linear(AffineForm(1).centre_ / y.centre_, -(q * q), rest + 4 * y.off() * most * most * most * y.sum());
    }

    [[nodiscard]] AffineForm squared() const {
        const double x = most(), d = deviation(), second = d * d / 2;
        if (!(second < HUGE_VAL)) return unknown();
        const double rest = 2 * x * rest_ + second * up + 2 * off() * sum();
        return joined(centre_ * centre_ + Centre(TwoWords<double>(second)), *this, 2 * centre_.first(), AffineForm(0),
                      0, rest);
    }
    /// Decides whether this is below 0, or at most 0 if `or_equal`.
    [[nodiscard]] Tri is_below(bool or_equal) const {
        const auto [middle, size] = ends();
        if (or_equal ? middle <= -size : middle < -size) return Tri::yes;
        if (or_equal ? middle > size : middle >= size) return Tri::no;
        return open ? open->is_below(*this, or_equal) : Tri::unknown;
    }
    [[nodiscard]] bool is_zero() const { return centre_.first() == 0 && off() == 0 && rest_ == 0 && sum() == 0; }
    [[nodiscard]] bool is_constant() const { return vectors_.data() == nullptr && rest_ == 0 && sum() == 0; }
    /// Bound on the distance of x₀ from its first word.
    [[nodiscard]] double off() const { return std::fabs(centre_.first()) * 0x1p-52 + centre_.radius(); }
    [[nodiscard]] double most() const { return std::fabs(centre_.first()) + off(); }
    [[nodiscard]] double least() const { return std::fabs(centre_.first()) * (1 - 0x1p-50) - centre_.radius() * up; }
    /// Σ |sᵢ|, rounded up.
    [[nodiscard]] double sum() const { return sum_; }
    struct Ends {
        double middle, size;
    };
    /// A number within `size` of `middle`. An exact 0 has size 0.
    [[nodiscard]] Ends ends() const { return {centre_.first(), (deviation() + off()) * up}; }

    /// This number times k, with another centre. The product of a term is rounded, by at most 2^-53 of itself.
    [[nodiscard]] AffineForm linear(const Centre& centre, double k, double rest) const {
        return joined(centre, *this, k, AffineForm(0), 0, rest);
    }
    static AffineForm joined(const Centre& centre, const AffineForm& a, double of_a, const AffineForm& b, double of_b,
                             double rest) {
        AffineForm x;
        x.centre_ = centre;
        x.used_ = std::max(a.used_, b.used_);
        double sum = 0;
        const std::size_t both = std::min(a.used_, b.used_);
        for (std::size_t i = 0; i < both; ++i) {
            x.terms_[i] = a.terms_[i] * of_a + b.terms_[i] * of_b;
            sum += std::fabs(x.terms_[i]);
        }
        const auto& [longer, k] = a.used_ > both ? std::pair(&a, of_a) : std::pair(&b, of_b);
        for (std::size_t i = both; i < x.used_; ++i) {
            x.terms_[i] = longer->terms_[i] * k;
            sum += std::fabs(x.terms_[i]);
        }
        x.sum_ = sum * up;
        const double size = std::fabs(of_a) * a.sum_ + std::fabs(of_b) * b.sum_;
        x.vectors_ = a.vectors_.empty() ? b.vectors_ : a.vectors_;
        // Rounding of the two products and their sum, 3 · 2^-53 of their size, and the loss of a product to underflow.
        x.rest_ = rest == 0 && size == 0 ? 0 : (rest + size * 0x1p-51 + tiny * tiny) * up;
        return x;
    }

    Centre centre_{0};
    std::array<double, N> terms_;
    std::size_t used_ = 0;  ///< all terms from here on are 0, and not stored
    double sum_ = 0, rest_ = 0;
    Vectors vectors_{};
};

static_assert(Number<AffineForm<4>>);

}  // namespace lostbits::number::wide
