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
#include "scene/toml/counted.hpp"

namespace lostbits::output::diff {

using file::CsvColumn;
using file::CsvTable;

namespace {

/// The columns before the form (a case, the value of an axis), the form and the format; of claims their id.
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

/// Rows by their key, and the keys in the table's order.
struct KeyedRows {
    std::vector<std::string> order;
    std::map<std::string, std::size_t> row;
};

KeyedRows keyed(const CsvTable& table, const RowChoice& choice) {
    KeyedRows rows;
    const CsvColumn* const form = table.find("form");
    for (std::size_t r = 0; r < table.rows(); ++r) {
        if (!choice.form.empty() && form->cells[r] != choice.form) continue;
        std::string key;
        for (const CsvColumn* column : key_columns(table)) {
            if (column == form && !choice.form.empty()) continue;
            key += (key.empty() ? "" : " ") + std::string(column->cells[r]);
        }
        if (rows.row.try_emplace(key, r).second) rows.order.push_back(key);
    }
    return rows;
}

bool is_outcome(const std::string& name) {
    return std::ranges::find(measure::answer::outcome_names, name) != measure::answer::outcome_names.end() ||
           name == "wrong_primitive";
}

/// True for columns that name a ray, a position or a command; the distance between two of them has no meaning.
bool is_place(const std::string& name) {
    return name.starts_with("worst_") || name.starts_with("fault_") || name.ends_with("_hex") ||
           name.ends_with("explain");
}

std::string shown(std::string_view cell) { return cell.empty() ? "(empty)" : std::string(cell); }

struct ColumnPair {
    const CsvColumn *a, *b;
    const Tolerance* tolerance;
};

bool is_wrong(const std::string& name) {
    return std::ranges::any_of(measure::evaluate::wrong_decisions, [&name](measure::answer::Outcome o) {
        return name == measure::answer::outcome_names[static_cast<std::size_t>(o)];
    });
}

/// Number of a row in a column; NaN if there is none.
double number_of(const CsvTable& table, std::size_t row, std::string_view name) {
    const CsvColumn* const column = table.find(name);
    return column == nullptr ? std::nan("") : cell_number(column->cells[row]);
}

/// Bounds on the number of true hits of a row. An answer that is not a number, or not proved, does not show if the ray
/// truly hits. NaN if the table lacks the columns.
std::pair<double, double> true_hits(const CsvTable& table, std::size_t row) {
    const auto count = [&](const char* name, double without) {
        return table.find(name) == nullptr ? without : number_of(table, row, name);
    };
    const double least = number_of(table, row, "agree_hit") + number_of(table, row, "false_miss") +
                         count("wrong_primitive", 0) + count("double_hit", 0) + count("wrong_neighbour", 0) +
                         count("out_of_order", 0);
    return {least, least + count("crack", 0) + count("not_a_number", 0) + count("unresolved", 0)};
}

/// A row of each table with the same key.
struct RowPair {
    const CsvTable &a, &b;
    std::size_t r, q;

