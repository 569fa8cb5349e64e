// What a file of input is called in results: they lie in a folder of that name.
#pragma once

#include <filesystem>
#include <string>

namespace lostbits::scene::toml {

/// The name of a file without its ending. InputError where it leads out of the folder of results or hides in it (a dot
/// in front, as `...toml` has), or cannot be shown (control characters).
[[nodiscard]] std::string result_name(const std::filesystem::path& file);

}  // namespace lostbits::scene::toml
