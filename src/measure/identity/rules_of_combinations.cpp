// Rules for the square of a combination of two vectors, which a formula has multiplied out.

#include <algorithm>

#include "measure/identity/rules.hpp"

namespace lostbits::measure::identity {

namespace {

/// The vector x a ± y b of a sum that contains x² (a·a), ±2 x y (a·b) and y² (b·b), all with the same remaining
/// factors.
struct Combination {
    NodeId x, y;
    Triple a, b;
    bool is_difference;
};

class CombinationFinder {
public:
    CombinationFinder(RewriteFinder& finder, const Sum& sum) : finder_(finder), terms_(finder.terms), sum_(sum) {}

    /// Returns the sum with dot products of the combination in place of those of its parts, once for each combination
    /// found.
    std::vector<Sum> find_all() {
        for (const auto& [product, factor] : sum_)
            for (const auto& [x, px] : product)
                for (const auto& [aa, pa] : product) {
                    const auto a = terms_.factors_of(aa);
                    if (px != 2 || terms_.factors_of(x) || pa != 1 || !a || a->first != a->second) continue;
                    const Product rest = times(product, times(power(x, -2), power(aa, -1)));
                    for (const auto& [partner, partner_factor] : sum_)
                        if (partner_factor == factor) try_partner(x, a->first, times(partner, inverse(rest)));
                }
        return std::move(found_);
    }

private:
    /// Tries whether `partner`, which lacks the remaining factors, is y² (b·b).
    void try_partner(NodeId x, const Triple& a, const Product& partner) {
        if (partner.size() != 2) return;
        for (const auto& [y, py] : partner)
            for (const auto& [bb, pb] : partner) {
                const auto b = terms_.factors_of(bb);
                if (py != 2 || y <= x || terms_.factors_of(y) || pb != 1 || !b || b->first != b->second) continue;
                for (const bool is_difference : {false, true}) replace({x, y, a, b->first, is_difference});
            }
    }

    void replace(const Combination& combination) {
        for (const bool uses_cross_products : {true, false}) {
            auto u = uses_cross_products ? by_cross_products(combination) : std::optional(plain(combination));
            if (!u)
                u = by_cross_products({combination.y, combination.x, combination.b, combination.a,
                                       combination.is_difference});  // this is -u
            if (!u) continue;
            Sum rewritten = sum_;
            const bool has_replaced = replace_products(combination, *u, rewritten);
            if (has_replaced && !rewritten.empty()) found_.push_back(std::move(rewritten));
        }
    }

    /// Replaces the three products of (u·v)(u·w), for any v and w, by that product. Returns true if there were any.
    bool replace_products(const Combination& combination, const Triple& u, Sum& rewritten) {
        bool has_replaced = false;
        for (const auto& [product, factor] : sum_) {
            if (!rewritten.contains(product)) continue;
            has_replaced |= std::ranges::any_of(product, [&, &first = product, &x = factor](const auto& dot_power) {
                return replace_three(combination, u, first, x, dot_power, rewritten);
            });
        }
        return has_replaced;
    }
    /// Replaces x² (a·a) or x² (a·v)² in `first` and the two products that belong to it. `dot_power` is an atom of
    /// `first` with its power. Returns false and changes nothing if the atom is not that dot product, or if a product
    /// is missing.
    bool replace_three(const Combination& combination, const Triple& u, const Product& first, const Ratio& factor,
                       const std::pair<const NodeId, int>& dot_power, Sum& rewritten) {
        const auto& [dot, exponent] = dot_power;
        const auto factors = terms_.factors_of(dot);
        if (!factors || (factors->first != combination.a && factors->second != combination.a) ||
            !first.contains(combination.x))
            return false;
        const Triple& v = factors->first == combination.a ? factors->second : factors->first;
        const bool is_square = v == combination.a;
        if (is_square ? exponent != 1 : exponent != 2) return false;

        // The products with x y and y² that must be in the sum too.
        const auto av = terms_.known_dot(combination.a, is_square ? combination.b : v),
                   bv = terms_.known_dot(combination.b, is_square ? combination.b : v);
        if (!av || !bv) return false;
        const Product rest = times(first, times(power(combination.x, -2), power(dot, -exponent)));
        const Product last = times(rest, times(power(combination.y, 2), power(*bv, is_square ? 1 : 2)));
        Product middle = times(rest, times(power(combination.x, 1), power(combination.y, 1)));
        middle = times(middle, is_square ? power(*av, 1) : times(power(*av, 1), power(*bv, 1)));
        const Ratio doubled = factor * Ratio(combination.is_difference ? -2 : 2, 1);
        if (!is_in(rewritten, last, factor) || !is_in(rewritten, middle, doubled)) return false;

        const NodeId combined_dot = is_square ? terms_.dot(u, u) : terms_.dot(u, v);
        for (const Product& removed : {first, last, middle}) rewritten.erase(removed);
        rewritten = plus(rewritten, Sum{{times(rest, power(combined_dot, is_square ? 1 : 2)), factor}});
        return true;
    }
    static bool is_in(const Sum& sum, const Product& product, const Ratio& factor) {
        const auto position = sum.find(product);
        return position != sum.end() && position->second == factor;
    }

