// Interface between tape_program.cpp and the translation units of the register widths: plain pointers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "number/tape.hpp"

namespace lostbits::measure::tape {

/// Arithmetic of a node: a float, a double, or two of either as one number.
enum class Word : std::uint8_t { single, twice, pair, twice_pair, decision };

/// Operation on columns.
struct TapeStep {
    TapeOp op;
    Word word, from;  ///< arithmetic of the result, and of the operands that are numbers
    std::array<std::uint16_t, 3> operands;
    std::uint16_t out;
};

/// Number of rays computed together: the columns of a form stay in the first-level cache, and fill whole registers of
/// any width.
inline constexpr std::size_t together = 128;

/// Columns of `together` numbers each. A number of two words has its low words in the next column.
struct StepColumns {
    float* floats;
    double* doubles;
    bool* decisions;
    std::size_t rays;  ///< valid rays; the rest of their last register is computed too, and never read
};

/// One function a register width, each in an object of its own.
void run_steps_w128(const TapeStep* steps, std::size_t count, const StepColumns& columns);
void run_steps_w256(const TapeStep* steps, std::size_t count, const StepColumns& columns);
void run_steps_w512(const TapeStep* steps, std::size_t count, const StepColumns& columns);

}  // namespace lostbits::measure::tape
