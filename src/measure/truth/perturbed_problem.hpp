// Problems whose inputs have errors, as functions of their numbers; reach.cpp bounds how far their answers move.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>

#include "measure/truth/reach.hpp"
#include "number/bounded.hpp"
#include "number/dual.hpp"
#include "number/real.hpp"
#include "shapes/bounding_box.hpp"

namespace lostbits::measure::truth {

/// Factor that covers the roundings of a bound itself, a few dozen u.
inline constexpr double rounding_factor = 1 + 0x1p-40;
/// Factor that covers the roundings of a bound computed from lengths of vectors, with margin.
inline constexpr double length_rounding_factor = 1 + 0x1p-30;
inline constexpr double unbounded = std::numeric_limits<double>::infinity();
inline constexpr int exponent_of_zero = -1000000;
/// Largest loss of a product that underflows.
inline constexpr double underflow_loss = std::numeric_limits<double>::denorm_min();

/// Number with a bound of its error.
using BoundedDouble = Bounded<double>;
/// Number with its derivatives by all inputs of a problem of any shape.
using DualNumber = Dual<BoundedDouble, 6 + max_primitive_number_count>;

inline double scaled(double x, int e) { return e == 0 ? x : std::ldexp(x, e); }
inline double scaled(const Real& x, int e) { return Real(ldexp(x, e)).convert_to<double>(); }
inline int binary_exponent(double x) { return x == 0 ? exponent_of_zero : std::ilogb(x); }
inline int binary_exponent(const Real& x) {
    int e = 0;
    if (x != 0) static_cast<void>(frexp(x, &e));
    return x == 0 ? exponent_of_zero : e - 1;
}

/// √Σx² over the numbers [first, end), also if their squares underflow.
inline double length_of(std::span<const double> x, std::size_t first, std::size_t end) {
    double largest = 0, squares = 0;
    for (std::size_t i = first; i < end; ++i) largest = std::max(largest, std::fabs(x[i]));
    const int e = std::clamp(binary_exponent(largest), -1000, 1000);
    for (std::size_t i = first; i < end; ++i) squares += std::ldexp(x[i], -e) * std::ldexp(x[i], -e);
    return std::ldexp(std::sqrt(squares), e);
}

/// Interval of all values that a number may have.
struct ValueInterval {
    double low, high;

    explicit ValueInterval(const BoundedDouble& x)
        : low(std::nextafter(x.value() - x.error(), -unbounded)),
          high(std::nextafter(x.value() + x.error(), unbounded)) {}
    /// Largest and least absolute values in the interval.
    [[nodiscard]] double largest_magnitude() const { return std::max(std::fabs(low), std::fabs(high)); }
    [[nodiscard]] double min_magnitude() const { return std::max({0.0, low, -high}); }
    void extend(const ValueInterval& x) {
        low = std::min(low, x.low);
        high = std::max(high, x.high);
    }
};

/// Numbers of a problem (of the origin, the direction, the primitive and its matrix) and the error bound of each. Each
/// number is divided by its unit, a power of two (`UnitKind`), so the largest numbers are about 1 and nothing
/// overflows. The bounds include the losses of small numbers to underflow.
class ProblemNumbers {
public:
    template <class S>
    ProblemNumbers(const Ray<S>& ray, const Primitive<S>& primitive, const FloatFormat& format,
                   Perturbation perturbation, Length length)
        : matrix_begin_(primitive_begin + row_of(primitive.shape).number_count),
          count_(matrix_begin_ + (primitive.transform ? Affine<S>::number_count : 0)),
          shape_(primitive.shape),
          is_normwise_(perturbation == Perturbation::normwise),
          is_distance_(length == Length::distance) {
        const auto exact_number = [&](std::size_t i) {
            return i < direction_begin   ? ray.origin[static_cast<int>(i)]
                   : i < primitive_begin ? ray.direction[static_cast<int>(i - direction_begin)]
                   : i < matrix_begin_   ? primitive.numbers[i - primitive_begin]
                                         : primitive.transform->matrix[index_in_matrix(i - matrix_begin_)];
        };
        if (primitive.transform) transform_ = convert_numbers(*primitive.transform, [](const S&) { return 0; });
        for_each_key(shape_, [&](const Key& key, std::size_t k) {
            std::fill_n(&is_direction_[primitive_begin + k], key.count(), key.kind == Key::Kind::direction);
        });

        choose_units(exact_number, format);
        scale_numbers<S>(exact_number);
        bound_errors(exact_number, format);
    }

