// Outcome of a ray: decisions are classified before any error is measured.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "measure/truth/truth.hpp"

namespace lostbits::measure::answer {

/// Error metrics exist for `agree_hit` only. `not_a_number`: the form claims a hit at NaN. `wrong_primitive`: form and
/// truth both hit, but the form hits another primitive than the ray meets first. `crack`, `double_hit`,
/// `wrong_neighbour` and `out_of_order` occur at meshes only; `wrong_neighbour` is not an error. Files store outcomes
/// as numbers, so new ones are appended.
enum class Outcome : std::uint8_t {
    agree_hit,
    agree_miss,
    false_hit,
    false_miss,
    not_a_number,
    unresolved,
    wrong_primitive,
    crack,
    double_hit,
    wrong_neighbour,
    out_of_order
};

inline constexpr std::array<std::string_view, 11> outcome_names{
    "agree_hit",       "agree_miss", "false_hit",  "false_miss",      "not_a_number", "unresolved",
    "wrong_primitive", "crack",      "double_hit", "wrong_neighbour", "out_of_order"};
/// Number of outcomes, counted from the first, that are possible where a ray has a single primitive.
inline constexpr std::size_t single_primitive_outcome_count = 6;
/// Number of outcomes that are possible where a ray has several primitives that are not a mesh.
inline constexpr std::size_t outcome_count_without_mesh = 7;

/// The ways in which a decision can be wrong. A summary names the most frequent kind, and the first in this list among
/// equally frequent ones.
inline constexpr std::array wrong_decisions{Outcome::not_a_number,    Outcome::false_miss, Outcome::false_hit,
                                            Outcome::wrong_primitive, Outcome::crack,      Outcome::double_hit,
                                            Outcome::out_of_order};
inline constexpr bool is_wrong(Outcome outcome) {
    return std::ranges::find(wrong_decisions, outcome) != wrong_decisions.end();
}

/// Outcome of a ray with one primitive. With several, a hit of another primitive than the true one is a
/// `wrong_primitive`.
inline Outcome classify(truth::Truth::Decision truth, bool hit, double t) {
    if (truth == truth::Truth::Decision::unresolved) return Outcome::unresolved;
    if (hit && std::isnan(t)) return Outcome::not_a_number;
    if (truth == truth::Truth::Decision::hit) return hit ? Outcome::agree_hit : Outcome::false_miss;
    return hit ? Outcome::false_hit : Outcome::agree_miss;
}

/// Table of `classify` for all cases of its three arguments. A look-up needs no branch.
class OutcomeTable {
public:
    /// Pass `false` for a form that reports no t: a NaN is then ignored.
    explicit OutcomeTable(bool reports_t = true) {
        using Decision = truth::Truth::Decision;
        for (const Decision decision : {Decision::miss, Decision::hit, Decision::unresolved})
            for (const bool hit : {false, true})
                for (const bool is_nan : {false, true})
                    cases_[case_index(decision, hit, is_nan)] = classify(decision, hit, is_nan && reports_t ? NAN : 0);
    }
    static constexpr std::size_t case_index(truth::Truth::Decision decision, bool hit, bool is_nan) {
        return 4 * static_cast<std::size_t>(decision) + 2 * static_cast<std::size_t>(hit) +
               static_cast<std::size_t>(is_nan);
    }
    Outcome operator[](std::size_t case_index) const { return cases_[case_index]; }

private:
    std::array<Outcome, 12> cases_;
};

}  // namespace lostbits::measure::answer
