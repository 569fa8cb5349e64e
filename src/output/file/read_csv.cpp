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
#include "scene/toml/counted.hpp"
#include "scene/toml/files_of_run.hpp"
#include "scene/toml/former_names.hpp"

namespace lostbits::output::file {
namespace {

/// Goes over the text once. It replaces doubled quotes by single ones in place, so that each cell is one piece of the
/// text.
class Parser {
public:
    Parser(std::string& text, const std::string& source) : text_(text), source_(source) {}

    bool at_end() const { return at_ == text_.size(); }
    std::size_t line() const { return line_; }
    void skip_byte_order_mark() {
        if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // spreadsheets write it
    }

    /// Reads the cells of a row and moves past its end.
    void row(std::vector<std::string_view>& cells) {
        cells.clear();
        do {
            const std::string_view cell = at_ < text_.size() && text_[at_] == '"' ? quoted() : plain();
            cells.push_back(scene::toml::current_name(cell));
        } while (comma());
        if (at_end()) return;
        if (text_[at_] == '\r') ++at_;
        ++at_;
        ++line_;
    }

    [[noreturn]] void fail(std::size_t line, const std::string& what) const {
        throw InputError(source_ + ":" + std::to_string(line) + ": " + what);
    }

private:
    bool ends_row() const {
        return at_end() || text_[at_] == '\n' ||
               (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n');
    }
    bool comma() {
        const bool is = at_ < text_.size() && text_[at_] == ',';
        at_ += is;
        return is;
    }

    std::string_view plain() {
        const std::size_t begin = at_;
        for (; !ends_row() && text_[at_] != ','; ++at_) {
            const char c = text_[at_];
            if (c == '"')
                fail(line_,
                     "is not a CSV file: a quote inside an unquoted cell; quote the whole cell and double the quotes "
                     "in it");
            if (c == '\r')
                fail(line_, "is not a CSV file: a carriage return without a line feed; end lines with LF or CRLF");
            if (c == '\0') fail(line_, "is not a CSV file: a NUL byte; give a text file");
        }
        return {text_.data() + begin, at_ - begin};
    }

    std::string_view quoted() {
        const std::size_t opened = line_, begin = ++at_;
        std::size_t end = begin;
        for (;; ++at_) {
            if (at_end())
                fail(opened,
                     "is not a CSV file: a quoted cell that never ends; close it with a quote, and double the quotes "
                     "inside");
            if (text_[at_] == '"' && (++at_ == text_.size() || text_[at_] != '"')) break;
            if (text_[at_] == '\0') fail(line_, "is not a CSV file: a NUL byte; give a text file");
            line_ += text_[at_] == '\n';
            text_[end++] = text_[at_];
        }
        if (!ends_row() && text_[at_] != ',')
            fail(line_, "is not a CSV file: text after a closing quote; double the quotes inside a quoted cell");
        return {text_.data() + begin, end - begin};
    }

    std::string& text_;
    const std::string& source_;
    std::size_t at_ = 0, line_ = 1;
};

bool take(std::string_view& text, std::string_view any_of_these) {
    if (text.empty() || any_of_these.find(text.front()) == std::string_view::npos) return false;
    text.remove_prefix(1);
    return true;
}

/// Moves the digits at the beginning of `text` to `digits` and returns their number.
std::size_t take_digits(std::string_view& text, std::string& digits, std::string_view allowed) {
    const std::size_t n = std::min(text.find_first_not_of(allowed), text.size());
    digits += text.substr(0, n);
    text.remove_prefix(n);
    return n;
}

/// Reads digits* ('.' digits*)? (mark sign? decimal+)? as digits and an exponent: the value is the digits times
/// 10^exponent, or 2^exponent for hexadecimal digits.
bool scan(std::string_view text, bool hexadecimal, std::string& digits, int& exponent) {
    constexpr int most = 10000;
    // 2^-1200 has 839 decimal digits. 2^-10000 would have 6990, from a cell of ten letters.
    const int most_power = hexadecimal ? 1200 : most;
    const std::string_view allowed = hexadecimal ? "0123456789abcdefABCDEF" : "0123456789";
    take_digits(text, digits, allowed);
    const std::size_t fraction = take(text, ".") ? take_digits(text, digits, allowed) : 0;
    if (digits.empty() || digits.size() > most) return false;
    if (take(text, hexadecimal ? "pP" : "eE")) {
        const bool plus = take(text, "+");
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
        if (error != std::errc{} || (plus && text.front() == '-')) return false;
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    }
    if (!text.empty() || exponent > most_power || exponent < -most_power) return false;
    exponent -= static_cast<int>(fraction) * (hexadecimal ? 4 : 1);
    return true;
}

/// Converts m · 2^e to n · 10^f exactly: 2^e = 5^-e · 10^e.
void to_decimal(std::string& digits, int& exponent) {
    using boost::multiprecision::cpp_int;
    cpp_int n("0x" + digits);
    if (exponent >= 0) n <<= exponent;
    else n *= boost::multiprecision::pow(cpp_int(5), static_cast<unsigned>(-exponent));
    digits = n.str();
    exponent = std::min(exponent, 0);
}

}  // namespace

const CsvColumn* CsvTable::find(std::string_view name) const {
    const auto found = places.find(name);
    return found == places.end() ? nullptr : &columns[found->second];
}

CsvTable parse_csv(std::string text, const std::string& source) {
    CsvTable table{source, {}, {}, std::make_unique<std::string>(std::move(text))};
    Parser parser(*table.text, source);
    parser.skip_byte_order_mark();
    if (parser.at_end()) parser.fail(1, "is not a CSV file: it is empty; a CSV file begins with a header");
    std::vector<std::string_view> cells;
    parser.row(cells);
    for (const std::string_view name : cells) {
        if (!table.places.emplace(name, table.columns.size()).second)
            parser.fail(1, "the column \"" + std::string(name) + "\" appears twice; rename one");
        table.columns.push_back({std::string(name), {}});
    }
    while (!parser.at_end()) {
        const std::size_t line = parser.line();
        parser.row(cells);
        if (cells.size() != table.columns.size()) {
            parser.fail(line, "is not a CSV file: " + scene::toml::counted(cells.size(), "cell") +
                                  " where the header has " + std::to_string(table.columns.size()) +
                                  "; quote cells that contain commas");
        }
        table.lines.push_back(line);
        for (std::size_t c = 0; c < cells.size(); ++c) table.columns[c].cells.push_back(cells[c]);
    }
    return table;
}

CsvTable read_csv(const std::filesystem::path& path) {
    scene::toml::note_read(path);
    return parse_csv(read_file(path), path.string());
}

std::string read_file(const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) throw InputError(path.string() + ": is a folder; give a file");
    errno = 0;
    std::ifstream in(path, std::ios::binary);
    std::string text;
    std::array<char, 65536> chunk;
    while (in) {
        in.read(chunk.data(), chunk.size());
        text.append(chunk.data(), static_cast<std::size_t>(in.gcount()));
    }
    if (in.is_open() && !in.bad()) return text;
    const std::string what = path.string() + ": cannot read: " + std::strerror(errno);
    if (errno == ENOENT || errno == ENOTDIR || errno == ELOOP || errno == ENAMETOOLONG)
        throw InputError(what + "; give an existing file");
    throw EnvironmentError(what + "; check the permissions");
}

bool CellValue::operator==(const CellValue& other) const {
    return kind == other.kind && kind != Kind::text && negative == other.negative && digits == other.digits &&
           exponent == other.exponent;
}

double CellValue::approximate() const {
    const double size = nearest_double(digits.empty() ? "0" : digits, exponent);
    return negative ? -size : size;
}

CellValue read_cell(std::string_view cell) {
    using enum CellValue::Kind;
    if (cell.empty()) return {};
    const bool negative = cell.front() == '-';
    take(cell, "+-");
    std::string word(cell.substr(0, 9));
    for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (word == "nan") return {nan, false, {}, 0};
    if (word == "inf" || word == "infinity") return {infinity, negative, {}, 0};

    CellValue value{number, negative, {}, 0};
    const bool hexadecimal = word.starts_with("0x");
    if (hexadecimal) cell.remove_prefix(2);
    if (!scan(cell, hexadecimal, value.digits, value.exponent)) return {text, false, {}, 0};
    if (hexadecimal) to_decimal(value.digits, value.exponent);
    const std::size_t last = value.digits.find_last_not_of('0');
    if (last == std::string::npos) return {number, negative, {}, 0};
    value.exponent += static_cast<int>(value.digits.size() - 1 - last);
    value.digits.erase(last + 1);
    value.digits.erase(0, value.digits.find_first_not_of('0'));
    return value;
}

}  // namespace lostbits::output::file
