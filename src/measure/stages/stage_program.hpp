// Records the stage of a shape as a column program, which computes the span of the shape and the first t at which a ray
// meets it. A program is recorded once for all batches with the same `StageKey`.
#pragma once

#include <compare>

#include "measure/stages/raw_stages.hpp"
#include "number/wide/column_program.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::stages {

/// Indices of the inputs of a program, which are the columns of a batch (`RawProblems`).
inline constexpr std::size_t input_of_ray = 0, input_of_primitive = 6,
                             input_of_ray_low = input_of_primitive + max_primitive_number_count,
                             input_of_primitive_low = input_of_ray_low + 6,
                             input_of_tmin = input_of_primitive_low + max_primitive_number_count,
                             input_of_tmax = input_of_tmin + 1, stage_input_count = input_of_tmax + 1;
/// Outputs: two decisions, then t* and t* |d|, each with two words and a bound. A length that is not requested is 0.
inline constexpr std::size_t output_settled = 0, output_hit = 1, output_t = 2, output_distance = 5;

/// Properties that all problems of a batch have in common, as far as their program depends on them.
struct StageKey {
    Shape shape;
    int words;       ///< number of words of each computed number: 1 or 2
    bool two_words;  ///< true if each input has two words
    MatrixKind matrix;
    bool has_ranges;
    OpenEnds open_ends;
    bool wants_t, wants_distance;

    friend auto operator<=>(const StageKey&, const StageKey&) = default;
};

number::wide::ColumnProgram record_stage(const StageKey& key);

}  // namespace lostbits::measure::stages
