// Whether what is compared was made with the same numbers: the commands that stand beside results say it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lostbits::analysis::diff {

/// `--set sphere[0].radius=1.0001 only in after`: for each option that changes what is measured (the size of a picture,
/// numbers of a scene, draws) and is not the same in the commands that made two folders. Nothing where a folder does
/// not say what made it.
std::vector<std::string> made_differently(const std::filesystem::path& a, const std::filesystem::path& b);

/// The same of every folder below the two that has results, with its name in front.
std::vector<std::string> made_differently_below(const std::filesystem::path& a, const std::filesystem::path& b);

/// Prints them below a heading; nothing where there are none.
void print_made_differently(const std::vector<std::string>& lines);

}  // namespace lostbits::analysis::diff
