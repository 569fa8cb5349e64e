// Reads CSV text, and the exact values of its cells.
#include "output/file/read_csv.hpp"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>

#include "number/error.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/files_of_run.hpp"
#include "scene/toml/former_names.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::file {
namespace {

/// Reads CSV text once, from front to back. The parser replaces doubled quotes by single ones in place, so that each
/// cell is one contiguous part of the text.
class Parser {
public:
    Parser(std::string& text, const std::string& file_name) : text_(text), file_name_(file_name) {}

    bool is_at_end() const { return position_ == text_.size(); }
    std::size_t line() const { return line_; }
    void skip_byte_order_mark() {
        if (text_.starts_with("\xEF\xBB\xBF")) position_ = 3;  // spreadsheets write this mark
    }

    /// Reads the cells of a row and moves past its end.
    void read_row(std::vector<std::string_view>& cells) {
        cells.clear();
        do {
            const std::string_view cell =
                position_ < text_.size() && text_[position_] == '"' ? read_quoted_cell() : read_plain_cell();
            cells.push_back(scene::toml::current_name(cell));
        } while (skip_comma());
        if (is_at_end()) return;
        if (text_[position_] == '\r') ++position_;
        ++position_;
        ++line_;
    }

    [[noreturn]] void fail(std::size_t line, const std::string& problem) const {
        throw InputError(file_name_ + ":" + std::to_string(line) + ": " + problem);
    }

private:
    bool is_row_end() const {
        return is_at_end() || text_[position_] == '\n' ||
               (text_[position_] == '\r' && position_ + 1 < text_.size() && text_[position_ + 1] == '\n');
    }
    bool skip_comma() {
        const bool is_comma = position_ < text_.size() && text_[position_] == ',';
        position_ += is_comma;
        return is_comma;
    }

    std::string_view read_plain_cell() {
        const std::size_t cell_begin = position_;
        for (; !is_row_end() && text_[position_] != ','; ++position_) {
            const char c = text_[position_];
            if (c == '"')
                fail(line_,
                     "is not a CSV file: a quote inside an unquoted cell; quote the whole cell and double the quotes "
                     "in it");
            if (c == '\r')
                fail(line_, "is not a CSV file: a carriage return without a line feed; end lines with LF or CRLF");
            if (c == '\0') fail(line_, "is not a CSV file: a NUL byte; give a text file");
        }
        return {text_.data() + cell_begin, position_ - cell_begin};
    }

    std::string_view read_quoted_cell() {
        const std::size_t first_line = line_, cell_begin = ++position_;
        std::size_t cell_end = cell_begin;
        for (;; ++position_) {
            if (is_at_end())
                fail(first_line,
                     "is not a CSV file: a quoted cell that never ends; close it with a quote, and double the quotes "
                     "inside");
            if (text_[position_] == '"' && (++position_ == text_.size() || text_[position_] != '"')) break;
            if (text_[position_] == '\0') fail(line_, "is not a CSV file: a NUL byte; give a text file");
            line_ += text_[position_] == '\n';
            text_[cell_end++] = text_[position_];
        }
        if (!is_row_end() && text_[position_] != ',')
            fail(line_, "is not a CSV file: text after a closing quote; double the quotes inside a quoted cell");
        return {text_.data() + cell_begin, cell_end - cell_begin};
    }

    std::string& text_;
    const std::string& file_name_;
    std::size_t position_ = 0, line_ = 1;
};

/// Removes the first character of `text` if it is one of `allowed`. Returns false if it is not.
bool skip_one_of(std::string_view& text, std::string_view allowed) {
    if (text.empty() || allowed.find(text.front()) == std::string_view::npos) return false;
    text.remove_prefix(1);
    return true;
}

/// Moves the digits at the beginning of `text` to the end of `digits`. Returns their number.
std::size_t move_digits(std::string_view& text, std::string& digits, std::string_view allowed) {
    const std::size_t count = std::min(text.find_first_not_of(allowed), text.size());
    digits += text.substr(0, count);
    text.remove_prefix(count);
    return count;
}

/// Reads an unsigned number, as digits and an exponent. Its grammar is digits* ('.' digits*)? (mark sign? decimal+)?.
/// After the mark e, the value is digits · 10^exponent; after the mark p, the digits are hexadecimal and the value is
/// digits · 2^exponent. Returns false for any other text, for too many digits, and for an exponent out of range.
bool parse_digits(std::string_view text, bool is_hexadecimal, std::string& digits, int& exponent) {
    constexpr int max_digits = 10000;
    // 2^-1200 has 839 decimal digits. 2^-10000 would have 6990, from a cell of ten letters.
    const int max_exponent = is_hexadecimal ? 1200 : max_digits;
    const std::string_view allowed = is_hexadecimal ? "0123456789abcdefABCDEF" : "0123456789";

    move_digits(text, digits, allowed);
    const std::size_t fraction_digits = skip_one_of(text, ".") ? move_digits(text, digits, allowed) : 0;
    if (digits.empty() || digits.size() > max_digits) return false;

    if (skip_one_of(text, is_hexadecimal ? "pP" : "eE")) {
        const bool has_plus = skip_one_of(text, "+");
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
        if (error != std::errc{} || (has_plus && text.front() == '-')) return false;
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    }
    if (!text.empty() || exponent > max_exponent || exponent < -max_exponent) return false;
    exponent -= static_cast<int>(fraction_digits) * (is_hexadecimal ? 4 : 1);
    return true;
}

/// Replaces hexadecimal digits and a binary exponent by decimal ones without rounding. For exponent < 0, digits ·
/// 2^exponent = digits · 5^-exponent · 10^exponent.
void convert_to_decimal(std::string& digits, int& exponent) {
    using boost::multiprecision::cpp_int;
    cpp_int n("0x" + digits);
    if (exponent >= 0) n <<= exponent;
    else n *= boost::multiprecision::pow(cpp_int(5), static_cast<unsigned>(-exponent));
    digits = n.str();
    exponent = std::min(exponent, 0);
}

}  // namespace

