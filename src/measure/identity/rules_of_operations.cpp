// Rules about one operation and its operands.
#include <map>

#include "measure/identity/rules.hpp"

namespace lostbits::measure::identity {

using Replaced = std::vector<std::pair<NodeId, NodeId>>;

namespace {

bool is_one(const Terms& terms, NodeId i) { return terms[i].op == TapeOp::constant && terms[i].operands[0] == 1; }
bool is_number(const Terms& terms, NodeId i) { return terms.is_own(i) && !is_decision(terms[i].op); }

/// Quotients of the formula, by divisor.
std::map<NodeId, std::vector<NodeId>> quotients_of(const RewriteFinder& finder) {
    std::map<NodeId, std::vector<NodeId>> by;
    for (const NodeId i : finder.needed)
        if (const TapeNode& n = finder.terms[i]; n.op == TapeOp::div && finder.terms.is_own(i))
            by[n.operands[1]].push_back(i);
    return by;
}

}  // namespace

void find_fused_products(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    Replaced all;
    for (const NodeId i : finder.needed) {
        const TapeNode n = terms[i];
        if ((n.op != TapeOp::sub && n.op != TapeOp::add) || !terms.is_own(i)) continue;
        const TapeNode first = terms[n.operands[0]], second = terms[n.operands[1]];
        if (first.op != TapeOp::mul || second.op != TapeOp::mul) continue;
        const auto [a, b, unused] = first.operands;
        const auto [c, d, none] = second.operands;
        const NodeId w = n.operands[1], minus_w = terms.add(TapeOp::neg, {w}), minus_c = terms.add(TapeOp::neg, {c});
        const bool minus = n.op == TapeOp::sub;
        const NodeId lost = terms.add(TapeOp::fma, {minus ? minus_c : c, d, minus ? w : minus_w});
        const NodeId most = terms.add(TapeOp::fma, {a, b, minus ? minus_w : w});
        all.emplace_back(i, terms.add(TapeOp::add, {most, lost}, n.label));
    }
    finder.add_each(all);
}

void find_other_orders(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    Replaced inner_last, middle_last;
    for (const NodeId i : finder.needed) {
        const TapeNode n = terms[i];
        if (n.op != TapeOp::add || !terms.is_own(i) || terms[n.operands[0]].op != TapeOp::add) continue;
        const auto [a, b, none] = terms[n.operands[0]].operands;
        const NodeId c = n.operands[1];
        inner_last.emplace_back(i, terms.add(TapeOp::add, {a, terms.add(TapeOp::add, {b, c})}, n.label));
        middle_last.emplace_back(i, terms.add(TapeOp::add, {terms.add(TapeOp::add, {a, c}), b}, n.label));
    }
    finder.add_each(inner_last);
    finder.add_each(middle_last);
}

void find_quotients(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    Replaced all;
    for (const NodeId i : finder.needed) {
        const TapeNode n = terms[i];
        if (n.op != TapeOp::mul || !terms.is_own(i)) continue;
        for (const std::size_t k : {0, 1}) {
            const TapeNode by = terms[n.operands[k]];
            if (by.op != TapeOp::div || !is_one(terms, by.operands[0])) continue;
            all.emplace_back(i, terms.add(TapeOp::div, {n.operands[1 - k], by.operands[1]}, n.label));
            break;
        }
    }
    finder.add_each(all);
}

void find_reciprocals(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    for (const auto& [below, quotients] : quotients_of(finder)) {
        if (quotients.size() < 2) continue;
        Replaced all;
        const NodeId inverse = terms.add(TapeOp::div, {terms.constant(1), below});
        for (const NodeId i : quotients)
            all.emplace_back(i, terms.add(TapeOp::mul, {terms[i].operands[0], inverse}, terms[i].label));
        finder.add_rewrite(all);
    }
}

void find_split_quotients(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    for (const auto& [below, quotients] : quotients_of(finder)) {
        Replaced all;
        for (const NodeId i : quotients) {
            const TapeNode quotient = terms[i], sum = terms[quotient.operands[0]];
            if (sum.op != TapeOp::add && sum.op != TapeOp::sub) continue;
            // A copy: terms move in memory while parts are added.
            const auto part = [&, by = below](NodeId x) { return terms.add(TapeOp::div, {x, by}); };
            all.emplace_back(i, terms.add(sum.op, {part(sum.operands[0]), part(sum.operands[1])}, quotient.label));
        }
        finder.add_rewrite(all);
    }
}

void find_scaled_lengths(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    Replaced all;
    for (const NodeId i : finder.needed) {
        if (terms[i].op != TapeOp::sqrt || !terms.is_own(i)) continue;
        const auto factors = terms.factors_of(terms[i].operands[0]);
        if (!factors || factors->first != factors->second) continue;
        Triple v = factors->first;
        const auto size = [&](std::size_t k) { return terms.add(TapeOp::abs, {v[k]}); };
        const NodeId largest = terms.add(TapeOp::max, {terms.add(TapeOp::max, {size(0), size(1)}), size(2)}, "largest");
        for (NodeId& x : v) x = terms.add(TapeOp::div, {x, largest});
        const NodeId root = terms.add(TapeOp::sqrt, {terms.dot(v, v)});
        all.emplace_back(i, terms.add(TapeOp::mul, {largest, root}, terms[i].label));
    }
    finder.add_each(all);
}

/// Exchanges all operations of one line of the source, which a loop repeats, together.
void find_exchanges(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    std::map<std::pair<TapeOp, std::string_view>, Replaced> lines;
    for (const NodeId i : finder.needed) {
        const TapeNode n = terms[i];
        if ((n.op == TapeOp::min || n.op == TapeOp::max) && is_number(terms, i))
            lines[{n.op, n.label}].emplace_back(i, terms.add(n.op, {n.operands[1], n.operands[0]}, n.label));
    }
    for (const auto& [line, all] : lines) finder.add_rewrite(all);
}

}  // namespace lostbits::measure::identity
