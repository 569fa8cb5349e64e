// What changed between two tables of forms: their rows paired by what they are about, outcomes and sizes kept apart.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "output/diff/difference.hpp"

namespace lostbits::output::diff {

/// Which rows of a table count, and what pairs them: all by every column of their key; or, of two forms held against
/// each other, those of one form, by the other columns of the key.
struct RowChoice {
    std::string form;  ///< empty: every form, which is part of the key then
};

/// One cell of a row that both sides have.
struct CellChange {
    std::string row, column, before, after;
    bool bits = false;  ///< a number of bits: `size` is their difference; otherwise it is relative to the larger
    double size = 0;    ///< infinite where a number meets what is none
};

/// The outcomes of a row that differ: `agree_hit 407 to 400, false_miss 0 to 7`.
struct OutcomeChange {
    std::string row, text;
    double rays = 0;  ///< by how much the counts differ, summed
};

/// How the second side stands to the first, row by row: better with fewer wrong decisions, and of as many with a
/// smaller `lost_bits_p99`. Where the sides have other numbers of rays, the shares of them count. Rows of tables that
/// have neither are left out.
struct RowVerdict {
    std::uint64_t better = 0, worse = 0, even = 0;
    std::uint64_t other_truth = 0;  ///< of two forms: as many rays, and other numbers of true hits
    std::uint64_t one_sided = 0;    ///< as many wrong decisions, and one side alone has a `lost_bits_p99`
    /// Of `better` and `worse`, of two forms: by bits where both decide as many rays wrongly, not always the same ones.
    std::uint64_t of_other_hits = 0;
    bool by_decisions = false, by_bits = false, by_shares = false;  ///< what the tables have

    void add(const RowVerdict& other);
    /// `out/b is better in 3 rows, worse in 1, the same in 40: by wrong decisions, then by lost_bits_p99`, and a line
    /// for each kind of rows that cannot be compared; empty where there is no row of either.
    [[nodiscard]] std::string text(const std::string& second) const;
};

struct RowChanges {
    std::uint64_t rows = 0, changed = 0;      ///< in both tables; those of them that differ
    std::vector<std::string> only_a, only_b;  ///< rows without a partner
    std::vector<OutcomeChange> outcomes;      ///< the most rays first
    std::vector<CellChange> cells;     ///< what has a size but outcomes and places: bits first, the largest first
    std::uint64_t count = 0;           ///< of cells that differ, all kinds of columns
    std::vector<std::string> columns;  ///< that only one table has
    std::vector<std::string> names;    ///< every column of either side
    RowVerdict verdict;

    [[nodiscard]] bool same() const { return count == 0 && only_a.empty() && only_b.empty() && columns.empty(); }
    /// Takes in what changed between two other tables.
    void add(RowChanges other);
    void sort();
};

/// Whether the rows of a table say which form and format they are about, each once: then rows have partners, wherever
/// they stand.
[[nodiscard]] bool has_row_keys(const file::CsvTable& table);

/// Pairs the rows of two such tables and compares them as `compare` does. `subject` stands before the names of rows.
/// Where two forms are held against each other, text (commands, names of rays) is not compared.
[[nodiscard]] RowChanges compare_rows(const file::CsvTable& a, const file::CsvTable& b, const std::string& subject,
                                      const CompareOptions& options, const RowChoice& of_a = {},
                                      const RowChoice& of_b = {});

}  // namespace lostbits::output::diff
