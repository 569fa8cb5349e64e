#include "intersect/spirv/assembly.hpp"

#include <algorithm>

#include "number/error.hpp"

namespace lostbits::intersect::spirv {

const std::string& SpirvInstruction::at(std::size_t k) const {
    if (k >= operands.size()) fail("an operand is missing");
    return operands[k];
}

void SpirvInstruction::fail(const std::string& what) const {
    throw InputError("the SPIR-V cannot be read: " + what + " at " + op + (result.empty() ? "" : " %" + result) +
                     ", line " + std::to_string(line) + " of its text");
}

std::vector<SpirvInstruction> instructions_of(std::string_view text) {
    std::vector<SpirvInstruction> all;
    int line = 1;
    std::size_t line_begin = 0;
    SpirvInstruction now;
    const auto end_line = [&](std::size_t at) {
        if (!now.op.empty()) all.push_back(std::move(now));
        now = {};
        ++line, line_begin = at + 1;
    };
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        if (c == '\n') end_line(at++);
        else if (c == ' ' || c == '\t' || c == '\r' || c == '=') ++at;
        else if (c == ';') at = std::min(text.find('\n', at), text.size());
        else if (c == '"') {  // a string, which may have several lines
            std::string word;
            for (++at; at < text.size() && text[at] != '"'; ++at) {
                if (text[at] == '\n') ++line, line_begin = at + 1;
                if (text[at] == '\\' && at + 1 < text.size()) ++at;
                word += text[at];
            }
            ++at;
            now.operands.push_back(std::move(word));
        } else {
            const std::size_t begin = at;
            at = std::min(text.find_first_of(" \t\r\n", at), text.size());
            const std::string word(text.substr(begin + (c == '%' ? 1 : 0), at - begin - (c == '%' ? 1 : 0)));
            if (!now.op.empty()) now.operands.push_back(word);
            else if (c == '%') now.result = word;
            else now.op = word, now.line = line, now.column = static_cast<int>(begin - line_begin) + 1;
        }
    }
    end_line(text.size());
    return all;
}

}  // namespace lostbits::intersect::spirv
