// A problem and all problems near it: enclosures of them all, and the answer of any one of them, exactly.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "measure/stability/stability.hpp"
#include "measure/truth/side.hpp"
#include "measure/truth/truth.hpp"
#include "number/wide/affine_form.hpp"

namespace lostbits::measure::stability {

using namespace truth;

constexpr std::size_t most_inputs = 6 + most_stored;
using Near = number::wide::AffineForm<most_inputs>;

/// A change of the inputs, number i by `by` times deviation i times its size (or that of its vector). Where vectors
/// change, the deviations of each have at most length 1.
struct Change {
    Near::Deviations deviations{};
    double by = 0;
};

/// A problem, and all problems within ε of it. Its units are those in which its largest length and its largest
/// component of d are about 1; the choice of units changes no answer.
class ChangedProblems {
public:
    ChangedProblems(const Ray<double>& ray, const Primitive<double>& primitive, Perturbed perturbed)
        : ray_(ray), primitive_(primitive), is_normwise_(perturbed == Perturbed::normwise) {
        for (int i = 0; i < 3; ++i) {
            numbers_[static_cast<std::size_t>(i)] = ray.origin[i];
            numbers_[static_cast<std::size_t>(i) + 3] = ray.direction[i];
        }
        vector(Of::length, 3), vector(Of::direction, 3);
        for (const Key& key : row_of(primitive.shape).keys) {
            for (std::size_t k = 0; k < key.count(); ++k) numbers_[end_ + k] = primitive.numbers[end_ - 6 + k];
            vector(key.kind == Key::Kind::direction ? Of::nothing : Of::length, key.count());
        }
        matrix_ = end_;
        if (primitive.placed) {
            // The linear part of a matrix needs no unit: world space and object space have the same one.
            for (std::size_t k = 0; k < 12; ++k) numbers_[matrix_ + k] = primitive.placed->matrix[place_in_matrix(k)];
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
        for (std::size_t v = 0, i = 0; v < vectors_used_; ++v) {
            double squares = 0;
            for (std::size_t k = i; k < vectors_[v]; ++k) squares += numbers_[k] * numbers_[k];
            for (; i < vectors_[v]; ++i) sizes_[i] = is_normwise_ ? std::sqrt(squares) : std::fabs(numbers_[i]);
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
        Primitive<Near> primitive;
    };
    /// `from` moves the middle of the enclosures by a change.
    [[nodiscard]] All within(double epsilon, const Change& from = {}) const {
        std::array<double, most_inputs> steps{}, middle = numbers_;
        for (std::size_t i = 0; i < end_; ++i)
            steps[i] = epsilon * sizes_[i] * (1 + 0x1p-40), middle[i] += from.by * sizes_[i] * from.deviations[i];
        const Near::Vectors vectors = is_normwise_ ? Near::Vectors(vectors_).first(vectors_used_) : Near::Vectors();
        const auto number = [&](std::size_t k) { return Near(middle[k], k, steps[k], lost_[k], vectors); };
        All all{{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}},
                Primitive<Near>(primitive_.shape)};
        for (std::size_t k = 6; k < matrix_; ++k) all.primitive.numbers[k - 6] = number(k);
        if (primitive_.placed) {
            all.primitive.placed = transformed(*primitive_.placed, [](double) { return Near(0); });
            for (std::size_t k = matrix_; k < end_; ++k)
                all.primitive.placed->matrix[place_in_matrix(k - matrix_)] = number(k);
        }
        return all;
    }

    /// The amount that a change adds to each number, rounded towards 0.
    [[nodiscard]] Amounts amounts(const Change& change) const {
        Amounts by{};
        for (std::size_t i = 0; i < end_; ++i) {
            const int unit = of_[i] == Of::length ? length_ : of_[i] == Of::direction ? direction_ : 0;
            by[i] = std::ldexp(change.by * sizes_[i] * change.deviations[i] * (1 - 0x1p-40), unit);
        }
        return by;
    }
    /// Calls `act(ray, primitive)` on the problem after a change. Each number is the sum of two doubles in E. Empty
    /// where that is no proper problem.
    template <class E, class Act>
    auto changed(const Change& change, const Act& act) const -> decltype(act(Ray<E>{}, Primitive<E>{})) {
        const Amounts by = amounts(change);
        const auto moved = [&](const auto& ray, const auto& primitive, auto& to_ray, auto& to_primitive) {
            using N = std::decay_t<decltype(to_ray.origin.x)>;
            to_ray = lift_ray<N>(ray), to_primitive = lift_primitive<N>(primitive);
            const auto move = [&](N& number, std::size_t i) { number = number + N(by[i]); };
            for (std::size_t i = 0; i < 3; ++i) {
                move(to_ray.origin[static_cast<int>(i)], i);
                move(to_ray.direction[static_cast<int>(i)], i + 3);
            }
            for (std::size_t i = 6; i < matrix_; ++i) move(to_primitive.numbers[i - 6], i);
            for (std::size_t i = matrix_; i < end_; ++i)
                move(to_primitive.placed->matrix[place_in_matrix(i - matrix_)], i);
        };
        Ray<double> near_ray;
        Primitive<double> near_primitive;
        moved(ray_, primitive_, near_ray, near_primitive);
        if (!is_proper(near_ray) || !is_proper(near_primitive)) return {};
        Ray<E> to_ray;
        Primitive<E> to_primitive;
        moved(ray_, primitive_, to_ray, to_primitive);
        return act(to_ray, to_primitive);
    }
    [[nodiscard]] std::size_t count() const { return end_; }
    [[nodiscard]] bool is_normwise() const { return is_normwise_; }

private:
    enum class Of : unsigned char { nothing, length, direction };
    static constexpr int none = -5000;
    void vector(Of of, std::size_t count) {
        std::fill_n(&of_[end_], count, of);
        end_ += count;
        vectors_[vectors_used_++] = end_;
    }

    Ray<double> ray_;
    Primitive<double> primitive_;
    bool is_normwise_;
    std::array<double, most_inputs> numbers_{}, lost_{}, sizes_{};
    std::array<Of, most_inputs> of_{};
    std::array<std::size_t, most_inputs> vectors_{};
    std::size_t vectors_used_ = 0, end_ = 0, matrix_ = 0;
    int length_ = none, direction_ = none;
};

/// True if no matrix within ε is singular, so that each has a determinant of the same sign as the stored one.
bool all_proper(const Primitive<Near>& primitive) {
    if (!primitive.placed) return true;
    const Near determinant = primitive.placed->map().determinant(), zero(0);
    return (primitive.placed->orientation > 0 ? determinant > zero : determinant < zero).is_yes();
}

/// A problem with its convention and range, for questions about all problems near it.
class MarginQuestion {
public:
    MarginQuestion(const Ray<double>& ray, const Primitive<double>& primitive, Perturbed perturbed,
                   intersect::Convention convention, Range<double> range)
        : neighbours_(ray, primitive, perturbed) {
        if (convention.endless) range.tmax = HUGE_VAL;
        convention_ = convention_in(range, convention.of(primitive.shape));
        in_world_ = range;
        range.tmin = in_time(range.tmin), range.tmax = in_time(range.tmax);
        range_ = range_over<Near, double>(range);
    }

