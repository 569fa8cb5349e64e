// Compares CSV tables (see `compare`).
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "output/diff/ledger.hpp"

namespace lostbits::output::diff {

using file::CsvColumn;
using file::CsvTable;

namespace {

std::string cell_text(std::string_view cell) {
    using Kind = file::CellValue::Kind;
    const Kind kind = file::read_cell(cell).kind;
    return kind == Kind::missing ? "(empty)" : kind == Kind::text ? escape_and_quote(cell) : std::string(cell);
}

/// Marks the numbers that are in one longest increasing subsequence of a list of distinct numbers. The others are the
/// fewest that have to move to sort the list.
///
/// Patience sorting, in n log n steps for n numbers: `ends[k]` is the index of the last number of an increasing list
/// of k + 1 numbers; of all such lists, the one whose last number is smallest.
std::vector<bool> longest_increasing(const std::vector<std::size_t>& numbers) {
    constexpr std::size_t none = SIZE_MAX;
    std::vector<std::size_t> ends, predecessor(numbers.size(), none);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto position =
            std::ranges::lower_bound(ends, numbers[i], {}, [&](std::size_t end) { return numbers[end]; });
        if (position != ends.begin()) predecessor[i] = *(position - 1);
        if (position == ends.end()) ends.push_back(i);
        else *position = i;
    }
    std::vector<bool> is_kept(numbers.size());
    for (std::size_t i = ends.empty() ? none : ends.back(); i != none; i = predecessor[i]) is_kept[i] = true;
    return is_kept;
}

/// A column that both tables have, in table a and in table b.
struct MatchedColumns {
    const CsvColumn *a, *b;
    const Tolerance* tolerance;
    bool compares_text;
};

/// Records the differences of the headers and returns the columns of both, in the first table's order.
std::vector<MatchedColumns> match_headers(const CsvTable& a, const CsvTable& b, Ledger& ledger) {
    std::vector<MatchedColumns> pairs;
    std::vector<std::size_t> indices_in_b;

    // Columns of the first table.
    for (const CsvColumn& column : a.columns) {
        ledger.result.names.push_back(column.name);
        if (is_ignored(ledger.options, column.name)) continue;
        const CsvColumn* column_in_b = b.find(column.name);
        if (column_in_b == nullptr) {
            ledger.add(1, [&] { return fmt::format("column {} is missing in the second", column.name); });
            continue;
        }
        const Tolerance* tolerance = tolerance_of(column.name, ledger.options);
        pairs.push_back({&column, column_in_b, tolerance, tolerance == nullptr && column.name.ends_with("_hex")});
        indices_in_b.push_back(static_cast<std::size_t>(column_in_b - b.columns.data()));
    }

    // Columns that only the second table has.
    for (const CsvColumn& column : b.columns) {
        if (a.find(column.name) != nullptr) continue;
        ledger.result.names.push_back(column.name);
        if (!is_ignored(ledger.options, column.name))
            ledger.add(1, [&] { return fmt::format("column {} is added in the second", column.name); });
    }

    // The fewest columns that have to move to give the order of the second table.
    const auto is_in_order = longest_increasing(indices_in_b);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (is_in_order[i]) continue;
        const auto old_position = pairs[i].a - a.columns.data() + 1;
        ledger.add(1, [&] {
            return fmt::format("column {} moved from place {} to place {}", pairs[i].a->name, old_position,
                               indices_in_b[i] + 1);
        });
    }
    return pairs;
}

/// Rows of two tables that are compared with each other, and rows that only one table has.
struct RowPairs {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    std::vector<std::size_t> only_a, only_b;
    /// The column of the first table by which rows are paired; null if they are paired by index.
    const CsvColumn* id_column = nullptr;
};

