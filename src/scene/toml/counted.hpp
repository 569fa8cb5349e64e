// Counts in words: `1 ray`, `2 rays`.
#pragma once

#include <string>
#include <string_view>

namespace lostbits::scene::toml {

/// `thing` is what one of them is called; `things` what several are, where that is more than an s behind it.
template <class Count>
std::string counted(Count n, std::string_view thing, std::string_view things = {}) {
    std::string text = std::to_string(n) + " ";
    if (n == Count{1}) return text.append(thing);
    return things.empty() ? text.append(thing) + "s" : text.append(things);
}

}  // namespace lostbits::scene::toml
