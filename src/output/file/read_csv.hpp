// CSV files read back: RFC 4180 as other programs write it too, and what a cell says however it is written.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace lostbits::output::file {

/// One column of a table that was read.
struct CsvColumn {
    std::string name;
    std::vector<std::string_view> cells;  ///< without quoting, a row each; they point into the table's text
};

/// A CSV file in memory. Every column has the same number of cells, and no two have the same name.
struct CsvTable {
    std::string source;                 ///< the file, for messages
    std::vector<CsvColumn> columns;     ///< in the file's order
    std::vector<std::size_t> lines;     ///< the line, counted from 1, on which each row begins
    std::unique_ptr<std::string> text;  ///< what the cells point into; behind a pointer so that it stays put
    std::map<std::string, std::size_t, std::less<>> places = {};  ///< of the columns, by name

    [[nodiscard]] std::size_t rows() const { return lines.size(); }

    /// The column of that name, or nullptr.
    [[nodiscard]] const CsvColumn* find(std::string_view name) const;
};

/// The table that `text` holds: a header, then rows, with LF or CRLF, the last line with or without one; a cell may be
/// quoted and then hold commas, line breaks and doubled quotes. A byte order mark in front is skipped.
///
/// Throws InputError, with `source:line:`, where the text is no CSV: empty, a row with another number of cells than the
/// header, a quote that never closes or stands inside an unquoted cell, a column name used twice, a NUL byte.
[[nodiscard]] CsvTable parse_csv(std::string text, const std::string& source);

/// `parse_csv` of a file's contents. Throws as it does, and as `read_file` does.
[[nodiscard]] CsvTable read_csv(const std::filesystem::path& path);

/// Every byte of a file or a pipe. Throws InputError where there is no such file or it is a folder, and
/// EnvironmentError where the machine does not let us read it.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

/// What a cell says, apart from how it is written: `1e3`, `1000.0` and `0x1.f4p+9` are equal, exactly and not after
/// rounding; `-0` and `0` are not. Text is equal to nothing here: compare the cells themselves.
struct CellValue {
    enum class Kind { missing, text, nan, infinity, number };

    Kind kind = Kind::missing;
    bool negative = false;  ///< of a number or an infinity; never of NaN
    std::string digits;     ///< |number| = digits · 10^exponent, without zeros at either end; empty is zero
    int exponent = 0;

    [[nodiscard]] bool operator==(const CellValue& other) const;

    /// The nearest double of a number, with its sign.
    [[nodiscard]] double approximate() const;
};

/// Reads a decimal, a C hexadecimal float, or `nan`, `inf`, `infinity` in any case with or without a sign. Anything
/// else is text, and so is a number of more than 10000 digits, a decimal with an exponent beyond ±10000, or a
/// hexadecimal one with an exponent beyond ±1200: no format reaches there.
[[nodiscard]] CellValue read_cell(std::string_view cell);

}  // namespace lostbits::output::file
