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

std::string in_words(std::string_view cell) {
    using Kind = file::CellValue::Kind;
    const Kind kind = file::read_cell(cell).kind;
    return kind == Kind::missing ? "(empty)" : kind == Kind::text ? in_quotes(cell) : std::string(cell);
}

/// Marks which of a list of distinct numbers are in one longest increasing subsequence. The others are the fewest that
/// have to move to sort the list.
/// Patience sorting: `ends[k]` is the end of the increasing list of k + 1 numbers whose last number is smallest. Takes
/// n log n steps for n numbers.
std::vector<bool> in_order(const std::vector<std::size_t>& list) {
    constexpr std::size_t none = SIZE_MAX;
    std::vector<std::size_t> ends, before(list.size(), none);
    for (std::size_t i = 0; i < list.size(); ++i) {
        const auto place = std::ranges::lower_bound(ends, list[i], {}, [&](std::size_t end) { return list[end]; });
        if (place != ends.begin()) before[i] = *(place - 1);
        if (place == ends.end()) ends.push_back(i);
        else *place = i;
    }
    std::vector<bool> in(list.size());
    for (std::size_t i = ends.empty() ? none : ends.back(); i != none; i = before[i]) in[i] = true;
    return in;
}

/// A column that both tables have.
struct Pair {
    const CsvColumn *a, *b;
    const Tolerance* tolerance;
    bool as_text;
};

/// Records the differences of the headers and returns the columns of both, in the first table's order.
std::vector<Pair> match_headers(const CsvTable& a, const CsvTable& b, Ledger& ledger) {
    std::vector<Pair> pairs;
    std::vector<std::size_t> places;
    for (const CsvColumn& column : a.columns) {
        ledger.result.names.push_back(column.name);
        if (ignores(ledger.options, column.name)) continue;
        const CsvColumn* other = b.find(column.name);
        if (other == nullptr) {
            ledger.add(1, [&] { return fmt::format("column {} is missing in the second", column.name); });
            continue;
        }
        const Tolerance* tolerance = tolerance_of(column.name, ledger.options);
        pairs.push_back({&column, other, tolerance, tolerance == nullptr && column.name.ends_with("_hex")});
        places.push_back(static_cast<std::size_t>(other - b.columns.data()));
    }
    for (const CsvColumn& column : b.columns) {
        if (a.find(column.name) != nullptr) continue;
        ledger.result.names.push_back(column.name);
        if (!ignores(ledger.options, column.name))
            ledger.add(1, [&] { return fmt::format("column {} is added in the second", column.name); });
    }
    const auto stays = in_order(places);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (stays[i]) continue;
        const auto place = pairs[i].a - a.columns.data() + 1;
        ledger.add(1, [&] {
            return fmt::format("column {} moved from place {} to place {}", pairs[i].a->name, place, places[i] + 1);
        });
    }
    return pairs;
}

/// Rows of two tables that are compared with each other, and rows of one table alone.
struct RowPairs {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    std::vector<std::size_t> only_a, only_b;
    const CsvColumn* id = nullptr;  ///< the column of the first table by which they are paired
};

/// Pairs rows with the same `id` (claims) if both tables have such a column without repetitions, and otherwise rows
/// with the same number.
RowPairs pair_rows(const CsvTable& a, const CsvTable& b) {
    const CsvColumn *const x = a.find("id"), *const y = b.find("id");
    std::map<std::string_view, std::size_t> of_a, of_b;
    if (x != nullptr && y != nullptr) {
        for (std::size_t r = 0; r < a.rows(); ++r) of_a.emplace(x->cells[r], r);
        for (std::size_t r = 0; r < b.rows(); ++r) of_b.emplace(y->cells[r], r);
    }
    RowPairs found;
    if (x == nullptr || y == nullptr || of_a.size() < a.rows() || of_b.size() < b.rows()) {
        for (std::size_t r = 0; r < std::min(a.rows(), b.rows()); ++r) found.pairs.emplace_back(r, r);
        return found;
    }
    found.id = x;
    for (std::size_t r = 0; r < a.rows(); ++r) {
        const auto other = of_b.find(x->cells[r]);
        if (other == of_b.end()) found.only_a.push_back(r);
        else found.pairs.emplace_back(r, other->second);
    }
    for (std::size_t r = 0; r < b.rows(); ++r) {
        if (!of_a.contains(y->cells[r])) found.only_b.push_back(r);
    }
    return found;
}

}  // namespace

Comparison compare(const CsvTable& a, const CsvTable& b, const CompareOptions& options) {
    Ledger ledger{options, {}};
    const auto pairs = match_headers(a, b, ledger);
    const RowPairs rows = pair_rows(a, b);
    const auto named = [&](std::size_t r) { return rows.id == nullptr ? "" : in_quotes(rows.id->cells[r]) + ": "; };
    for (const Pair& p : pairs) ledger.result.columns.emplace_back().name = p.a->name;
    ledger.result.rows = rows.pairs.size();
    for (const auto& [r, q] : rows.pairs) {
        const std::uint64_t before = ledger.result.count;
        for (std::size_t c = 0; c < pairs.size(); ++c) {
            const std::string_view left = pairs[c].a->cells[r], right = pairs[c].b->cells[q];
            if (left == right) continue;
            const PairVerdict v = judge_cells(left, right, pairs[c].tolerance, pairs[c].as_text);
            if (!record_verdict(ledger.result.columns[c], v, [&] { return fmt::format("line {}", a.lines[r]); }))
                continue;
            ledger.add(a.lines[r], [&] {
                return fmt::format("{}{}: {} != {}{}", named(r), pairs[c].a->name, in_words(left), in_words(right),
                                   distances(v));
            });
        }
        ledger.result.rows_differ += ledger.result.count > before;
    }
    for (const std::size_t r : rows.only_a) ledger.add(a.lines[r], [&] { return named(r) + "missing in the second"; });
    for (const std::size_t r : rows.only_b)
        ledger.add(0, [&] { return in_quotes(b.find("id")->cells[r]) + ": added in the second"; });
    if (rows.id == nullptr && a.rows() != b.rows())
        ledger.add(0, [&] {
            return fmt::format("rows: {} != {}; the first {} are compared", a.rows(), b.rows(), rows.pairs.size());
        });
    return ledger.result;
}

}  // namespace lostbits::output::diff