    [[nodiscard]] bool has_transform() const { return transform_.has_value(); }
    [[nodiscard]] Shape shape() const { return shape_; }
    /// Number i with the largest error that it may have.
    [[nodiscard]] BoundedDouble perturbed(std::size_t i) const { return {numbers_[i], total_error_[i]}; }
    /// Number i as it is stored, without an error of the input. The bound is 0 if a double holds the number in its
    /// unit. If the number underflows to 0 in its unit, the bound is above 0.
    [[nodiscard]] BoundedDouble stored(std::size_t i) const { return {numbers_[i], rounding_error_[i]}; }
    /// log2 of the unit of t, or of the distance.
    [[nodiscard]] int unit_exponent() const {
        return is_distance_ ? unit(UnitKind::length) : unit(UnitKind::length) - unit(UnitKind::direction);
    }
    /// t, or the distance, in its unit.
    [[nodiscard]] BoundedDouble in_units(const CertifiedNumber& t) const {
        const auto e = std::clamp<std::int64_t>(t.exponent - unit_exponent(), -5000, 5000);
        const double value = std::ldexp(t.hi, static_cast<int>(e));
        return BoundedDouble(value, t.is_zero() ? 0 : std::fabs(value) * 0x1p-51 + underflow_loss);
    }

    /// Bound of |f(x') − f(x)|: Σ hᵢ |∂f/∂xᵢ|, each derivative the largest within the errors (the mean value theorem);
    /// for vectors, Σ hᵥ |∇ᵥ f|.
    [[nodiscard]] double bound_change(const DualNumber& f) const {
        std::array<double, capacity> movements;
        for (std::size_t i = 0; i < count_; ++i) {
            const double steepest = ValueInterval(f.derivative(i)).largest_magnitude();
            movements[i] = steepest == 0 ? 0 : input_error_[i] * steepest + underflow_loss;
        }
        double sum = 0;
        if (!is_normwise_)
            for (std::size_t i = 0; i < count_; ++i) sum += movements[i];
        else for_each_vector([&](std::size_t first, std::size_t end) { sum += length_of(movements, first, end); });
        return sum * rounding_factor;
    }

    /// Bound of how far f(x') may lie beyond 0, seen from f(x). If t is a root of f, this bounds |f(x')|. If f(x) is
    /// not 0 (the range begins at t, or the ray meets another face), only the part beyond 0 can move t, and the bound
    /// is often 0. Returns the smaller of two bounds: `bound_change`, and the part of the enclosure of f(x') beyond 0.
    [[nodiscard]] double bound_at_root(const DualNumber& f) const {
        const BoundedDouble& enclosure = f.value();
        return std::min(bound_change(f),
                        std::max(0.0, enclosure.error() * rounding_factor - std::fabs(enclosure.value())));
    }

    /// Bound of |t' − t| by a ball that holds the primitive. The ray meets the primitive at X = o + t d, and with
    /// errors at X' = o' + t' d'. So |X' − X| is at most the diameter of the ball plus the distance by which the
    /// errors move the primitive:
    ///
    ///     |t' − t| (|d| − |Δd|) ≤ |X' − X| + |Δo| + |t| |Δd|
    ///
    /// For distances d is replaced by e = d/|d|, where |e| = 1 and |Δe| ≤ 2|Δd|/(2|d| − |Δd|) (Dunkl and Williams, A
    /// simple norm inequality, 1964).
    [[nodiscard]] double ball_bound(const BoundedDouble& t) const {
        if (transform_ || !has_bounding_box(shape_)) return unbounded;
        Primitive<double> untransformed(shape_);
        std::copy_n(numbers_.begin() + primitive_begin, untransformed.shape_numbers().size(),
                    untransformed.numbers.begin());
        // Covers the roundings of a radius, and what its squares lose to underflow.
        double largest_separation =
            2 * ball_around(untransformed).radius + 0x1p-48 * length_of(numbers_, primitive_begin, count_) + 0x1p-500;
        for_each_vector([&](std::size_t first, std::size_t end) {
            if (first != direction_begin) largest_separation += length_of(input_error_, first, end);
        });

        const double direction_error = length_of(input_error_, direction_begin, primitive_begin);
        const double d = length_of(numbers_, direction_begin, primitive_begin) - direction_error;
        if (!(d > 0)) return unbounded;
        const double unit_direction_error =
            is_distance_ ? 2 * direction_error / (2 * d + direction_error) : direction_error;
        return (largest_separation + std::fabs(t.value()) * unit_direction_error) * length_rounding_factor /
               (is_distance_ ? 1 : d);
    }

protected:
    /// Indices of the first numbers of the direction and the primitive; those of the origin come first.
    static constexpr std::size_t direction_begin = 3, primitive_begin = 6;
    std::size_t matrix_begin_, count_;         ///< index of the first number of the matrix; count of all numbers
    std::optional<Transform<int>> transform_;  ///< kind of the matrix, without its numbers
    [[nodiscard]] bool is_distance() const { return is_distance_; }

private:
    static constexpr std::size_t capacity = primitive_begin + max_primitive_number_count;
    static constexpr std::size_t linear_part_size = 9;  ///< numbers of a matrix before its translation

