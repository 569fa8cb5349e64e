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
        Ratio& here = a[product];
        here = here + factor;
        if (here.numerator == 0) a.erase(product);
    }
    return a;
}

Sum times(const Sum& a, const Sum& b) {
    Sum all;
    for (const auto& [p, x] : a)
        for (const auto& [q, y] : b) all = plus(std::move(all), Sum{{times(p, q), x * y}});
    return all;
}

namespace {

const Sum minus_one{{{}, Ratio(-1, 1)}};

struct Reader {
    const Terms& terms;
    bool written;
    const std::set<NodeId>& kept;

    [[nodiscard]] std::optional<Sum> operator()(NodeId i) const {
        if (written) i = terms.meaning(i);
        const TapeNode& n = terms[i];
        const auto read = [&](std::size_t k) { return (*this)(n.operands[k]); };
        if (!terms.is_own(i) || kept.contains(i)) return as_it_is(i);
        switch (n.op) {
            case TapeOp::constant: return n.operands[0] == 0 ? Sum() : Sum{{{}, Ratio(n.operands[0], 1)}};
            case TapeOp::neg: return times_both(read(0), minus_one);
            case TapeOp::mul: return times_both(read(0), read(1));
            case TapeOp::div: return quotient(read(0), read(1), n.operands[1]);
            case TapeOp::sub: return added(read(0), times_both(read(1), minus_one));
            case TapeOp::add:
                if (const auto factors = terms.factors_of(i))
                    return Sum{{{{terms.known_dot(factors->first, factors->second).value(), 1}}, Ratio(1, 1)}};
                return added(read(0), read(1));
            default: return as_it_is(i);
        }
    }

private:
    [[nodiscard]] Sum as_it_is(NodeId i) const { return {{{{terms.meaning(i), 1}}, Ratio(1, 1)}}; }
    static std::optional<Sum> short_enough(std::optional<Sum> sum) {
        return sum && sum->size() <= most_products ? sum : std::nullopt;
    }
    static std::optional<Sum> times_both(const std::optional<Sum>& a, const std::optional<Sum>& b) {
        return a && b ? short_enough(times(*a, *b)) : std::nullopt;
    }
    static std::optional<Sum> added(const std::optional<Sum>& a, const std::optional<Sum>& b) {
        return a && b ? short_enough(plus(*a, *b)) : std::nullopt;
    }
    [[nodiscard]] std::optional<Sum> quotient(const std::optional<Sum>& a, const std::optional<Sum>& b,
                                              NodeId below) const {
        if (b && b->size() == 1) {
            const auto& [product, factor] = *b->begin();
            return times_both(a, Sum{{inverse(product), Ratio(factor.denominator, factor.numerator)}});
        }
        return times_both(a, Sum{{{{terms.meaning(below), -1}}, Ratio(1, 1)}});
    }
};

}  // namespace

std::optional<Sum> multiplied_out(const Terms& terms, NodeId i, bool written, const std::set<NodeId>& kept) {
    return Reader{terms, written, kept}(i);
}

Newest newest_of(const Terms& terms, const std::vector<NodeId>& needed) {
    Newest newest;
    for (const NodeId i : needed) newest[terms.meaning(i)] = i;
    return newest;
}

std::pair<std::pair<Product, Ratio>, Sum> without_common(const Sum& sum) {
    Product common = sum.begin()->first;
    Ratio factor = sum.begin()->second;
    for (const auto& [product, x] : sum) {
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
    return {{common, factor}, rest};
}

NodeId product_of(Terms& terms, const Product& product, const Ratio& factor, const Newest& newest) {
    NodeId above = no_node, below = no_node;
    const auto multiply = [&](NodeId& so_far, NodeId by) {
        so_far = so_far == no_node ? by : terms.add(TapeOp::mul, {so_far, by});
    };
    const auto whole = [&](NodeId& so_far, std::int64_t x) {
        if (x != 1) multiply(so_far, terms.constant(static_cast<std::int32_t>(x)));
    };
    whole(above, std::abs(factor.numerator));
    whole(below, factor.denominator);
    for (const auto& [atom, power] : product) {
        const auto now = newest.find(terms.meaning(atom));
        NodeId base = now == newest.end() || terms.factors_of(atom) ? atom : now->second;
        for (int k = 0; k + 1 < std::abs(power); k += 2)
            multiply(power > 0 ? above : below, terms.add(TapeOp::mul, {base, base}));
        if (std::abs(power) % 2 == 1) multiply(power > 0 ? above : below, base);
    }
    if (above == no_node) above = terms.constant(1);
    return below == no_node ? above : terms.add(TapeOp::div, {above, below});
}

NodeId written_out(Terms& terms, const Sum& sum, const Newest& newest, std::string_view label) {
    if (sum.size() == 1) {
        const auto& [product, factor] = *sum.begin();
        const NodeId size = product_of(terms, product, factor, newest);
        return terms.named(factor.numerator < 0 ? terms.add(TapeOp::neg, {size}) : size, label);
    }
    const auto [common, rest] = without_common(sum);
    NodeId all = no_node;
    for (const bool negative : {false, true}) {
        for (const auto& [product, factor] : rest) {
            if ((factor.numerator < 0) != negative) continue;
            const NodeId one = product_of(terms, product, factor, newest);
            if (all == no_node) all = negative ? terms.add(TapeOp::neg, {one}) : one;
            else all = terms.add(negative ? TapeOp::sub : TapeOp::add, {all, one});
        }
    }
    const auto& [shared, factor] = common;
    const bool alone = shared.empty() && factor == Ratio(1, 1);
    if (alone) return terms.named(all, label);
    const auto positive = [](const Product& p) {
        return std::ranges::all_of(p, [](const auto& x) { return x.second > 0; });
    };
    if (positive(shared) && factor.denominator == 1)
        return terms.add(TapeOp::mul, {product_of(terms, shared, factor, newest), all}, label);
    // k·s/(m·n) is written as (k·s)/(m·n), not as a product with a quotient.
    Product above, below;
    for (const auto& [atom, power] : shared) (power > 0 ? above[atom] : below[atom]) = std::abs(power);
    NodeId upper = all;
    if (!above.empty() || factor.numerator != 1)
        upper = terms.add(TapeOp::mul, {product_of(terms, above, Ratio(factor.numerator, 1), newest), all});
    return terms.add(TapeOp::div, {upper, product_of(terms, below, Ratio(factor.denominator, 1), newest)}, label);
}

}  // namespace lostbits::measure::identity
