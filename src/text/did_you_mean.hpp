// Gives advice for an unknown name, in the same words for keys, scenes, forms, formats and metrics.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lostbits::text {

/// Returns the smallest number of letters to insert, delete, replace or swap with a neighbour that turns `a` into `b`
/// ("optimal string alignment"). Upper and lower case count as the same letter.
int edit_distance(std::string_view a, std::string_view b);

/// Returns the candidate with the fewest edits from `word` (the first if several have equally many), if a typing error
/// explains the difference: at most one edit in a word of up to five letters, two up to eight, then a third of its
/// length.
std::optional<std::string> match_typo(std::string_view word, const std::vector<std::string>& candidates);

/// Returns `match_typo`, or the only candidate that begins with `word` or with all but its last letter, or whose
/// letters appear in `word` in their order.
std::optional<std::string> closest(std::string_view word, const std::vector<std::string>& candidates);

/// Shortens a user's text for messages: of a long text, its first letters and the number of its bytes.
std::string excerpt(std::string_view text);
/// Returns `excerpt` in quotes.
std::string quoted_excerpt(std::string_view text);

/// Returns the end of an error message: `did you mean "camera"?`; if nothing is near, `names that contain it:
/// "box-far", "cone-far"`; if no name contains it, `known here: "camera", "size"`. Lists at most twelve names, then the
/// number of the others. Empty only if there are no candidates.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace lostbits::text
