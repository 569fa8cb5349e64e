#include "measure/stability/stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "measure/truth/side.hpp"
#include "number/wide/affine_form.hpp"

namespace lostbits::measure::stability {

using namespace truth;

namespace {

constexpr std::size_t most_inputs = 6 + most_stored;
using Near = number::wide::AffineForm<most_inputs>;

/// A problem, and all problems within ε of it. Its units are those in which its largest length and its largest
/// component of d are about 1; the choice of units changes no answer.
class Neighbours {
public:
    Neighbours(const Ray<double>& ray, const Solid<double>& solid, Perturbed perturbed)
        : solid_(solid), is_normwise_(perturbed == Perturbed::normwise) {
        for (int i = 0; i < 3; ++i) {
            numbers_[static_cast<std::size_t>(i)] = ray.origin[i];
            numbers_[static_cast<std::size_t>(i) + 3] = ray.direction[i];
        }
        vector(Of::length, 3), vector(Of::direction, 3);
        for (const Key& key : row_of(solid.shape).keys) {
            for (std::size_t k = 0; k < key.count(); ++k) numbers_[end_ + k] = solid.numbers[end_ - 6 + k];
            vector(key.kind == Key::Kind::direction ? Of::nothing : Of::length, key.count());
        }
        matrix_ = end_;
        if (solid.placed) {
            // The linear part of a matrix needs no unit: world space and object space have the same one.
            for (std::size_t k = 0; k < 12; ++k) numbers_[matrix_ + k] = solid.placed->matrix[place_in_matrix(k)];
            vector(Of::nothing, 9), vector(Of::length, 3);
        }
        for (std::size_t i = 0; i < end_; ++i)
            if (of_[i] != Of::nothing && numbers_[i] != 0) {
                int& unit = of_[i] == Of::length ? length_ : direction_;
                unit = std::max(unit, std::ilogb(numbers_[i]));
            }
        for (int* const unit : {&length_, &direction_})
            if (*unit == none) *unit = 0;
        for (std::size_t i = 0; i < end_; ++i) {
            const bool is_zero = numbers_[i] == 0;
            if (of_[i] != Of::nothing)
                numbers_[i] = std::ldexp(numbers_[i], of_[i] == Of::length ? -length_ : -direction_);
            // A number so small beside the largest may underflow, and so may its step. Neither loses more than this.
            if (!is_zero && std::fabs(numbers_[i]) < 0x1p-900) lost_[i] = 0x1p-900;
        }
    }

    /// t in the units of the problem. Infinity stays infinity. NaN, which decides nothing, where the scaling
    /// underflows.
    [[nodiscard]] double in_time(double t) const {
        const double scaled = std::ldexp(t, direction_ - length_);
        return std::isinf(t) || std::ldexp(scaled, length_ - direction_) == t ? scaled : std::nan("");
    }

    /// Enclosure of every ray and primitive within ε, as long as they are proper.
    struct All {
        Ray<Near> ray;
        Solid<Near> solid;
    };
    [[nodiscard]] All within(double epsilon) const {
        std::array<double, most_inputs> steps{};
        std::size_t i = 0;
        for (std::size_t v = 0; v < vectors_used_; ++v) {
            double squares = 0;
            for (std::size_t k = i; k < vectors_[v]; ++k) squares += numbers_[k] * numbers_[k];
            for (; i < vectors_[v]; ++i)
                steps[i] = epsilon * (is_normwise_ ? std::sqrt(squares) : std::fabs(numbers_[i])) * (1 + 0x1p-40);
        }
        const Near::Vectors vectors = is_normwise_ ? Near::Vectors(vectors_).first(vectors_used_) : Near::Vectors();
        const auto number = [&](std::size_t k) { return Near(numbers_[k], k, steps[k], lost_[k], vectors); };
        All all{{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}}, Solid<Near>(solid_.shape)};
        for (std::size_t k = 6; k < matrix_; ++k) all.solid.numbers[k - 6] = number(k);
        if (solid_.placed) {
            all.solid.placed = transformed(*solid_.placed, [](double) { return Near(0); });
            for (std::size_t k = matrix_; k < end_; ++k)
                all.solid.placed->matrix[place_in_matrix(k - matrix_)] = number(k);
        }
        return all;
    }

private:
    enum class Of : unsigned char { nothing, length, direction };
    static constexpr int none = -5000;
    void vector(Of of, std::size_t count) {
        std::fill_n(&of_[end_], count, of);
        end_ += count;
        vectors_[vectors_used_++] = end_;
    }

