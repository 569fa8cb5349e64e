// The rule for the three edges of a triangle, whose vertices are relative to the ray's origin.
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
    Difference result{};
    for (std::size_t k = 0; k < 3; ++k) {
        const TapeNode& n = terms[v[k]];
        if (n.op != TapeOp::sub) return std::nullopt;
        result.p[k] = n.operands[0];
        result.q[k] = n.operands[1];
    }
    return result;
}

std::optional<Cross> cross_of(const Terms& terms, const Triple& v) {
    Cross result{};
    for (std::size_t k = 0; k < 3; ++k) {
        const TapeNode& n = terms[v[k]];
        if (n.op != TapeOp::sub || terms[n.operands[0]].op != TapeOp::mul) return std::nullopt;
        const auto& [a, b, none] = terms[n.operands[0]].operands;
        result.a[(k + 1) % 3] = a;
        result.b[(k + 2) % 3] = b;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const TapeNode& other = terms[terms[v[k]].operands[1]];
        if (other.op != TapeOp::mul || other.operands[0] != result.a[(k + 2) % 3] ||
            other.operands[1] != result.b[(k + 1) % 3])
            return std::nullopt;
    }
    return result;
}

/// An edge function of the edge from q to p: ((p or q) − o) × d · (p − q) = d·((p − o) × (q − o)).
struct Edge {
    NodeId node;
    Triple p, q, o, d;
};
std::optional<Edge> find_edge_at(const Terms& terms, NodeId i) {
    const auto factors = terms.factors_of(i);
    if (!factors) return std::nullopt;
    const auto cross = cross_of(terms, factors->first);
    const auto edge = difference_of(terms, factors->second);
    const auto to_vertex = cross ? difference_of(terms, cross->a) : std::nullopt;
    if (!edge || !to_vertex || (to_vertex->p != edge->p && to_vertex->p != edge->q)) return std::nullopt;
    return Edge{.node = i, .p = edge->p, .q = edge->q, .o = to_vertex->q, .d = cross->b};
}

NodeId determinant(Terms& terms, const Edge& e, std::string_view label) {
    const auto from_origin = [&](const Triple& p) {
        Triple difference{};
        for (std::size_t k = 0; k < 3; ++k) difference[k] = terms.add(TapeOp::sub, {p[k], e.o[k]});
        return difference;
    };
    return terms.dot(terms.cross(from_origin(e.p), from_origin(e.q)), e.d, label);
}

/// x and `negates` of select(negates, −x, x).
struct ConditionalNegation {
    NodeId x, negates;
};
std::optional<ConditionalNegation> negation_at(const Terms& terms, NodeId i) {
    const TapeNode& n = terms[i];
    if (n.op != TapeOp::select) return std::nullopt;
    const TapeNode& negated = terms[n.operands[1]];
    if (negated.op != TapeOp::neg || negated.operands[0] != n.operands[2]) return std::nullopt;
    return ConditionalNegation{n.operands[2], n.operands[0]};
}

}  // namespace

void find_edges_from_origin(RewriteFinder& finder) {
    Terms& terms = finder.terms;
    for (const NodeId i : finder.formula_nodes) {
        const TapeNode n = terms[i];
        if (n.op != TapeOp::less_equal) continue;

        // u + v <= |s|, where one condition negates both u and v.
        const TapeNode sum = terms[n.operands[0]], size = terms[n.operands[1]];
        if (sum.op != TapeOp::add || size.op != TapeOp::abs) continue;
        const auto u = negation_at(terms, sum.operands[0]), v = negation_at(terms, sum.operands[1]);
        if (!u || !v || u->negates != v->negates) continue;
        const auto first = find_edge_at(terms, u->x), second = find_edge_at(terms, v->x);
        if (!first || !second || first->o != second->o || first->d != second->d) continue;

        // The third edge closes the triangle.
        Edge third = *first;
        if (first->q == second->p) {
            third.p = second->q;
            third.q = first->p;
        } else if (second->q == first->p) {
            third.p = first->q;
            third.q = second->p;
        } else {
            continue;
        }

        // Each edge function becomes a determinant, and the comparison the sign of the third.
        const NodeId w = determinant(terms, third, "W");
        const NodeId signed_w = terms.add(TapeOp::select, {u->negates, terms.add(TapeOp::neg, {w}), w});
        finder.add_rewrite({{u->x, determinant(terms, *first, {})},
                            {v->x, determinant(terms, *second, {})},
                            {i, terms.add(TapeOp::greater_equal, {signed_w, terms.constant(0)})}});
    }
}

}  // namespace lostbits::measure::identity
