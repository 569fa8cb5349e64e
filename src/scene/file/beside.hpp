// A file that another names.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace lostbits::scene::file {

/// `x.toml` as the file `by` means it: the one that lies beside `by`, if there is one; otherwise the name as it is.
inline std::string beside(const std::filesystem::path& by, const std::string& name) {
    const std::filesystem::path given(name), there = by.parent_path() / given;
    std::error_code ignored;
    const bool is_file = given.is_relative() && given.extension() == ".toml";
    return is_file && std::filesystem::is_regular_file(there, ignored) ? there.string() : name;
}

}  // namespace lostbits::scene::file