    /// Units of the numbers.
    enum class UnitKind : std::uint8_t {
        length,         ///< lengths of the world, and those of a primitive without a matrix
        direction,      ///< components of the ray's direction
        object_length,  ///< lengths of a transformed primitive
        linear_part,    ///< numbers of the matrix before its translation: unit of the result's lengths / the source's
        object_direction,  ///< directions of the primitive
    };
    static constexpr std::size_t unit_kind_count = 5;

    [[nodiscard]] UnitKind unit_kind(std::size_t i) const {
        if (i >= direction_begin && i < primitive_begin) return UnitKind::direction;
        if (i >= primitive_begin && i < matrix_begin_ && is_direction_[i]) return UnitKind::object_direction;
        if (!transform_ || i < direction_begin) return UnitKind::length;
        if (i < matrix_begin_) return UnitKind::object_length;
        if (i < matrix_begin_ + linear_part_size) return UnitKind::linear_part;
        return transform_->is_inverse ? UnitKind::object_length : UnitKind::length;
    }
    [[nodiscard]] int& unit(UnitKind kind) { return units_[static_cast<std::size_t>(kind)]; }
    [[nodiscard]] int unit(UnitKind kind) const { return units_[static_cast<std::size_t>(kind)]; }
    [[nodiscard]] int unit_of(std::size_t i) const { return unit(unit_kind(i)); }

    /// Sets each unit to the exponent of the largest number that has it. Without a matrix, units near 1 are 1, and the
    /// unit of zeros is 2^emin.
    template <class Number>
    void choose_units(const Number& exact_number, const FloatFormat& format) {
        units_.fill(exponent_of_zero);
        for (std::size_t i = 0; i < count_; ++i) {
            int& exponent = unit(unit_kind(i));
            exponent = std::max(exponent, binary_exponent(exact_number(i)));
        }
        if (transform_) {
            set_units_of_matrix();
            return;
        }
        for (const UnitKind kind : {UnitKind::length, UnitKind::direction}) {
            int& exponent = unit(kind);
            exponent = std::abs(exponent) < 32 ? 0 : std::max(exponent, format.emin);
        }
    }
    /// Divides each number by its unit. S is the type of the stored numbers.
    template <class S, class Number>
    void scale_numbers(const Number& exact_number) {
        for (std::size_t i = 0; i < count_; ++i) {
            numbers_[i] = scaled(exact_number(i), -unit_of(i));
            if (S(ldexp(S(numbers_[i]), unit_of(i))) != exact_number(i))
                rounding_error_[i] = std::fabs(numbers_[i]) * 0x1p-53 + underflow_loss;
        }
    }
    /// Bounds the error of each input, by its own size or by that of its vector, and the total error.
    template <class Number>
    void bound_errors(const Number& exact_number, const FloatFormat& format) {
        for (std::size_t i = 0; i < count_; ++i) {
            const int exponent = std::max(binary_exponent(exact_number(i)), format.emin);
            input_error_[i] = scaled(1, exponent - format.precision - unit_of(i)) + underflow_loss;
        }
        if (is_normwise_)
            for_each_vector([&](std::size_t first, std::size_t end) {
                std::fill(&input_error_[first], &input_error_[first] + (end - first),
                          scaled(length_of(numbers_, first, end), -format.precision) + underflow_loss);
            });
        for (std::size_t i = 0; i < count_; ++i)
            total_error_[i] = (input_error_[i] + rounding_error_[i]) * rounding_factor + underflow_loss;
    }
    /// Sets the units of a matrix. A point x' of the primitive is at A x' + τ in the world, or the inverse holds, so
    /// the unit of A is the quotient of both units. If A is larger than this quotient, the unit of its result grows.
    void set_units_of_matrix() {
        const bool is_inverse = transform_->is_inverse;
        int& result = unit(is_inverse ? UnitKind::object_length : UnitKind::length);
        int& source = unit(is_inverse ? UnitKind::length : UnitKind::object_length);
        int& linear = unit(UnitKind::linear_part);
        source = std::max(source, -1000);  // if all numbers are zeros
        result = std::max(result, linear + source);
        linear = result - source;
    }
    /// Calls `act(first, end)` for the indices of each vector and each length.
    template <class Act>
    void for_each_vector(const Act& act) const {
        act(0, direction_begin);
        act(direction_begin, primitive_begin);
        for_each_key(shape_, [&](const Key& key, std::size_t k) {
            act(primitive_begin + k, primitive_begin + k + key.count());
        });
        if (!transform_) return;
        act(matrix_begin_, matrix_begin_ + linear_part_size);
        act(matrix_begin_ + linear_part_size, count_);
    }

