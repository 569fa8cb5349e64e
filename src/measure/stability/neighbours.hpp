// Encloses a problem and all problems near it, and computes the exact answer of any single one of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "measure/stability/stability.hpp"
#include "measure/truth/compare_hit.hpp"
#include "measure/truth/truth.hpp"
#include "number/wide/affine_form.hpp"

namespace lostbits::measure::stability {

using namespace truth;

constexpr std::size_t max_inputs = 6 + max_primitive_number_count;
using Near = number::wide::AffineForm<max_inputs>;

/// A change of the inputs: number i changes by `scale` times deviation i times its size (or the size of its vector).
/// If vectors change, the deviations of each vector have at most length 1.
struct InputChange {
    Near::Deviations deviations{};
    double scale = 0;
};

/// A problem, and all problems within ε of it. Its units are those in which its largest length and its largest
/// component of d are about 1; the choice of units does not change any answer.
class ChangedProblems {
public:
    ChangedProblems(const Ray<double>& ray, const Primitive<double>& primitive, Perturbation perturbation)
        : ray_(ray), primitive_(primitive), is_normwise_(perturbation == Perturbation::normwise) {
        for (int i = 0; i < 3; ++i) {
            numbers_[i] = ray.origin[i];
            numbers_[static_cast<std::size_t>(i) + 3] = ray.direction[i];
        }
        add_vector(InputUnit::length, 3), add_vector(InputUnit::direction, 3);
        for (const Key& key : row_of(primitive.shape).keys) {
            for (std::size_t k = 0; k < key.count(); ++k)
                numbers_[number_count_ + k] = primitive.numbers[number_count_ - 6 + k];
            add_vector(key.kind == Key::Kind::direction ? InputUnit::unitless : InputUnit::length, key.count());
        }
        matrix_begin_ = number_count_;
        if (primitive.transform) {
            // The linear part of a matrix needs no unit: world space and object space have the same one.
            for (std::size_t k = 0; k < 12; ++k)
                numbers_[matrix_begin_ + k] = primitive.transform->matrix[index_in_matrix(k)];
            add_vector(InputUnit::unitless, 9), add_vector(InputUnit::length, 3);
        }
        for (std::size_t i = 0; i < number_count_; ++i)
            if (units_[i] != InputUnit::unitless && numbers_[i] != 0) {
                int& exponent = units_[i] == InputUnit::length ? length_exponent_ : direction_exponent_;
                exponent = std::max(exponent, std::ilogb(numbers_[i]));
            }
        for (int* const exponent : {&length_exponent_, &direction_exponent_})
            if (*exponent == unset_exponent) *exponent = 0;
        for (std::size_t i = 0; i < number_count_; ++i) {
            const bool is_zero = numbers_[i] == 0;
            if (units_[i] != InputUnit::unitless)
                numbers_[i] =
                    std::ldexp(numbers_[i], units_[i] == InputUnit::length ? -length_exponent_ : -direction_exponent_);
            // A number that is so small relative to the largest one may underflow, and so may its step. Neither loses
            // more than 2^-900.
            if (!is_zero && std::fabs(numbers_[i]) < 0x1p-900) underflow_[i] = 0x1p-900;
        }
        for (std::size_t v = 0, i = 0; v < vector_count_; ++v) {
            double squares = 0;
            for (std::size_t k = i; k < vector_ends_[v]; ++k) squares += numbers_[k] * numbers_[k];
            for (; i < vector_ends_[v]; ++i) sizes_[i] = is_normwise_ ? std::sqrt(squares) : std::fabs(numbers_[i]);
        }
    }

    /// Converts t to the units of the problem. Infinity stays infinity. NaN, which decides nothing, if the scaling
    /// underflows.
    [[nodiscard]] double to_problem_units(double t) const {
        const double scaled = std::ldexp(t, direction_exponent_ - length_exponent_);
        return std::isinf(t) || std::ldexp(scaled, length_exponent_ - direction_exponent_) == t ? scaled : std::nan("");
    }

    /// Enclosures of every ray and primitive within ε, as long as they are proper.
    struct Enclosures {
        Ray<Near> ray;
        Primitive<Near> primitive;
    };
    /// Encloses all problems within ε of the problem after the change `start`.
    [[nodiscard]] Enclosures enclose_problems(double epsilon, const InputChange& start = {}) const {
        std::array<double, max_inputs> steps{}, middle = numbers_;
        for (std::size_t i = 0; i < number_count_; ++i) {
            steps[i] = epsilon * sizes_[i] * (1 + 0x1p-40);
            middle[i] += start.scale * sizes_[i] * start.deviations[i];
        }
        const Near::Vectors vectors = is_normwise_ ? Near::Vectors(vector_ends_).first(vector_count_) : Near::Vectors();
        const auto number = [&](std::size_t k) { return Near(middle[k], k, steps[k], underflow_[k], vectors); };
        Enclosures enclosures{{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}},
                              Primitive<Near>(primitive_.shape)};
        for (std::size_t k = 6; k < matrix_begin_; ++k) enclosures.primitive.numbers[k - 6] = number(k);
        if (primitive_.transform) {
            enclosures.primitive.transform = convert_numbers(*primitive_.transform, [](double) { return Near(0); });
            for (std::size_t k = matrix_begin_; k < number_count_; ++k)
                enclosures.primitive.transform->matrix[index_in_matrix(k - matrix_begin_)] = number(k);
        }
        return enclosures;
    }

