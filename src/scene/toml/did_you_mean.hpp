// What to try when a name is unknown: the same words for keys, scenes, forms, formats and metrics.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lostbits::scene::toml {

/// The smallest number of letters to insert, delete, replace or swap with a neighbour that turns `a` into `b`
/// ("optimal string alignment"; upper and lower case count as the same letter).
int edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word`, the first of equals, if a slip of the fingers explains it: at most one edit in a
/// word of up to five letters, two up to eight, then a third of its length.
std::optional<std::string> slip_of(std::string_view word, const std::vector<std::string>& candidates);

/// The same, or the only candidate that begins with `word`, or with all but its last letter, or whose letters stand in
/// `word` in their order.
std::optional<std::string> closest(std::string_view word, const std::vector<std::string>& candidates);

/// A text of a user as messages have it: of many letters the first, and how many bytes there are.
std::string excerpt(std::string_view text);
/// The same in quotes.
std::string quoted_excerpt(std::string_view text);

/// The end of an error message: `did you mean "camera"?`, or, with nothing near, `known here: "camera", "size"`
/// (at most twelve, then their number). Empty only where there are no candidates.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace lostbits::scene::toml
