// CSV files that pandas, R, DuckDB and spreadsheets read in the same way, and their Frictionless description.
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

/// Description of a column, for the CSV header and `datapackage.json`.
struct Column {
    std::string name;     ///< `snake_case_unit`, unique in its file
    std::string type;     ///< `string`, `integer`, `number` or `boolean`
    std::string unit;     ///< `bits`, `ulp`, `ns`, ...; empty if the numbers have no unit
    std::string meaning;  ///< one sentence
};

/// One value of a row. A default-constructed cell is missing and is written as an empty text.
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
    template <class T>
    Cell(const std::optional<T>& value) : Cell(value ? Cell(*value) : Cell()) {}

    [[nodiscard]] bool is_missing() const { return std::holds_alternative<std::monostate>(value_); }

    /// The text between the commas, before it is quoted.
    [[nodiscard]] std::string text() const;

    /// True if a column of this type may hold the cell: a missing cell fits every type, and an integer fits `number`.
    [[nodiscard]] bool fits(std::string_view column_type) const;

    /// The value as a number; a boolean is 0 or 1. NaN for a text and for a missing cell.
    [[nodiscard]] double number() const;

private:
    std::variant<std::monostate, bool, std::int64_t, std::uint64_t, float, double, std::string> value_;
};

/// `x`; missing if `x` is NaN.
inline std::optional<double> number_or_missing(double x) { return std::isnan(x) ? std::nullopt : std::optional(x); }

/// Writes one CSV file: a header and rows, in UTF-8 with LF and the quotes of RFC 4180. A missing cell is empty, and a
/// boolean is 0 or 1.
///
/// The file gets its final name only in `close`. Texts are written by `escape_formula`.
class CsvWriter {
public:
    /// Opens the file and writes the header. Throws EnvironmentError, and std::logic_error for a column with an
    /// unknown type or a name used twice.
    CsvWriter(const std::filesystem::path& path, std::vector<Column> columns);

    /// Makes rows without a file or a header, for a part of a file that another writer assembles. `take_lines` returns
    /// the rows and drops them.
    explicit CsvWriter(std::vector<Column> columns) : columns_(std::move(columns)) {}
    [[nodiscard]] std::string take_lines() { return std::exchange(finished_lines_, {}); }
    /// Receives a cell and the index of its column, counted from 0.
    using CellReceiver = std::function<void(std::size_t column, const Cell& cell)>;
    /// Writes nothing: passes each cell to `receive_cell`, in the order of the rows.
    CsvWriter(std::vector<Column> columns, CellReceiver receive_cell)
        : columns_(std::move(columns)), receive_cell_(std::move(receive_cell)) {}
    /// Adds rows that `take_lines` of a writer with the same columns returned.
    void add_lines(std::string_view lines);

    /// Adds one cell to the current row. Throws std::logic_error if the row is full or the column has another type.
    CsvWriter& add(const Cell& cell);

    /// Ends the current row. Throws std::logic_error if cells are missing from it.
    void end_row();

    /// Adds a whole row.
    void add_row(std::initializer_list<Cell> cells) {
        for (const Cell& cell : cells) add(cell);
        end_row();
    }

    /// Gives the file its final name. Throws std::logic_error in the middle of a row.
    void close();

    [[nodiscard]] const std::vector<Column>& columns() const noexcept { return columns_; }

private:
    void append_field(const std::string& text);

    std::vector<Column> columns_;
    std::size_t filled_cells_ = 0;
    [[nodiscard]] std::string name() const { return file_ ? file_->path().string() : "rows of a CSV"; }

    std::string line_, finished_lines_;
    CellReceiver receive_cell_ = {};
    std::optional<AtomicFile> file_;  // missing: rows go to `finished_lines_` or `receive_cell_`
};

/// Returns the text as valid UTF-8 (`to_valid_utf8`). If a spreadsheet would take it for a formula, puts an apostrophe
/// in front. A formula begins with = + - @, a tab or a carriage return. Numbers, and texts of digits and signs alone
/// (`-`,
/// `+2^127`), get no apostrophe.
[[nodiscard]] std::string escape_formula(std::string_view text);

/// `text` as one RFC 4180 field: quoted only if it holds a comma, a quote or a line break.
[[nodiscard]] std::string quoted_field(std::string_view text);

/// First character of a text that is not empty, and its number of bytes. The number is 0 if the text does not begin
/// with valid UTF-8 (overlong, surrogate, cut short).
struct Character {
    char32_t code;
    std::size_t size;
};
[[nodiscard]] Character first_character(std::string_view text);

/// `text` with each byte that is not part of valid UTF-8 replaced by U+FFFD.
[[nodiscard]] std::string to_valid_utf8(std::string_view text);

/// One CSV file of a data package.
struct DataResource {
    std::string file_name;  ///< relative to the folder of the `datapackage.json`, with `/`
    std::string title;      ///< what a row is
    std::vector<Column> columns;
};

/// Writes a Frictionless `datapackage.json` to `path`. It has each column's type, unit and meaning, and in the property
/// `lostbits` the command and the program that made the files. The same input gives the same bytes: no timestamps, keys
/// in a fixed order, resources in the given order. Throws EnvironmentError.
void write_datapackage(const std::filesystem::path& path, const std::string& title,
                       const std::vector<DataResource>& resources);

}  // namespace lostbits::output::file
