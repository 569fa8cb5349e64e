// Claims as HTML: how many hold, and each with its number and the place it was measured at.
#pragma once

#include <string>

#include "output/claim/claim_files.hpp"
#include "output/page/page.hpp"

namespace lostbits::output::page {

/// The counts as tiles, the gravest first to be seen.
[[nodiscard]] std::string verdict_tiles(const claim::VerdictCounts& counts);
/// A table per subject, with a row per claim; where the page shows what it was measured on, its place is a link to it.
[[nodiscard]] std::string claims_table(const Report& report);

}  // namespace lostbits::output::page
