// Finds which operations of a form a repair changes, by matching its tape with the tape of the repaired form.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "measure/repair/shared_nodes.hpp"

namespace lostbits::measure::repair {

/// Number of pairs of nodes that one round compares before it gives up.
inline constexpr std::size_t max_match_steps = 200'000;

/// Finds nodes of an old tape whose replacement turns it into a new tape of the same form. Prefers nodes that are far
/// from the answer.
class Matcher {
public:
    Matcher(const Tape& old_tape, const Tape& new_tape, const std::function<bool(NodeId)>& can_replace)
        : old_tape_(old_tape),
          new_tape_(new_tape),
          can_replace_(can_replace),
          old_values_(shared_.values_of(old_tape)),
          new_values_(shared_.values_of(new_tape)) {}

    /// The node of the new tape for each node of the old tape to replace; empty if no such set of nodes is found.
    std::optional<std::map<NodeId, NodeId>> find_replacements() {
        for (int round = 0; round < 12; ++round) {
            replacements_.clear();
            failed_pairs_.clear();
            matched_pairs_.clear();
            step_count_ = 0;
            const auto &old_outputs = old_tape_.outputs, &new_outputs = new_tape_.outputs;
            if (!match(old_outputs.t, new_outputs.t) || !match(old_outputs.hit, new_outputs.hit) ||
                !match(old_outputs.near, new_outputs.near) || !match(old_outputs.far, new_outputs.far))
                return {};

            // Operations that several nodes use may give the wrong values elsewhere; the next round avoids those.
            const std::vector<int> changed_values = values_with(replacements_);
            const NodeId wrong_node = find_wrong_node(changed_values);
            if (wrong_node == no_node) return replacements_;
            forbid_below(wrong_node);
        }
        return {};
    }
    /// The values of the old tape's nodes after the change.
    [[nodiscard]] std::vector<int> values_with(const std::map<NodeId, NodeId>& replacements) {
        std::map<NodeId, int> values;
        for (const auto& [old_node, new_node] : replacements) values[old_node] = value_of_new(new_node);
        return shared_.values_of(old_tape_, values);
    }
    [[nodiscard]] int value_of_new(NodeId new_node) const { return new_values_[new_node]; }
    [[nodiscard]] SharedNodes& shared() { return shared_; }

private:
    /// Matches an old node with a new node, and the operands of both. Where they differ, adds a replacement. Returns
    /// false if the old node cannot become the new node.
    bool match(NodeId old_node, NodeId new_node) {
        if (++step_count_ > max_match_steps || failed_pairs_.contains({old_node, new_node})) return false;
        matched_pairs_.emplace_back(old_node, new_node);

        // The values may be equal already, from the start or by a replacement.
        if (old_values_[old_node] == value_of_new(new_node)) return true;
        if (const auto found = replacements_.find(old_node); found != replacements_.end())
            return value_of_new(found->second) == value_of_new(new_node);

        // Replaces the node as a whole only if its operands cannot become those of the new node.
        const bool same_format = have_same_format(old_node, new_node);
        if (same_format && match_operands(old_node, new_node)) return true;
        if (same_format && !forbidden_.contains(old_node) && can_replace_(old_node)) {
            replacements_[old_node] = new_node;
            return true;
        }
        failed_pairs_.emplace(old_node, new_node);
        return false;
    }
    [[nodiscard]] bool have_same_format(NodeId old_node, NodeId new_node) const {
        const TapeNode &a = old_tape_[old_node], &b = new_tape_[new_node];
        if (is_decision(a.op)) return is_decision(b.op);
        return !is_decision(b.op) && old_tape_.format_of(old_node) == new_tape_.format_of(new_node);
    }
    /// Matches the operands of two nodes with the same operation, also in the other order if the operation commutes.
    /// Returns false and changes nothing if they do not match.
    bool match_operands(NodeId old_node, NodeId new_node) {
        const TapeNode &a = old_tape_[old_node], &b = new_tape_[new_node];
        if (a.op != b.op || is_given(a.op)) return false;
        const auto saved_replacements = replacements_;
        const std::size_t matched_count = matched_pairs_.size();
        const bool commutes = a.op == TapeOp::add || a.op == TapeOp::mul;

        for (const bool is_swapped : {false, true}) {
            if (is_swapped && !commutes) break;
            bool all_match = true;
            for (std::size_t k = 0; all_match && k < row_of(a.op).operand_count; ++k)
                all_match = match(a.operands[k], b.operands[is_swapped ? 1 - k : k]);
            if (all_match) return true;
            replacements_ = saved_replacements;
            matched_pairs_.resize(matched_count);
        }
        return false;
    }
    /// Finds a node that does not have the value of its counterpart in the new tape, because an operation that it uses
    /// was replaced for another node.
    [[nodiscard]] NodeId find_wrong_node(const std::vector<int>& changed_values) const {
        for (const auto& [old_node, new_node] : matched_pairs_)
            if (changed_values[old_node] != value_of_new(new_node)) return old_node;
        return no_node;
    }
    void forbid_below(NodeId wrong_node) {
        std::vector<NodeId> pending{wrong_node};
        std::set<NodeId> visited;
        while (!pending.empty()) {
            const NodeId i = pending.back();
            pending.pop_back();
            if (!visited.insert(i).second) continue;
            if (i != wrong_node && replacements_.contains(i)) forbidden_.insert(i);
            for (const NodeId k : old_tape_.operands_of(i)) pending.push_back(k);
        }
        if (replacements_.contains(wrong_node)) forbidden_.insert(wrong_node);
    }

    SharedNodes shared_;
    const Tape &old_tape_, &new_tape_;
    const std::function<bool(NodeId)>& can_replace_;
    std::vector<int> old_values_, new_values_;
    std::map<NodeId, NodeId> replacements_;
    std::set<std::pair<NodeId, NodeId>> failed_pairs_;
    std::vector<std::pair<NodeId, NodeId>> matched_pairs_;
    std::set<NodeId> forbidden_;
    std::size_t step_count_ = 0;
};

}  // namespace lostbits::measure::repair
