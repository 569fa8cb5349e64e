#include "measure/repair/text_change.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace lostbits::measure::repair {
namespace {

constexpr std::size_t around = 3;  ///< lines that a diff shows beside each change

std::vector<std::string_view> lines_of(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
        lines.push_back(text.substr(0, end));
        text.remove_prefix(end);
    }
    return lines;
}

/// A line of the difference: kept (' '), of the old text ('-') or of the new one ('+').
struct DiffLine {
    char sign;
    std::string_view text;
};

std::vector<DiffLine> difference(const std::vector<std::string_view>& old, const std::vector<std::string_view>& now) {
    std::size_t head = 0, tail = 0;
    const std::size_t least = std::min(old.size(), now.size());
    while (head < least && old[head] == now[head]) ++head;
    while (tail < least - head && old[old.size() - 1 - tail] == now[now.size() - 1 - tail]) ++tail;
    const std::size_t a = old.size() - tail, b = now.size() - tail;
    // common[i][j]: the most lines that old[head + i..] and now[head + j..] share, in order
    std::vector<std::vector<std::size_t>> common(a - head + 1, std::vector<std::size_t>(b - head + 1));
    for (std::size_t i = a; i-- > head;)
        for (std::size_t j = b; j-- > head;)
            common[i - head][j - head] = old[i] == now[j]
                                             ? common[i - head + 1][j - head + 1] + 1
                                             : std::max(common[i - head + 1][j - head], common[i - head][j - head + 1]);
    std::vector<DiffLine> all;
    for (std::size_t k = 0; k < head; ++k) all.push_back({' ', old[k]});
    for (std::size_t i = head, j = head; i < a || j < b;) {
        if (i < a && j < b && old[i] == now[j]) all.push_back({' ', old[i]}), ++i, ++j;
        else if (i < a && (j == b || common[i - head + 1][j - head] >= common[i - head][j - head + 1]))
            all.push_back({'-', old[i++]});
        else all.push_back({'+', now[j++]});
    }
    for (std::size_t k = a; k < old.size(); ++k) all.push_back({' ', old[k]});
    return all;
}

}  // namespace

std::optional<std::string> changed_text(const std::string& text, std::vector<TextChange> changes) {
    std::ranges::stable_sort(changes, {}, &TextChange::span);
    std::string made;
    std::size_t at = 0;
    for (const TextChange& change : changes) {
        if (change.span.begin < at) return {};
        made += text.substr(at, change.span.begin - at) + change.text;
        at = change.span.end;
    }
    return made + text.substr(at);
}

std::string unified_diff(const std::string& path, const std::string& before, const std::string& after) {
    const std::vector<DiffLine> all = difference(lines_of(before), lines_of(after));
    std::string text = fmt::format("--- {}\n+++ {}\n", path, path);
    std::size_t old_line = 1, new_line = 1;
    const auto is_near = [&](std::size_t k) {
        for (std::size_t j = k < around ? 0 : k - around; j < std::min(k + around + 1, all.size()); ++j)
            if (all[j].sign != ' ') return true;
        return false;
    };
    for (std::size_t k = 0; k < all.size();) {
        if (!is_near(k)) {
            ++k, ++old_line, ++new_line;
            continue;
        }
        std::size_t old_count = 0, new_count = 0;
        std::string hunk;
        for (; k < all.size() && is_near(k); ++k) {
            old_count += all[k].sign != '+', new_count += all[k].sign != '-';
            hunk += all[k].sign + std::string(all[k].text);
            if (!hunk.ends_with('\n')) hunk += "\n\\ No newline at end of file\n";
        }
        text += fmt::format("@@ -{},{} +{},{} @@\n", old_line, old_count, new_line, new_count) + hunk;
        old_line += old_count, new_line += new_count;
    }
    return text;
}

}  // namespace lostbits::measure::repair
