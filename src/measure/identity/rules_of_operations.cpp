// Rules about a single operation and its operands.
#include <map>

#include "measure/identity/rules.hpp"

namespace lostbits::measure::identity {

using Replacements = std::vector<std::pair<NodeId, NodeId>>;

namespace {

bool is_one(const Terms& terms, NodeId i) { return terms[i].op == TapeOp::constant && terms[i].operands[0] == 1; }
bool is_number(const Terms& terms, NodeId i) { return terms.has_answer_format(i) && !is_decision(terms[i].op); }

/// Quotients of the formula, indexed by their divisor.
std::map<NodeId, std::vector<NodeId>> quotients_of(const RewriteFinder& finder) {
    std::map<NodeId, std::vector<NodeId>> quotients_by_divisor;
    for (const NodeId i : finder.formula_nodes)
        if (const TapeNode& n = finder.terms[i]; n.op == TapeOp::div && finder.terms.has_answer_format(i))
            quotients_by_divisor[n.operands[1]].push_back(i);
    return quotients_by_divisor;
}

}  // namespace

void find_fused_products(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    Replacements replacements;
    for (const NodeId i : finder.formula_nodes) {
        const TapeNode n = terms[i];
        if ((n.op != TapeOp::sub && n.op != TapeOp::add) || !terms.has_answer_format(i)) continue;
        const TapeNode first = terms[n.operands[0]], second = terms[n.operands[1]];
        if (first.op != TapeOp::mul || second.op != TapeOp::mul) continue;

        const auto [a, b, unused] = first.operands;
        const auto [c, d, none] = second.operands;
        const NodeId w = n.operands[1], minus_w = terms.add(TapeOp::neg, {w}), minus_c = terms.add(TapeOp::neg, {c});
        const bool minus = n.op == TapeOp::sub;
        const NodeId rounding_error = terms.add(TapeOp::fma, {minus ? minus_c : c, d, minus ? w : minus_w});
        const NodeId main_part = terms.add(TapeOp::fma, {a, b, minus ? minus_w : w});
        replacements.emplace_back(i, terms.add(TapeOp::add, {main_part, rounding_error}, n.label));
    }
    finder.add_each(replacements);
}

void find_other_orders(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    Replacements last_two_first, outer_first;
    for (const NodeId i : finder.formula_nodes) {
        const TapeNode n = terms[i];
        if (n.op != TapeOp::add || !terms.has_answer_format(i) || terms[n.operands[0]].op != TapeOp::add) continue;
        const auto [a, b, none] = terms[n.operands[0]].operands;
        const NodeId c = n.operands[1];
        last_two_first.emplace_back(i, terms.add(TapeOp::add, {a, terms.add(TapeOp::add, {b, c})}, n.label));
        outer_first.emplace_back(i, terms.add(TapeOp::add, {terms.add(TapeOp::add, {a, c}), b}, n.label));
    }
    finder.add_each(last_two_first);
    finder.add_each(outer_first);
}

void find_quotients(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    Replacements replacements;
    for (const NodeId i : finder.formula_nodes) {
        const TapeNode n = terms[i];
        if (n.op != TapeOp::mul || !terms.has_answer_format(i)) continue;
        for (const std::size_t k : {0, 1}) {
            const TapeNode reciprocal = terms[n.operands[k]];
            if (reciprocal.op != TapeOp::div || !is_one(terms, reciprocal.operands[0])) continue;
            replacements.emplace_back(i, terms.add(TapeOp::div, {n.operands[1 - k], reciprocal.operands[1]}, n.label));
            break;
        }
    }
    finder.add_each(replacements);
}

void find_reciprocals(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    for (const auto& [divisor, quotients] : quotients_of(finder)) {
        if (quotients.size() < 2) continue;
        Replacements replacements;
        const NodeId inverse = terms.add(TapeOp::div, {terms.constant(1), divisor});
        for (const NodeId i : quotients)
            replacements.emplace_back(i, terms.add(TapeOp::mul, {terms[i].operands[0], inverse}, terms[i].label));
        finder.add_rewrite(replacements);
    }
}

void find_split_quotients(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    for (const auto& [divisor, quotients] : quotients_of(finder)) {
        Replacements replacements;
        for (const NodeId i : quotients) {
            const TapeNode quotient = terms[i], sum = terms[quotient.operands[0]];
            if (sum.op != TapeOp::add && sum.op != TapeOp::sub) continue;
            // `divisor` is copied, because terms move in memory while parts are added.
            const auto quotient_of = [&, copied_divisor = divisor](NodeId x) {
                return terms.add(TapeOp::div, {x, copied_divisor});
            };
            replacements.emplace_back(
                i, terms.add(sum.op, {quotient_of(sum.operands[0]), quotient_of(sum.operands[1])}, quotient.label));
        }
        finder.add_rewrite(replacements);
    }
}

void find_scaled_lengths(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    Replacements replacements;
    for (const NodeId i : finder.formula_nodes) {
        if (terms[i].op != TapeOp::sqrt || !terms.has_answer_format(i)) continue;
        const auto factors = terms.factors_of(terms[i].operands[0]);
        if (!factors || factors->first != factors->second) continue;

        Triple v = factors->first;
        const auto magnitude_of = [&](std::size_t k) { return terms.add(TapeOp::abs, {v[k]}); };
        const NodeId largest = terms.add(
            TapeOp::max, {terms.add(TapeOp::max, {magnitude_of(0), magnitude_of(1)}), magnitude_of(2)}, "largest");
        for (NodeId& x : v) x = terms.add(TapeOp::div, {x, largest});
        const NodeId root = terms.add(TapeOp::sqrt, {terms.dot(v, v)});
        replacements.emplace_back(i, terms.add(TapeOp::mul, {largest, root}, terms[i].label));
    }
    finder.add_each(replacements);
}

/// The operations of one line of the source, which a loop repeats, are exchanged together.
void find_exchanges(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    std::map<std::pair<TapeOp, std::string_view>, Replacements> lines;
    for (const NodeId i : finder.formula_nodes) {
        const TapeNode n = terms[i];
        if ((n.op == TapeOp::min || n.op == TapeOp::max) && is_number(terms, i))
            lines[{n.op, n.label}].emplace_back(i, terms.add(n.op, {n.operands[1], n.operands[0]}, n.label));
    }
    for (const auto& [line, replacements] : lines) finder.add_rewrite(replacements);
}

}  // namespace lostbits::measure::identity
