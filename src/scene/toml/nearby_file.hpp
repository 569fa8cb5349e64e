// What to try when a file is not there: one beside it with almost that name.
#pragma once

#include <filesystem>
#include <string>

namespace lostbits::scene::toml {

/// `did you mean "sub/mine.toml"?` for `sub/mine.tom` or `sub/mine`: the TOML file of that folder whose name is
/// nearest, if a slip of the fingers explains it. Empty otherwise.
std::string nearby_file(const std::filesystem::path& path);

}  // namespace lostbits::scene::toml
