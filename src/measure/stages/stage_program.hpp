// A shape's stage as a program: its span and where a ray meets it first, recorded once for what a batch has in common.
#pragma once

#include <compare>

#include "measure/stages/raw_stages.hpp"
#include "number/wide/column_program.hpp"
#include "shapes/solid.hpp"

namespace lostbits::measure::stages {

/// The columns of a batch as inputs of a program: which number of `RawProblems` each is.
inline constexpr std::size_t input_of_ray = 0, input_of_solid = 6, input_of_ray_low = input_of_solid + most_stored,
                             input_of_solid_low = input_of_ray_low + 6,
                             input_of_tmin = input_of_solid_low + most_stored, input_of_tmax = input_of_tmin + 1,
                             stage_inputs = input_of_tmax + 1;
/// The outputs: two decisions, then t* and t* |d|, two words and a bound each; of a length that is not asked for 0.
inline constexpr std::size_t output_settled = 0, output_hit = 1, output_t = 2, output_distance = 5;

/// What all problems of a batch have in common, as far as their program depends on it.
struct StageTerms {
    Shape shape;
    int words;       ///< of the arithmetic: 1 or 2
    bool two_words;  ///< of each input
    UnderMatrix matrix;
    bool ranged;
    OpenEnds open;
    bool t, distance;  ///< which of the lengths are asked for

    friend auto operator<=>(const StageTerms&, const StageTerms&) = default;
};

number::wide::ColumnProgram record_stage(const StageTerms& terms);

}  // namespace lostbits::measure::stages
