// Names of files of input: what their results are called, and what to try when one is not there.
#pragma once

#include <filesystem>
#include <string>

namespace lostbits::scene::toml {

/// The name of a file without its ending. InputError where it leads out of the folder of results or hides in it (a dot
/// in front, as `...toml` has), or cannot be shown (control characters).
[[nodiscard]] std::string result_name(const std::filesystem::path& file);

/// `did you mean "sub/mine.toml"?` for `sub/mine.tom` or `sub/mine`: the TOML file of that folder whose name is
/// nearest, if a slip of the fingers explains it. Empty otherwise.
std::string nearby_file(const std::filesystem::path& path);

/// What to say of a path that somebody named and the system does not follow: links in a circle, a part that is a file,
/// a folder that may not be read.
[[nodiscard]] std::string words_about(const std::filesystem::filesystem_error& error);

}  // namespace lostbits::scene::toml
