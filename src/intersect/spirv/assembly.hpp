// The text that spirv-dis writes, as instructions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lostbits::intersect::spirv {

struct SpirvInstruction {
    std::string result;                 ///< without the %; empty if it has none
    std::string op;                     ///< "OpFAdd"
    std::vector<std::string> operands;  ///< names without the %, words, numbers, strings without quotation marks
    int line = 0, column = 0;           ///< of the name of the operation in the text, from 1

    /// Operand k. InputError if it is missing.
    [[nodiscard]] const std::string& at(std::size_t k) const;
    [[noreturn]] void fail(const std::string& what) const;
};

/// Throws InputError for a text that is not such an assembly.
std::vector<SpirvInstruction> instructions_of(std::string_view assembly);

}  // namespace lostbits::intersect::spirv
