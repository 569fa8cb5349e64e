// Pictures for the document of claims.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/claim/claim.hpp"

namespace lostbits::output::claim {

/// What is shown of a subject, and of which claims about it.
struct ShownSubject {
    const std::filesystem::path& folder;
    std::vector<const scene::claim::Claim*> claims;
    const measure::claim::ClaimRequest& run;
};

/// Drawn into `folder`/pictures; the Markdown that shows it, empty for what has no picture.
std::string pictures_of(const ShownSubject& shown);

}  // namespace lostbits::output::claim
