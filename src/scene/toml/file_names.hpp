// Names of input files: the names of their results, and advice when a file does not exist.
#pragma once

#include <filesystem>
#include <string>

namespace lostbits::scene::toml {

/// Returns the name of a file without its ending. Throws InputError if that name leads out of the folder of results,
/// would be hidden there (a dot in front, as in `...toml`), or cannot be shown (control characters).
[[nodiscard]] std::string result_name(const std::filesystem::path& file);

/// Returns `did you mean "sub/mine.toml"?` for `sub/mine.tom` or `sub/mine`: the TOML file of that folder with the
/// nearest name, if a typing error explains the difference. Otherwise empty.
std::string suggest_file(const std::filesystem::path& path);

/// Returns the message for a path that the system cannot resolve: links in a circle, a part that is a file, a folder
/// that may not be read.
[[nodiscard]] std::string error_phrase(const std::filesystem::filesystem_error& error);

/// Returns the folder `scenes`, `sweeps` or `claims` of the data folder. Throws InputError if it does not exist, since
/// an empty list would hide this fault.
[[nodiscard]] std::filesystem::path find_data_folder(const std::filesystem::path& data_dir,
                                                     const std::string& folder_name);

}  // namespace lostbits::scene::toml
