// What became of a ray: classified before any error is measured.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "measure/truth/truth.hpp"

namespace lostbits::measure::answer {

/// Error metrics exist on `agree_hit` alone. `not_a_number` is a form that claims a hit at NaN; `wrong_object` is a hit
/// where there is one, but on another solid than the ray meets first; `crack`, `double_hit`, `wrong_neighbour`
/// and `out_of_order` are of meshes alone, and `wrong_neighbour` is no error. Files number outcomes: new ones stand
/// last.
enum class Outcome : std::uint8_t {
    agree_hit,
    agree_miss,
    false_hit,
    false_miss,
    not_a_number,
    unresolved,
    wrong_object,
    crack,
    double_hit,
    wrong_neighbour,
    out_of_order
};

inline constexpr std::array<std::string_view, 11> outcome_names{
    "agree_hit",    "agree_miss", "false_hit",  "false_miss",      "not_a_number", "unresolved",
    "wrong_object", "crack",      "double_hit", "wrong_neighbour", "out_of_order"};
/// So many of them, from the first, are there where a ray has one solid to hit.
inline constexpr std::size_t outcomes_of_one_solid = 6;
/// So many where it has several that are not a mesh.
inline constexpr std::size_t outcomes_without_mesh = 7;

/// The ways in which a decision can be wrong. Of several kinds in one summary the most frequent counts, the first here
/// of equally frequent ones.
inline constexpr std::array wrong_decisions{Outcome::not_a_number, Outcome::false_miss, Outcome::false_hit,
                                            Outcome::wrong_object, Outcome::crack,      Outcome::double_hit,
                                            Outcome::out_of_order};
inline constexpr bool is_wrong(Outcome outcome) {
    return std::ranges::find(wrong_decisions, outcome) != wrong_decisions.end();
}

/// Of a ray with one solid; where there are several, a hit of another one than the true one is a `wrong_object`.
inline Outcome classify(truth::Truth::Decision truth, bool hit, double t) {
    if (truth == truth::Truth::Decision::unresolved) return Outcome::unresolved;
    if (hit && std::isnan(t)) return Outcome::not_a_number;
    if (truth == truth::Truth::Decision::hit) return hit ? Outcome::agree_hit : Outcome::false_miss;
    return hit ? Outcome::false_hit : Outcome::agree_miss;
}

/// `classify` of every case of the three things that it depends on, so that no ray has to wait for a branch.
class OutcomeTable {
public:
    /// Where a form does not tell t, NaN is as good as any.
    explicit OutcomeTable(bool tells_t = true) {
        using Decision = truth::Truth::Decision;
        for (const Decision decision : {Decision::miss, Decision::hit, Decision::unresolved})
            for (const bool hit : {false, true})
                for (const bool is_nan : {false, true})
                    cases_[place(decision, hit, is_nan)] = classify(decision, hit, is_nan && tells_t ? NAN : 0);
    }
    static constexpr std::size_t place(truth::Truth::Decision decision, bool hit, bool is_nan) {
        return 4 * static_cast<std::size_t>(decision) + 2 * static_cast<std::size_t>(hit) +
               static_cast<std::size_t>(is_nan);
    }
    Outcome operator[](std::size_t place) const { return cases_[place]; }

private:
    std::array<Outcome, 12> cases_;
};

}  // namespace lostbits::measure::answer
