// Tables on standard output: columns of text, each as wide as its widest cell.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace lostbits::analysis::shell {

struct TextColumn {
    std::string title;
    std::size_t width;             ///< least width, so that tables of one command look alike
    bool is_left_aligned = false;  ///< its cells begin at the left; otherwise they end at the right
};

class TextTable {
public:
    explicit TextTable(std::vector<TextColumn> columns);
    /// Adds a row with one cell for each column.
    void add(std::vector<std::string> cells);
    /// Prints the titles and all rows, each line indented by two spaces.
    void print() const;

private:
    std::vector<TextColumn> columns_;
    std::vector<std::vector<std::string>> rows_;
};

}  // namespace lostbits::analysis::shell
