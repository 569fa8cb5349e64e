// Writes counts with their noun: `1 ray`, `2 rays`.
#pragma once

#include <string>
#include <string_view>

namespace lostbits::scene::toml {

/// Returns `2 rays` for n = 2 and `thing` = "ray". `things` is the plural, if it is not `thing` followed by an s.
template <class Count>
std::string count_with_noun(Count n, std::string_view thing, std::string_view things = {}) {
    std::string text = std::to_string(n) + " ";
    if (n == Count{1}) return text.append(thing);
    return things.empty() ? text.append(thing) + "s" : text.append(things);
}

}  // namespace lostbits::scene::toml
