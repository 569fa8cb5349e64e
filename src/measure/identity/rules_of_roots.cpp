// Rules for roots of a quadratic that subtract nearly equal numbers.
#include <cstdlib>
#include <map>

#include "measure/identity/rules.hpp"

namespace lostbits::measure::identity {

namespace {

/// (b ± s)/a with s = √D, as written in the source.
struct Root {
    NodeId node;
    NodeId s;
    bool minus;
    Sum b, a;
};

std::optional<Root> root_at(const Terms& terms, NodeId i) {
    if (terms[i].op != TapeOp::div) return std::nullopt;
    const auto above = multiplied_out(terms, terms[i].operands[0], true);
    const auto below = multiplied_out(terms, terms[i].operands[1], true);
    if (!above || !below || below->size() != 1) return std::nullopt;
    for (const auto& [product, factor] : *above) {
        if (product.size() != 1 || product.begin()->second != 1) continue;
        const NodeId s = product.begin()->first;
        const bool one = factor == Ratio(1, 1), minus = factor == Ratio(-1, 1);
        if (terms[s].op != TapeOp::sqrt || (!one && !minus)) continue;
        Sum b = *above;
        b.erase(product);
        if (b.empty()) return std::nullopt;
        return Root{.node = i, .s = s, .minus = minus, .b = std::move(b), .a = *below};
    }
    return std::nullopt;
}

Sum divided_by(const Sum& sum, const Sum& one) {
    const auto& [product, factor] = *one.begin();
    return times(sum, Sum{{inverse(product), Ratio(factor.denominator, factor.numerator)}});
}

}  // namespace

void find_stable_roots(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    const Sum minus_one{{{}, Ratio(-1, 1)}};
    std::map<NodeId, std::vector<Root>> roots;
    for (const NodeId i : finder.needed) {
        auto root = root_at(terms, i);
        if (!root) continue;
        auto& both = roots[root->s];
        if (both.empty() || both.front().b == root->b) both.push_back(std::move(*root));
    }
    for (const auto& [s, both] : roots) {
        const Sum& b = both.front().b;
        const auto disc = multiplied_out(terms, terms[s].operands[0], true);
        if (!disc) continue;
        // (b − s)(b + s): the numerators of the two roots, multiplied
        const Sum product = plus(times(b, b), times(*disc, minus_one));
        if (product.empty() || product.size() > most_products) continue;
        const auto newest = finder.newest.find(s);
        const NodeId root = newest == finder.newest.end() ? s : newest->second;
        const NodeId b_now = written_out(terms, b, finder.newest);
        const NodeId negative = terms.add(TapeOp::less, {b_now, terms.constant(0)});
        const NodeId with_sign = terms.add(TapeOp::select, {negative, terms.add(TapeOp::neg, {root}), root});
        const NodeId q = terms.add(TapeOp::add, {b_now, with_sign}, "q");
        std::vector<std::pair<NodeId, NodeId>> replaced;
        for (const Root& one : both) {
            const NodeId plain = terms.add(TapeOp::div, {q, written_out(terms, one.a, finder.newest)});
            const NodeId other =
                terms.add(TapeOp::div, {written_out(terms, divided_by(product, one.a), finder.newest), q});
            // b − s cancels if b > 0, b + s if b < 0.
            replaced.emplace_back(one.node, one.minus ? terms.add(TapeOp::select, {negative, plain, other})
                                                      : terms.add(TapeOp::select, {negative, other, plain}));
        }
        finder.add_rewrite(replaced);
    }
}

namespace {

/// The sum with x in place of every square of √x; nothing if it has none, or would be too long.
std::optional<Sum> without_squared_roots(const Terms& terms, const Sum& sum) {
    Sum all;
    bool found = false;
    for (const auto& [product, factor] : sum) {
        Sum here{{{}, factor}};
        for (const auto& [atom, exponent] : product) {
            const int squares = terms[atom].op == TapeOp::sqrt ? exponent / 2 : 0;
            if (exponent != 2 * squares) here = times(here, Sum{{power(atom, exponent - 2 * squares), Ratio(1, 1)}});
            if (squares == 0) continue;
            found = true;
            const auto under = multiplied_out(terms, terms[atom].operands[0]);
            if (!under || under->empty() || (squares < 0 && under->size() > 1)) return std::nullopt;
            const Sum one = squares > 0 ? *under : divided_by(Sum{{{}, Ratio(1, 1)}}, *under);
            for (int k = 0; k < std::abs(squares); ++k) here = times(here, one);
        }
        all = plus(std::move(all), here);
        if (all.size() > most_products) return std::nullopt;
    }
    return found && !all.empty() ? std::optional(all) : std::nullopt;
}

}  // namespace

void find_squares_of_roots(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    std::vector<std::pair<NodeId, NodeId>> all;
    for (const NodeId i : finder.needed) {
        const TapeNode n = terms[i];
        if (n.op != TapeOp::mul || !terms.is_own(i)) continue;
        const TapeNode a = terms[n.operands[0]], b = terms[n.operands[1]];
        if (a.op == TapeOp::sqrt && b.op == TapeOp::sqrt &&
            terms.meaning(a.operands[0]) == terms.meaning(b.operands[0]))
            all.emplace_back(i, a.operands[0]);
    }
    finder.add_each(all);
    finder.for_each_sum([&](NodeId i, const Sum& sum) {
        if (const auto to = without_squared_roots(terms, sum))
            finder.add_rewrite(i, written_out(terms, *to, finder.newest, terms[i].label));
    });
}

}  // namespace lostbits::measure::identity
