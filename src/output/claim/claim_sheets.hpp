// Pictures for the document of claims.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/claim/claim.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::output::claim {

/// The scene of that name that claims are about; the first of its variants where none is named.
scene::file::Scene shown_scene(const std::string& name, const measure::claim::ClaimRequest& run);

/// All checks of consistency of a scene, by the rows that claims name, into `folder`/pictures; the Markdown that shows
/// it.
std::string picture_consistency(const std::filesystem::path& folder,
                                const std::vector<measure::evaluate::TestedForm>& rows, const std::string& name,
                                const measure::claim::ClaimRequest& run);

/// The pictures of `lostbits report`, which tests/browser/screenshots.js takes, as far as the folder has them.
std::string screenshots_in(const std::filesystem::path& folder);

}  // namespace lostbits::output::claim
