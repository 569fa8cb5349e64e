#include "measure/identity/rules.hpp"

namespace lostbits::measure::identity {

void RewriteFinder::add_rewrite(std::vector<std::pair<NodeId, NodeId>> replaced) {
    std::erase_if(replaced, [](const auto& r) { return r.first == r.second; });
    if (!replaced.empty()) found.push_back({rule, std::move(replaced)});
}

void RewriteFinder::add_each(const std::vector<std::pair<NodeId, NodeId>>& replaced) {
    if (replaced.size() > 1) add_rewrite(replaced);
    for (const auto& one : replaced) add_rewrite({one});
}

std::set<NodeId> RewriteFinder::innermost_names() const {
    std::set<NodeId> names;
    std::map<NodeId, bool> named;  // true if it is a name or computed from one
    for (const NodeId i : needed) {
        const TapeNode& n = terms[i];
        const bool leaf = is_given(n.op) || is_decision(n.op) || !terms.is_own(i) || terms.factors_of(i).has_value();
        bool within = false;
        if (!leaf)
            for (const NodeId operand : n.operands) within |= operand != no_node && named[operand];
        if (!leaf && !within && !n.label.empty()) names.insert(i);
        named[i] = within || names.contains(i);
    }
    return names;
}

void RewriteFinder::for_each_sum(const std::function<void(NodeId, const Sum&)>& act, bool with_names) const {
    const std::set<NodeId> names = with_names ? innermost_names() : std::set<NodeId>();
    for (const NodeId i : needed) {
        const TapeOp op = terms[i].op;
        if ((op != TapeOp::add && op != TapeOp::sub) || !terms.is_own(i) || terms.factors_of(i)) continue;
        const auto sum = multiplied_out(terms, i);
        if (sum && sum->size() >= 2) act(i, *sum);
        if (names.empty() || names.contains(i)) continue;
        const auto other = multiplied_out(terms, i, false, names);
        if (other && other->size() >= 2 && other != sum) act(i, *other);
    }
}

std::vector<Rewrite> rewrites_of(Terms& terms, const TapeOutputs& outputs, std::optional<Triple> unit) {
    RewriteFinder finder(terms, outputs, unit);
    for (const Rule& rule : rules) {
        finder.rule = &rule;
        rule.find(finder);
    }
    return std::move(finder.found);
}

}  // namespace lostbits::measure::identity
