// A program over columns of doubles: operations in the order in which they were recorded, each on whole columns.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace lostbits::number::wide {

/// What an instruction does. A number is a column of words, a decision one of masks; a bounded number is two columns or
/// three: its one or two words and its bound (`Running`).
enum class ColumnOperation : std::uint8_t {
    // of words
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
    // of masks
    both,
    either,
    opposite,
    // of bounded numbers
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
    // of several words: the operations of a whole step
    order_of_first_words,  ///< x, y, least: less yes, no, at most yes, no
    near_root_of_quartic,  ///< coefficients of x⁴, x², x, 1, begin, bound
    /// No number: where its mask is unset in every lane, no number that is recorded behind it is wanted.
    gate,
};
inline constexpr std::size_t column_operations = static_cast<std::size_t>(ColumnOperation::gate) + 1;

inline constexpr bool is_of_masks(ColumnOperation operation) {
    return operation == ColumnOperation::both || operation == ColumnOperation::either ||
           operation == ColumnOperation::opposite;
}

/// How many bounded numbers it takes; 0 of those of words and masks.
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

/// How many columns an operation of words or masks takes and gives.
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

/// The operands of which an operation on bounded numbers has a kernel that knows them to be exact: of those that are,
/// the most. Of two every choice has one; of a cross or dot product the first or second factors, or all, since rays and
/// solids as they are given are exact.
inline constexpr unsigned known_exact(unsigned exact, std::size_t operands) {
    const unsigned all = (1U << operands) - 1, firsts = 0b010101U & all, seconds = 0b101010U & all;
    if (operands <= 2 || exact == all) return exact;
    if (operands == 3) return 0;
    return (exact & firsts) == firsts ? firsts : (exact & seconds) == seconds ? seconds : 0;
}

/// A column of a program. Those below 0 are constants: `constant_at`.
using ColumnPlace = std::int16_t;

/// One step of a program: the places of what it takes and gives. Of bounded numbers bit k of `exact` says that operand
/// k is one word without a bound, so that one place is read of it; else all its words and its bound.
struct ColumnInstruction {
    static constexpr std::size_t most_in = 18, most_out = 4;

    ColumnOperation operation{};
    std::uint8_t exact = 0, ins = 0, outs = 0;
    std::array<ColumnPlace, most_in> in{};
    std::array<ColumnPlace, most_out> out{};
};

/// Instructions over columns of inputs and of constants, which give every number that was asked of them.
struct ColumnProgram {
    int words = 1;           ///< of a bounded number
    std::size_t inputs = 0;  ///< columns 0 to inputs − 1
    std::size_t columns = 0;
    std::vector<double> constants;  ///< of the places −1, −2, …
    std::vector<ColumnInstruction> instructions;
    std::vector<ColumnPlace> outputs;

    [[nodiscard]] double constant_at(ColumnPlace place) const {
        return constants[static_cast<std::size_t>(-1 - place)];
    }
};

/// Writes a program: what is recorded in its life, in its thread, becomes instructions of it. What was recorded before
/// with the same operands is not recorded again.
class ColumnRecorder {
public:
    ColumnRecorder(int words, std::size_t inputs);
    ~ColumnRecorder();
    ColumnRecorder(const ColumnRecorder&) = delete;
    ColumnRecorder& operator=(const ColumnRecorder&) = delete;

    static ColumnRecorder& current();

    ColumnPlace constant(double x);
    [[nodiscard]] double constant_at(ColumnPlace place) const { return program_.constant_at(place); }
    /// The places of what the operation gives.
    std::array<ColumnPlace, ColumnInstruction::most_out> record(ColumnInstruction step);
    /// The program, of which the outputs are wanted and nothing else is left.
    ColumnProgram finish(std::vector<ColumnPlace> outputs);

private:
    using Key = std::array<std::int32_t, 2 + ColumnInstruction::most_in>;

    ColumnProgram program_;
    std::map<std::uint64_t, ColumnPlace> constants_;  ///< by their bits
    std::map<Key, std::array<ColumnPlace, ColumnInstruction::most_out>> known_;
    ColumnRecorder* before_;
};

}  // namespace lostbits::number::wide
