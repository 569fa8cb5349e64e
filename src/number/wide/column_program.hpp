// A program over columns of doubles: operations in the order in which they were recorded, each on whole columns.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace lostbits::number::wide {

/// Operation of an instruction. A number is a column of words, a decision a column of masks. A bounded number is two or
/// three columns: its one or two words and its bound (`Running`).
enum class ColumnOperation : std::uint8_t {
    // on words
    add,
    subtract,
    multiply,
    divide,
    negate,
    absolute,
    largest,
    power_below,  ///< 2^⌊log2⌋
    choose,       ///< mask, a, b
    less,
    at_most,
    // on masks
    both,
    either,
    opposite,
    // on bounded numbers
    sum,
    difference,
    product,
    squared,
    product_difference,
    product_sum,
    square_sum,
    quotient,
    root,
    is_less,     ///< yes, no
    is_at_most,  ///< yes, no
    // on several words: the operations of a whole step
    order_of_first_words,  ///< x, y, least: less yes, no, at most yes, no
    near_root_of_quartic,  ///< coefficients of x⁴, x², x, 1, begin, bound
    /// Produces no number. If its mask is unset in every lane, no number recorded after it is needed.
    gate,
};
inline constexpr std::size_t column_operations = static_cast<std::size_t>(ColumnOperation::gate) + 1;

inline constexpr bool is_of_masks(ColumnOperation operation) {
    return operation == ColumnOperation::both || operation == ColumnOperation::either ||
           operation == ColumnOperation::opposite;
}

/// Number of bounded operands; 0 for operations on words and masks.
inline constexpr std::size_t bounded_operands(ColumnOperation operation) {
    using enum ColumnOperation;
    switch (operation) {
        case squared:
        case root: return 1;
        case sum:
        case difference:
        case product:
        case quotient:
        case is_less:
        case is_at_most: return 2;
        case square_sum: return 3;
        case product_difference: return 4;
        case product_sum: return 6;
        default: return 0;
    }
}

/// Numbers of columns that an operation on words or masks reads and writes.
inline constexpr std::size_t word_columns(ColumnOperation operation) {
    using enum ColumnOperation;
    switch (operation) {
        case negate:
        case absolute:
        case power_below:
        case opposite: return 2;
        case choose: return 4;
        case order_of_first_words:
        case near_root_of_quartic: return 7;
        default: return 3;
    }
}

/// Selects, for an operation on bounded numbers, the largest set of exact operands that has a kernel of its own. For
/// two operands every choice has a kernel. For a cross or dot product there are kernels for exact first factors, exact
/// second factors, or all, since rays and primitives as given are exact.
inline constexpr unsigned known_exact(unsigned exact, std::size_t operands) {
    const unsigned all = (1U << operands) - 1, firsts = 0b010101U & all, seconds = 0b101010U & all;
    if (operands <= 2 || exact == all) return exact;
    if (operands == 3) return 0;
    return (exact & firsts) == firsts ? firsts : (exact & seconds) == seconds ? seconds : 0;
}

/// A column of a program. Those below 0 are constants: `constant_at`.
using ColumnIndex = std::int16_t;

/// One step of a program: the columns that it reads and writes. For bounded numbers, bit k of `exact` means that
/// operand k is one word without a bound, so that only one column of it is read. Otherwise all its words and its bound
/// are read.
struct ColumnInstruction {
    static constexpr std::size_t most_in = 18, most_out = 4;

    ColumnOperation operation{};
    std::uint8_t exact = 0, ins = 0, outs = 0;
    std::array<ColumnIndex, most_in> in{};
    std::array<ColumnIndex, most_out> out{};
};

/// Instructions over columns of inputs and of constants, which compute all requested numbers.
struct ColumnProgram {
    int words = 1;           ///< words of a bounded number
    std::size_t inputs = 0;  ///< columns 0 to inputs − 1
    std::size_t columns = 0;
    std::vector<double> constants;  ///< constants of the columns −1, −2, …
    std::vector<ColumnInstruction> instructions;
    std::vector<ColumnIndex> outputs;

    [[nodiscard]] double constant_at(ColumnIndex place) const {
        return constants[static_cast<std::size_t>(-1 - place)];
    }
};

/// Writes a program: operations recorded in its lifetime, by its thread, become instructions of it. An operation that
/// was already recorded with the same operands is not recorded again.
class ColumnRecorder {
public:
    ColumnRecorder(int words, std::size_t inputs);
    ~ColumnRecorder();
    ColumnRecorder(const ColumnRecorder&) = delete;
    ColumnRecorder& operator=(const ColumnRecorder&) = delete;

    static ColumnRecorder& current();

    ColumnIndex constant(double x);
    [[nodiscard]] double constant_at(ColumnIndex place) const { return program_.constant_at(place); }
    /// Columns of the results of the operation.
    std::array<ColumnIndex, ColumnInstruction::most_out> record(ColumnInstruction step);
    /// The finished program with these outputs; the recorder is empty afterwards.
    ColumnProgram finish(std::vector<ColumnIndex> outputs);

private:
    using Key = std::array<std::int32_t, 2 + ColumnInstruction::most_in>;

    ColumnProgram program_;
    std::map<std::uint64_t, ColumnIndex> constants_;  ///< by their bits
    std::map<Key, std::array<ColumnIndex, ColumnInstruction::most_out>> known_;
    ColumnRecorder* before_;
};

}  // namespace lostbits::number::wide
