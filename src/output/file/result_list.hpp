// The list that a run leaves in its folder: what made which files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output/file/result_folder.hpp"

namespace lostbits::output::file {

inline constexpr const char* list_name = "manifest.json";

/// What the list of a folder names, the last run first; nothing where there is no list, or none of ours.
[[nodiscard]] std::vector<ResultFolder::Made> made_in(const std::filesystem::path& folder);

/// The contents of a list.
[[nodiscard]] std::string list_text(const ResultFolder::Made& last, const std::vector<ResultFolder::Made>& others);

}  // namespace lostbits::output::file
