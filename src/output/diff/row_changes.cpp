// Compares the rows of two tables of forms (see `compare_rows`).
#include "output/diff/row_changes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "measure/answer/outcome.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "output/diff/ledger.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::diff {

using file::CsvColumn;
using file::CsvTable;

namespace {

/// Columns that form the key of a row: those before the form (a case, the value of an axis), the form and the format.
/// For claims, only the id. Empty if the table has no such columns.
std::vector<const CsvColumn*> key_columns(const CsvTable& table) {
    std::vector<const CsvColumn*> keys;
    if (const CsvColumn* const id = table.find("id"); id != nullptr && table.find("statement") != nullptr) return {id};
    const CsvColumn *const form = table.find("form"), *const format = table.find("format");
    if (form == nullptr || format == nullptr) return keys;
    for (const CsvColumn& column : table.columns) {
        if (!column.name.ends_with("_hex") && column.name != "verdict") keys.push_back(&column);
        if (&column == std::max(form, format)) break;
    }
    return keys;
}

/// Indices of the rows by their key, and the keys in the table's order.
struct KeyedRows {
    std::vector<std::string> order;
    std::map<std::string, std::size_t> index_of;
};

KeyedRows rows_by_key(const CsvTable& table, const RowChoice& choice) {
    KeyedRows rows;
    const CsvColumn* const form = table.find("form");
    for (std::size_t r = 0; r < table.rows(); ++r) {
        if (!choice.form.empty() && form->cells[r] != choice.form) continue;
        std::string key;
        for (const CsvColumn* column : key_columns(table)) {
            if (column == form && !choice.form.empty()) continue;
            key += (key.empty() ? "" : " ") + std::string(column->cells[r]);
        }
        if (rows.index_of.try_emplace(key, r).second) rows.order.push_back(key);
    }
    return rows;
}

bool is_outcome(const std::string& name) {
    return std::ranges::find(measure::answer::outcome_names, name) != measure::answer::outcome_names.end() ||
           name == "wrong_primitive";
}

/// True for columns that name a ray, a position or a command: the difference of two such values has no meaning.
bool names_ray_or_command(const std::string& name) {
    return name.starts_with("worst_") || name.starts_with("fault_") || name.ends_with("_hex") ||
           name.ends_with("explain");
}

std::string cell_or_empty(std::string_view cell) { return cell.empty() ? "(empty)" : std::string(cell); }

struct ColumnPair {
    const CsvColumn *a, *b;
    const Tolerance* tolerance;
};

bool is_wrong_decision(const std::string& name) {
    return std::ranges::any_of(measure::evaluate::wrong_decisions, [&name](measure::answer::Outcome o) {
        return name == measure::answer::outcome_names[static_cast<std::size_t>(o)];
    });
}

/// Number in a column of a row; NaN if the cell has no number.
double number_in_column(const CsvTable& table, std::size_t row_index, std::string_view name) {
    const CsvColumn* const column = table.find(name);
    return column == nullptr ? std::nan("") : cell_number(column->cells[row_index]);
}

/// Lower and upper bound on the number of true hits of a row. The upper bound includes answers that are not a number or
/// not proved, which do not show whether the ray truly hits. NaN if the table lacks the columns.
std::pair<double, double> true_hits(const CsvTable& table, std::size_t row_index) {
    const auto count_or = [&](const char* name, double fallback) {
        return table.find(name) == nullptr ? fallback : number_in_column(table, row_index, name);
    };
    const double smallest = number_in_column(table, row_index, "agree_hit") +
                            number_in_column(table, row_index, "false_miss") + count_or("wrong_primitive", 0) +
                            count_or("double_hit", 0) + count_or("wrong_neighbour", 0) + count_or("out_of_order", 0);
    return {smallest, smallest + count_or("crack", 0) + count_or("not_a_number", 0) + count_or("unresolved", 0)};
}

/// Two rows with the same key, one of each table.
struct RowPair {
    const CsvTable &a, &b;
    std::size_t row_in_a, row_in_b;