    /// True if as many rays have another truth. A comparison with NaN is false.
    [[nodiscard]] bool has_other_truth() const {
        const auto [least, most] = true_hits(a, r);
        const auto [other_least, other_most] = true_hits(b, q);
        return number_of(a, r, "rays") == number_of(b, q, "rays") && (most < other_least || other_most < least);
    }
};

/// Compares two rows by the columns that both tables have.
RowVerdict judge_rows(const std::vector<ColumnPair>& pairs, const RowPair& rows, bool two_forms) {
    RowVerdict verdict;
    const double rays = number_of(rows.a, rows.r, "rays"), other_rays = number_of(rows.b, rows.q, "rays");
    const bool shares = rays > 0 && other_rays > 0 && rays != other_rays;
    double wrong = 0, bits = 0;  // how much more the second has
    double wrongly = 0;          // wrong decisions of the first
    bool one_sided = false;
    for (const auto& [x, y, tolerance] : pairs) {
        const bool decisions = is_wrong(x->name), lost = x->name == "lost_bits_p99";
        if (!decisions && !lost) continue;
        (decisions ? verdict.by_decisions : verdict.by_bits) = true;
        const double before = cell_number(x->cells[rows.r]), after = cell_number(y->cells[rows.q]);
        if (decisions && before > 0) wrongly += before;
        const bool differs = judge_cells(x->cells[rows.r], y->cells[rows.q], tolerance, false).differs;
        if (!differs && (!shares || tolerance != nullptr)) continue;
        if (decisions && shares) wrong += after * rays - before * other_rays;  // exact below 2^53
        else if (std::isnan(after - before)) one_sided |= lost && std::isnan(after) != std::isnan(before);
        else (decisions ? wrong : bits) += after - before;
    }
    if (!verdict.by_decisions && !verdict.by_bits) return verdict;
    verdict.by_shares = shares && verdict.by_decisions;
    const double more = wrong != 0 ? wrong : bits;
    if (two_forms && rows.has_other_truth()) ++verdict.other_truth;
    else if (wrong == 0 && one_sided) ++verdict.one_sided;
    else ++(more < 0 ? verdict.better : more > 0 ? verdict.worse : verdict.even);
    verdict.of_other_hits = two_forms && wrong == 0 && wrongly > 0 ? verdict.better + verdict.worse : 0;
    return verdict;
}

}  // namespace

void RowVerdict::add(const RowVerdict& other) {
    better += other.better;
    worse += other.worse;
    even += other.even;
    other_truth += other.other_truth;
    one_sided += other.one_sided;
    of_other_hits += other.of_other_hits;
    by_decisions |= other.by_decisions;
    by_bits |= other.by_bits;
    by_shares |= other.by_shares;
}

std::string RowVerdict::text(const std::string& second) const {
    std::vector<std::string> lines;
    if (other_truth > 0)
        lines.push_back(
            fmt::format("not comparable in {}: the two forms are asked different questions, so other rays are "
                        "hits (agree_hit + false_miss differ)",
                        scene::toml::counted(other_truth, "row")));
    if (one_sided > 0)
        lines.push_back(
            fmt::format("not comparable in {}: as many wrong decisions, but only one side has a lost_bits_p99",
                        scene::toml::counted(one_sided, "row")));
    if (of_other_hits > 0)
        lines.push_back(fmt::format(
            "in {} both forms decide equally many rays wrongly, perhaps not the same ones: each lost_bits_p99 is "
            "over its own hits; `lostbits map --against` compares the hits that both have",
            scene::toml::counted(of_other_hits, "row")));
    if (better + worse + even > 0)
        lines.push_back(fmt::format("{} is better in {}, worse in {}, the same in {}: by {}{}{}{}", second,
                                    scene::toml::counted(better, "row"), worse, even, by_shares ? "the share of " : "",
                                    by_decisions ? "wrong decisions" : "", by_decisions && by_bits ? ", then by " : "",
                                    by_bits ? "lost_bits_p99" : ""));
    return fmt::format("{}", fmt::join(lines, "\n"));
}

void RowChanges::add(RowChanges other) {
    verdict.add(other.verdict);
    rows += other.rows;
    changed += other.changed;
    count += other.count;
    const auto append = [](auto& to, auto& from) {
        to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
    };
    append(only_a, other.only_a);
    append(only_b, other.only_b);
    append(outcomes, other.outcomes);
    append(cells, other.cells);
    append(columns, other.columns);
    append(names, other.names);
}

void RowChanges::sort() {
    std::ranges::stable_sort(outcomes, [](const auto& a, const auto& b) { return a.rays > b.rays; });
    std::ranges::stable_sort(
        cells, [](const CellChange& a, const CellChange& b) { return a.bits != b.bits ? a.bits : a.size > b.size; });
}

bool has_row_keys(const CsvTable& table) {
    const auto keys = key_columns(table);
    return !keys.empty() && table.rows() > 0 && keyed(table, {}).order.size() == table.rows();
}

RowChanges compare_rows(const CsvTable& a, const CsvTable& b, const std::string& subject, const CompareOptions& options,
                        const RowChoice& of_a, const RowChoice& of_b) {
    RowChanges found;
    const bool two_forms = !of_a.form.empty();
    std::vector<ColumnPair> pairs;
    std::set<const CsvColumn*> keys;
    for (const CsvColumn* key : key_columns(a)) keys.insert(key);
    for (const CsvColumn& column : a.columns) {
        found.names.push_back(column.name);
        if (is_ignored(options, column.name) || keys.contains(&column)) continue;
        const CsvColumn* const other = b.find(column.name);
        if (other != nullptr) pairs.push_back({&column, other, tolerance_of(column.name, options)});
        else found.columns.push_back(fmt::format("{}column {} is missing in the second", subject, column.name));
    }
    for (const CsvColumn& column : b.columns) {
        if (a.find(column.name) != nullptr) continue;
        found.names.push_back(column.name);
        if (!is_ignored(options, column.name))
            found.columns.push_back(fmt::format("{}column {} is added in the second", subject, column.name));
    }
    const KeyedRows left = keyed(a, of_a), right = keyed(b, of_b);
    for (const std::string& key : right.order) {
        if (!left.row.contains(key)) found.only_b.push_back(subject + key);
    }
    for (const std::string& key : left.order) {
        const auto other = right.row.find(key);
        if (other == right.row.end()) {
            found.only_a.push_back(subject + key);
            continue;
        }
        ++found.rows;
        const std::size_t r = left.row.at(key), q = other->second;
        found.verdict.add(judge_rows(pairs, {a, b, r, q}, two_forms));
        OutcomeChange outcome{subject + key, {}, 0};
        bool differs = false;
        for (const auto& [x, y, tolerance] : pairs) {
            const std::string_view before = x->cells[r], after = y->cells[q];
            if (before == after) continue;
            const bool place = is_place(x->name);
            const PairVerdict v = judge_cells(before, after, tolerance, tolerance == nullptr && place);
            if (!v.differs || (two_forms && (place || (!v.measured && !v.not_finite)))) continue;
            differs = true;
            ++found.count;
            if (is_outcome(x->name)) {
                outcome.text += fmt::format("{}{} {} to {}", outcome.text.empty() ? "" : ", ", x->name, before, after);
                outcome.rays += v.absolute;
            } else if (!place) {
                const bool bits = x->name.find("bits") != std::string::npos;
                const double size = !v.measured ? HUGE_VAL : bits ? v.absolute : v.relative;
                found.cells.push_back({subject + key, x->name, shown(before), shown(after), bits, size});
            }
        }
        found.changed += differs;
        if (!outcome.text.empty()) found.outcomes.push_back(std::move(outcome));
    }
    found.sort();
    return found;
}

}  // namespace lostbits::output::diff