    Shape shape_;
    bool is_normwise_, is_distance_;
    std::array<int, unit_kind_count> units_;
    std::array<bool, capacity> is_direction_{};
    std::array<double, capacity> numbers_, input_error_, total_error_, rounding_error_{};
};

/// A problem as a function of its numbers: f(ray, primitive) encloses f(x') for any x' within the errors. For distances
/// the direction is d/|d|, also a function of its numbers, so that t is the distance.
class PerturbedProblem : public ProblemNumbers {
    template <class Number>
    static auto make_ray(const Number& number) {
        using T = decltype(number(0));
        return Ray<T>{Vec<T>(number(0), number(1), number(2)), Vec<T>(number(3), number(4), number(5))};
    }
    /// Sets the numbers of a primitive and its matrix to what `number` returns for their indices.
    template <class T, class Number>
    void fill_primitive(Primitive<T>& target, const Number& number) const {
        for (std::size_t i = primitive_begin; i < matrix_begin_; ++i) target.numbers[i - primitive_begin] = number(i);
        if (!transform_) return;
        target.transform = convert_numbers(*transform_, [](int) { return T(0); });
        for (std::size_t i = matrix_begin_; i < count_; ++i)
            target.transform->matrix[index_in_matrix(i - matrix_begin_)] = number(i);
    }

public:
    Ray<DualNumber> ray;
    Primitive<DualNumber> primitive;

    explicit PerturbedProblem(const ProblemNumbers& numbers) : ProblemNumbers(numbers), primitive(numbers.shape()) {
        const auto number = [&](std::size_t i) { return DualNumber::input(perturbed(i), i, count_); };
        ray = make_ray(number);
        fill_primitive(primitive, number);
        if (!is_distance()) return;
        const DualNumber length = sqrt(square(ray.direction));
        ray.direction = {ray.direction.x / length, ray.direction.y / length, ray.direction.z / length};
    }

    /// Calls `act(shape, ray)` in object space, with a ray that starts at the point at t.
    template <class Act>
    [[nodiscard]] auto in_object_space_from(const BoundedDouble& t, const Act& act) const {
        const Ray<DualNumber> moved_ray{ray.origin + DualNumber(t) * ray.direction, ray.direction};
        return visit_shape(primitive, [&]<template <class> class Of>() {
            return visit_in_object_space<Of>(moved_ray, primitive, act);
        });
    }
    /// Calls `act(shape, ray)` in object space with the problem as it is stored.
    template <class Act>
    [[nodiscard]] auto in_object_space_as_stored(const Act& act) const {
        const auto number = [&](std::size_t i) { return stored(i); };
        const Ray<BoundedDouble> stored_ray = make_ray(number);
        Primitive<BoundedDouble> stored_primitive(shape());
        fill_primitive(stored_primitive, number);
        return visit_shape(stored_primitive, [&]<template <class> class Of>() {
            return visit_in_object_space<Of>(stored_ray, stored_primitive, act);
        });
    }
};

}  // namespace lostbits::measure::truth
