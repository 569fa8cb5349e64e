// Rule for the three edges of a triangle, seen from the ray's origin.
#include "measure/identity/rules.hpp"

namespace lostbits::measure::identity {

namespace {

/// v = p − q.
struct Difference {
    Triple p, q;
};
/// v = a × b, as `Terms::cross` writes it.
struct Cross {
    Triple a, b;
};

std::optional<Difference> difference_of(const Terms& terms, const Triple& v) {
    Difference found{};
    for (std::size_t k = 0; k < 3; ++k) {
        const TapeNode& n = terms[v[k]];
        if (n.op != TapeOp::sub) return std::nullopt;
        found.p[k] = n.operands[0], found.q[k] = n.operands[1];
    }
    return found;
}

std::optional<Cross> cross_of(const Terms& terms, const Triple& v) {
    Cross found{};
    for (std::size_t k = 0; k < 3; ++k) {
        const TapeNode& n = terms[v[k]];
        if (n.op != TapeOp::sub || terms[n.operands[0]].op != TapeOp::mul) return std::nullopt;
        const auto& [a, b, none] = terms[n.operands[0]].operands;
        found.a[(k + 1) % 3] = a, found.b[(k + 2) % 3] = b;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const TapeNode& other = terms[terms[v[k]].operands[1]];
        if (other.op != TapeOp::mul || other.operands[0] != found.a[(k + 2) % 3] ||
            other.operands[1] != found.b[(k + 1) % 3])
            return std::nullopt;
    }
    return found;
}

/// ((p or q) − o) × d · (p − q) = d·((p − o) × (q − o))
struct Edge {
    NodeId node;
    Triple p, q, o, d;
};
std::optional<Edge> edge_at(const Terms& terms, NodeId i) {
    const auto factors = terms.factors_of(i);
    if (!factors) return std::nullopt;
    const auto cross = cross_of(terms, factors->first);
    const auto along = difference_of(terms, factors->second);
    const auto from = cross ? difference_of(terms, cross->a) : std::nullopt;
    if (!along || !from || (from->p != along->p && from->p != along->q)) return std::nullopt;
    return Edge{.node = i, .p = along->p, .q = along->q, .o = from->q, .d = cross->b};
}

NodeId determinant(Terms& terms, const Edge& e, std::string_view label) {
    const auto seen = [&](const Triple& p) {
        Triple at{};
        for (std::size_t k = 0; k < 3; ++k) at[k] = terms.add(TapeOp::sub, {p[k], e.o[k]});
        return at;
    };
    return terms.dot(terms.cross(seen(e.p), seen(e.q)), e.d, label);
}

/// x and `turned` of select(turned, −x, x).
struct ConditionalNegation {
    NodeId x, turned;
};
std::optional<ConditionalNegation> turned_at(const Terms& terms, NodeId i) {
    const TapeNode& n = terms[i];
    if (n.op != TapeOp::select) return std::nullopt;
    const TapeNode& minus = terms[n.operands[1]];
    if (minus.op != TapeOp::neg || minus.operands[0] != n.operands[2]) return std::nullopt;
    return ConditionalNegation{n.operands[2], n.operands[0]};
}

}  // namespace

void find_edges_from_origin(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    for (const NodeId i : finder.needed) {
        const TapeNode n = terms[i];
        if (n.op != TapeOp::less_equal) continue;
        const TapeNode sum = terms[n.operands[0]], size = terms[n.operands[1]];
        if (sum.op != TapeOp::add || size.op != TapeOp::abs) continue;
        const auto u = turned_at(terms, sum.operands[0]), v = turned_at(terms, sum.operands[1]);
        if (!u || !v || u->turned != v->turned) continue;
        const auto first = edge_at(terms, u->x), second = edge_at(terms, v->x);
        if (!first || !second || first->o != second->o || first->d != second->d) continue;
        Edge third = *first;
        if (first->q == second->p) third.p = second->q, third.q = first->p;
        else if (second->q == first->p) third.p = first->q, third.q = second->p;
        else continue;
        const NodeId w = determinant(terms, third, "W");
        const NodeId turned = terms.add(TapeOp::select, {u->turned, terms.add(TapeOp::neg, {w}), w});
        finder.add_rewrite({{u->x, determinant(terms, *first, {})},
                            {v->x, determinant(terms, *second, {})},
                            {i, terms.add(TapeOp::greater_equal, {turned, terms.constant(0)})}});
    }
}

}  // namespace lostbits::measure::identity
