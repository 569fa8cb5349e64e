// Rules of rewriting: identities of real arithmetic, one line each, with functions that find where a formula can use
// them.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "measure/identity/sums.hpp"

namespace lostbits::measure::identity {

struct Rule;

/// Nodes of a formula and their replacements, all of which are applied at once.
struct Rewrite {
    const Rule* rule;
    std::vector<std::pair<NodeId, NodeId>> replacements;
};

/// Treatment of innermost names in sums: they are multiplied out, or each sum is also visited with them as atoms.
enum class InnermostNames : std::uint8_t { multiplied_out, kept_as_well };

/// Finds the rewrites of a formula that the rules allow.
class RewriteFinder {
public:
    /// `direction` is set if the form takes only directions of length one.
    RewriteFinder(Terms& form_terms, const TapeOutputs& outputs, std::optional<Triple> direction)
        : terms(form_terms),
          formula_nodes(form_terms.nodes_of(outputs)),
          newest_nodes(find_newest_nodes(form_terms, formula_nodes)),
          unit_direction(direction) {}

    Terms& terms;
    const std::vector<NodeId> formula_nodes;
    const NewestNodes newest_nodes;
    const std::optional<Triple> unit_direction;  ///< absent if the form takes directions of any length
    const Rule* rule = nullptr;                  ///< the rule whose `find` is running
    std::vector<Rewrite> rewrites = {};

    /// Adds a rewrite of one node.
    void add_rewrite(NodeId node, NodeId replacement) { add_rewrite({{node, replacement}}); }
    void add_rewrite(std::vector<std::pair<NodeId, NodeId>> replacements);
    /// Named numbers that are not computed from other named numbers, without dot products. A rule may use them without
    /// multiplying them out.
    [[nodiscard]] std::set<NodeId> innermost_names() const;
    /// Calls visit(node, sum) for every number of the formula that is a sum of products, except dot products. With
    /// `kept_as_well`, calls it again if the sum is different when innermost names are not multiplied out.
    void for_each_sum(const std::function<void(NodeId, const Sum&)>& visit,
                      InnermostNames treatment = InnermostNames::multiplied_out) const;
    /// Adds a rewrite for each replacement by itself, and one for all of them at once.
    void add_each(const std::vector<std::pair<NodeId, NodeId>>& replacements);
};

struct Rule {
    std::string_view name;
    std::string_view identity;   ///< in real arithmetic
    std::string_view condition;  ///< condition for the identity; empty if it always holds
    void (*find)(RewriteFinder& finder);
};

void find_differences_of_squares(RewriteFinder& finder);
void find_differences_of_lengths(RewriteFinder& finder);
void find_cross_products(RewriteFinder& finder);
void find_combinations(RewriteFinder& finder);
void find_volumes(RewriteFinder& finder);
void find_closest_approach(RewriteFinder& finder);
void find_unit_approach(RewriteFinder& finder);
void find_stable_roots(RewriteFinder& finder);
void find_squares_of_roots(RewriteFinder& finder);
void find_edges_from_origin(RewriteFinder& finder);
void find_fused_products(RewriteFinder& finder);
void find_other_orders(RewriteFinder& finder);
void find_quotients(RewriteFinder& finder);
void find_reciprocals(RewriteFinder& finder);
void find_split_quotients(RewriteFinder& finder);
void find_scaled_lengths(RewriteFinder& finder);
void find_exchanges(RewriteFinder& finder);

inline constexpr Rule rules[]{
    {"difference of squares", "a^2 - b^2 = (a - b)(a + b)", "", find_differences_of_squares},
    {"difference of lengths", "|a|^2 - b^2 = (|a| - b)(|a| + b)", "", find_differences_of_lengths},
    {"cross products", "(a.c)(b.d) - (a.d)(b.c) = (a x b).(c x d), so |f|^2 |d|^2 - (f.d)^2 = |f x d|^2", "",
     find_cross_products},
    {"volume", "|a|^2 |b|^2 |c|^2 + 2 (a.b)(b.c)(c.a) - |a|^2 (b.c)^2 - |b|^2 (c.a)^2 - |c|^2 (a.b)^2 = (a.(b x c))^2",
     "", find_volumes},
    {"combination",
     "x^2 a.a - 2 x y a.b + y^2 b.b = |x a - y b|^2, also for (a.v)(b.v); in it, (v.b) a - (v.a) b = v x (a x b)", "",
     find_combinations},
    {"closest approach",
     "|n|^2 (a.b) - (a.n)(b.n) = |n|^2 (a - (a.n)/|n|^2 n).b: seen from the point nearest to the centre",
     "n != 0; if the form promises |d| = 1, only for such directions", find_closest_approach},
    {"closest approach, normalised", "the same with n/|n|", "n != 0", find_unit_approach},
    {"stable roots", "-b + s and -b - s, s = sqrt(D): q, the one with terms of like signs, and (b^2 - D)/q", "q != 0",
     find_stable_roots},
    // sqrt(x) is not a number for x < 0, and neither is its square.
    {"square of a root", "sqrt(x) sqrt(x) = x", "x >= 0", find_squares_of_roots},
    {"edges from the origin", "u + v <= |s|: u, v and s - u - v as d.((p - o) x (q - o)) for the three edges p q", "",
     find_edges_from_origin},
    {"fused products", "ab - cd = fma(a, b, -w) + fma(-c, d, w), w = cd (Kahan)", "", find_fused_products},
    {"other order", "(a + b) + c = a + (b + c) = (a + c) + b", "", find_other_orders},
    {"quotient", "x (1/y) = x/y", "y != 0", find_quotients},
    {"reciprocal", "x/y and z/y = x (1/y) and z (1/y)", "y != 0", find_reciprocals},
    {"split quotient", "(x + y)/z = x/z + y/z", "z != 0", find_split_quotients},
    {"scaled length", "sqrt(x^2 + y^2) = m sqrt((x/m)^2 + (y/m)^2), m = max(|x|, |y|)", "m != 0", find_scaled_lengths},
    {"exchange", "min(a, b) = min(b, a), and the same for max", "neither is NaN", find_exchanges},
};

/// Finds all rewrites that the rules allow, in the order of the rules.
std::vector<Rewrite> find_rewrites(Terms& terms, const TapeOutputs& outputs, std::optional<Triple> unit);

}  // namespace lostbits::measure::identity
