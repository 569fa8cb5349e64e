// Changes between two tables of forms. Rows are paired by their keys. Changed outcomes are listed apart from other
// changed values.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "output/diff/difference.hpp"

namespace lostbits::output::diff {

/// Rows of a table to compare, and the columns that pair them. By default: all rows, paired by every column of their
/// key. If two forms are compared with each other: the rows of one form, paired by the other columns of the key.
struct RowChoice {
    std::string form;  ///< empty: the rows of every form, and the form is part of the key
};

/// A changed cell of a row that both sides have.
struct CellChange {
    std::string row, column, before, after;
    bool is_bits = false;  ///< true if the cell is a number of bits
    /// Size of the change: the difference of bits; otherwise the difference relative to the larger number. Infinite if
    /// only one side is a number.
    double size = 0;
};

/// Changed outcomes of a row: `agree_hit 407 to 400, false_miss 0 to 7`.
struct OutcomeChange {
    std::string row, text;
    double rays = 0;  ///< sum of the differences of the counts
};

/// Counts how many rows of the second table are better or worse than in the first. A row is better if it has fewer
/// wrong decisions, or equally many and a smaller `lost_bits_p99`. If the tables have different numbers of rays,
/// fractions of the rays are compared. Rows of tables that have neither column are left out.
struct RowVerdict {
    std::uint64_t better = 0, worse = 0, equal = 0;
    /// For two forms: number of rows with equally many rays, but not equally many true hits.
    std::uint64_t different_truth_count = 0;
    /// Number of rows with equally many wrong decisions, if only one side has a `lost_bits_p99`.
    std::uint64_t one_sided_bits_count = 0;
    /// For two forms: number of `better` and `worse` rows that were decided by bits although both forms decide some
    /// rays wrongly. The forms decide equally many rays wrongly, but not always the same ones.
    std::uint64_t other_hits_count = 0;
    /// What the columns of the tables allow to compare.
    bool compares_decisions = false, compares_bits = false, compares_fractions = false;

    void add(const RowVerdict& other);
    /// `out/b is better in 3 rows, worse in 1, the same in 40 (compared by wrong decisions, then by lost_bits_p99)`,
    /// and a line for each kind of row that cannot be compared. Empty if there are no rows.
    [[nodiscard]] std::string text(const std::string& second) const;
};

struct RowChanges {
    std::uint64_t compared_row_count = 0, changed_row_count = 0;  ///< rows in both tables, and how many of them differ
    std::vector<std::string> only_a, only_b;                      ///< rows without a partner
    std::vector<OutcomeChange> outcomes;  ///< changed outcomes, the row with the most rays first
    /// Changed values other than outcomes and references: bits first, then the largest change first.
    std::vector<CellChange> cells;
    std::uint64_t difference_count = 0;          ///< number of cells that differ, in all kinds of columns
    std::vector<std::string> one_sided_columns;  ///< columns that only one table has
    /// Columns that name a ray or a command (references) and differ in some row. Their cells are in neither list above.
    std::set<std::string> changed_reference_columns;
    std::vector<std::string> column_names;  ///< every column of either side
    RowVerdict verdict;

    [[nodiscard]] bool is_same() const {
        return difference_count == 0 && only_a.empty() && only_b.empty() && one_sided_columns.empty();
    }
    /// Adds the changes between two other tables.
    void add(RowChanges other);
    void sort();
};

/// True if every row of the table has a form and a format, or the id of a claim, and no two rows have the same key.
/// Rows can then be paired wherever they stand.
[[nodiscard]] bool has_row_keys(const file::CsvTable& table);

/// Pairs the rows of two tables with row keys and compares them as `compare` does. `subject` precedes the names of
/// rows. If two forms are compared with each other, text (commands, names of rays) is left out.
[[nodiscard]] RowChanges compare_rows(const file::CsvTable& a, const file::CsvTable& b, const std::string& subject,
                                      const CompareOptions& options, const RowChoice& choice_a = {},
                                      const RowChoice& choice_b = {});

}  // namespace lostbits::output::diff
