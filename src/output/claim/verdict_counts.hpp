// How many sentences hold, and how many do not: those of a source apart from our own.
#pragma once

#include <string>
#include <vector>

#include "measure/claim/claim.hpp"

namespace lostbits::output::claim {

struct VerdictCounts {
    std::size_t held = 0, qualified = 0, refuted = 0, differing = 0, broken = 0, skipped = 0;
    std::size_t with_criterion = 0;  ///< of the verdicts that are confirmed, those that follow from a criterion

    void add(const scene::claim::Claim& claim, const measure::claim::ClaimResult& result);
    [[nodiscard]] std::size_t confirmed() const { return held + qualified + refuted; }
    /// `4 hold, 1 is qualified, 2 are refuted`; `none` where none is confirmed.
    [[nodiscard]] std::string text() const;
};

struct CountsBySource {
    VerdictCounts all, sourced, own;
    /// `from a source 1 holds, 1 is refuted; of our own 2 hold`, without that of which there is none
    [[nodiscard]] std::string text() const;
};
[[nodiscard]] CountsBySource count_verdicts(const std::vector<scene::claim::Claim>& claims,
                                            const std::vector<measure::claim::ClaimResult>& results);

}  // namespace lostbits::output::claim
