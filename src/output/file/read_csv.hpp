// Reads CSV files (RFC 4180, with the variations of other programs), and the values of their cells.
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
    std::vector<std::string_view> cells;  ///< one per row, without quotes; they point into the table's text
};

/// A CSV file in memory. Every column has the same number of cells, and no two have the same name.
struct CsvTable {
    std::string source;                 ///< the file, for messages
    std::vector<CsvColumn> columns;     ///< in the file's order
    std::vector<std::size_t> lines;     ///< the line, counted from 1, on which each row begins
    std::unique_ptr<std::string> text;  ///< the text that the cells point into; stays in place when the table moves
    std::map<std::string, std::size_t, std::less<>> column_indices = {};  ///< index of each column, by name

    [[nodiscard]] std::size_t rows() const { return lines.size(); }

    /// The column of this name; null if the file has no such column.
    [[nodiscard]] const CsvColumn* find(std::string_view name) const;
};

/// Reads the table in `text`: a header, then rows. Lines end with LF or CRLF; the last line may end without either. A
/// quoted cell may hold commas, line breaks and doubled quotes. A byte order mark at the beginning is skipped.
///
/// Throws InputError, with `file_name:line:`, if the text is not CSV:
/// - it is empty, or has a NUL byte;
/// - a row has another number of cells than the header;
/// - a quote never closes, or is inside an unquoted cell;
/// - a column name occurs twice.
[[nodiscard]] CsvTable parse_csv(std::string text, const std::string& file_name);

/// Reads a file with `read_file` and `parse_csv`, and throws as they do.
[[nodiscard]] CsvTable read_csv(const std::filesystem::path& path);

/// All bytes of a file or a pipe. Throws InputError if there is no such file or it is a folder, and EnvironmentError if
/// it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

/// Exact value of a cell, independent of its notation: `1e3`, `1000.0` and `0x1.f4p+9` are equal; `-0` and `0` are not.
/// A value of kind text equals nothing; compare the cells themselves.
struct CellValue {
    enum class Kind { missing, text, nan, infinity, number };

    Kind kind = Kind::missing;
    bool is_negative = false;  ///< sign of a number or an infinity; NaN has none
    std::string digits;        ///< |number| = digits · 10^exponent, without zeros at either end; empty is zero
    int exponent = 0;

    [[nodiscard]] bool operator==(const CellValue& other) const;

    /// The double nearest to the number, with its sign.
    [[nodiscard]] double to_double() const;
};

/// Reads a decimal, a C hexadecimal float, or `nan`, `inf`, `infinity` in any case with or without a sign. Everything
/// else is text. A number of more than 10000 digits, a decimal with an exponent beyond ±10000, and a hexadecimal float
/// with an exponent beyond ±1200 are text too: no format reaches them.
[[nodiscard]] CellValue read_cell(std::string_view cell);

}  // namespace lostbits::output::file
