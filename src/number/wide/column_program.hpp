// A program over columns of doubles: a list of operations in the order of their recording, each on whole columns.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace lostbits::number::wide {

/// Operation of an instruction. Numbers are stored as columns of words, decisions as columns of masks. A bounded number
/// has two or three columns: its one or two words and its bound (`RunningError`).
enum class ColumnOperation : std::uint8_t {
    // on words
    add,
    subtract,
    multiply,
    divide,
    negate,
    absolute,
    maximum,
    power_at_most,  ///< 2^⌊log2⌋
    choose,         ///< mask, a, b -> a where the mask is set, b elsewhere
    less,
    at_most,
    // on masks
    mask_and,
    mask_or,
    mask_not,
    // on bounded numbers
    bounded_add,
    bounded_subtract,
    bounded_multiply,
    bounded_square,
    bounded_product_difference,
    bounded_product_sum,
    bounded_square_sum,
    bounded_divide,
    bounded_root,
    bounded_less,     ///< a, b -> yes, no
    bounded_at_most,  ///< a, b -> yes, no
    // operations of a whole step of a formula, on several words
    order_of_first_words,   ///< x, y, least -> less yes, less no, at most yes, at most no
    first_root_of_quartic,  ///< coefficients of x⁴, x², x and 1, begin, bound -> root
    /// Has no result. If its mask is unset in every lane, the rest of the program need not run.
    gate,
};
inline constexpr std::size_t column_operation_count = static_cast<std::size_t>(ColumnOperation::gate) + 1;

inline constexpr bool acts_on_masks(ColumnOperation operation) {
    return operation == ColumnOperation::mask_and || operation == ColumnOperation::mask_or ||
           operation == ColumnOperation::mask_not;
}

/// Number of bounded operands; 0 for operations on words and masks.
inline constexpr std::size_t bounded_operand_count(ColumnOperation operation) {
    using enum ColumnOperation;
    switch (operation) {
        case bounded_square:
        case bounded_root: return 1;
        case bounded_add:
        case bounded_subtract:
        case bounded_multiply:
        case bounded_divide:
        case bounded_less:
        case bounded_at_most: return 2;
        case bounded_square_sum: return 3;
        case bounded_product_difference: return 4;
        case bounded_product_sum: return 6;
        default: return 0;
    }
}

/// Number of columns that an operation on words or masks reads and writes, together.
inline constexpr std::size_t column_count_of(ColumnOperation operation) {
    using enum ColumnOperation;
    switch (operation) {
        case negate:
        case absolute:
        case power_at_most:
        case mask_not: return 2;
        case choose: return 4;
        case order_of_first_words:
        case first_root_of_quartic: return 7;
        default: return 3;
    }
}

/// Returns the largest subset of the exact operands for which a kernel exists. For two operands every subset has a
/// kernel. For three operands there are kernels for none exact and for all exact. A cross or dot product has two more:
/// for exact first factors and for exact second factors, since rays and primitives as given are exact.
inline constexpr unsigned exact_operands_with_kernel(unsigned exact, std::size_t operand_count) {
    const unsigned all = (1U << operand_count) - 1, first_factors = 0b010101U & all, second_factors = 0b101010U & all;
    if (operand_count <= 2 || exact == all) return exact;
    if (operand_count == 3) return 0;
    return (exact & first_factors) == first_factors     ? first_factors
           : (exact & second_factors) == second_factors ? second_factors
                                                        : 0;
}

/// Index of a column of a program. An index below 0 is that of a constant (`constant_at`).
using ColumnIndex = std::int16_t;

/// One instruction of a program, with the columns that it reads and writes. For bounded numbers, bit k of `exact` means
/// that operand k is one word without a bound, so that only one column of it is read. Otherwise all its words and its
/// bound are read.
struct ColumnInstruction {
    static constexpr std::size_t max_inputs = 18, max_outputs = 4;

    ColumnOperation operation{};
    std::uint8_t exact = 0, input_count = 0, output_count = 0;
    std::array<ColumnIndex, max_inputs> in{};
    std::array<ColumnIndex, max_outputs> out{};
};

/// Computes the outputs from columns of inputs and constants.
struct ColumnProgram {
    int words_per_number = 1;     ///< words of a bounded number
    std::size_t input_count = 0;  ///< inputs are the columns 0 to input_count − 1
    std::size_t column_count = 0;
    std::vector<double> constants;  ///< constants of the columns −1, −2, …
    std::vector<ColumnInstruction> instructions;
    std::vector<ColumnIndex> outputs;

    [[nodiscard]] double constant_at(ColumnIndex index) const { return constants[-1 - index]; }
};

/// Writes a program. While a recorder lives, operations on its thread become instructions. An operation with the same
/// operands as an earlier one is not recorded again.
class ColumnRecorder {
public:
    ColumnRecorder(int words_per_number, std::size_t input_count);
    ~ColumnRecorder();
    ColumnRecorder(const ColumnRecorder&) = delete;
    ColumnRecorder& operator=(const ColumnRecorder&) = delete;

    static ColumnRecorder& current();

    ColumnIndex constant(double x);
    [[nodiscard]] double constant_at(ColumnIndex index) const { return program_.constant_at(index); }
    /// Records an instruction and returns the columns of its results.
    std::array<ColumnIndex, ColumnInstruction::max_outputs> record(ColumnInstruction instruction);
    /// Returns the finished program with these outputs. The recorder is empty afterwards.
    ColumnProgram finish(std::vector<ColumnIndex> outputs);

private:
    using Key = std::array<std::int32_t, 2 + ColumnInstruction::max_inputs>;

    ColumnProgram program_;
    std::map<std::uint64_t, ColumnIndex> constants_;  ///< indexed by the bits of the constants
    std::map<Key, std::array<ColumnIndex, ColumnInstruction::max_outputs>> results_;
    ColumnRecorder* previous_;
};

}  // namespace lostbits::number::wide
