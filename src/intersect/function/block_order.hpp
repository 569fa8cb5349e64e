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
            if (p < 0) p = count_++;  // cannot be reached
    }
    [[nodiscard]] const std::vector<int>& positions() const { return position_; }

private:
    /// Gives positions to the blocks of `inside` that `entry` reaches. The strongly connected components follow one
    /// another, and the blocks of each component are arranged again without its head. Tarjan's algorithm without
    /// recursion into blocks.
    void arrange(int entry, const std::vector<bool>& inside) {
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
            const auto b = static_cast<std::size_t>(block);
            if (edge == 0 && visit_index[b] < 0) {
                visit_index[b] = low_link[b] = visit_count++;
                stack.push_back(block);
                on_stack[b] = true;
            }
            if (edge < successors_[b].size()) {
                const int successor = successors_[b][edge++];
                const auto t = static_cast<std::size_t>(successor);
                if (!inside[t]) continue;
                if (visit_index[t] < 0) visits.push_back({successor, 0});
                else if (on_stack[t]) low_link[b] = std::min(low_link[b], visit_index[t]);
                continue;
            }
            if (low_link[b] == visit_index[b]) {
                components.emplace_back();
                int top = -1;
                do {
                    top = stack.back();
                    stack.pop_back();
                    on_stack[static_cast<std::size_t>(top)] = false;
                    components.back().push_back(top);
                } while (top != block);
            }
            const int block_low_link = low_link[b];
            visits.pop_back();
            if (!visits.empty()) {
                int& parent_low_link = low_link[static_cast<std::size_t>(visits.back().block)];
                parent_low_link = std::min(parent_low_link, block_low_link);
            }
        }
        for (std::size_t c = components.size(); c-- > 0;) {
            const int head = components[c].back();  // the block by which the component is entered first
            position_[static_cast<std::size_t>(head)] = count_++;
            if (components[c].size() == 1) continue;
            std::vector<bool> without_head(n, false);
            for (const int b : components[c]) without_head[static_cast<std::size_t>(b)] = b != head;
            for (const int successor : successors_[static_cast<std::size_t>(head)])
                if (without_head[static_cast<std::size_t>(successor)] &&
                    position_[static_cast<std::size_t>(successor)] < 0)
                    arrange_once(successor, without_head);
            for (const int b : components[c])
                if (position_[static_cast<std::size_t>(b)] < 0) arrange_once(b, without_head);
        }
    }
    void arrange_once(int entry, std::vector<bool>& inside) {
        arrange(entry, inside);
        for (std::size_t b = 0; b < inside.size(); ++b) inside[b] = inside[b] && position_[b] < 0;
    }

    std::vector<std::vector<int>> successors_;
    std::vector<int> position_;
    int count_ = 0;
};

}  // namespace lostbits::intersect::function
