#include "text/did_you_mean.hpp"

#include <algorithm>
#include <utility>

namespace lostbits::text {
namespace {

constexpr std::size_t max_listed = 12;

char to_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

int max_edits(std::size_t letter_count) {
    if (letter_count <= 1) return 0;
    if (letter_count <= 5) return 1;
    if (letter_count <= 8) return 2;
    return static_cast<int>(letter_count / 3);
}

/// Returns the candidate for which `matches` is true, if there is exactly one.
template <class Matches>
std::optional<std::string> single_match(const std::vector<std::string>& candidates, const Matches& matches) {
    const auto found = std::ranges::find_if(candidates, matches);
    if (found == candidates.end() || std::find_if(found + 1, candidates.end(), matches) != candidates.end()) return {};
    return *found;
}

/// True if the letters of `part` appear in `whole` in their order, beginning with its first letter.
bool is_subsequence(std::string_view part, std::string_view whole) {
    if (part.size() < 3 || part.front() != whole.front()) return false;
    std::size_t matched = 0;
    for (const char c : whole) matched += matched < part.size() && part[matched] == c;
    return matched == part.size();
}

}  // namespace

std::string excerpt(std::string_view text) {
    constexpr std::size_t max_bytes = 400;
    if (text.size() <= max_bytes) return std::string(text);
    std::size_t end = max_bytes / 4;
    while ((text[end] & 0xC0) == 0x80) --end;  // so that no letter is cut
    return std::string(text.substr(0, end)) + "... (" + std::to_string(text.size()) + " bytes)";
}

std::string quoted_excerpt(std::string_view text) { return '"' + excerpt(text) + '"'; }

int edit_distance(std::string_view a, std::string_view b) {
    // Three rows of the table are kept, because a swap looks two rows back.
    std::vector<int> two_back(b.size() + 1), previous(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        two_back.swap(previous);
        previous.swap(row);
        row[0] = static_cast<int>(i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool is_same = to_lower(a[i - 1]) == to_lower(b[j - 1]);
            row[j] = std::min({previous[j] + 1, row[j - 1] + 1, previous[j - 1] + (is_same ? 0 : 1)});
            const bool is_swap =
                i > 1 && j > 1 && to_lower(a[i - 1]) == to_lower(b[j - 2]) && to_lower(a[i - 2]) == to_lower(b[j - 1]);
            if (is_swap) row[j] = std::min(row[j], two_back[j - 2] + 1);
        }
    }
    return row[b.size()];
}

namespace {

/// Stores the candidate that needs the fewest edits so far. A candidate is compared as a whole, or by a part of its
/// name.
class FewestEdits {
public:
    explicit FewestEdits(std::string_view word) : edits(max_edits(word.size()) + 1), word_(word) {}
    void consider(std::string_view part, const std::string& candidate) {
        // Each edit changes the length by at most one, so a name of a megabyte is rejected at once.
        const std::size_t longer = std::max(word_.size(), part.size()), shorter = std::min(word_.size(), part.size());
        if (longer - shorter >= static_cast<std::size_t>(edits)) return;
        const int needed = edit_distance(word_, part);
        if (needed >= edits) return;
        edits = needed;
        best = candidate;
    }

    int edits;
    std::optional<std::string> best = {};

private:
    std::string_view word_;
};

FewestEdits fewest_edits(std::string_view word, const std::vector<std::string>& candidates) {
    FewestEdits fewest(word);
    for (const std::string& candidate : candidates) fewest.consider(candidate, candidate);
    return fewest;
}

}  // namespace

std::optional<std::string> match_typo(std::string_view word, const std::vector<std::string>& candidates) {
    return fewest_edits(word, candidates).best;
}

std::optional<std::string> closest(std::string_view word, const std::vector<std::string>& candidates) {
    FewestEdits fewest = fewest_edits(word, candidates);
    // Finds a name that is not complete, or has another ending: `sphere-dist`, `ulps`.
    if (fewest.edits > 1 && word.size() >= 3) {
        const std::string_view without_last_letter = word.substr(0, std::max<std::size_t>(3, word.size() - 1));
        for (const std::string_view prefix : {word, without_last_letter})
            if (auto match = single_match(candidates, [&](const std::string& c) { return c.starts_with(prefix); }))
                return match;
    }
    // If no whole name is near, compare the last part of the names: `unified` is `sphere.unified`.
    if (fewest.best || word.find_first_of("./") != std::string_view::npos) return fewest.best;
    for (const std::string& candidate : candidates) {
        const auto dot = candidate.find_last_of("./");
        const std::string_view part = std::string_view(candidate).substr(dot == std::string::npos ? 0 : dot + 1);
        if (part.size() > 2) fewest.consider(part, candidate);
    }
    if (fewest.best) return fewest.best;
    return single_match(candidates, [&](const std::string& c) { return is_subsequence(c, word); });  // `ouput`: out
}

/// Returns the candidates that contain `word`: those that begin with it first, then the shortest, which it describes
/// best.
std::vector<std::string> names_containing(std::string_view word, std::vector<std::string> candidates) {
    std::erase_if(candidates, [word](const std::string& c) { return c.find(word) == std::string::npos; });
    std::ranges::stable_sort(candidates, {},
                             [word](const std::string& c) { return std::pair(!c.starts_with(word), c.size()); });
    return candidates;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
    if (candidates.empty()) return "";
    if (const auto closest_name = closest(word, candidates))
        return "did you mean " + quoted_excerpt(*closest_name) + "?";
    const std::vector<std::string> containing =
        word.size() < 3 ? std::vector<std::string>() : names_containing(word, candidates);
    const std::vector<std::string>& listed = containing.empty() ? candidates : containing;
    std::string text = containing.empty() ? "known here: " : "names that contain it: ";
    for (std::size_t i = 0; i < std::min(listed.size(), max_listed); ++i)
        text += (i > 0 ? ", " : "") + quoted_excerpt(listed[i]);
    if (listed.size() > max_listed) text += " and " + std::to_string(listed.size() - max_listed) + " more";
    return text;
}

}  // namespace lostbits::text
