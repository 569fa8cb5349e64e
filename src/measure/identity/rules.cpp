#include "measure/identity/rules.hpp"

namespace lostbits::measure::identity {

void RewriteFinder::add_rewrite(std::vector<std::pair<NodeId, NodeId>> replacements) {
    std::erase_if(replacements, [](const auto& replacement) { return replacement.first == replacement.second; });
    if (!replacements.empty()) rewrites.push_back({rule, std::move(replacements)});
}

void RewriteFinder::add_each(const std::vector<std::pair<NodeId, NodeId>>& replacements) {
    if (replacements.size() > 1) add_rewrite(replacements);
    for (const auto& replacement : replacements) add_rewrite({replacement});
}

std::set<NodeId> RewriteFinder::innermost_names() const {
    std::set<NodeId> names;
    std::map<NodeId, bool> has_name_inside;  // true if the node has a name or is computed from one that has
    for (const NodeId i : formula_nodes) {
        const TapeNode& n = terms[i];
        const bool is_leaf =
            is_given(n.op) || is_decision(n.op) || !terms.has_answer_format(i) || terms.factors_of(i).has_value();
        bool contains_name = false;
        if (!is_leaf)
            for (const NodeId operand : n.operands) contains_name |= operand != no_node && has_name_inside[operand];
        if (!is_leaf && !contains_name && !n.label.empty()) names.insert(i);
        has_name_inside[i] = contains_name || names.contains(i);
    }
    return names;
}

void RewriteFinder::for_each_sum(const std::function<void(NodeId, const Sum&)>& visit, InnermostNames treatment) const {
    const std::set<NodeId> names = treatment == InnermostNames::kept_as_well ? innermost_names() : std::set<NodeId>();
    for (const NodeId i : formula_nodes) {
        const TapeOp op = terms[i].op;
        if ((op != TapeOp::add && op != TapeOp::sub) || !terms.has_answer_format(i) || terms.factors_of(i)) continue;
        const auto sum = multiply_out(terms, i);
        if (sum && sum->size() >= 2) visit(i, *sum);
        if (names.empty() || names.contains(i)) continue;
        const auto sum_with_names = multiply_out(terms, i, false, names);
        if (sum_with_names && sum_with_names->size() >= 2 && sum_with_names != sum) visit(i, *sum_with_names);
    }
}

std::vector<Rewrite> find_rewrites(Terms& terms, const TapeOutputs& outputs, std::optional<Triple> unit) {
    RewriteFinder finder(terms, outputs, unit);
    for (const Rule& rule : rules) {
        finder.rule = &rule;
        rule.find(finder);
    }
    return std::move(finder.rewrites);
}

}  // namespace lostbits::measure::identity
