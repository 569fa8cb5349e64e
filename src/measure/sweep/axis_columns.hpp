// A ray and its solid at many floats of an axis, as columns: what the truth and the forms are asked.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/truth/truth_columns.hpp"
#include "scene/sweep/exhaustive_file.hpp"

namespace lostbits::measure::sweep {

class AxisColumns {
public:
    /// Room for so many floats; `file` outlives this.
    AxisColumns(const scene::sweep::ExhaustiveFile& file, std::size_t ray, std::size_t most);

    /// Moves on to other floats, at most as many as there is room for.
    void set(std::span<const float> values);
    [[nodiscard]] std::span<const float> values() const { return values_; }

    [[nodiscard]] truth::ProblemColumns<float> problems() const;
    /// The same for other floats than those that were set.
    [[nodiscard]] truth::ProblemColumns<float> problems(std::span<const float> values) const;
    /// The whole truth of float i.
    [[nodiscard]] truth::Truth find_truth(std::size_t i, const truth::ColumnTerms& terms) const;

    /// What a form answers at each float: `hit` is 0 or 1.
    void answer(const evaluate::TestedForm& row, std::span<float> t, std::span<std::uint8_t> hit);

    /// What a form is given at float i, once it has answered there.
    [[nodiscard]] Ray<float> ray_for(const evaluate::TestedForm& row, std::size_t i) const;
    [[nodiscard]] Solid<float> solid(std::size_t i) const { return file_.solid_at(values_[i]); }
    /// Whether that is another solid at each float.
    [[nodiscard]] bool solid_varies() const { return !file_.solid_places.empty(); }

private:
    void make_unit_directions();
    [[nodiscard]] std::span<const float> wide(std::size_t place, bool unit) const;
    void answer_solids(const evaluate::TestedForm& row, std::span<float> t, std::span<std::uint8_t> hit);
    void answer_one_by_one(const evaluate::TestedForm& row, std::span<float> t, std::span<std::uint8_t> hit);

    const scene::sweep::ExhaustiveFile& file_;
    std::size_t ray_;
    std::span<const float> values_;
    std::array<float, 6> ray_numbers_;  ///< what does not vary
    std::array<float, most_numbers> solid_numbers_;
    std::array<bool, 6> ray_varies_{};
    std::array<bool, most_numbers> solid_varies_{};
    std::array<std::vector<float>, 6> ray_columns_;  ///< of what does not vary, as many as there is room
    std::array<std::vector<float>, most_numbers> solid_columns_;
    std::array<std::vector<float>, 3> unit_columns_;  ///< directions of unit length, rounded to binary32
    std::vector<float> tmax_, near_, far_;
    bool units_made_ = false, direction_varies_ = false;
};

}  // namespace lostbits::measure::sweep
