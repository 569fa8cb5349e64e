#include "measure/identity/terms.hpp"

#include <algorithm>

namespace lostbits::measure::identity {

namespace {

/// a + b and a·b round the same as b + a and b·a.
bool commutes(TapeOp op) { return op == TapeOp::add || op == TapeOp::mul; }

}  // namespace

Terms::Terms(const Tape& form) : format_(form.format_of(form.outputs.t)) {
    tape_.formats = form.formats;
    std::map<NodeId, NodeId> place;
    for (NodeId i = 0; i < form.size(); ++i) {
        TapeNode n = form[i];
        if (!is_given(n.op))
            for (NodeId& operand : n.operands)
                if (operand != no_node) operand = place.at(operand);
        place[i] = known_or_new(n);
    }
    const auto [hit, t, near, far] = form.outputs;
    tape_.outputs = {place.at(hit), place.at(t), place.at(near), place.at(far)};
}

NodeId Terms::known_or_new(TapeNode n) {
    std::array<NodeId, 3> of = n.operands;
    if (commutes(n.op) && of[0] > of[1]) std::swap(of[0], of[1]);
    const auto [known, is_new] = known_.try_emplace({n.op, n.format, of[0], of[1], of[2]}, tape_.size());
    if (!is_new) {
        if (!n.label.empty()) tape_.name(known->second, n.label);
        return known->second;
    }
    tape_.nodes.push_back(n);
    meaning_.push_back(known->second);
    note_dot(known->second);
    return known->second;
}

NodeId Terms::add(TapeOp op, const TapeOperands& of, std::string_view label) {
    const auto place = std::ranges::find(tape_.formats, format_) - tape_.formats.begin();
    return known_or_new({op, static_cast<std::uint8_t>(place), {of.a, of.b, of.c}, 0, label});
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
    while (meaning_[static_cast<std::size_t>(i)] != i) i = meaning_[static_cast<std::size_t>(i)];
    return i;
}

void Terms::unite(NodeId a, NodeId b) {
    a = meaning(a), b = meaning(b);
    meaning_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
}

std::optional<std::pair<Triple, Triple>> Terms::factors_of(NodeId i) const {
    const TapeNode& sum = tape_[i];
    if (sum.op != TapeOp::add || !is_own(i)) return std::nullopt;
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

void Terms::note_dot(NodeId i) {
    if (const auto factors = factors_of(i)) {
        const auto& [a, b] = *factors;
        dots_.try_emplace({std::min(a, b), std::max(a, b)}, i);
    }
}

std::optional<NodeId> Terms::known_dot(const Triple& a, const Triple& b) const {
    const auto found = dots_.find({std::min(a, b), std::max(a, b)});
    return found == dots_.end() ? std::nullopt : std::optional(found->second);
}

NodeId Terms::renewed(NodeId i, std::map<NodeId, NodeId>& done) {
    if (const auto found = done.find(i); found != done.end()) return found->second;
    TapeNode n = tape_[i];
    bool changed = false;
    if (!is_given(n.op))
        for (NodeId& operand : n.operands) {
            if (operand == no_node) continue;
            const NodeId now = renewed(operand, done);
            changed |= now != operand;
            operand = now;
        }
    NodeId made = i;
    if (changed) {
        made = known_or_new(n);
        unite(i, made);
    }
    return done[i] = made;
}

TapeOutputs Terms::with_replaced(const TapeOutputs& outputs, const std::vector<std::pair<NodeId, NodeId>>& replaced) {
    std::map<NodeId, NodeId> done;
    for (const auto& [old, now] : replaced) {
        unite(old, now);
        done[old] = now;
    }
    return {renewed(outputs.hit, done), renewed(outputs.t, done), renewed(outputs.near, done),
            renewed(outputs.far, done)};
}

std::vector<NodeId> Terms::needed(const TapeOutputs& outputs) const {
    std::set<NodeId> found;
    std::vector<NodeId> open;
    const auto ask = [&](NodeId i) {
        if (i != no_node && found.insert(i).second) open.push_back(i);
    };
    for (const NodeId i : all_of(outputs)) ask(i);
    while (!open.empty()) {
        const TapeNode& n = tape_[open.back()];
        open.pop_back();
        if (!is_given(n.op))
            for (const NodeId operand : n.operands) ask(operand);
    }
    return {found.begin(), found.end()};
}

Tape Terms::tape(const TapeOutputs& outputs, std::vector<NodeId>* origins) const {
    std::set<NodeId> all;
    for (NodeId i = 0; i < tape_.size(); ++i)
        if (tape_[i].op == TapeOp::input) all.insert(i);
    const auto used = needed(outputs);
    all.insert(used.begin(), used.end());
    Tape made;
    std::map<NodeId, NodeId> place;
    for (const NodeId i : all) {
        TapeNode n = tape_[i];
        if (n.op == TapeOp::input) {
            place[i] = made.add_input(tape_.format_of(i), n.value);
            continue;
        }
        if (!is_given(n.op))
            for (NodeId& operand : n.operands)
                if (operand != no_node) operand = place.at(operand);
        place[i] = made.add(n.op, tape_.format_of(i), n.value, {n.operands[0], n.operands[1], n.operands[2]});
        made[place[i]].label = n.label;
    }
    made.outputs = {place.at(outputs.hit), place.at(outputs.t), place.at(outputs.near), place.at(outputs.far)};
    if (origins) origins->assign(all.begin(), all.end());
    return made;
}

Triple direction_of(const Terms& terms) {
    Triple d{};
    for (NodeId i = 0; i < terms.size(); ++i)
        if (const TapeNode& n = terms[i]; n.op == TapeOp::input && n.operands[0] >= 3 && n.operands[0] < 6)
            d[static_cast<std::size_t>(n.operands[0] - 3)] = i;
    return d;
}

}  // namespace lostbits::measure::identity