    [[nodiscard]] double in_time(double t) const { return neighbours_.in_time(t); }
    [[nodiscard]] std::size_t count() const { return neighbours_.count(); }
    [[nodiscard]] Amounts amounts(const Change& change) const { return neighbours_.amounts(change); }
    /// The share of a step that a number may take: all of it, or 1/3, so that a vector of nine has length 1 at most.
    [[nodiscard]] double share() const { return neighbours_.is_normwise() ? 1.0 / 3 : 1; }
    /// Result of `act(ray, primitive, range, convention)` on all problems within `epsilon`; false where a matrix may be
    /// singular.
    template <class Act>
    bool of_all_within(double epsilon, const Act& act, const Change& from = {}) const {
        const auto all = neighbours_.within(epsilon, from);
        return all_proper(all.primitive) && act(all.ray, all.primitive, range_ ? &*range_ : nullptr, convention_);
    }
    /// Result of `act(ray, primitive, range, convention)`, an optional, on the problem after a change, in balls or in
    /// intervals that decide; empty where none does.
    template <class Act>
    auto of_changed(const Change& change, const Act& act) const {
        return by_rising_precision([&]<class E>() {
            const auto range = range_over<E>(in_world_);
            return neighbours_.changed<E>(change, [&](const Ray<E>& ray, const Primitive<E>& primitive) {
                return act(ray, primitive, range ? &*range : nullptr, convention_);
            });
        });
    }

private:
    ChangedProblems neighbours_;
    intersect::Convention convention_;
    Range<double> in_world_;
    std::optional<RangeOfSpan<Near>> range_;
};

}  // namespace lostbits::measure::stability
