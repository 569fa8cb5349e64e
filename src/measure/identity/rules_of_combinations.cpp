// Rules for the square of a combination of two vectors, multiplied out.

#include "measure/identity/rules.hpp"

namespace lostbits::measure::identity {

namespace {

/// x a ± y b, if the sum contains x² (a·a), ±2 x y (a·b) and y² (b·b), all with the same remaining factors.
struct Combination {
    NodeId x, y;
    Triple a, b;
    bool minus;
};

class CombinationFinder {
public:
    CombinationFinder(RewriteFinder& finder, const Sum& sum) : finder_(finder), terms_(finder.terms), sum_(sum) {}

    /// The sum with dot products of the combination in place of those of its parts, once for each combination found.
    std::vector<Sum> all() {
        for (const auto& [product, factor] : sum_)
            for (const auto& [x, px] : product)
                for (const auto& [aa, pa] : product) {
                    const auto a = terms_.factors_of(aa);
                    if (px != 2 || terms_.factors_of(x) || pa != 1 || !a || a->first != a->second) continue;
                    const Product rest = times(product, times(power(x, -2), power(aa, -1)));
                    for (const auto& [other, same] : sum_)
                        if (same == factor) look(x, a->first, times(other, inverse(rest)));
                }
        return std::move(found_);
    }

private:
    /// Tries `other`, without the remaining factors, as y² (b·b).
    void look(NodeId x, const Triple& a, const Product& other) {
        if (other.size() != 2) return;
        for (const auto& [y, py] : other)
            for (const auto& [bb, pb] : other) {
                const auto b = terms_.factors_of(bb);
                if (py != 2 || y <= x || terms_.factors_of(y) || pb != 1 || !b || b->first != b->second) continue;
                for (const bool minus : {false, true}) replace({x, y, a, b->first, minus});
            }
    }

    void replace(const Combination& c) {
        for (const bool crossed : {true, false}) {
            auto u = crossed ? by_cross_products(c) : std::optional(plain(c));
            if (!u) u = by_cross_products({c.y, c.x, c.b, c.a, c.minus});  // this is -u
            if (!u) continue;
            Sum now = sum_;
            const bool any = take(c, *u, now);
            if (any && !now.empty()) found_.push_back(std::move(now));
        }
    }

    /// Replaces the three products of (u·v)(u·w), for any v and w, by that product; true if there were any.
    bool take(const Combination& c, const Triple& u, Sum& now) {
        bool any = false;
        for (const auto& [product, factor] : sum_) {
            if (!now.contains(product)) continue;
            for (const auto& [dot, exponent] : product) {
                const auto of = terms_.factors_of(dot);
                if (!of || (of->first != c.a && of->second != c.a) || !product.contains(c.x)) continue;
                const Triple& v = of->first == c.a ? of->second : of->first;
                const bool own = v == c.a;
                if (own ? exponent != 1 : exponent != 2) continue;
                const auto av = terms_.known_dot(c.a, own ? c.b : v), bv = terms_.known_dot(c.b, own ? c.b : v);
                if (!av || !bv) continue;
                const Product rest = times(product, times(power(c.x, -2), power(dot, -exponent)));
                const Product last = times(rest, times(power(c.y, 2), power(*bv, own ? 1 : 2)));
                Product middle = times(rest, times(power(c.x, 1), power(c.y, 1)));
                middle = times(middle, own ? power(*av, 1) : times(power(*av, 1), power(*bv, 1)));
                const Ratio twice = factor * Ratio(c.minus ? -2 : 2, 1);
                if (!is_in(now, last, factor) || !is_in(now, middle, twice)) continue;
                const NodeId with = own ? terms_.dot(u, u) : terms_.dot(u, v);
                for (const Product& gone : {product, last, middle}) now.erase(gone);
                now = plus(now, Sum{{times(rest, power(with, own ? 1 : 2)), factor}});
                any = true;
                break;
            }
        }
        return any;
    }
    static bool is_in(const Sum& sum, const Product& product, const Ratio& factor) {
        const auto found = sum.find(product);
        return found != sum.end() && found->second == factor;
    }

    [[nodiscard]] NodeId newest(NodeId atom) const {
        const auto found = finder_.newest.find(terms_.meaning(atom));
        return found == finder_.newest.end() ? atom : found->second;
    }
    Triple plain(const Combination& c) {
        Triple u{};
        for (std::size_t k = 0; k < 3; ++k)
            u[k] = terms_.add(c.minus ? TapeOp::sub : TapeOp::add, {terms_.add(TapeOp::mul, {newest(c.x), c.a[k]}),
                                                                    terms_.add(TapeOp::mul, {newest(c.y), c.b[k]})});
        return u;
    }
    /// The vector p a + q v × (a × b), for x a − y b with x = p + q (v·b) and y = q (v·a).
    std::optional<Triple> by_cross_products(const Combination& c) {
        const auto x = multiplied_out(terms_, c.x), y = multiplied_out(terms_, c.y);
        if (!c.minus || !x || !y || y->empty()) return std::nullopt;
        for (const auto& [dot, exponent] : y->begin()->first) {
            const auto of = terms_.factors_of(dot);
            if (!of || exponent < 1 || (of->first != c.a && of->second != c.a)) continue;
            const Triple v = of->first == c.a ? of->second : of->first;
            const auto vb = terms_.known_dot(v, c.b);
            const Sum q = times(*y, Sum{{power(dot, -1), Ratio(1, 1)}});
            const Sum p = vb ? plus(*x, times(q, Sum{{power(*vb, 1), Ratio(-1, 1)}})) : Sum();
            if (p.empty() || p.size() >= x->size()) continue;
            const NodeId first = written_out(terms_, p, finder_.newest),
                         second = written_out(terms_, q, finder_.newest);
            const Triple turned = terms_.cross(v, terms_.cross(c.a, c.b));
            Triple u{};
            for (std::size_t k = 0; k < 3; ++k)
                u[k] = terms_.add(TapeOp::add, {terms_.add(TapeOp::mul, {first, c.a[k]}),
                                                terms_.add(TapeOp::mul, {second, turned[k]})});
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
    std::vector<std::pair<NodeId, Sum>> all;
    finder.for_each_sum(
        [&](NodeId i, const Sum& sum) {
            for (Sum& now : CombinationFinder(finder, sum).all()) all.emplace_back(i, std::move(now));
        },
        true);
    for (const auto& [i, now] : all)
        finder.add_rewrite(i, written_out(finder.terms, now, finder.newest, finder.terms[i].label));
}

}  // namespace lostbits::measure::identity
