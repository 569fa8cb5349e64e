#include "intersect/spirv/assembly.hpp"

#include <algorithm>

#include "number/error.hpp"

namespace lostbits::intersect::spirv {

const std::string& SpirvInstruction::at(std::size_t k) const {
    if (k >= operands.size()) fail("an operand is missing");
    return operands[k];
}

void SpirvInstruction::fail(const std::string& problem) const {
    throw InputError("the SPIR-V cannot be read: " + problem + " at " + op + (result.empty() ? "" : " %" + result) +
                     ", line " + std::to_string(line) + " of its text");
}

std::vector<SpirvInstruction> read_instructions(std::string_view text) {
    std::vector<SpirvInstruction> instructions;
    int line = 1;
    std::size_t line_begin = 0;
    SpirvInstruction current;
    const auto end_line = [&](std::size_t position) {
        if (!current.op.empty()) instructions.push_back(std::move(current));
        current = {};
        ++line;
        line_begin = position + 1;
    };

    // An instruction ends with its line.
    for (std::size_t position = 0; position < text.size();) {
        // Signs and comments between words.
        const char c = text[position];
        if (c == '\n') end_line(position++);
        else if (c == ' ' || c == '\t' || c == '\r' || c == '=') ++position;
        else if (c == ';') position = std::min(text.find('\n', position), text.size());
        else if (c == '"') {  // a string, which may have several lines
            std::string word;
            for (++position; position < text.size() && text[position] != '"'; ++position) {
                if (text[position] == '\n') {
                    ++line;
                    line_begin = position + 1;
                }
                if (text[position] == '\\' && position + 1 < text.size()) ++position;
                word += text[position];
            }
            ++position;
            current.operands.push_back(std::move(word));
        } else {  // the result, the name of the operation, or an operand
            const std::size_t begin = position;
            position = std::min(text.find_first_of(" \t\r\n", position), text.size());
            const std::string word(text.substr(begin + (c == '%' ? 1 : 0), position - begin - (c == '%' ? 1 : 0)));
            if (!current.op.empty()) current.operands.push_back(word);
            else if (c == '%') current.result = word;
            else {
                current.op = word;
                current.line = line;
                current.column = static_cast<int>(begin - line_begin) + 1;
            }
        }
    }
    end_line(text.size());
    return instructions;
}

}  // namespace lostbits::intersect::spirv
