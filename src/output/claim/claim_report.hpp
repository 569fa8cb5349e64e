// The claims as a document: README.md with every sentence, its verdict, its number and a picture of what it is about.
#pragma once

#include <filesystem>
#include <vector>

#include "measure/claim/claim.hpp"

namespace lostbits::output::claim {

/// Writes `README.md`, `claims.csv` and `pictures/` into a folder; the same claims and results give the same bytes. A
/// scene is shown as a contact sheet, a sweep as its plots, cases as their matrix: of the forms that are claimed about.
void write_claim_report(const std::filesystem::path& folder, const std::vector<scene::claim::Claim>& claims,
                        const std::vector<measure::claim::ClaimResult>& results, const std::filesystem::path& data_dir);

}  // namespace lostbits::output::claim
