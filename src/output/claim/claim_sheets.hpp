// Sheets of scenes for the document of claims.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "measure/map/map.hpp"

namespace lostbits::output::claim {

/// All checks of consistency of a scene, by the rows that claims name, into `folder`/pictures; the Markdown that shows
/// it.
std::string picture_consistency(const std::filesystem::path& folder, const std::vector<measure::map::MapRow>& rows,
                                const std::string& name, const std::filesystem::path& data_dir);

}  // namespace lostbits::output::claim
