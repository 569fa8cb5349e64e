// Reads the text that spirv-dis writes as instructions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lostbits::intersect::spirv {

struct SpirvInstruction {
    std::string result;                 ///< without the %; empty if the instruction has no result
    std::string op;                     ///< "OpFAdd"
    std::vector<std::string> operands;  ///< names without the %, keywords, numbers, and strings without quotation marks
    int line = 0, column = 0;           ///< where the name of the operation stands in the text, from 1

    /// Operand k. Throws InputError if the operand is missing.
    [[nodiscard]] const std::string& at(std::size_t k) const;
    [[noreturn]] void fail(const std::string& problem) const;
};

/// Reads the instructions of an assembly. Throws InputError for any other text.
std::vector<SpirvInstruction> read_instructions(std::string_view assembly);

}  // namespace lostbits::intersect::spirv