    [[nodiscard]] NodeId newest(NodeId atom) const {
        const auto position = finder_.newest_nodes.find(terms_.meaning(atom));
        return position == finder_.newest_nodes.end() ? atom : position->second;
    }
    Triple plain(const Combination& combination) {
        Triple u{};
        for (std::size_t k = 0; k < 3; ++k)
            u[k] = terms_.add(combination.is_difference ? TapeOp::sub : TapeOp::add,
                              {terms_.add(TapeOp::mul, {newest(combination.x), combination.a[k]}),
                               terms_.add(TapeOp::mul, {newest(combination.y), combination.b[k]})});
        return u;
    }
    /// The vector p a + q v × (a × b), which equals x a − y b for x = p + q (v·b) and y = q (v·a). Returns nothing if x
    /// and y are not of this form.
    std::optional<Triple> by_cross_products(const Combination& combination) {
        const auto x = multiply_out(terms_, combination.x), y = multiply_out(terms_, combination.y);
        if (!combination.is_difference || !x || !y || y->empty()) return std::nullopt;
        for (const auto& [dot, exponent] : y->begin()->first) {
            const auto factors = terms_.factors_of(dot);
            if (!factors || exponent < 1 || (factors->first != combination.a && factors->second != combination.a))
                continue;

            // p and q, from y = q (v·a) and x = p + q (v·b).
            const Triple v = factors->first == combination.a ? factors->second : factors->first;
            const auto vb = terms_.known_dot(v, combination.b);
            const Sum q = times(*y, Sum{{power(dot, -1), Ratio(1, 1)}});
            const Sum p = vb ? plus(*x, times(q, Sum{{power(*vb, 1), Ratio(-1, 1)}})) : Sum();
            if (p.empty() || p.size() >= x->size()) continue;

            const NodeId first = write_sum(terms_, p, finder_.newest_nodes),
                         second = write_sum(terms_, q, finder_.newest_nodes);
            const Triple perpendicular = terms_.cross(v, terms_.cross(combination.a, combination.b));
            Triple u{};
            for (std::size_t k = 0; k < 3; ++k)
                u[k] = terms_.add(TapeOp::add, {terms_.add(TapeOp::mul, {first, combination.a[k]}),
                                                terms_.add(TapeOp::mul, {second, perpendicular[k]})});
            return u;
        }
        return std::nullopt;
    }

    RewriteFinder& finder_;
    Terms& terms_;
    const Sum& sum_;
    std::vector<Sum> found_;
};

}  // namespace

void find_combinations(RewriteFinder& finder) {
    std::vector<std::pair<NodeId, Sum>> rewritten_sums;
    finder.for_each_sum(
        [&](NodeId i, const Sum& sum) {
            for (Sum& rewritten : CombinationFinder(finder, sum).find_all())
                rewritten_sums.emplace_back(i, std::move(rewritten));
        },
        InnermostNames::kept_as_well);
    for (const auto& [i, rewritten] : rewritten_sums)
        finder.add_rewrite(i, write_sum(finder.terms, rewritten, finder.newest_nodes, finder.terms[i].label));
}

}  // namespace lostbits::measure::identity