    /// True if the rows have equally many rays, but the bounds of their true hits do not overlap. False if a bound is
    /// NaN.
    [[nodiscard]] bool have_different_true_hits() const {
        const auto [smallest, largest] = true_hits(a, row_in_a);
        const auto [other_smallest, other_largest] = true_hits(b, row_in_b);
        return number_in_column(a, row_in_a, "rays") == number_in_column(b, row_in_b, "rays") &&
               (largest < other_smallest || other_largest < smallest);
    }
};

/// Compares two rows by the columns that both tables have.
RowVerdict judge_rows(const std::vector<ColumnPair>& pairs, const RowPair& rows, bool compares_two_forms) {
    RowVerdict verdict;
    const double rays = number_in_column(rows.a, rows.row_in_a, "rays"),
                 other_rays = number_in_column(rows.b, rows.row_in_b, "rays");
    const bool compares_fractions = rays > 0 && other_rays > 0 && rays != other_rays;
    double more_wrong = 0, more_bits = 0;  // excess of the second row over the first: wrong decisions, lost bits
    double first_wrong = 0;                // wrong decisions of the first row
    bool is_one_sided = false;
    for (const auto& [x, y, tolerance] : pairs) {
        const bool is_decision = is_wrong_decision(x->name), is_lost_bits = x->name == "lost_bits_p99";
        if (!is_decision && !is_lost_bits) continue;
        (is_decision ? verdict.compares_decisions : verdict.compares_bits) = true;

        const double before = cell_number(x->cells[rows.row_in_a]), after = cell_number(y->cells[rows.row_in_b]);
        if (is_decision && before > 0) first_wrong += before;
        const bool differs = judge_cells(x->cells[rows.row_in_a], y->cells[rows.row_in_b], tolerance, false).differs;
        if (!differs && (!compares_fractions || tolerance != nullptr)) continue;
        if (is_decision && compares_fractions) more_wrong += after * rays - before * other_rays;  // exact below 2^53
        else if (std::isnan(after - before)) is_one_sided |= is_lost_bits && std::isnan(after) != std::isnan(before);
        else (is_decision ? more_wrong : more_bits) += after - before;
    }
    if (!verdict.compares_decisions && !verdict.compares_bits) return verdict;

    // Wrong decisions count before lost bits.
    verdict.compares_fractions = compares_fractions && verdict.compares_decisions;
    const double more_errors = more_wrong != 0 ? more_wrong : more_bits;
    if (compares_two_forms && rows.have_different_true_hits()) ++verdict.different_truth_count;
    else if (more_wrong == 0 && is_one_sided) ++verdict.one_sided_bits_count;
    else ++(more_errors < 0 ? verdict.better : more_errors > 0 ? verdict.worse : verdict.equal);
    verdict.other_hits_count =
        compares_two_forms && more_wrong == 0 && first_wrong > 0 ? verdict.better + verdict.worse : 0;
    return verdict;
}

}  // namespace

void RowVerdict::add(const RowVerdict& other) {
    better += other.better;
    worse += other.worse;
    equal += other.equal;
    different_truth_count += other.different_truth_count;
    one_sided_bits_count += other.one_sided_bits_count;
    other_hits_count += other.other_hits_count;
    compares_decisions |= other.compares_decisions;
    compares_bits |= other.compares_bits;
    compares_fractions |= other.compares_fractions;
}

std::string RowVerdict::text(const std::string& second) const {
    std::vector<std::string> lines;
    if (different_truth_count > 0)
        lines.push_back(
            fmt::format("not comparable in {}: the two forms are asked different questions, so other rays are "
                        "hits (agree_hit + false_miss differ)",
                        text::count_with_noun(different_truth_count, "row")));
    if (one_sided_bits_count > 0)
        lines.push_back(
            fmt::format("not comparable in {}: as many wrong decisions, but only one side has a lost_bits_p99",
                        text::count_with_noun(one_sided_bits_count, "row")));
    if (other_hits_count > 0)
        lines.push_back(fmt::format(
            "in {} both forms decide equally many rays wrongly, perhaps not the same ones: each lost_bits_p99 is "
            "over its own hits; `lostbits map --against` compares the hits that both have",
            text::count_with_noun(other_hits_count, "row")));
    if (better + worse + equal > 0)
        lines.push_back(
            fmt::format("{} is better in {}, worse in {}, the same in {} (compared by {}{}{}{})", second,
                        text::count_with_noun(better, "row"), worse, equal, compares_fractions ? "the share of " : "",
                        compares_decisions ? "wrong decisions" : "",
                        compares_decisions && compares_bits ? ", then by " : "", compares_bits ? "lost_bits_p99" : ""));
    return fmt::format("{}", fmt::join(lines, "\n"));
}

void RowChanges::add(RowChanges other) {
    verdict.add(other.verdict);
    compared_row_count += other.compared_row_count;
    changed_row_count += other.changed_row_count;
    difference_count += other.difference_count;
    const auto append = [](auto& target, auto& source) {
        target.insert(target.end(), std::make_move_iterator(source.begin()), std::make_move_iterator(source.end()));
    };
    append(only_a, other.only_a);
    append(only_b, other.only_b);
    append(outcomes, other.outcomes);
    append(cells, other.cells);
    append(one_sided_columns, other.one_sided_columns);
    append(column_names, other.column_names);
    changed_reference_columns.merge(other.changed_reference_columns);
}

