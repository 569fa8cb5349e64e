// The blocks between ``` and ``` of a page in Markdown.
#pragma once

#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

namespace lostbits::test {

inline std::vector<std::string> split_lines(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

/// A block, with the word behind the first ```.
struct Block {
    std::string language;
    std::vector<std::string> lines;
    std::size_t first = 0;  ///< the number of its first line in the page

    [[nodiscard]] std::string text() const {
        std::string all;
        for (const std::string& line : lines) all += line + "\n";
        return all;
    }
};

inline std::vector<Block> find_blocks(const std::string& text) {
    std::vector<Block> blocks;
    bool inside = false;
    const auto lines = split_lines(text);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (lines[i].starts_with("```")) {
            if (!inside) blocks.push_back({lines[i].substr(3), {}, i + 2});
            inside = !inside;
        } else if (inside) blocks.back().lines.push_back(lines[i]);
    }
    return blocks;
}

}  // namespace lostbits::test
