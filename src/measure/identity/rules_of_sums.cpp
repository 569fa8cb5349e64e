// Rules that find two products of opposite sign in a sum that is multiplied out.
#include <algorithm>

#include "measure/identity/rules.hpp"

namespace lostbits::measure::identity {

namespace {

/// The products (a·c)(b·d) and −(a·d)(b·c), both multiplied by `rest` and `factor`.
struct Pair {
    Triple a, b, c, d;
    Product rest;
    Ratio factor;
    Sum others;  ///< the sum without these two products
};

class PairFinder {
public:
    PairFinder(const RewriteFinder& finder, const Sum& sum) : terms_(finder.terms), sum_(sum) {
        if (finder.unit_direction) unit_ = terms_.known_dot(*finder.unit_direction, *finder.unit_direction);
    }

    std::vector<Pair> find_all() {
        for (const auto& [product, factor] : sum_) {
            const std::vector<NodeId> dots = dots_of(product);
            for (std::size_t k = 0; k < dots.size(); ++k)
                for (std::size_t l = k + 1; l < dots.size(); ++l) {
                    const Product rest = times(product, times(power(dots[k], -1), power(dots[l], -1)));
                    const auto [p, q] = terms_.factors_of(dots[k]).value();
                    const auto [r, s] = terms_.factors_of(dots[l]).value();
                    // The signs are those of −(a·d)(b·c) for this product.
                    try_pair({.a = p, .b = s, .c = r, .d = q, .rest = rest, .factor = -factor, .others = {}}, product);
                    try_pair({.a = p, .b = r, .c = s, .d = q, .rest = rest, .factor = -factor, .others = {}}, product);
                }
        }
        return std::move(found_);
    }

    /// The product without the square of the direction's length, if the form requires that this length is one.
    [[nodiscard]] Product without_unit_length(Product product) const {
        if (unit_) product.erase(*unit_);
        return product;
    }

private:
    /// Dot products of a product; a dot product with power n occurs n times.
    [[nodiscard]] std::vector<NodeId> dots_of(const Product& product) const {
        std::vector<NodeId> dots;
        for (const auto& [atom, power] : product)
            if (power > 0 && terms_.factors_of(atom)) dots.insert(dots.end(), static_cast<std::size_t>(power), atom);
        return dots;
    }
    void try_pair(Pair pair, const Product& product) {
        const auto first = terms_.known_dot(pair.a, pair.c), second = terms_.known_dot(pair.b, pair.d);
        if (!first || !second) return;
        const Product partner = without_unit_length(times(pair.rest, times(power(*first, 1), power(*second, 1))));
        const auto other = sum_.find(partner);
        if (partner == product || other == sum_.end() || !(other->second == pair.factor)) return;
        pair.others = sum_;
        pair.others.erase(product);
        pair.others.erase(partner);
        found_.push_back(std::move(pair));
    }

