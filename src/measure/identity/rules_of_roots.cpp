// Rules for roots of a quadratic that subtract nearly equal numbers.
#include <cstdlib>
#include <map>

#include "measure/identity/rules.hpp"

namespace lostbits::measure::identity {

namespace {

/// The root (b ± s)/a with s = √D, as the source writes it.
struct Root {
    NodeId node;
    NodeId s;
    bool minus;
    Sum b, a;
};

std::optional<Root> find_root_at(const Terms& terms, NodeId i) {
    if (terms[i].op != TapeOp::div) return std::nullopt;
    const auto numerator_sum = multiply_out(terms, terms[i].operands[0], true);
    const auto denominator_sum = multiply_out(terms, terms[i].operands[1], true);
    if (!numerator_sum || !denominator_sum || denominator_sum->size() != 1) return std::nullopt;
    for (const auto& [product, factor] : *numerator_sum) {
        if (product.size() != 1 || product.begin()->second != 1) continue;
        const NodeId s = product.begin()->first;
        const bool is_positive = factor == Ratio(1, 1), is_negative = factor == Ratio(-1, 1);
        if (terms[s].op != TapeOp::sqrt || (!is_positive && !is_negative)) continue;
        Sum b = *numerator_sum;
        b.erase(product);
        if (b.empty()) return std::nullopt;
        return Root{.node = i, .s = s, .minus = is_negative, .b = std::move(b), .a = *denominator_sum};
    }
    return std::nullopt;
}

Sum divided_by(const Sum& sum, const Sum& divisor) {
    const auto& [product, factor] = *divisor.begin();
    return times(sum, Sum{{inverse(product), Ratio(factor.denominator, factor.numerator)}});
}

/// Finds the roots in a formula, by their s. All roots of a group have the same b.
std::map<NodeId, std::vector<Root>> find_roots_by_s(const RewriteFinder& finder) {
    std::map<NodeId, std::vector<Root>> roots;
    for (const NodeId i : finder.formula_nodes) {
        auto root = find_root_at(finder.terms, i);
        if (!root) continue;
        auto& root_group = roots[root->s];
        if (root_group.empty() || root_group.front().b == root->b) root_group.push_back(std::move(*root));
    }
    return roots;
}

}  // namespace

void find_stable_roots(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    const Sum minus_one{{{}, Ratio(-1, 1)}};
    for (const auto& [s, root_group] : find_roots_by_s(finder)) {
        const Sum& b = root_group.front().b;
        const auto disc = multiply_out(terms, terms[s].operands[0], true);
        if (!disc) continue;
        // (b − s)(b + s): the numerators of the two roots, multiplied
        const Sum product = plus(times(b, b), times(*disc, minus_one));
        if (product.empty() || product.size() > max_products) continue;

        // q = b ± s, with the sign of b
        const auto newest = finder.newest_nodes.find(s);
        const NodeId newest_root = newest == finder.newest_nodes.end() ? s : newest->second;
        const NodeId b_now = write_sum(terms, b, finder.newest_nodes);
        const NodeId negative = terms.add(TapeOp::less, {b_now, terms.constant(0)});
        const NodeId with_sign =
            terms.add(TapeOp::select, {negative, terms.add(TapeOp::neg, {newest_root}), newest_root});
        const NodeId q = terms.add(TapeOp::add, {b_now, with_sign}, "q");

        std::vector<std::pair<NodeId, NodeId>> replacements;
        for (const Root& root : root_group) {
            const NodeId from_sum = terms.add(TapeOp::div, {q, write_sum(terms, root.a, finder.newest_nodes)});
            const NodeId from_product =
                terms.add(TapeOp::div, {write_sum(terms, divided_by(product, root.a), finder.newest_nodes), q});
            // b − s cancels if b > 0, b + s if b < 0.
            replacements.emplace_back(root.node, root.minus
                                                     ? terms.add(TapeOp::select, {negative, from_sum, from_product})
                                                     : terms.add(TapeOp::select, {negative, from_product, from_sum}));
        }
        finder.add_rewrite(replacements);
    }
}

namespace {

/// The sum with x in place of every square of √x. Returns nothing if there is no such square, or if the sum would be
/// too long.
std::optional<Sum> without_squared_roots(const Terms& terms, const Sum& sum) {
    Sum result;
    bool has_replaced = false;
    for (const auto& [product, factor] : sum) {
        // The product, as a sum if it has a square of a root.
        Sum term{{{}, factor}};
        for (const auto& [atom, exponent] : product) {
            const int square_count = terms[atom].op == TapeOp::sqrt ? exponent / 2 : 0;
            if (exponent != 2 * square_count)
                term = times(term, Sum{{power(atom, exponent - 2 * square_count), Ratio(1, 1)}});
            if (square_count == 0) continue;

            has_replaced = true;
            const auto radicand = multiply_out(terms, terms[atom].operands[0]);
            if (!radicand || radicand->empty() || (square_count < 0 && radicand->size() > 1)) return std::nullopt;
            const Sum factor_sum = square_count > 0 ? *radicand : divided_by(Sum{{{}, Ratio(1, 1)}}, *radicand);
            for (int k = 0; k < std::abs(square_count); ++k) term = times(term, factor_sum);
        }

        result = plus(std::move(result), term);
        if (result.size() > max_products) return std::nullopt;
    }
    return has_replaced && !result.empty() ? std::optional(result) : std::nullopt;
}

}  // namespace

void find_squares_of_roots(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    std::vector<std::pair<NodeId, NodeId>> replacements;
    for (const NodeId i : finder.formula_nodes) {
        const TapeNode n = terms[i];
        if (n.op != TapeOp::mul || !terms.has_answer_format(i)) continue;
        const TapeNode a = terms[n.operands[0]], b = terms[n.operands[1]];
        if (a.op == TapeOp::sqrt && b.op == TapeOp::sqrt &&
            terms.meaning(a.operands[0]) == terms.meaning(b.operands[0]))
            replacements.emplace_back(i, a.operands[0]);
    }
    finder.add_each(replacements);
    finder.for_each_sum([&](NodeId i, const Sum& sum) {
        if (const auto rewritten = without_squared_roots(terms, sum))
            finder.add_rewrite(i, write_sum(terms, *rewritten, finder.newest_nodes, terms[i].label));
    });
}

}  // namespace lostbits::measure::identity
