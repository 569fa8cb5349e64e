// A ray and its primitive at many floats of an axis, as columns: the inputs of the truth and of the forms.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "measure/answer/outcome.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/truth/truth_columns.hpp"
#include "scene/sweep/exhaustive_file.hpp"

namespace lostbits::measure::sweep {

class AxisColumns {
public:
    /// Allocates buffers for `capacity` floats; `file` must outlive this object.
    AxisColumns(const scene::sweep::ExhaustiveFile& file, std::size_t ray, std::size_t capacity);

    /// Replaces the floats by other floats, at most `capacity` of them.
    void set_values(std::span<const float> values);
    [[nodiscard]] std::span<const float> values() const { return values_; }

    [[nodiscard]] truth::ProblemColumns<float> problems() const;
    /// Problems at these floats, which may be other floats than those that were set.
    [[nodiscard]] truth::ProblemColumns<float> problems(std::span<const float> values) const;
    /// Complete truth of float i.
    [[nodiscard]] truth::Truth find_truth(std::size_t i, const truth::TruthOptions& options) const;

    /// Writes the answers of a form at each float; each `hit` is 0 or 1.
    void answer(const evaluate::TestedForm& tested_form, std::span<float> t, std::span<std::uint8_t> hit);

    /// Ray that a form receives at float i; valid after the form has answered there.
    [[nodiscard]] Ray<float> ray_for(const evaluate::TestedForm& tested_form, std::size_t i) const;
    [[nodiscard]] Primitive<float> primitive(std::size_t i) const { return file_.primitive_at(values_[i]); }
    /// True if the primitive differs from float to float.
    [[nodiscard]] bool primitive_varies() const { return !file_.primitive_indices.empty(); }

private:
    void make_unit_directions();
    void make_primitives();
    [[nodiscard]] std::span<const float> ray_column(std::size_t component, bool is_unit) const;
    void answer_primitives(const evaluate::TestedForm& tested_form, const intersect::table::RayBatch<float>& rays,
                           const intersect::table::HitBatch<float>& hits);

    const scene::sweep::ExhaustiveFile& file_;
    std::size_t ray_;
    std::span<const float> values_;
    std::array<float, 6> ray_numbers_;  ///< numbers that do not vary
    std::array<float, max_number_count> primitive_numbers_;
    std::array<bool, 6> ray_varies_{};
    std::array<bool, max_number_count> primitive_varies_{};
    std::array<std::vector<float>, 6> ray_columns_;  ///< a number that does not vary fills its whole column
    std::array<std::vector<float>, max_number_count> primitive_columns_;
    std::array<std::vector<float>, 3> unit_columns_;  ///< directions of unit length, rounded to binary32
    std::vector<float> tmax_, near_, far_;
    std::vector<Primitive<float>> primitives_;  ///< one per float, for forms without a kernel for many primitives
    bool has_unit_directions_ = false, has_primitives_ = false, direction_varies_ = false;
};

/// Bounds of the errors of one form at the floats of some columns.
class UlpColumns {
public:
    using Outcomes = std::array<std::uint64_t, answer::single_primitive_outcome_count>;

    UlpColumns(const AxisColumns& columns, const truth::TruthOptions& options) : columns_(columns), options_(options) {}
    /// Compares the answers of a form with the truth of the same floats.
    void compare(std::span<const float> t, std::span<const std::uint8_t> hit, const truth::TruthColumns& truth);

    [[nodiscard]] std::size_t size() const { return outcome_.size(); }
    [[nodiscard]] const Outcomes& counts() const { return counts_; }
    [[nodiscard]] answer::Outcome outcome(std::size_t i) const { return static_cast<answer::Outcome>(outcome_[i]); }

    /// Bounds of |ulp error| at floats where form and truth hit; elsewhere both are −1.
    [[nodiscard]] double lower_bound(std::size_t i) const { return low_[i]; }
    [[nodiscard]] double upper_bound(std::size_t i) const { return high_[i]; }
    /// Largest value of each bound, −1 for none.
    [[nodiscard]] double largest_lower_bound() const { return largest_low_; }
    [[nodiscard]] double largest_upper_bound() const { return largest_high_; }

    /// Narrows both bounds to 2^-48 of themselves if packed truths are accurate enough. Form and truth must hit at
    /// these floats.
    void refine(std::span<const std::size_t> indices);
    /// Signed error by the complete truth of float i, as `lostbits explain` reports it.
    [[nodiscard]] double find_exact_error(std::size_t i);

private:
    void classify(std::span<const std::uint8_t> hit, const truth::TruthColumns& truth);
    void set_exact_error(std::size_t i, double ulps);

    const AxisColumns& columns_;
    truth::TruthOptions options_;
    std::span<const float> t_;
    std::vector<std::uint8_t> outcome_;
    std::vector<double> low_, high_;
    Outcomes counts_{};
    double largest_low_ = -1, largest_high_ = -1;
    truth::TruthColumns refined_truths_;  ///< truths of `refine`
};

}  // namespace lostbits::measure::sweep
