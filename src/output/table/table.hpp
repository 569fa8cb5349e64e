// Tables. Each column is defined in one place: its name, its meaning, and how a cell is computed from a row. The CSV
// file and its entry in `datapackage.json` follow from that.
#pragma once

#include <algorithm>
#include <concepts>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "output/file/csv.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::table {

using file::Cell;

/// Computes the cell of a column from a row of type R.
template <class R>
using CellOf = std::function<Cell(const R&)>;

/// Type of a column in `datapackage.json`, for values of type T or optional values of type T.
template <class T>
constexpr const char* column_type() {
    if constexpr (requires(T x) { x.value(); }) return column_type<typename T::value_type>();
    else
        return std::is_same_v<T, bool>                   ? "boolean"
               : std::is_integral_v<T>                   ? "integer"
               : std::is_floating_point_v<T>             ? "number"
               : std::is_constructible_v<std::string, T> ? "string"
                                                         : nullptr;
}

/// A column: its name, unit and meaning, and how its value is computed from a row. The type of the values gives its
/// type.
template <class R>
struct TableColumn {
    /// `compute` is a function of a row or a pointer to a member of a row.
    template <class Value>
    requires std::invocable<Value, const R&> TableColumn(std::string name, std::string unit, std::string meaning,
                                                         Value compute)
        : TableColumn({std::move(name), column_type<std::remove_cvref_t<std::invoke_result_t<Value, const R&>>>(),
                       std::move(unit), std::move(meaning)},
                      [compute](const R& row) { return Cell(std::invoke(compute, row)); }) {}
    template <class Value>
    requires std::invocable<Value, const R&> TableColumn(std::string name, std::string meaning, Value compute)
        : TableColumn(std::move(name), "", std::move(meaning), std::move(compute)) {}
    /// For values whose type is known only at run time.
    TableColumn(file::Column description, CellOf<R> compute)
        : about(std::move(description)), value(std::move(compute)) {}

    file::Column about;
    CellOf<R> value;
};

/// The value `x` if `is_present`, otherwise a missing cell.
template <class T>
std::optional<T> when(bool is_present, const T& x) {
    return is_present ? std::optional(x) : std::nullopt;
}

/// Returns a function that computes the cell of a number: `value(row)`, or a missing cell if that is NaN.
template <class Value>
auto or_missing(Value value) {
    return [value](const auto& row) { return file::number_or_missing(std::invoke(value, row)); };
}

/// Text of a number as a C hexadecimal float. A missing number stays missing.
inline std::optional<std::string> hex_text(const Cell& cell) {
    return cell.is_missing() ? std::nullopt : std::optional(file::hex(cell.number()));
}

/// The columns of a table whose rows are of type R.
template <class R>
class Table {
public:
    Table() = default;
    Table(std::initializer_list<TableColumn<R>> columns) : columns_(columns) {}

    Table& add(TableColumn<R> column) {
        columns_.push_back(std::move(column));
        return *this;
    }
    Table& add(Table columns) {
        for (TableColumn<R>& column : columns.columns_) add(std::move(column));
        return *this;
    }
    /// Adds the columns of a part of the row. `find(row)` returns the part as a reference, an optional or a pointer;
    /// if there is no part, all cells are missing.
    template <class Part, class Find>
    Table& add(const Table<Part>& columns, const Find& find) {
        for (const TableColumn<Part>& column : columns) {
            add({column.about, [find, value = column.value](const R& row) {
                     const Part* const part = pointer_to(std::invoke(find, row));
                     return part != nullptr ? value(*part) : Cell();
                 }});
        }
        return *this;
    }
    /// Adds a column of decimals and a column `NAME_hex` with the exact values.
    Table& add_exact(const TableColumn<R>& column) {
        add(column);
        return add({column.about.name + "_hex", column.about.unit, "the same, exactly",
                    [value = column.value](const R& row) { return hex_text(value(row)); }});
    }

