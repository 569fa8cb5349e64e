#include "analysis/shell/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace lostbits::analysis::shell {

TextTable::TextTable(std::vector<TextColumn> columns) : columns_(std::move(columns)) {
    // At least two spaces separate the titles, which may have spaces themselves.
    for (TextColumn& c : columns_) c.width = std::max(c.width, c.title.size() + (c.is_left_aligned ? 0 : 1));
}

void TextTable::add(std::vector<std::string> cells) {
    if (cells.size() != columns_.size()) throw std::logic_error("a row of a table has a cell for each column");
    for (std::size_t c = 0; c < cells.size(); ++c) columns_[c].width = std::max(columns_[c].width, cells[c].size());
    rows_.push_back(std::move(cells));
}

void TextTable::print() const {
    const auto print_line = [this](const auto& cell_of) {
        std::string line = " ";
        for (std::size_t c = 0; c < columns_.size(); ++c)
            line += columns_[c].is_left_aligned ? fmt::format(" {:<{}}", cell_of(c), columns_[c].width)
                                                : fmt::format(" {:>{}}", cell_of(c), columns_[c].width);
        fmt::print("{}\n", line);
    };
    print_line([this](std::size_t c) { return columns_[c].title; });
    for (const auto& row : rows_) print_line([&row](std::size_t c) { return row[c]; });
}

}  // namespace lostbits::analysis::shell
