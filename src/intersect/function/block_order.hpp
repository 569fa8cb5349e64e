// The order in which the blocks of a function run.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace lostbits::intersect::function {

/// Positions of the blocks: all blocks of a loop come before the blocks after the loop, and each block comes before its
/// successors, except along edges back to the head of a loop. The block with the lowest position runs next (F.
/// Bourdoncle, Efficient chaotic iteration strategies with widenings, 1993: a weak topological order).
class BlockOrder {
public:
    explicit BlockOrder(std::vector<std::vector<int>> successors)
        : successors_(std::move(successors)), position_(successors_.size(), -1) {
        std::vector<bool> every_block(successors_.size(), true);
        arrange(0, every_block);
        for (int& p : position_)
            if (p < 0) p = next_position_++;  // a block that cannot be reached
    }
    [[nodiscard]] const std::vector<int>& positions() const { return position_; }

private:
    /// Gives positions to those of the `allowed` blocks that `entry` reaches. Finds the strongly connected components
    /// by Tarjan's algorithm, with a stack in place of recursion. The components follow one another, and the blocks of
    /// each component are arranged again without its head.
    void arrange(int entry, const std::vector<bool>& allowed) {
        const std::size_t n = successors_.size();
        std::vector<int> visit_index(n, -1), low_link(n, 0), stack;
        std::vector<bool> on_stack(n, false);
        std::vector<std::vector<int>> components;
        struct Visit {
            int block;
            std::size_t edge;
        };
        std::vector<Visit> visits{{entry, 0}};
        int visit_count = 0;
        while (!visits.empty()) {
            auto& [block, edge] = visits.back();
            const auto block_index = static_cast<std::size_t>(block);
            if (edge == 0 && visit_index[block_index] < 0) {
                visit_index[block_index] = low_link[block_index] = visit_count++;
                stack.push_back(block);
                on_stack[block_index] = true;
            }
            if (edge < successors_[block_index].size()) {
                const int successor = successors_[block_index][edge++];
                const auto successor_index = static_cast<std::size_t>(successor);
                if (!allowed[successor_index]) continue;
                if (visit_index[successor_index] < 0) visits.push_back({successor, 0});
                else if (on_stack[successor_index])
                    low_link[block_index] = std::min(low_link[block_index], visit_index[successor_index]);
                continue;
            }
            if (low_link[block_index] == visit_index[block_index]) {
                components.emplace_back();
                int top = -1;
                do {
                    top = stack.back();
                    stack.pop_back();
                    on_stack[static_cast<std::size_t>(top)] = false;
                    components.back().push_back(top);
                } while (top != block);
            }
            const int block_low_link = low_link[block_index];
            visits.pop_back();
            if (!visits.empty()) {
                int& parent_low_link = low_link[static_cast<std::size_t>(visits.back().block)];
                parent_low_link = std::min(parent_low_link, block_low_link);
            }
        }
        for (std::size_t c = components.size(); c-- > 0;) {
            const int head = components[c].back();  // the block by which the component is entered first
            position_[static_cast<std::size_t>(head)] = next_position_++;
            if (components[c].size() == 1) continue;
            std::vector<bool> without_head(n, false);
            for (const int b : components[c]) without_head[static_cast<std::size_t>(b)] = b != head;
            for (const int successor : successors_[static_cast<std::size_t>(head)])
                if (without_head[static_cast<std::size_t>(successor)] &&
                    position_[static_cast<std::size_t>(successor)] < 0)
                    arrange_and_remove(successor, without_head);
            for (const int b : components[c])
                if (position_[static_cast<std::size_t>(b)] < 0) arrange_and_remove(b, without_head);
        }
    }
    /// Arranges the blocks that `entry` reaches, and removes every block that has a position from `allowed`.
    void arrange_and_remove(int entry, std::vector<bool>& allowed) {
        arrange(entry, allowed);
        for (std::size_t b = 0; b < allowed.size(); ++b) allowed[b] = allowed[b] && position_[b] < 0;
    }

    std::vector<std::vector<int>> successors_;
    std::vector<int> position_;
    int next_position_ = 0;
};

}  // namespace lostbits::intersect::function
