// Joins tapes, one after the other.
#pragma once

#include <vector>

#include "number/tape.hpp"

namespace lostbits::intersect::table {

/// Appends the operations of a form's tape to another tape. `inputs` are the nodes of that tape which replace the
/// form's first inputs. Further inputs of the form become inputs of the whole tape.
inline TapeOutputs append(const Tape& form, const std::vector<NodeId>& inputs, Tape& target) {
    std::vector<NodeId> new_index(form.nodes.size());
    const auto renumbered = [&new_index](NodeId node) {
        return node == no_node ? no_node : new_index[static_cast<std::size_t>(node)];
    };
    for (NodeId i = 0; i < form.size(); ++i) {
        const TapeNode& n = form[i];
        NodeId& copied = new_index[static_cast<std::size_t>(i)];
        if (n.op == TapeOp::input) {
            const auto k = static_cast<std::size_t>(n.operands[0]);
            copied = k < inputs.size() ? inputs[k] : target.add_input(form.format_of(i), n.value);
            continue;
        }
        if (n.op == TapeOp::call) {
            const TapeCall& call = form.call_at(i);
            std::vector<NodeId> arguments;
            for (const NodeId k : call.arguments) arguments.push_back(renumbered(k));
            copied = target.add_call(call.callee, form.format_of(i), n.value, std::move(arguments));
            target[copied].label = n.label;
            continue;
        }
        const bool is_given_node = is_given(n.op);
        const auto operand = [&](std::size_t k) { return is_given_node ? n.operands[k] : renumbered(n.operands[k]); };
        copied = target.add(n.op, form.format_of(i), n.value, {operand(0), operand(1), operand(2)});
        target[copied].label = n.label;
    }
    return {renumbered(form.outputs.hit), renumbered(form.outputs.t), renumbered(form.outputs.near),
            renumbered(form.outputs.far)};
}

}  // namespace lostbits::intersect::table