    /// The column of this name; null if the table has no such column.
    [[nodiscard]] TableColumn<R>* find(const std::string& name) {
        const auto has_name = [&name](const TableColumn<R>& column) { return column.about.name == name; };
        const auto column = std::ranges::find_if(columns_, has_name);
        return column == columns_.end() ? nullptr : &*column;
    }
    [[nodiscard]] auto begin() { return columns_.begin(); }
    [[nodiscard]] auto end() { return columns_.end(); }
    [[nodiscard]] auto begin() const { return columns_.begin(); }
    [[nodiscard]] auto end() const { return columns_.end(); }

    [[nodiscard]] std::vector<file::Column> columns() const {
        std::vector<file::Column> descriptions;
        for (const TableColumn<R>& column : columns_) descriptions.push_back(column.about);
        return descriptions;
    }
    /// Replaces the meaning of the column of this name, if there is one.
    void set_meaning(const std::string& name, const std::string& meaning) {
        if (TableColumn<R>* const column = find(name)) column->about.meaning = meaning;
    }
    void add_row(file::CsvWriter& csv, const R& row) const {
        for (const TableColumn<R>& column : columns_) csv.add(column.value(row));
        csv.end_row();
    }

private:
    template <class Part>
    static const Part* pointer_to(const Part& part) {
        return &part;
    }
    template <class Part>
    static const Part* pointer_to(const Part* part) {
        return part;
    }
    template <class Part>
    static const Part* pointer_to(const std::optional<Part>& part) {
        return part ? &*part : nullptr;
    }

    std::vector<TableColumn<R>> columns_;
};

/// A CSV file of a table. The constructor opens it, and `close` gives it its final name.
template <class R>
class TableFile {
public:
    /// `title` says what a row is. If `folder` is empty, there is no file: see `take_lines`.
    TableFile(const std::filesystem::path& folder, const std::string& name, std::string title, Table<R> table)
        : table_(std::move(table)),
          about_{name, std::move(title), table_.columns()},
          csv_(folder.empty() ? file::CsvWriter(about_.columns) : file::CsvWriter(folder / name, about_.columns)) {}

    void add(const R& row) { table_.add_row(csv_, row); }
    void add_all(const std::vector<R>& rows) {
        for (const R& row : rows) add(row);
    }
    [[nodiscard]] const file::DataResource& about() const { return about_; }
    void add_lines(const std::string& lines) { csv_.add_lines(lines); }
    /// Returns the lines of the rows that were added since the last call. Only for a table without a file.
    [[nodiscard]] std::string take_lines() { return csv_.take_lines(); }
    void close() { csv_.close(); }

private:
    Table<R> table_;
    file::DataResource about_;
    file::CsvWriter csv_;
};

/// Closes a part of a folder and adds its description to `resources`. A part is a table, an optional table, a list of
/// parts, or an object with a function `table()`. A DataResource describes a table that another object writes; it is
/// only added.
template <class Part>
void close_part(Part& part, std::vector<file::DataResource>& resources) {
    if constexpr (std::is_same_v<std::remove_const_t<Part>, file::DataResource>) {
        resources.push_back(part);
    } else if constexpr (requires { part.about(); }) {
        resources.push_back(part.about());
        part.close();
    } else if constexpr (requires { part.table(); }) {
        close_part(part.table(), resources);
    } else if constexpr (requires { part.begin(); }) {
        for (auto& element : part) close_part(element, resources);
    } else if (part) {
        close_part(*part, resources);
    }
}
/// Closes the tables of a folder and describes them in its `datapackage.json`. The summary is closed last, because a
/// folder that has a summary is finished.
template <class R, class... Part>
void close_tables(const std::filesystem::path& folder, const std::string& title, TableFile<R>& summary,
                  Part&... parts) {
    std::vector<file::DataResource> resources{summary.about()};
    (close_part(parts, resources), ...);
    file::write_datapackage(folder / "datapackage.json", title, resources);
    summary.close();
}

}  // namespace lostbits::output::table