/// Pairs rows with the same `id` (claims have one) if both tables have such a column without repetitions, and
/// otherwise rows with the same index.
RowPairs pair_rows(const CsvTable& a, const CsvTable& b) {
    const CsvColumn *const id_a = a.find("id"), *const id_b = b.find("id");
    std::map<std::string_view, std::size_t> rows_of_a, rows_of_b;
    if (id_a != nullptr && id_b != nullptr) {
        for (std::size_t r = 0; r < a.rows(); ++r) rows_of_a.emplace(id_a->cells[r], r);
        for (std::size_t r = 0; r < b.rows(); ++r) rows_of_b.emplace(id_b->cells[r], r);
    }

    // Without an id for each row, the position pairs the rows.
    RowPairs row_pairs;
    if (id_a == nullptr || id_b == nullptr || rows_of_a.size() < a.rows() || rows_of_b.size() < b.rows()) {
        for (std::size_t r = 0; r < std::min(a.rows(), b.rows()); ++r) row_pairs.pairs.emplace_back(r, r);
        return row_pairs;
    }

    row_pairs.id_column = id_a;
    for (std::size_t r = 0; r < a.rows(); ++r) {
        const auto row_in_b = rows_of_b.find(id_a->cells[r]);
        if (row_in_b == rows_of_b.end()) row_pairs.only_a.push_back(r);
        else row_pairs.pairs.emplace_back(r, row_in_b->second);
    }
    for (std::size_t r = 0; r < b.rows(); ++r) {
        if (!rows_of_a.contains(id_b->cells[r])) row_pairs.only_b.push_back(r);
    }
    return row_pairs;
}

}  // namespace

Comparison compare(const CsvTable& a, const CsvTable& b, const CompareOptions& options) {
    Ledger ledger{options, {}};
    const auto column_pairs = match_headers(a, b, ledger);
    const RowPairs row_pairs = pair_rows(a, b);
    const auto row_prefix = [&](std::size_t r) {
        return row_pairs.id_column == nullptr ? "" : escape_and_quote(row_pairs.id_column->cells[r]) + ": ";
    };

    // The cells of the rows and columns that both tables have.
    for (const MatchedColumns& column : column_pairs) ledger.result.columns.emplace_back().name = column.a->name;
    ledger.result.rows = row_pairs.pairs.size();
    for (const auto& [row_in_a, row_in_b] : row_pairs.pairs) {
        const std::uint64_t count_before = ledger.result.count;
        for (std::size_t c = 0; c < column_pairs.size(); ++c) {
            const std::string_view cell_in_a = column_pairs[c].a->cells[row_in_a],
                                   cell_in_b = column_pairs[c].b->cells[row_in_b];
            if (cell_in_a == cell_in_b) continue;
            const PairVerdict verdict =
                judge_cells(cell_in_a, cell_in_b, column_pairs[c].tolerance, column_pairs[c].compares_text);
            if (!record_verdict(ledger.result.columns[c], verdict,
                                [&] { return fmt::format("line {}", a.lines[row_in_a]); }))
                continue;
            ledger.add(a.lines[row_in_a], [&] {
                return fmt::format("{}{}: {} != {}{}", row_prefix(row_in_a), column_pairs[c].a->name,
                                   cell_text(cell_in_a), cell_text(cell_in_b), distances_text(verdict));
            });
        }
        ledger.result.differing_rows += ledger.result.count > count_before;
    }

    // Rows that only one table has.
    for (const std::size_t r : row_pairs.only_a)
        ledger.add(a.lines[r], [&] { return row_prefix(r) + "missing in the second"; });
    for (const std::size_t r : row_pairs.only_b)
        ledger.add(0, [&] { return escape_and_quote(b.find("id")->cells[r]) + ": added in the second"; });
    if (row_pairs.id_column == nullptr && a.rows() != b.rows())
        ledger.add(0, [&] {
            return fmt::format("rows: {} != {}; the first {} are compared", a.rows(), b.rows(), row_pairs.pairs.size());
        });
    return ledger.result;
}

}  // namespace lostbits::output::diff
