// The part of a tape on which some of its values depend.
#pragma once

#include <algorithm>
#include <vector>

#include "number/tape.hpp"

namespace lostbits::output::attribution {

/// Marks the values that the roots are computed from, on both sides of every select, and the values that depend only
/// on constants.
struct TapeSlice {
    std::vector<bool> needed, constant;
    std::vector<int> use_counts;  ///< number of needed operations that use each value

    TapeSlice(const Tape& tape, const std::vector<NodeId>& roots)
        : needed(tape.nodes.size()), constant(tape.nodes.size()), use_counts(tape.nodes.size()) {
        for (const NodeId root : roots) needed[root] = true;
        for (NodeId i = tape.size() - 1; i >= 0; --i) {
            if (!needed[i]) continue;
            for (const NodeId operand : tape.operands_of(i)) {
                needed[operand] = true;
                ++use_counts[operand];
            }
        }
        for (NodeId i = 0; i < tape.size(); ++i) {
            constant[i] =
                tape[i].op != TapeOp::input &&
                std::ranges::all_of(tape.operands_of(i), [this](NodeId operand) { return constant[operand]; });
        }
    }
    [[nodiscard]] bool is_needed(NodeId i) const { return needed[i]; }
    [[nodiscard]] bool is_constant(NodeId i) const { return constant[i]; }
};

}  // namespace lostbits::output::attribution
