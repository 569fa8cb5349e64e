#include "measure/identity/terms.hpp"

#include <algorithm>

namespace lostbits::measure::identity {

namespace {

/// True if a op b and b op a round to the same number.
bool is_commutative(TapeOp op) { return op == TapeOp::add || op == TapeOp::mul; }

}  // namespace

Terms::Terms(const Tape& form) : format_(form.format_of(form.outputs.t)) {
    tape_.formats = form.formats;
    std::map<NodeId, NodeId> new_nodes;
    for (NodeId i = 0; i < form.size(); ++i) {
        TapeNode n = form[i];
        if (!is_given(n.op))
            for (NodeId& operand : n.operands)
                if (operand != no_node) operand = new_nodes.at(operand);
        new_nodes[i] = find_or_add(n);
    }
    const auto [hit, t, near, far] = form.outputs;
    tape_.outputs = {new_nodes.at(hit), new_nodes.at(t), new_nodes.at(near), new_nodes.at(far)};
}

NodeId Terms::find_or_add(TapeNode n) {
    std::array<NodeId, 3> operands = n.operands;
    if (is_commutative(n.op) && operands[0] > operands[1]) std::swap(operands[0], operands[1]);
    const auto [found, is_new] =
        known_.try_emplace({n.op, n.format, operands[0], operands[1], operands[2]}, tape_.size());
    if (!is_new) {
        if (!n.label.empty()) tape_.name(found->second, n.label);
        return found->second;
    }
    tape_.nodes.push_back(n);
    meaning_.push_back(found->second);
    remember_dot(found->second);
    return found->second;
}

NodeId Terms::add(TapeOp op, const TapeOperands& operands, std::string_view label) {
    const auto format_index = std::ranges::find(tape_.formats, format_) - tape_.formats.begin();
    return find_or_add({op, static_cast<std::uint8_t>(format_index), {operands.a, operands.b, operands.c}, 0, label});
}

NodeId Terms::constant(std::int32_t x) {
    const NodeId i = add(TapeOp::constant, {x});
    tape_[i].value = x;
    return i;
}

NodeId Terms::dot(const Triple& a, const Triple& b, std::string_view label) {
    if (const auto known = known_dot(a, b)) return *known;
    const auto product = [&](std::size_t k) { return add(TapeOp::mul, {a[k], b[k]}); };
    return add(TapeOp::add, {add(TapeOp::add, {product(0), product(1)}), product(2)}, label);
}

Triple Terms::cross(const Triple& a, const Triple& b) {
    const auto component = [&](std::size_t k, std::size_t l, std::string_view label) {
        return add(TapeOp::sub, {add(TapeOp::mul, {a[k], b[l]}), add(TapeOp::mul, {a[l], b[k]})}, label);
    };
    return {component(1, 2, "cross.x"), component(2, 0, "cross.y"), component(0, 1, "cross.z")};
}

NodeId Terms::meaning(NodeId i) const {
    while (meaning_[i] != i) i = meaning_[i];
    return i;
}

void Terms::unite(NodeId a, NodeId b) {
    a = meaning(a);
    b = meaning(b);
    meaning_[std::max(a, b)] = std::min(a, b);
}

std::optional<std::pair<Triple, Triple>> Terms::factors_of(NodeId i) const {
    const TapeNode& sum = tape_[i];
    if (sum.op != TapeOp::add || !has_answer_format(i)) return std::nullopt;
    std::vector<NodeId> products;
    for (const NodeId side : {sum.operands[0], sum.operands[1]}) {
        const TapeNode& n = tape_[side];
        if (n.op == TapeOp::add) products.insert(products.end(), {n.operands[0], n.operands[1]});
        else products.push_back(side);
    }
    if (products.size() != 3) return std::nullopt;

    std::pair<Triple, Triple> factors;
    for (std::size_t k = 0; k < 3; ++k) {
        const TapeNode& n = tape_[products[k]];
        if (n.op != TapeOp::mul) return std::nullopt;
        factors.first[k] = n.operands[0];
        factors.second[k] = n.operands[1];
    }
    return factors;
}

void Terms::remember_dot(NodeId i) {
    if (const auto factors = factors_of(i)) {
        const auto& [a, b] = *factors;
        dots_.try_emplace({std::min(a, b), std::max(a, b)}, i);
    }
}

std::optional<NodeId> Terms::known_dot(const Triple& a, const Triple& b) const {
    const auto found = dots_.find({std::min(a, b), std::max(a, b)});
    return found == dots_.end() ? std::nullopt : std::optional(found->second);
}

NodeId Terms::rebuild_node(NodeId i, std::map<NodeId, NodeId>& renewed_nodes) {
    if (const auto found = renewed_nodes.find(i); found != renewed_nodes.end()) return found->second;
    TapeNode n = tape_[i];
    bool is_changed = false;
    if (!is_given(n.op))
        for (NodeId& operand : n.operands) {
            if (operand == no_node) continue;
            const NodeId replacement = rebuild_node(operand, renewed_nodes);
            is_changed |= replacement != operand;
            operand = replacement;
        }
    NodeId result = i;
    if (is_changed) {
        result = find_or_add(n);
        unite(i, result);
    }
    return renewed_nodes[i] = result;
}

TapeOutputs Terms::replace_nodes(const TapeOutputs& outputs,
                                 const std::vector<std::pair<NodeId, NodeId>>& replacements) {
    std::map<NodeId, NodeId> renewed_nodes;
    for (const auto& [node, replacement] : replacements) {
        unite(node, replacement);
        renewed_nodes[node] = replacement;
    }
    return {rebuild_node(outputs.hit, renewed_nodes), rebuild_node(outputs.t, renewed_nodes),
            rebuild_node(outputs.near, renewed_nodes), rebuild_node(outputs.far, renewed_nodes)};
}

std::vector<NodeId> Terms::nodes_of(const TapeOutputs& outputs) const {
    std::set<NodeId> found;
    std::vector<NodeId> pending;
    const auto add_node = [&](NodeId i) {
        if (i != no_node && found.insert(i).second) pending.push_back(i);
    };
    for (const NodeId i : output_nodes(outputs)) add_node(i);
    while (!pending.empty()) {
        const TapeNode& n = tape_[pending.back()];
        pending.pop_back();
        if (!is_given(n.op))
            for (const NodeId operand : n.operands) add_node(operand);
    }
    return {found.begin(), found.end()};
}

Tape Terms::tape(const TapeOutputs& outputs, std::vector<NodeId>* origins) const {
    // All inputs of the form, and the nodes that the outputs are computed from.
    std::set<NodeId> nodes;
    for (NodeId i = 0; i < tape_.size(); ++i)
        if (tape_[i].op == TapeOp::input) nodes.insert(i);
    const auto used = nodes_of(outputs);
    nodes.insert(used.begin(), used.end());

    // Copies them in order, with the new numbers of their operands.
    Tape result;
    std::map<NodeId, NodeId> new_nodes;
    for (const NodeId i : nodes) {
        TapeNode n = tape_[i];
        if (n.op == TapeOp::input) {
            new_nodes[i] = result.add_input(tape_.format_of(i), n.value);
            continue;
        }
        if (!is_given(n.op))
            for (NodeId& operand : n.operands)
                if (operand != no_node) operand = new_nodes.at(operand);
        new_nodes[i] = result.add(n.op, tape_.format_of(i), n.value, {n.operands[0], n.operands[1], n.operands[2]});
        result[new_nodes[i]].label = n.label;
    }

    result.outputs = {new_nodes.at(outputs.hit), new_nodes.at(outputs.t), new_nodes.at(outputs.near),
                      new_nodes.at(outputs.far)};
    if (origins) origins->assign(nodes.begin(), nodes.end());
    return result;
}

Triple direction_of(const Terms& terms) {
    Triple d{};
    for (NodeId i = 0; i < terms.size(); ++i)
        if (const TapeNode& n = terms[i]; n.op == TapeOp::input && n.operands[0] >= 3 && n.operands[0] < 6)
            d[n.operands[0] - 3] = i;
    return d;
}

}  // namespace lostbits::measure::identity
