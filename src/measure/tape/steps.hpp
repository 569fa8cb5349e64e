// Interface between tape_program.cpp and the translation units of the register widths: plain pointers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "number/tape.hpp"

namespace lostbits::measure::tape {

/// Arithmetic of a node: one float, one double, or a pair of either as one number. A decision is a bool.
enum class NodeArithmetic : std::uint8_t { one_float, one_double, float_pair, double_pair, decision };

/// One operation on columns.
struct TapeStep {
    TapeOp op;
    NodeArithmetic arithmetic, operand_arithmetic;  ///< arithmetic of the result, and of the operands that are numbers
    std::array<std::uint16_t, 3> operands;
    std::uint16_t out;
};

/// Number of rays in a batch. The columns of a form for a batch fit in the first-level cache, and fill whole registers
/// of any width.
inline constexpr std::size_t rays_per_batch = 128;

/// Columns of `rays_per_batch` numbers each. A pair has its low words in the next column.
struct StepColumns {
    float* floats;
    double* doubles;
    bool* decisions;
    /// Number of valid rays; the other lanes of their last register are computed too, but never read.
    std::size_t rays;
};

/// One function for each register width, each in its own object.
void run_steps_w128(const TapeStep* steps, std::size_t count, const StepColumns& columns);
void run_steps_w256(const TapeStep* steps, std::size_t count, const StepColumns& columns);
void run_steps_w512(const TapeStep* steps, std::size_t count, const StepColumns& columns);

}  // namespace lostbits::measure::tape