    const Solid<double>& solid_;
    bool is_normwise_;
    std::array<double, most_inputs> numbers_{}, lost_{};
    std::array<Of, most_inputs> of_{};
    std::array<std::size_t, most_inputs> vectors_{};
    std::size_t vectors_used_ = 0, end_ = 0, matrix_ = 0;
    int length_ = none, direction_ = none;
};

/// True if no matrix within ε is singular, so that each has a determinant of the same sign as the stored one.
bool all_proper(const Solid<Near>& solid) {
    if (!solid.placed) return true;
    const Near determinant = solid.placed->map().determinant(), zero(0);
    return (solid.placed->orientation > 0 ? determinant > zero : determinant < zero).is_yes();
}

constexpr double least_change = 0x1p-90, most_change = 0.5;

/// Largest ε for which `holds` is proved, to a factor of 2^(1/16), and at most `most_change`; 0 where not even
/// `least_change` is proved. Bisects the exponent: what holds within ε holds within less, too.
template <class Holds>
double largest(const Holds& holds) {
    if (!holds(least_change)) return 0;
    if (holds(most_change)) return most_change;
    double low = std::log2(least_change), high = std::log2(most_change);
    while (high - low > 1.0 / 16) {
        const double middle = (low + high) / 2;
        (holds(std::exp2(middle)) ? low : high) = middle;
    }
    return std::exp2(low);
}

/// Side of m on which the answers of all rays that hit lie. −1 and +1 prove that no answer is m, even where some rays
/// miss.
template <class S>
std::optional<int> side_if_any(const S& span, const Near& m, const RangeOfSpan<Near>* range,
                               intersect::Convention convention) {
    return side_of<Near>(span, m, Length::parameter, range, convention);
}
std::optional<int> side_if_any(const FlatSpan<Near>& span, const Near& m, const RangeOfSpan<Near>*,
                               intersect::Convention) {
    return side_of_fraction(span.at, span.d2, m, Length::parameter);
}
/// The largest entry lies after m if any entry does, and before m if all do.
std::optional<int> side_if_any(const SlabSpan<Near>& span, const Near& m, const RangeOfSpan<Near>* range,
                               intersect::Convention convention) {
    const bool is_exit =
        !(span.entry[0].n > Near(0) || span.entry[1].n > Near(0) || span.entry[2].n > Near(0)).is_yes();
    if (range || is_exit) return side_of<Near>(span, m, Length::parameter, range, convention);
    bool all_before = true;
    for (const Fraction<Near>& entry : span.entry) {
        const auto side = side_of_fraction(entry, span.d2, m, Length::parameter);
        if (side == 1) return 1;
        all_before = all_before && side == -1;
    }
    return all_before ? std::optional(-1) : std::nullopt;
}

/// A problem with its convention and range, for questions about all problems near it.
class Asked {
public:
    Asked(const Ray<double>& ray, const Solid<double>& solid, Perturbed perturbed, intersect::Convention convention,
          Range<double> range)
        : neighbours_(ray, solid, perturbed) {
        if (convention.endless) range.tmax = HUGE_VAL;
        convention_ = convention_in(range, convention.of(solid.shape));
        range.tmin = in_time(range.tmin), range.tmax = in_time(range.tmax);
        range_ = range_over<Near, double>(range);
    }

    [[nodiscard]] double in_time(double t) const { return neighbours_.in_time(t); }
    /// Result of `act(ray, solid, range, convention)` on all problems within `epsilon`; false where a matrix may be
    /// singular.
    template <class Act>
    bool of_all_within(double epsilon, const Act& act) const {
        const auto all = neighbours_.within(epsilon);
        return all_proper(all.solid) && act(all.ray, all.solid, range_ ? &*range_ : nullptr, convention_);
    }

private:
    Neighbours neighbours_;
    intersect::Convention convention_;
    std::optional<RangeOfSpan<Near>> range_;
};

}  // namespace

double decision_margin(const Ray<double>& ray, const Solid<double>& solid, Turned turned, Perturbed perturbed,
                       intersect::Convention convention, Range<double> range) {
    if (!is_proper(ray) || !is_proper(solid)) return 0;
    const Asked asked(ray, solid, perturbed, convention, range);
    std::optional<Enclosed<Near>> first;
    const auto is_the_same = [&](const auto&... problem) {
        const Enclosed<Near> found = enclose(problem...);
        if (found.hit.is_unknown()) return false;
        if (!first) first = found;
        return found.hit == first->hit && (turned == Turned::decision || found.at == first->at);
    };
    return largest([&](double epsilon) { return asked.of_all_within(epsilon, is_the_same); });
}

double backward_error(const Ray<double>& ray, const Solid<double>& solid, double t, Perturbed perturbed,
                      intersect::Convention convention, Range<double> range) {
    if (!(t > 0)) return std::nan("");
    if (!is_proper(ray) || !is_proper(solid) || std::isinf(t)) return 0;
    const Asked asked(ray, solid, perturbed, convention, range);
    const Near there(asked.in_time(t));
    return largest([&](double epsilon) {
        return asked.of_all_within(epsilon, [&](const auto& r, const auto& s, const auto* within, const auto& words) {
            const auto side =
                with_span(r, s, [&](const auto& span) { return side_if_any(span, there, within, words); });
            return side && *side != 0;
        });
    });
}

}  // namespace lostbits::measure::stability
