// Claims as HTML: how many hold, and each with its number and the place it was measured at.
#pragma once

#include <string>

#include "output/page/page.hpp"

namespace lostbits::output::page {

struct VerdictCounts {
    std::size_t held = 0, refuted = 0, differing = 0, broken = 0, skipped = 0;
    void add(const scene::claim::Claim& claim, const measure::claim::ClaimResult& result);
};
[[nodiscard]] VerdictCounts count_verdicts(const Report& report);

/// The counts as tiles, the gravest first to be seen.
[[nodiscard]] std::string verdict_tiles(const VerdictCounts& counts);
/// A table per subject, with a row per claim; where the page shows what it was measured on, its place is a link to it.
[[nodiscard]] std::string claims_table(const Report& report);

}  // namespace lostbits::output::page
