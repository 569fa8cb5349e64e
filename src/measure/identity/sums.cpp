#include "measure/identity/sums.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>

namespace lostbits::measure::identity {

Ratio::Ratio(std::int64_t a, std::int64_t b) {
    const std::int64_t common = std::gcd(a, b) * (b < 0 ? -1 : 1);
    numerator = a / common;
    denominator = b / common;
}

Product times(Product a, const Product& b) {
    for (const auto& [atom, power] : b)
        if ((a[atom] += power) == 0) a.erase(atom);
    return a;
}

Product inverse(Product a) {
    for (auto& [atom, power] : a) power = -power;
    return a;
}

Sum plus(Sum a, const Sum& b) {
    for (const auto& [product, factor] : b) {
        Ratio& total = a[product];
        total = total + factor;
        if (total.numerator == 0) a.erase(product);
    }
    return a;
}

Sum times(const Sum& a, const Sum& b) {
    Sum result;
    for (const auto& [p, x] : a)
        for (const auto& [q, y] : b) result = plus(std::move(result), Sum{{times(p, q), x * y}});
    return result;
}

namespace {

const Sum minus_one{{{}, Ratio(-1, 1)}};

struct Expander {
    const Terms& terms;
    bool before_rules;
    const std::set<NodeId>& extra_atoms;

