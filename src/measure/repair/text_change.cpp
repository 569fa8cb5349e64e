#include "measure/repair/text_change.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace lostbits::measure::repair {
namespace {

constexpr std::size_t context_lines = 3;  ///< number of lines that a diff shows before and after each change

std::vector<std::string_view> split_lines(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
        lines.push_back(text.substr(0, end));
        text.remove_prefix(end);
    }
    return lines;
}

/// A line of the difference: in both texts (' '), only in the old text ('-') or only in the new text ('+').
struct DiffLine {
    char sign;
    std::string_view text;
};

std::vector<DiffLine> compare_lines(const std::vector<std::string_view>& old_lines,
                                    const std::vector<std::string_view>& new_lines) {
    // Sets the common lines at both ends apart: most changes are small.
    std::size_t head = 0, tail = 0;
    const std::size_t shorter = std::min(old_lines.size(), new_lines.size());
    while (head < shorter && old_lines[head] == new_lines[head]) ++head;
    while (tail < shorter - head && old_lines[old_lines.size() - 1 - tail] == new_lines[new_lines.size() - 1 - tail])
        ++tail;
    const std::size_t old_end = old_lines.size() - tail, new_end = new_lines.size() - tail;

    // common[i][j]: the most lines that old_lines[head + i..] and new_lines[head + j..] share, in order
    std::vector<std::vector<std::size_t>> common(old_end - head + 1, std::vector<std::size_t>(new_end - head + 1));
    for (std::size_t i = old_end; i-- > head;)
        for (std::size_t j = new_end; j-- > head;)
            common[i - head][j - head] = old_lines[i] == new_lines[j]
                                             ? common[i - head + 1][j - head + 1] + 1
                                             : std::max(common[i - head + 1][j - head], common[i - head][j - head + 1]);

    // Follows a longest common subsequence; where lines differ, old lines come first.
    std::vector<DiffLine> lines;
    for (std::size_t k = 0; k < head; ++k) lines.push_back({' ', old_lines[k]});
    for (std::size_t i = head, j = head; i < old_end || j < new_end;) {
        if (i < old_end && j < new_end && old_lines[i] == new_lines[j]) {
            lines.push_back({' ', old_lines[i]});
            ++i;
            ++j;
        } else if (i < old_end && (j == new_end || common[i - head + 1][j - head] >= common[i - head][j - head + 1])) {
            lines.push_back({'-', old_lines[i++]});
        } else {
            lines.push_back({'+', new_lines[j++]});
        }
    }
    for (std::size_t k = old_end; k < old_lines.size(); ++k) lines.push_back({' ', old_lines[k]});
    return lines;
}

/// True if line k of a difference is shown: it lies within `context_lines` of a change.
bool is_near_change(const std::vector<DiffLine>& lines, std::size_t k) {
    const std::size_t begin = k < context_lines ? 0 : k - context_lines;
    for (std::size_t j = begin; j < std::min(k + context_lines + 1, lines.size()); ++j)
        if (lines[j].sign != ' ') return true;
    return false;
}

}  // namespace

std::optional<std::string> apply_changes(const std::string& text, std::vector<TextChange> changes) {
    std::ranges::stable_sort(changes, {}, &TextChange::span);
    std::string changed_text;
    std::size_t position = 0;
    for (const TextChange& change : changes) {
        if (change.span.begin < position) return {};
        changed_text += text.substr(position, change.span.begin - position) + change.text;
        position = change.span.end;
    }
    return changed_text + text.substr(position);
}

std::string make_unified_diff(const std::string& path, const std::string& old_text, const std::string& new_text) {
    const std::vector<DiffLine> lines = compare_lines(split_lines(old_text), split_lines(new_text));
    std::string text = fmt::format("--- {}\n+++ {}\n", path, path);
    std::size_t old_line = 1, new_line = 1;
    for (std::size_t k = 0; k < lines.size();) {
        if (!is_near_change(lines, k)) {
            ++k;
            ++old_line;
            ++new_line;
            continue;
        }

        // Takes all lines up to the next one that is far from every change.
        std::size_t old_count = 0, new_count = 0;
        std::string hunk;
        for (; k < lines.size() && is_near_change(lines, k); ++k) {
            old_count += lines[k].sign != '+';
            new_count += lines[k].sign != '-';
            hunk += lines[k].sign + std::string(lines[k].text);
            if (!hunk.ends_with('\n')) hunk += "\n\\ No newline at end of file\n";
        }

        text += fmt::format("@@ -{},{} +{},{} @@\n", old_line, old_count, new_line, new_count) + hunk;
        old_line += old_count;
        new_line += new_count;
    }
    return text;
}

}  // namespace lostbits::measure::repair
