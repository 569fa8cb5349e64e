// The claims as a document: README.md with every sentence, its verdict, its number and a picture of what it is about.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/claim/claim.hpp"

namespace lostbits::output::claim {

/// The claims about one scene, sweep or table.
struct ClaimSubject {
    std::string name;
    std::vector<std::size_t> claims;  ///< their places
};
/// Each subject once, in the order of the first claim about it.
[[nodiscard]] std::vector<ClaimSubject> subjects_of(const std::vector<scene::claim::Claim>& claims);

/// Writes `README.md`, `claims.csv` and `pictures/` into a folder; the same claims and results give the same bytes. A
/// scene is shown as a contact sheet, a sweep as its plots, cases as their matrix: of the forms that are claimed about.
void write_claim_report(const std::filesystem::path& folder, const std::vector<scene::claim::Claim>& claims,
                        const std::vector<measure::claim::ClaimResult>& results,
                        const measure::claim::ClaimRequest& run);

}  // namespace lostbits::output::claim
