#include "output/file/csv.hpp"

#include <algorithm>
#include <boost/locale/utf.hpp>
#include <charconv>
#include <stdexcept>
#include <unordered_set>

#include "output/file/number_text.hpp"

namespace lostbits::output::file {
namespace {

template <class... F>
struct Overloaded : F... {
    using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

/// True for a decimal or a C hexadecimal float, with or without a sign.
bool is_number(std::string_view text) {
    if (text.starts_with('+') || text.starts_with('-')) text.remove_prefix(1);
    const bool is_hexadecimal = text.starts_with("0x");
    if (is_hexadecimal) text.remove_prefix(2);
    double value = 0;
    const auto format = is_hexadecimal ? std::chars_format::hex : std::chars_format::general;
    const char* const end = text.data() + text.size();
    return !text.empty() && text.front() != '-' && std::from_chars(text.data(), end, value, format).ptr == end;
}

/// True if a spreadsheet would evaluate the text as a formula. Formulas of numbers alone (`+2^127`) do no harm and are
/// allowed.
bool is_formula(std::string_view text) {
    if (text.size() < 2 || std::string_view("=+-@\t\r").find(text.front()) == std::string_view::npos) return false;
    return text.find_first_not_of("0123456789.^+-*/ ") != std::string_view::npos && !is_number(text);
}

}  // namespace

Character first_character(std::string_view text) {
    const char *const begin = text.data(), *next = begin;
    const boost::locale::utf::code_point code = boost::locale::utf::utf_traits<char>::decode(next, begin + text.size());
    // An illegal or incomplete sequence has a code beyond all characters.
    return code > 0x10FFFF ? Character{0xFFFD, 0} : Character{code, static_cast<std::size_t>(next - begin)};
}

std::string to_valid_utf8(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    while (!text.empty()) {
        const std::size_t size = first_character(text).size;
        out += size == 0 ? "\xEF\xBF\xBD" : text.substr(0, size);
        text.remove_prefix(std::max<std::size_t>(size, 1));
    }
    return out;
}

std::string escape_formula(std::string_view text) { return (is_formula(text) ? "'" : "") + to_valid_utf8(text); }

std::string quoted_field(std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"') out += '"';
        out += c;
    }
    return out + '"';
}

std::string Cell::text() const {
    return std::visit(
        Overloaded{[](std::monostate) { return std::string(); }, [](bool b) { return std::string(b ? "1" : "0"); },
                   [](std::int64_t i) { return std::to_string(i); }, [](std::uint64_t i) { return std::to_string(i); },
                   [](float f) { return decimal(f); }, [](double d) { return decimal(d); },
                   [](const std::string& s) { return escape_formula(s); }},
        value_);
}

double Cell::number() const {
    return std::visit(
        Overloaded{[](std::monostate) { return std::nan(""); }, [](const std::string&) { return std::nan(""); },
                   [](auto x) { return static_cast<double>(x); }},
        value_);
}

bool Cell::fits(std::string_view type) const {
    return std::visit(Overloaded{[](std::monostate) { return true; }, [&](bool) { return type == "boolean"; },
                                 [&](std::int64_t) { return type == "integer" || type == "number"; },
                                 [&](std::uint64_t) { return type == "integer" || type == "number"; },
                                 [&](float) { return type == "number"; }, [&](double) { return type == "number"; },
                                 [&](const std::string&) { return type == "string"; }},
                      value_);
}

CsvWriter::CsvWriter(const std::filesystem::path& path, std::vector<Column> columns)
    : columns_(std::move(columns)), file_(std::in_place, path) {
    if (columns_.empty()) throw std::logic_error(path.string() + ": a CSV without columns");
    std::unordered_set<std::string> names;
    for (const auto& column : columns_) {
        if (column.type != "string" && column.type != "integer" && column.type != "number" &&
            column.type != "boolean") {
            throw std::logic_error("column " + column.name + ": unknown type \"" + column.type + "\"");
        }
        if (!names.insert(column.name).second) {
            throw std::logic_error("column " + column.name + " appears twice");
        }
        append_field(column.name);
    }
    end_row();
}

void CsvWriter::add_lines(std::string_view lines) {
    if (filled_cells_ != 0) throw std::logic_error(name() + ": lines come in the middle of a row");
    file_->write(lines);
}

void CsvWriter::append_field(const std::string& text) {
    if (filled_cells_ > 0) line_ += ',';
    line_ += quoted_field(text);
    ++filled_cells_;
}

CsvWriter& CsvWriter::add(const Cell& cell) {
    if (filled_cells_ == columns_.size()) {
        throw std::logic_error(name() + ": a row has more cells than columns");
    }
    const Column& column = columns_[filled_cells_];
    if (!cell.fits(column.type)) {
        throw std::logic_error(name() + ": column " + column.name + " is of type " + column.type +
                               " and cannot hold \"" + cell.text() + "\"");
    }
    if (receive_cell_) receive_cell_(filled_cells_++, cell);
    else append_field(cell.text());
    return *this;
}

void CsvWriter::end_row() {
    if (filled_cells_ != columns_.size()) {
        throw std::logic_error(name() + ": a row has " + std::to_string(filled_cells_) + " cells for " +
                               std::to_string(columns_.size()) + " columns");
    }
    if (receive_cell_) {
        filled_cells_ = 0;
        return;
    }

    // A row of one missing cell would be a blank line, which readers skip.
    if (line_.empty()) line_ = "\"\"";
    line_ += '\n';
    if (file_) file_->write(line_);
    else finished_lines_ += line_;
    line_.clear();
    filled_cells_ = 0;
}

void CsvWriter::close() {
    if (filled_cells_ != 0) throw std::logic_error(name() + ": closed in the middle of a row");
    file_->commit();
}

}  // namespace lostbits::output::file