void RowChanges::sort() {
    std::ranges::stable_sort(outcomes, [](const auto& a, const auto& b) { return a.rays > b.rays; });
    std::ranges::stable_sort(cells, [](const CellChange& a, const CellChange& b) {
        return a.is_bits != b.is_bits ? a.is_bits : a.size > b.size;
    });
}

bool has_row_keys(const CsvTable& table) {
    const auto keys = key_columns(table);
    return !keys.empty() && table.rows() > 0 && rows_by_key(table, {}).order.size() == table.rows();
}

namespace {

/// Pairs the columns of both tables that are not keys. Records all names, and the columns that only one table has.
std::vector<ColumnPair> pair_columns(const CsvTable& a, const CsvTable& b, const std::string& subject,
                                     const CompareOptions& options, RowChanges& changes) {
    std::vector<ColumnPair> pairs;
    std::set<const CsvColumn*> keys;
    for (const CsvColumn* key : key_columns(a)) keys.insert(key);
    for (const CsvColumn& column : a.columns) {
        changes.column_names.push_back(column.name);
        if (is_ignored(options, column.name) || keys.contains(&column)) continue;
        const CsvColumn* const other = b.find(column.name);
        if (other != nullptr) pairs.push_back({&column, other, tolerance_of(column.name, options)});
        else
            changes.one_sided_columns.push_back(
                fmt::format("{}column {} is missing in the second", subject, column.name));
    }

    for (const CsvColumn& column : b.columns) {
        if (a.find(column.name) != nullptr) continue;
        changes.column_names.push_back(column.name);
        if (!is_ignored(options, column.name))
            changes.one_sided_columns.push_back(
                fmt::format("{}column {} is added in the second", subject, column.name));
    }
    return pairs;
}

/// Records the cells of two rows that differ. `key` names the row in the report.
void record_changes(const std::vector<ColumnPair>& pairs, const RowPair& rows, const std::string& key,
                    bool compares_two_forms, RowChanges& changes) {
    OutcomeChange outcome{key, {}, 0};
    bool differs = false;
    for (const auto& [x, y, tolerance] : pairs) {
        const std::string_view before = x->cells[rows.row_in_a], after = y->cells[rows.row_in_b];
        if (before == after) continue;
        const bool is_reference = names_ray_or_command(x->name);
        const PairVerdict verdict = judge_cells(before, after, tolerance, tolerance == nullptr && is_reference);
        if (!verdict.differs ||
            (compares_two_forms && (is_reference || (!verdict.has_distances && !verdict.is_not_finite))))
            continue;

        differs = true;
        ++changes.difference_count;
        if (is_outcome(x->name)) {
            outcome.text += fmt::format("{}{} {} to {}", outcome.text.empty() ? "" : ", ", x->name, before, after);
            outcome.rays += verdict.absolute;
        } else if (!is_reference) {
            const bool is_bits = x->name.find("bits") != std::string::npos;
            const double size = !verdict.has_distances ? HUGE_VAL : is_bits ? verdict.absolute : verdict.relative;
            changes.cells.push_back({key, x->name, cell_or_empty(before), cell_or_empty(after), is_bits, size});
        } else {
            changes.changed_reference_columns.insert(x->name);
        }
    }
    changes.changed_row_count += differs;
    if (!outcome.text.empty()) changes.outcomes.push_back(std::move(outcome));
}

}  // namespace

RowChanges compare_rows(const CsvTable& a, const CsvTable& b, const std::string& subject, const CompareOptions& options,
                        const RowChoice& choice_a, const RowChoice& choice_b) {
    RowChanges changes;
    const bool compares_two_forms = !choice_a.form.empty();
    const std::vector<ColumnPair> pairs = pair_columns(a, b, subject, options, changes);

    const KeyedRows rows_of_a = rows_by_key(a, choice_a), rows_of_b = rows_by_key(b, choice_b);
    for (const std::string& key : rows_of_b.order) {
        if (!rows_of_a.index_of.contains(key)) changes.only_b.push_back(subject + key);
    }
    for (const std::string& key : rows_of_a.order) {
        const auto match = rows_of_b.index_of.find(key);
        if (match == rows_of_b.index_of.end()) {
            changes.only_a.push_back(subject + key);
            continue;
        }
        ++changes.compared_row_count;
        const RowPair rows{a, b, rows_of_a.index_of.at(key), match->second};
        changes.verdict.add(judge_rows(pairs, rows, compares_two_forms));
        record_changes(pairs, rows, subject + key, compares_two_forms, changes);
    }
    changes.sort();
    return changes;
}

}  // namespace lostbits::output::diff
