// Joins tapes one behind the other.
#pragma once

#include <vector>

#include "number/tape.hpp"

namespace lostbits::intersect::table {

/// Appends the operations of a form's tape to another tape; `inputs` are nodes there. Further inputs of the form become
/// inputs of the whole tape.
inline TapeOutputs append(const Tape& form, const std::vector<NodeId>& inputs, Tape& to) {
    std::vector<NodeId> place(form.nodes.size());
    const auto moved = [&place](NodeId node) {
        return node == no_node ? no_node : place[static_cast<std::size_t>(node)];
    };
    for (NodeId i = 0; i < form.size(); ++i) {
        const TapeNode& n = form[i];
        NodeId& there = place[static_cast<std::size_t>(i)];
        if (n.op == TapeOp::input) {
            const auto k = static_cast<std::size_t>(n.operands[0]);
            there = k < inputs.size() ? inputs[k] : to.add_input(form.format_of(i), n.value);
            continue;
        }
        if (n.op == TapeOp::call) {
            const TapeCall& call = form.call_at(i);
            std::vector<NodeId> arguments;
            for (const NodeId k : call.arguments) arguments.push_back(moved(k));
            there = to.add_call(call.of, form.format_of(i), n.value, std::move(arguments));
            to[there].label = n.label;
            continue;
        }
        const bool given = is_given(n.op);
        const auto operand = [&](std::size_t k) { return given ? n.operands[k] : moved(n.operands[k]); };
        there = to.add(n.op, form.format_of(i), n.value, {operand(0), operand(1), operand(2)});
        to[there].label = n.label;
    }
    return {moved(form.outputs.hit), moved(form.outputs.t), moved(form.outputs.near), moved(form.outputs.far)};
}

}  // namespace lostbits::intersect::table
