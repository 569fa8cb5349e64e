// What tape_program.cpp and the translation units of the register widths say to each other: plain pointers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "number/tape.hpp"

namespace lostbits::measure::tape {

/// What a node is computed in: a float, a double, or two of either as one number.
enum class Word : std::uint8_t { single, twice, pair, twice_pair, decision };

/// An operation on columns.
struct TapeStep {
    TapeOp op;
    Word word, from;  ///< of the result, and of the operands that are numbers
    std::array<std::uint16_t, 3> operands;
    std::uint16_t out;
};

/// Rays at a time: the columns of a form stay in the first-level cache. Whole registers of any width.
inline constexpr std::size_t together = 128;

/// Columns of `together` each; of two words the low ones are the next column.
struct StepColumns {
    float* floats;
    double* doubles;
    bool* decisions;
    std::size_t rays;  ///< at hand; what lies behind them in a register is computed, too, and nobody reads it
};

/// One function a register width, each in an object of its own.
void run_steps_w128(const TapeStep* steps, std::size_t count, const StepColumns& columns);
void run_steps_w256(const TapeStep* steps, std::size_t count, const StepColumns& columns);
void run_steps_w512(const TapeStep* steps, std::size_t count, const StepColumns& columns);

}  // namespace lostbits::measure::tape
