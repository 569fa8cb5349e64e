// The rewritings of drivers. Each keeps what the operations are in real arithmetic.
#include <algorithm>
#include <array>
#include <optional>

#include "measure/tape/driver_difference.hpp"

namespace lostbits::measure::tape {
namespace {

/// A tape that grows while another one is copied. Nodes keep their order; those of the old tape are found by `place`.
class Copy {
public:
    explicit Copy(const DerivedTape& all) : from_(all.tape), origins_(all.origins), uses_(from_.nodes.size()) {
        const Tape& from = all.tape;
        for (const TapeNode& n : from.nodes)
            if (!is_given(n.op))
                for (const NodeId o : n.operands)
                    if (o != no_node) ++uses_[static_cast<std::size_t>(o)];
        for (const NodeId o : {from.outputs.hit, from.outputs.t, from.outputs.near, from.outputs.far})
            ++uses_[static_cast<std::size_t>(o)];
        made_.tape.formats = from.formats;
    }
    [[nodiscard]] const TapeNode& old(NodeId i) const { return from_[i]; }
    [[nodiscard]] bool is_used_once(NodeId i) const { return uses_[static_cast<std::size_t>(i)] == 1; }
    [[nodiscard]] NodeId at(NodeId i) const { return place_[static_cast<std::size_t>(i)]; }
    NodeId add(TapeOp op, NodeId like, std::array<NodeId, 3> operands) {
        made_.tape.nodes.push_back({op, from_[like].format, operands, 0});
        made_.origins.push_back(origins_[static_cast<std::size_t>(like)]);
        return made_.tape.size() - 1;
    }
    void put(NodeId made) { place_.push_back(made); }
    void copy(NodeId i) {
        TapeNode n = from_[i];
        if (!is_given(n.op))
            for (NodeId& o : n.operands)
                if (o != no_node) o = at(o);
        made_.tape.nodes.push_back(n);
        made_.origins.push_back(origins_[static_cast<std::size_t>(i)]);
        put(made_.tape.size() - 1);
    }
    DerivedTape done() {
        const auto [hit, t, near, far] = from_.outputs;
        made_.tape.outputs = {at(hit), at(t), at(near), at(far)};
        return std::move(made_);
    }

private:
    const Tape& from_;
    const std::vector<NodeId>& origins_;
    DerivedTape made_;
    std::vector<int> uses_;
    std::vector<NodeId> place_;
};

/// The new node in place of node i; nothing if the rewriting does not apply there.
using Rewrite = std::optional<NodeId>(Copy& c, NodeId i);

std::optional<NodeId> fused(Copy& c, NodeId i) {
    const TapeNode& n = c.old(i);
    if (n.op != TapeOp::add && n.op != TapeOp::sub) return {};
    for (const std::size_t k : {0, 1}) {
        const NodeId product = n.operands[k], other = n.operands[1 - k];
        if (c.old(product).op != TapeOp::mul || !c.is_used_once(product)) continue;
        NodeId a = c.at(c.old(product).operands[0]), addend = c.at(other);
        if (n.op == TapeOp::sub && k == 0) addend = c.add(TapeOp::neg, i, {addend, no_node, no_node});
        if (n.op == TapeOp::sub && k == 1) a = c.add(TapeOp::neg, i, {a, no_node, no_node});
        return c.add(TapeOp::fma, i, {a, c.at(c.old(product).operands[1]), addend});
    }
    return {};
}

std::optional<NodeId> in_other_order(Copy& c, NodeId i) {
    const TapeNode& n = c.old(i);
    if (n.op != TapeOp::add) return {};
    const NodeId left = n.operands[0];
    if (c.old(left).op != TapeOp::add || !c.is_used_once(left)) return {};
    const NodeId last = c.add(TapeOp::add, i, {c.at(c.old(left).operands[1]), c.at(n.operands[1]), no_node});
    return c.add(TapeOp::add, i, {c.at(c.old(left).operands[0]), last, no_node});
}

std::optional<NodeId> rounded_twice(Copy& c, NodeId i) {
    const TapeNode& n = c.old(i);
    if (n.op != TapeOp::fma) return {};
    const NodeId product = c.add(TapeOp::mul, i, {c.at(n.operands[0]), c.at(n.operands[1]), no_node});
    return c.add(TapeOp::add, i, {product, c.at(n.operands[2]), no_node});
}

std::optional<NodeId> by_reciprocal(Copy& c, NodeId i) {
    const TapeNode& n = c.old(i);
    if (n.op != TapeOp::div || c.old(n.operands[0]).op == TapeOp::constant) return {};
    const NodeId one = c.add(TapeOp::constant, i, {1, no_node, no_node});
    const NodeId inverse = c.add(TapeOp::div, i, {one, c.at(n.operands[1]), no_node});
    return c.add(TapeOp::mul, i, {c.at(n.operands[0]), inverse, no_node});
}

std::optional<NodeId> with_common_factor(Copy& c, NodeId i) {
    const TapeNode& n = c.old(i);
    if (n.op != TapeOp::add && n.op != TapeOp::sub) return {};
    const TapeNode &a = c.old(n.operands[0]), &b = c.old(n.operands[1]);
    if (a.op != TapeOp::mul || b.op != TapeOp::mul) return {};
    for (const std::size_t k : {0, 1})
        for (const std::size_t l : {0, 1})
            if (a.operands[k] == b.operands[l]) {
                const NodeId sum = c.add(n.op, i, {c.at(a.operands[1 - k]), c.at(b.operands[1 - l]), no_node});
                return c.add(TapeOp::mul, i, {c.at(a.operands[k]), sum, no_node});
            }
    return {};
}

std::optional<NodeId> without_root(Copy& c, NodeId i) {
    const TapeNode& n = c.old(i);
    if (n.op != TapeOp::mul || n.operands[0] != n.operands[1] || c.old(n.operands[0]).op != TapeOp::sqrt) return {};
    return c.at(c.old(n.operands[0]).operands[0]);
}

struct DriverRow {
    const char* name;
    Rewrite* rewrite;
};
constexpr std::array driver_rows{DriverRow{"adds x + (y + z) in place of (x + y) + z", in_other_order},
                                 DriverRow{"rounds fma(a, b, c) twice", rounded_twice},
                                 DriverRow{"rounds a*b + c once", fused},
                                 DriverRow{"multiplies by 1/y in place of dividing by y", by_reciprocal},
                                 DriverRow{"takes a common factor out of a sum", with_common_factor},
                                 DriverRow{"takes x in place of sqrt(x)*sqrt(x)", without_root}};

}  // namespace

std::vector<std::string> driver_rewritings() {
    std::vector<std::string> names;
    for (const DriverRow& row : driver_rows) names.emplace_back(row.name);
    return names;
}

DerivedTape rewritten_by_driver(const DerivedTape& from, std::size_t which, const std::vector<NodeId>* sites,
                                std::vector<NodeId>& changed) {
    Copy copy(from);
    for (NodeId i = 0; i < from.tape.size(); ++i) {
        const NodeId origin = from.origins[static_cast<std::size_t>(i)];
        const bool asked = sites == nullptr || std::ranges::find(*sites, origin) != sites->end();
        const auto made = asked && !is_given(from.tape[i].op) ? driver_rows.at(which).rewrite(copy, i) : std::nullopt;
        if (made) copy.put(*made), changed.push_back(origin);
        else copy.copy(i);
    }
    return copy.done();
}

}  // namespace lostbits::measure::tape