const CsvColumn* CsvTable::find(std::string_view name) const {
    const auto entry = column_indices.find(name);
    return entry == column_indices.end() ? nullptr : &columns[entry->second];
}

CsvTable parse_csv(std::string text, const std::string& file_name) {
    CsvTable table{file_name, {}, {}, std::make_unique<std::string>(std::move(text))};
    Parser parser(*table.text, file_name);
    parser.skip_byte_order_mark();
    if (parser.is_at_end()) parser.fail(1, "is not a CSV file: it is empty; a CSV file begins with a header");

    std::vector<std::string_view> cells;
    parser.read_row(cells);
    for (const std::string_view name : cells) {
        if (!table.column_indices.emplace(name, table.columns.size()).second)
            parser.fail(1, "the column \"" + std::string(name) + "\" appears twice; rename one");
        table.columns.push_back({std::string(name), {}});
    }

    while (!parser.is_at_end()) {
        const std::size_t line = parser.line();
        parser.read_row(cells);
        if (cells.size() != table.columns.size()) {
            parser.fail(line, "is not a CSV file: " + text::count_with_noun(cells.size(), "cell") +
                                  " where the header has " + std::to_string(table.columns.size()) +
                                  "; quote cells that contain commas");
        }
        table.lines.push_back(line);
        for (std::size_t c = 0; c < cells.size(); ++c) table.columns[c].cells.push_back(cells[c]);
    }
    return table;
}

CsvTable read_csv(const std::filesystem::path& path) {
    scene::toml::reserve_for_reading(path);
    return parse_csv(read_file(path), path.string());
}

std::string read_file(const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) throw InputError(path.string() + ": is a folder; give a file");

    errno = 0;
    std::ifstream stream(path, std::ios::binary);
    std::string text;
    std::array<char, 65536> chunk;
    while (stream) {
        stream.read(chunk.data(), chunk.size());
        text.append(chunk.data(), static_cast<std::size_t>(stream.gcount()));
    }
    if (stream.is_open() && !stream.bad()) return text;

    const std::string message = path.string() + ": cannot read: " + std::strerror(errno);
    if (errno == ENOENT || errno == ENOTDIR || errno == ELOOP || errno == ENAMETOOLONG)
        throw InputError(message + "; give an existing file");
    throw EnvironmentError(message + "; check the permissions");
}

bool CellValue::operator==(const CellValue& other) const {
    return kind == other.kind && kind != Kind::text && is_negative == other.is_negative && digits == other.digits &&
           exponent == other.exponent;
}

double CellValue::to_double() const {
    const double magnitude = nearest_double(digits.empty() ? "0" : digits, exponent);
    return is_negative ? -magnitude : magnitude;
}

CellValue read_cell(std::string_view cell) {
    using enum CellValue::Kind;
    if (cell.empty()) return {};

    // Names of values that are not finite, in any case.
    const bool is_negative = cell.front() == '-';
    skip_one_of(cell, "+-");
    std::string prefix(cell.substr(0, 9));
    for (char& c : prefix) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (prefix == "nan") return {nan, false, {}, 0};
    if (prefix == "inf" || prefix == "infinity") return {infinity, is_negative, {}, 0};

    CellValue value{number, is_negative, {}, 0};
    const bool is_hexadecimal = prefix.starts_with("0x");
    if (is_hexadecimal) cell.remove_prefix(2);
    if (!parse_digits(cell, is_hexadecimal, value.digits, value.exponent)) return {text, false, {}, 0};
    if (is_hexadecimal) convert_to_decimal(value.digits, value.exponent);

    // Removes zeros at both ends, so that equal numbers have equal digits.
    const std::size_t last_nonzero = value.digits.find_last_not_of('0');
    if (last_nonzero == std::string::npos) return {number, is_negative, {}, 0};
    value.exponent += static_cast<int>(value.digits.size() - 1 - last_nonzero);
    value.digits.erase(last_nonzero + 1);
    value.digits.erase(0, value.digits.find_first_not_of('0'));
    return value;
}

}  // namespace lostbits::output::file