    [[nodiscard]] std::optional<Sum> operator()(NodeId i) const {
        if (before_rules) i = terms.meaning(i);
        const TapeNode& n = terms[i];
        const auto expand = [&](std::size_t k) { return (*this)(n.operands[k]); };
        if (!terms.has_answer_format(i) || extra_atoms.contains(i)) return as_atom(i);
        switch (n.op) {
            case TapeOp::constant: return n.operands[0] == 0 ? Sum() : Sum{{{}, Ratio(n.operands[0], 1)}};
            case TapeOp::neg: return multiply(expand(0), minus_one);
            case TapeOp::mul: return multiply(expand(0), expand(1));
            case TapeOp::div: return quotient(expand(0), expand(1), n.operands[1]);
            case TapeOp::sub: return sum_of(expand(0), multiply(expand(1), minus_one));
            case TapeOp::add:
                if (const auto factors = terms.factors_of(i))
                    return Sum{{{{terms.known_dot(factors->first, factors->second).value(), 1}}, Ratio(1, 1)}};
                return sum_of(expand(0), expand(1));
            default: return as_atom(i);
        }
    }

private:
    [[nodiscard]] Sum as_atom(NodeId i) const { return {{{{terms.meaning(i), 1}}, Ratio(1, 1)}}; }
    static std::optional<Sum> nothing_if_too_long(std::optional<Sum> sum) {
        return sum && sum->size() <= max_products ? sum : std::nullopt;
    }
    static std::optional<Sum> multiply(const std::optional<Sum>& a, const std::optional<Sum>& b) {
        return a && b ? nothing_if_too_long(times(*a, *b)) : std::nullopt;
    }
    static std::optional<Sum> sum_of(const std::optional<Sum>& a, const std::optional<Sum>& b) {
        return a && b ? nothing_if_too_long(plus(*a, *b)) : std::nullopt;
    }
    [[nodiscard]] std::optional<Sum> quotient(const std::optional<Sum>& a, const std::optional<Sum>& b,
                                              NodeId divisor) const {
        if (b && b->size() == 1) {
            const auto& [product, factor] = *b->begin();
            return multiply(a, Sum{{inverse(product), Ratio(factor.denominator, factor.numerator)}});
        }
        return multiply(a, Sum{{{{terms.meaning(divisor), -1}}, Ratio(1, 1)}});
    }
};

}  // namespace

std::optional<Sum> multiply_out(const Terms& terms, NodeId i, bool before_rules, const std::set<NodeId>& extra_atoms) {
    return Expander{terms, before_rules, extra_atoms}(i);
}

NewestNodes find_newest_nodes(const Terms& terms, const std::vector<NodeId>& formula_nodes) {
    NewestNodes newest;
    for (const NodeId i : formula_nodes) newest[terms.meaning(i)] = i;
    return newest;
}

FactoredSum factor_out_common(const Sum& sum) {
    Product common = sum.begin()->first;
    Ratio factor = sum.begin()->second;
    for (const auto& [product, x] : sum) {
        // The least power of each atom. A divisor of only one product is common too: the others are multiplied by it.
        Product shared;
        for (const auto& [atom, power] : common) {
            const auto found = product.find(atom);
            const int other = found == product.end() ? 0 : found->second;
            if (const int least = std::min(power, other); least != 0) shared[atom] = least;
        }
        for (const auto& [atom, power] : product)
            if (power < 0 && !common.contains(atom)) shared[atom] = power;
        common = shared;

        factor = Ratio(std::gcd(factor.numerator, x.numerator), std::lcm(factor.denominator, x.denominator));
    }
    if (factor.numerator < 0) factor = -factor;

    Sum rest;
    for (const auto& [product, x] : sum)
        rest[times(product, inverse(common))] = x * Ratio(factor.denominator, factor.numerator);
    return {.common = common, .factor = factor, .rest = rest};
}

NodeId write_product(Terms& terms, const Product& product, const Ratio& factor, const NewestNodes& newest) {
    NodeId numerator_node = no_node, denominator_node = no_node;
    const auto multiply = [&](NodeId& accumulated, NodeId operand) {
        accumulated = accumulated == no_node ? operand : terms.add(TapeOp::mul, {accumulated, operand});
    };
    const auto multiply_integer = [&](NodeId& accumulated, std::int64_t x) {
        if (x != 1) multiply(accumulated, terms.constant(static_cast<std::int32_t>(x)));
    };

    // Whole numbers first, then the powers of the atoms as products of squares.
    multiply_integer(numerator_node, std::abs(factor.numerator));
    multiply_integer(denominator_node, factor.denominator);
    for (const auto& [atom, power] : product) {
        const auto found = newest.find(terms.meaning(atom));
        NodeId base = found == newest.end() || terms.factors_of(atom) ? atom : found->second;
        for (int k = 0; k + 1 < std::abs(power); k += 2)
            multiply(power > 0 ? numerator_node : denominator_node, terms.add(TapeOp::mul, {base, base}));
        if (std::abs(power) % 2 == 1) multiply(power > 0 ? numerator_node : denominator_node, base);
    }

    if (numerator_node == no_node) numerator_node = terms.constant(1);
    return denominator_node == no_node ? numerator_node : terms.add(TapeOp::div, {numerator_node, denominator_node});
}

namespace {

/// Writes the products of a sum, the positive ones first.
NodeId write_products(Terms& terms, const Sum& sum, const NewestNodes& newest) {
    NodeId sum_node = no_node;
    for (const bool negative : {false, true}) {
        for (const auto& [product, factor] : sum) {
            if ((factor.numerator < 0) != negative) continue;
            const NodeId term = write_product(terms, product, factor, newest);
            if (sum_node == no_node) sum_node = negative ? terms.add(TapeOp::neg, {term}) : term;
            else sum_node = terms.add(negative ? TapeOp::sub : TapeOp::add, {sum_node, term});
        }
    }
    return sum_node;
}

}  // namespace

NodeId write_sum(Terms& terms, const Sum& sum, const NewestNodes& newest, std::string_view label) {
    if (sum.size() == 1) {
        const auto& [product, factor] = *sum.begin();
        const NodeId magnitude = write_product(terms, product, factor, newest);
        return terms.name_if_unnamed(factor.numerator < 0 ? terms.add(TapeOp::neg, {magnitude}) : magnitude, label);
    }

    const auto [common, factor, rest] = factor_out_common(sum);
    const NodeId sum_node = write_products(terms, rest, newest);
    const bool is_plain = common.empty() && factor == Ratio(1, 1);
    if (is_plain) return terms.name_if_unnamed(sum_node, label);

    // A common factor without a divisor is one product.
    const auto has_positive_powers = [](const Product& p) {
        return std::ranges::all_of(p, [](const auto& x) { return x.second > 0; });
    };
    if (has_positive_powers(common) && factor.denominator == 1)
        return terms.add(TapeOp::mul, {write_product(terms, common, factor, newest), sum_node}, label);

    // k·s/(m·n) is written as (k·s)/(m·n), not as a product with a quotient.
    Product numerator_product, denominator_product;
    for (const auto& [atom, power] : common)
        (power > 0 ? numerator_product[atom] : denominator_product[atom]) = std::abs(power);
    NodeId numerator_node = sum_node;
    if (!numerator_product.empty() || factor.numerator != 1)
        numerator_node = terms.add(
            TapeOp::mul, {write_product(terms, numerator_product, Ratio(factor.numerator, 1), newest), sum_node});
    return terms.add(TapeOp::div,
                     {numerator_node, write_product(terms, denominator_product, Ratio(factor.denominator, 1), newest)},
                     label);
}

}  // namespace lostbits::measure::identity
