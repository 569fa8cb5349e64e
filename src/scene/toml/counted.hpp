// Writes counts with their noun: `1 ray`, `2 rays`.
#pragma once

#include <string>
#include <string_view>

namespace lostbits::scene::toml {

/// `thing` is the noun for one; `things` is the plural if it is not just `thing` and an s.
template <class Count>
std::string counted(Count n, std::string_view thing, std::string_view things = {}) {
    std::string text = std::to_string(n) + " ";
    if (n == Count{1}) return text.append(thing);
    return things.empty() ? text.append(thing) + "s" : text.append(things);
}

}  // namespace lostbits::scene::toml
