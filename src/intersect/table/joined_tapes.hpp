// Joins tapes, one after the other.
#pragma once

#include <vector>

#include "number/tape.hpp"

namespace lostbits::intersect::table {

/// Appends the operations of a form's tape to the tape `target`, and returns the indices of the form's outputs in it.
/// The nodes `inputs` of `target` replace the form's first inputs; any further inputs of the form become inputs of
/// `target`.
inline TapeOutputs append_tape(const Tape& form, const std::vector<NodeId>& inputs, Tape& target) {
    std::vector<NodeId> new_nodes(form.nodes.size());
    const auto renumber = [&new_nodes](NodeId node) { return node == no_node ? no_node : new_nodes[node]; };

    for (NodeId i = 0; i < form.size(); ++i) {
        const TapeNode& n = form[i];
        NodeId& new_node = new_nodes[i];
        if (n.op == TapeOp::input) {
            const auto k = static_cast<std::size_t>(n.operands[0]);
            new_node = k < inputs.size() ? inputs[k] : target.add_input(form.format_of(i), n.value);
            continue;
        }

        if (n.op == TapeOp::call) {
            const TapeCall& call = form.call_at(i);
            std::vector<NodeId> arguments;
            for (const NodeId k : call.arguments) arguments.push_back(renumber(k));
            new_node = target.add_call(call.callee, form.format_of(i), n.value, std::move(arguments));
            target[new_node].label = n.label;
            continue;
        }

        // The operands of a given number are not indices of nodes.
        const bool is_given_node = is_given(n.op);
        const auto operand = [&](std::size_t k) { return is_given_node ? n.operands[k] : renumber(n.operands[k]); };
        new_node = target.add(n.op, form.format_of(i), n.value, {operand(0), operand(1), operand(2)});
        target[new_node].label = n.label;
    }
    return {renumber(form.outputs.hit), renumber(form.outputs.t), renumber(form.outputs.near),
            renumber(form.outputs.far)};
}

}  // namespace lostbits::intersect::table
