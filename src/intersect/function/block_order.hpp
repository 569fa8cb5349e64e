// The order in which the blocks of a function run.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace lostbits::intersect::function {

/// Positions of the blocks: all blocks of a loop come before those after it, and each block before those that it leads
/// to. The block with the lowest position runs next (F. Bourdoncle, Efficient chaotic iteration strategies with
/// widenings, 1993: a weak topological order).
class BlockOrder {
public:
    explicit BlockOrder(std::vector<std::vector<int>> next) : next_(std::move(next)), position_(next_.size(), -1) {
        std::vector<bool> all(next_.size(), true);
        arrange(0, all);
        for (int& p : position_)
            if (p < 0) p = count_++;  // cannot be reached
    }
    [[nodiscard]] const std::vector<int>& positions() const { return position_; }

private:
    /// Arranges the blocks of `inside` that `entry` reaches. Components stand one after another, and each is arranged
    /// again without its entry. Tarjan's algorithm without recursion into blocks.
    void arrange(int entry, const std::vector<bool>& inside) {
        const std::size_t n = next_.size();
        std::vector<int> number(n, -1), low(n, 0), stack;
        std::vector<bool> on_stack(n, false);
        std::vector<std::vector<int>> components;
        struct Visit {
            int block;
            std::size_t edge;
        };
        std::vector<Visit> visits{{entry, 0}};
        int counter = 0;
        while (!visits.empty()) {
            auto& [block, edge] = visits.back();
            const auto b = static_cast<std::size_t>(block);
            if (edge == 0 && number[b] < 0) {
                number[b] = low[b] = counter++;
                stack.push_back(block);
                on_stack[b] = true;
            }
            if (edge < next_[b].size()) {
                const int to = next_[b][edge++];
                const auto t = static_cast<std::size_t>(to);
                if (!inside[t]) continue;
                if (number[t] < 0) visits.push_back({to, 0});
                else if (on_stack[t]) low[b] = std::min(low[b], number[t]);
                continue;
            }
            if (low[b] == number[b]) {
                components.emplace_back();
                int top = -1;
                do {
                    top = stack.back();
                    stack.pop_back();
                    on_stack[static_cast<std::size_t>(top)] = false;
                    components.back().push_back(top);
                } while (top != block);
            }
            const int low_here = low[b];
            visits.pop_back();
            if (!visits.empty()) {
                int& above = low[static_cast<std::size_t>(visits.back().block)];
                above = std::min(above, low_here);
            }
        }
        for (std::size_t c = components.size(); c-- > 0;) {
            const int head = components[c].back();  // the block by which the component is entered first
            position_[static_cast<std::size_t>(head)] = count_++;
            if (components[c].size() == 1) continue;
            std::vector<bool> rest(n, false);
            for (const int b : components[c]) rest[static_cast<std::size_t>(b)] = b != head;
            for (const int to : next_[static_cast<std::size_t>(head)])
                if (rest[static_cast<std::size_t>(to)] && position_[static_cast<std::size_t>(to)] < 0)
                    arrange_once(to, rest);
            for (const int b : components[c])
                if (position_[static_cast<std::size_t>(b)] < 0) arrange_once(b, rest);
        }
    }
    void arrange_once(int entry, std::vector<bool>& inside) {
        arrange(entry, inside);
        for (std::size_t b = 0; b < inside.size(); ++b) inside[b] = inside[b] && position_[b] < 0;
    }

    std::vector<std::vector<int>> next_;
    std::vector<int> position_;
    int count_ = 0;
};

}  // namespace lostbits::intersect::function
