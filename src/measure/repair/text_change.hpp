// Changes of a text, and the unified diff that `patch` applies.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intersect/source_text/source_tokens.hpp"

namespace lostbits::measure::repair {

/// Replaces the text at `span` by `text`.
struct TextChange {
    intersect::source_text::TextSpan span;
    std::string text;
};

/// Returns the text with the changes; insertions at the same offset keep their order. Empty if two changes overlap.
std::optional<std::string> apply_changes(const std::string& text, std::vector<TextChange> changes);

/// Difference of two texts as `patch -p0` reads it, with three lines around each change.
std::string make_unified_diff(const std::string& path, const std::string& old_text, const std::string& new_text);

}  // namespace lostbits::measure::repair
