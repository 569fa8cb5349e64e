// What a sentence says of the number that is measured for it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::claim {

/// The numbers of which a sentence is true: "no ray is missed" says = 0 of a share of misses.
struct Criterion {
    double low, high;  ///< both count; a bound that is not met itself (`> 0`) is the next double beyond it
    std::string text;  ///< as tables show it: `>= 10`, `[0.4, 0.6]`

    /// True of all numbers from `from` to `to`.
    [[nodiscard]] bool is_met_by(double from, double to) const { return low <= from && to <= high; }
    /// True of none of them.
    [[nodiscard]] bool is_failed_by(double from, double to) const { return to < low || high < from; }
    /// A verdict follows from what the sentence says of every number that the interval from `from` to `to` admits, so
    /// whatever is measured in it confirms the verdict too. InputError at the criterion where it does not.
    void demand(const toml::TableReader& table, std::string_view verdict, double from, double to) const;
};

/// The key `criterion`: a comparison ("= 0", "< 1", "<= 1", "> 0", ">= 10"), or the two ends of an interval. InputError
/// for anything else.
std::optional<Criterion> read_criterion(toml::TableReader& table);

}  // namespace lostbits::scene::claim