    const Terms& terms_;
    const Sum& sum_;
    std::optional<NodeId> unit_;
    std::vector<Pair> found_;
};

/// The node with `replacement` in place of the two products.
NodeId replace_pair(RewriteFinder& finder, NodeId i, const Pair& pair, const Product& replacement) {
    const PairFinder pair_finder(finder, pair.others);
    const Sum rewritten =
        plus(pair.others, Sum{{pair_finder.without_unit_length(times(pair.rest, replacement)), pair.factor}});
    return rewritten.empty() ? i : write_sum(finder.terms, rewritten, finder.newest_nodes, finder.terms[i].label);
}

/// Adds each rewrite by itself, and one that applies all innermost rewrites at once (the first at each node).
void add_all(RewriteFinder& finder, const std::vector<std::pair<NodeId, NodeId>>& replacements) {
    std::vector<std::pair<NodeId, NodeId>> innermost;
    for (const auto& [node, replacement_node] : replacements) {
        const auto within = finder.terms.nodes_of({node, node, node, node});
        const auto is_within = [&](const auto& other) { return std::ranges::binary_search(within, other.first); };
        if (node != replacement_node && std::ranges::none_of(innermost, is_within))
            innermost.emplace_back(node, replacement_node);
    }
    if (innermost.size() > 1) finder.add_rewrite(innermost);
    for (const auto& replacement : replacements) finder.add_rewrite({replacement});
}

/// Writes a − (a·n)/|n|² n. If `uses_unit_vector`, it is computed with n/|n|.
Triple write_foot(RewriteFinder& finder, const Triple& a, const Triple& n, bool uses_unit_vector) {
    Terms& terms = finder.terms;
    const bool is_unit = finder.unit_direction == n;
    Triple direction = n;
    NodeId share = terms.dot(a, n);
    if (!is_unit && uses_unit_vector) {
        const NodeId length = terms.add(TapeOp::sqrt, {terms.dot(n, n)}, "len");
        for (NodeId& x : direction) x = terms.add(TapeOp::div, {x, length});
        share = terms.dot(a, direction);
    } else if (!is_unit) {
        share = terms.add(TapeOp::div, {share, terms.dot(n, n)}, "share");
    }

    constexpr std::array<std::string_view, 3> names{"l.x", "l.y", "l.z"};
    Triple foot_point{};
    for (std::size_t k = 0; k < 3; ++k)
        foot_point[k] = terms.add(TapeOp::sub, {a[k], terms.add(TapeOp::mul, {share, direction[k]})}, names[k]);
    return foot_point;
}

void find_approach(RewriteFinder& finder, bool uses_unit_vector) {
    Terms& terms = finder.terms;
    std::vector<std::pair<NodeId, NodeId>> replacements;
    if (finder.unit_direction) terms.dot(*finder.unit_direction, *finder.unit_direction);
    finder.for_each_sum([&](NodeId i, const Sum& sum) {
        for (const Pair& p : PairFinder(finder, sum).find_all()) {
            // (n·n)(b·d) − (n·d)(b·n)
            const auto add_foot = [&](const Triple& n, const Triple& a, const Triple& b) {
                if (uses_unit_vector && finder.unit_direction == n) return;
                const Triple foot_point = write_foot(finder, a, n, uses_unit_vector);
                const NodeId dot_product = a == b ? terms.dot(foot_point, foot_point, "l^2") : terms.dot(foot_point, b);
                replacements.emplace_back(
                    i, replace_pair(finder, i, p, times(power(terms.dot(n, n), 1), power(dot_product, 1))));
            };
            if (p.a == p.c) add_foot(p.a, p.b, p.d);
            if (p.b == p.d) add_foot(p.b, p.a, p.c);
        }
    });
    add_all(finder, replacements);
}

/// Finds the number whose square is the product. Returns nothing if the product is not such a square.
std::optional<NodeId> find_root(RewriteFinder& finder, const Product& product, bool by_length) {
    // Halves the powers. A length stands for one square of a vector.
    Product halved;
    bool has_length = false;
    NodeId root = no_node;
    for (const auto& [atom, power] : product) {
        if (power % 2 == 0) {
            halved[atom] = power / 2;
            continue;
        }
        const auto factors = finder.terms.factors_of(atom);
        if (!by_length || power != 1 || has_length || !factors || factors->first != factors->second)
            return std::nullopt;
        has_length = true;
        root = finder.terms.add(TapeOp::sqrt, {atom}, "length");
    }
    if (has_length != by_length) return std::nullopt;

    if (!halved.empty() || root == no_node) {
        const NodeId rest = write_product(finder.terms, halved, Ratio(1, 1), finder.newest_nodes);
        root = root == no_node ? rest : finder.terms.add(TapeOp::mul, {root, rest});
    }
    return root;
}

void find_squares(RewriteFinder& finder, bool by_length) {
    Terms& terms = finder.terms;
    finder.for_each_sum([&](NodeId i, const Sum& sum) {
        if (sum.size() != 2) return;

        // After the common factor, one square is positive and the other negative.
        const auto [common, factor, rest] = factor_out_common(sum);
        const auto positive = std::ranges::find_if(rest, [](const auto& x) { return x.second == Ratio(1, 1); });
        const auto negative = std::ranges::find_if(rest, [](const auto& x) { return x.second == Ratio(-1, 1); });
        if (positive == rest.end() || negative == rest.end()) return;
        const auto a = find_root(finder, positive->first, by_length);
        const auto b = find_root(finder, negative->first, false);
        if (!a || !b) return;

        const NodeId product =
            terms.add(TapeOp::mul, {terms.add(TapeOp::sub, {*a, *b}), terms.add(TapeOp::add, {*a, *b})});
        const NodeId common_node = write_product(terms, common, factor, finder.newest_nodes);
        const bool is_plain = common.empty() && factor == Ratio(1, 1);
        finder.add_rewrite(i, is_plain ? terms.name_if_unnamed(product, terms[i].label)
                                       : terms.add(TapeOp::mul, {common_node, product}, terms[i].label));
    });
}

/// Finds three vectors whose pairwise dot products are ab, bc and ca. Returns nothing if no three vectors have these
/// products.
std::optional<std::array<Triple, 3>> find_ring(const Terms& terms, NodeId ab, NodeId bc, NodeId ca) {
    const auto [a, b] = terms.factors_of(ab).value();
    for (const auto& [x, y] : {std::pair(a, b), std::pair(b, a)}) {
        const auto [p, q] = terms.factors_of(bc).value();
        if (p != y && q != y) continue;
        const Triple z = p == y ? q : p;
        if (z != x && x != y && y != z && terms.known_dot(z, x) == ca) return std::array{x, y, z};
    }
    return std::nullopt;
}

/// The sum with (a·(b × c))² in place of its Gram determinant. `cross_term` is factor·rest·2(a·b)(b·c)(c·a). Returns
/// nothing if the sum does not contain the determinant.
std::optional<Sum> without_gram(Terms& terms, const Sum& sum, const Product& cross_term,
                                const std::array<Triple, 3>& v) {
    const auto dot = [&](std::size_t k, std::size_t l) { return terms.known_dot(v[k % 3], v[l % 3]); };
    for (std::size_t k = 0; k < 3; ++k)
        if (!dot(k, k)) return std::nullopt;

    // The determinant, times the factors that remain of the cross term.
    const Ratio factor = sum.at(cross_term) * Ratio(1, 2);
    Product rest = cross_term, squares;
    for (std::size_t k = 0; k < 3; ++k) {
        rest = times(rest, power(*dot(k, k + 1), -1));
        squares = times(squares, power(*dot(k, k), 1));
    }
    Sum gram{{cross_term, sum.at(cross_term)}, {times(rest, squares), factor}};
    for (std::size_t k = 0; k < 3; ++k)
        gram[times(rest, times(power(*dot(k, k), 1), power(*dot(k + 1, k + 2), 2)))] = -factor;
    for (const auto& [product, x] : gram)
        if (const auto found = sum.find(product); found == sum.end() || !(found->second == x)) return std::nullopt;

    Sum rewritten = sum;
    for (const auto& [product, x] : gram) rewritten.erase(product);
    const NodeId volume = terms.dot(v[0], terms.cross(v[1], v[2]), "volume");
    return plus(rewritten, Sum{{times(rest, power(volume, 2)), factor}});
}

}  // namespace

void find_volumes(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    finder.for_each_sum(
        [&](NodeId i, const Sum& sum) {
            for (const auto& [product, factor] : sum) {
                std::vector<NodeId> dots;
                for (const auto& [atom, power] : product)
                    if (power > 0 && terms.factors_of(atom)) dots.push_back(atom);

                // Three dot products of one product may be those of a cross term.
                for (std::size_t j = 0; j < dots.size(); ++j)
                    for (std::size_t k = j + 1; k < dots.size(); ++k)
                        for (std::size_t l = k + 1; l < dots.size(); ++l) {
                            const auto ring = find_ring(terms, dots[j], dots[k], dots[l]);
                            const auto rewritten = ring ? without_gram(terms, sum, product, *ring) : std::nullopt;
                            if (rewritten && !rewritten->empty())
                                finder.add_rewrite(i,
                                                   write_sum(terms, *rewritten, finder.newest_nodes, terms[i].label));
                        }
            }
        },
        InnermostNames::kept_as_well);
}

void find_differences_of_squares(RewriteFinder& finder) { find_squares(finder, false); }
void find_differences_of_lengths(RewriteFinder& finder) { find_squares(finder, true); }
void find_closest_approach(RewriteFinder& finder) { find_approach(finder, false); }
void find_unit_approach(RewriteFinder& finder) { find_approach(finder, true); }

void find_cross_products(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    std::vector<std::pair<NodeId, NodeId>> replacements;
    if (finder.unit_direction) terms.dot(*finder.unit_direction, *finder.unit_direction);
    finder.for_each_sum([&](NodeId i, const Sum& sum) {
        for (const Pair& p : PairFinder(finder, sum).find_all()) {
            const Triple first = terms.cross(p.a, p.b), second = terms.cross(p.c, p.d);
            replacements.emplace_back(i, replace_pair(finder, i, p, power(terms.dot(first, second), 1)));
        }
    });
    add_all(finder, replacements);
}

}  // namespace lostbits::measure::identity