    /// The amount that a change adds to each number, rounded towards 0.
    [[nodiscard]] Amounts amounts(const InputChange& change) const {
        Amounts added{};
        for (std::size_t i = 0; i < number_count_; ++i) {
            const int exponent = units_[i] == InputUnit::length      ? length_exponent_
                                 : units_[i] == InputUnit::direction ? direction_exponent_
                                                                     : 0;
            added[i] = std::ldexp(change.scale * sizes_[i] * change.deviations[i] * (1 - 0x1p-40), exponent);
        }
        return added;
    }
    /// Calls `act(ray, primitive)` on the problem after a change. Each number is the sum of two doubles in E. Returns
    /// an empty result if that is not a proper problem.
    template <class E, class Act>
    auto visit_changed(const InputChange& change, const Act& act) const -> decltype(act(Ray<E>{}, Primitive<E>{})) {
        const Amounts added = amounts(change);
        const auto apply_change = [&](const auto& ray, const auto& primitive, auto& to_ray, auto& to_primitive) {
            using N = std::decay_t<decltype(to_ray.origin.x)>;
            to_ray = lift_ray<N>(ray);
            to_primitive = lift_primitive<N>(primitive);
            const auto shift = [&](N& number, std::size_t i) { number = number + N(added[i]); };
            for (std::size_t i = 0; i < 3; ++i) {
                shift(to_ray.origin[static_cast<int>(i)], i);
                shift(to_ray.direction[static_cast<int>(i)], i + 3);
            }
            for (std::size_t i = 6; i < matrix_begin_; ++i) shift(to_primitive.numbers[i - 6], i);
            for (std::size_t i = matrix_begin_; i < number_count_; ++i)
                shift(to_primitive.transform->matrix[index_in_matrix(i - matrix_begin_)], i);
        };

        // Doubles are enough to tell whether the changed problem is proper.
        Ray<double> double_ray;
        Primitive<double> double_primitive;
        apply_change(ray_, primitive_, double_ray, double_primitive);
        if (!is_valid(double_ray) || !is_valid(double_primitive)) return {};

        Ray<E> to_ray;
        Primitive<E> to_primitive;
        apply_change(ray_, primitive_, to_ray, to_primitive);
        return act(to_ray, to_primitive);
    }
    [[nodiscard]] std::size_t number_count() const { return number_count_; }
    [[nodiscard]] bool is_normwise() const { return is_normwise_; }

private:
    enum class InputUnit : unsigned char { unitless, length, direction };
    static constexpr int unset_exponent = -5000;
    void add_vector(InputUnit unit, std::size_t count) {
        std::fill_n(&units_[number_count_], count, unit);
        number_count_ += count;
        vector_ends_[vector_count_++] = number_count_;
    }

    Ray<double> ray_;
    Primitive<double> primitive_;
    bool is_normwise_;
    std::array<double, max_inputs> numbers_{}, underflow_{}, sizes_{};
    std::array<InputUnit, max_inputs> units_{};
    std::array<std::size_t, max_inputs> vector_ends_{};
    std::size_t vector_count_ = 0, number_count_ = 0, matrix_begin_ = 0;
    int length_exponent_ = unset_exponent, direction_exponent_ = unset_exponent;
};

/// True if no matrix within ε is singular, so that each has a determinant of the same sign as the stored one.
bool is_always_proper(const Primitive<Near>& primitive) {
    if (!primitive.transform) return true;
    const Near determinant = primitive.transform->map().determinant(), zero(0);
    return (primitive.transform->orientation > 0 ? determinant > zero : determinant < zero).is_yes();
}

/// A problem with its convention and range, for questions about all problems near it.
class MarginQuestion {
public:
    MarginQuestion(const Ray<double>& ray, const Primitive<double>& primitive, Perturbation perturbation,
                   intersect::Convention convention, Range<double> range)
        : neighbours_(ray, primitive, perturbation) {
        if (convention.endless) range.tmax = HUGE_VAL;
        convention_ = convention_in(range, convention.for_shape(primitive.shape));
        range_in_world_ = range;
        range.tmin = to_problem_units(range.tmin);
        range.tmax = to_problem_units(range.tmax);
        range_ = range_over<Near, double>(range);
    }

    [[nodiscard]] double to_problem_units(double t) const { return neighbours_.to_problem_units(t); }
    [[nodiscard]] std::size_t number_count() const { return neighbours_.number_count(); }
    [[nodiscard]] Amounts amounts(const InputChange& change) const { return neighbours_.amounts(change); }
    /// Largest deviation that every number may take: 1, or 1/3 if vectors change, so that a vector of nine numbers has
    /// at most length 1.
    [[nodiscard]] double largest_deviation() const { return neighbours_.is_normwise() ? 1.0 / 3 : 1; }
    /// Result of `act(ray, primitive, range, convention)` on all problems within `epsilon`; false if a matrix may be
    /// singular.
    template <class Act>
    bool holds_for_all_within(double epsilon, const Act& act, const InputChange& start = {}) const {
        const auto enclosures = neighbours_.enclose_problems(epsilon, start);
        return is_always_proper(enclosures.primitive) &&
               act(enclosures.ray, enclosures.primitive, range_ ? &*range_ : nullptr, convention_);
    }
    /// Result of `act(ray, primitive, range, convention)`, an optional, on the problem after a change. It is computed
    /// in balls, and in intervals of rising precision until it is decided; empty if it is not.
    template <class Act>
    auto result_after(const InputChange& change, const Act& act) const {
        return find_at_rising_precision([&]<class E>() {
            const auto range = range_over<E>(range_in_world_);
            return neighbours_.visit_changed<E>(change, [&](const Ray<E>& ray, const Primitive<E>& primitive) {
                return act(ray, primitive, range ? &*range : nullptr, convention_);
            });
        });
    }

private:
    ChangedProblems neighbours_;
    intersect::Convention convention_;
    Range<double> range_in_world_;
    std::optional<SpanRange<Near>> range_;
};

}  // namespace lostbits::measure::stability
