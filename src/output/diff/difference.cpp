#include "output/diff/difference.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>

#include "number/error.hpp"

namespace lostbits::output::diff {

using file::CellValue;

Tolerance parse_tolerance(const std::string& text) {
    const auto equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0) {
        throw InputError(fmt::format(
            "--tolerance {}: is not a tolerance; write COLUMN=ABS or COLUMN=ABS,REL, as in lost_bits=0.5", text));
    }
    const std::string numbers = text.substr(equals + 1);
    const auto comma = numbers.find(',');
    const auto read = [&text](const std::string& word) {
        const CellValue value = file::read_cell(word);
        if (value.kind == CellValue::Kind::number && !value.negative) return value;
        throw InputError(fmt::format(
            "--tolerance {}: \"{}\" is not a finite number of at least 0; write one, or use --ignore for the column",
            text, word));
    };
    return {text.substr(0, equals), read(numbers.substr(0, comma)),
            comma == std::string::npos ? read("0") : read(numbers.substr(comma + 1))};
}

bool names_column(const std::string& pattern, const std::string& name) {
    return pattern == name || fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

Comparison compare_bytes(std::string_view a, std::string_view b) {
    Comparison result;
    if (a == b) return result;
    const auto at = std::ranges::mismatch(a, b).in1 - a.begin();
    const auto line = static_cast<std::size_t>(std::count(a.begin(), a.begin() + at, '\n')) + 1;
    result.count = 1;
    result.differences.push_back(
        {line, fmt::format("bytes differ from byte {} on; {} != {} bytes in all", at, a.size(), b.size())});
    return result;
}

}  // namespace lostbits::output::diff
