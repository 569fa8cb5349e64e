// Writes counts with their noun: `1 ray`, `2 rays`.
#pragma once

#include <string>
#include <string_view>

namespace lostbits::text {

/// Returns `2 rays` for n = 2 and `noun` = "ray". `plural` is the plural, if it is not `noun` followed by an s.
template <class Count>
std::string count_with_noun(Count n, std::string_view noun, std::string_view plural = {}) {
    std::string text = std::to_string(n) + " ";
    if (n == Count{1}) return text.append(noun);
    return plural.empty() ? text.append(noun) + "s" : text.append(plural);
}

}  // namespace lostbits::text
