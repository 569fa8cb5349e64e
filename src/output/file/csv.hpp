// CSV that pandas, R, DuckDB and a spreadsheet read the same way, and the Frictionless description that travels beside
// it.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "output/file/atomic_file.hpp"

namespace lostbits::output::file {

/// One column: what the CSV header and `datapackage.json` say about it.
struct Column {
    std::string name;     ///< `snake_case_unit`, unique in its file
    std::string type;     ///< `string`, `integer`, `number` or `boolean`
    std::string unit;     ///< `bits`, `ulp`, `ns`, ...; empty when there is none
    std::string meaning;  ///< one sentence
};

/// One value of a row. Default-constructed it is missing, which is written as nothing at all.
class Cell {
public:
    Cell() = default;
    Cell(bool value) : value_(value) {}
    template <std::signed_integral I>
    Cell(I value) : value_(static_cast<std::int64_t>(value)) {}
    template <std::unsigned_integral I>
    requires(!std::same_as<I, bool>) Cell(I value) : value_(static_cast<std::uint64_t>(value)) {}
    Cell(float value) : value_(value) {}
    Cell(double value) : value_(value) {}
    Cell(std::string value) : value_(std::move(value)) {}
    Cell(std::string_view value) : value_(std::string(value)) {}
    Cell(const char* value) : value_(std::string(value)) {}

    [[nodiscard]] bool is_missing() const { return std::holds_alternative<std::monostate>(value_); }

    /// The text between the commas, before quoting.
    [[nodiscard]] std::string text() const;

    /// Whether a column of this type may hold the cell: a missing one fits everywhere, an integer fits `number`.
    [[nodiscard]] bool fits(std::string_view column_type) const;

    /// The value as a number, a boolean being 0 or 1; NaN of a text and where it is missing.
    [[nodiscard]] double number() const;

private:
    std::variant<std::monostate, bool, std::int64_t, std::uint64_t, float, double, std::string> value_;
};

/// Missing where x is NaN.
inline Cell number_or_missing(double x) { return std::isnan(x) ? Cell() : Cell(x); }

/// Writes one CSV file: UTF-8, LF, RFC 4180 quoting, a header, empty = missing, booleans 0/1.
///
/// The file has its final name only after `close`. Strings are written as `csv_text` says.
class CsvWriter {
public:
    /// Opens the file and writes the header. Throws EnvironmentError, and std::logic_error for a column with an
    /// unknown type or a name used twice.
    CsvWriter(const std::filesystem::path& path, std::vector<Column> columns);

    /// Rows alone, which `take_lines` gives: a part of a file that is put together elsewhere.
    explicit CsvWriter(std::vector<Column> columns) : columns_(std::move(columns)) {}
    [[nodiscard]] std::string take_lines() { return std::exchange(lines_, {}); }
    /// No text at all: `take` is told each cell and the place of its column, from 0, row by row.
    using TakeCell = std::function<void(std::size_t column, const Cell& cell)>;
    CsvWriter(std::vector<Column> columns, TakeCell take) : columns_(std::move(columns)), take_(std::move(take)) {}
    /// Rows that such a writer of the same columns gave.
    void add_lines(std::string_view lines);

    /// Adds one cell to the current row. Throws std::logic_error when the row is full or the column has another type.
    CsvWriter& add(const Cell& cell);

    /// Ends the current row. Throws std::logic_error when cells are lacking.
    void end_row();

    /// A whole row at once.
    void row(std::initializer_list<Cell> cells) {
        for (const Cell& cell : cells) add(cell);
        end_row();
    }

    /// Gives the file its final name. Throws std::logic_error in the middle of a row.
    void close();

    [[nodiscard]] const std::vector<Column>& columns() const noexcept { return columns_; }

private:
    void put(const std::string& text);

    std::vector<Column> columns_;
    std::size_t filled_ = 0;
    [[nodiscard]] std::string name() const { return file_ ? file_->path().string() : "rows of a CSV"; }

    std::string line_, lines_;
    TakeCell take_ = {};
    std::optional<AtomicFile> file_;  // none: the rows go to `lines_`
};

/// The text of a cell: `valid_utf8`, and with an apostrophe in front where a spreadsheet would take it for a formula,
/// that is where it begins with = + - @, a tab or a carriage return and is neither a number nor made of digits and
/// signs alone (`-`, `+2^127`).
[[nodiscard]] std::string csv_text(std::string_view text);

/// `text` as one RFC 4180 field: quoted only when it holds a comma, a quote or a line break.
[[nodiscard]] std::string csv_field(std::string_view text);

/// The character at the head of a text that is not empty, and how many bytes it has: 0 where they are not UTF-8
/// (overlong, surrogate, cut short).
struct Character {
    char32_t code;
    std::size_t size;
};
[[nodiscard]] Character first_character(std::string_view text);

/// `text` with each byte that is not part of valid UTF-8 replaced by U+FFFD.
[[nodiscard]] std::string valid_utf8(std::string_view text);

/// One CSV file of a data package.
struct DataResource {
    std::string file_name;  ///< relative to the folder of the `datapackage.json`, with `/`
    std::string title;      ///< what a row is
    std::vector<Column> columns;
};

/// Writes a Frictionless `datapackage.json` to `path`: each column's type, unit and meaning, and in the property
/// `lostbits` the command and the program that made the files. Same input, same
/// bytes: no timestamps, keys in a fixed order, resources in the order given. Throws EnvironmentError.
void write_datapackage(const std::filesystem::path& path, const std::string& title,
                       const std::vector<DataResource>& resources);

}  // namespace lostbits::output::file
