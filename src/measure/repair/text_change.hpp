// Changes of a text, and the unified diff that `patch` applies.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intersect/source_text/source_tokens.hpp"

namespace lostbits::measure::repair {

struct TextChange {
    intersect::source_text::TextSpan span;
    std::string text;
};

/// Returns the text with the changes; insertions at the same offset keep their order. Empty if two changes overlap.
std::optional<std::string> changed_text(const std::string& text, std::vector<TextChange> changes);

/// The difference of two texts with three lines around each change, for `patch -p0`.
std::string unified_diff(const std::string& path, const std::string& old_text, const std::string& new_text);

}  // namespace lostbits::measure::repair
