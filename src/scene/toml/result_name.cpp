#include "scene/toml/result_name.hpp"

#include <algorithm>

#include "number/error.hpp"

namespace lostbits::scene::toml {

std::string result_name(const std::filesystem::path& file) {
    std::string name = file.stem().string();
    if (name.starts_with('.'))
        throw InputError(file.string() +
                         ": results are called as the file without its ending, and this name gives none; rename it to "
                         "start with a letter");
    if (std::ranges::any_of(name, [](unsigned char c) { return c < ' ' || c == 0x7F; }))
        throw InputError(file.string() +
                         ": results are called as the file without its ending, and this name has a line break or "
                         "another control character; rename it");
    return name;
}

}  // namespace lostbits::scene::toml
