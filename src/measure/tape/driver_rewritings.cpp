// The rewritings of drivers. In real arithmetic each leaves the results unchanged.
#include <algorithm>
#include <array>
#include <optional>

#include "measure/tape/driver_difference.hpp"

namespace lostbits::measure::tape {
namespace {

/// A tape that grows while another one is copied. Nodes keep their order; `copy_of` finds the copy of a node of the
/// source tape.
class TapeCopy {
public:
    explicit TapeCopy(const DerivedTape& source)
        : source_(source.tape), origins_(source.origins), uses_(source_.nodes.size()) {
        const Tape& source_tape = source.tape;
        for (const TapeNode& n : source_tape.nodes)
            if (!is_given(n.op))
                for (const NodeId o : n.operands)
                    if (o != no_node) ++uses_[static_cast<std::size_t>(o)];
        for (const NodeId o :
             {source_tape.outputs.hit, source_tape.outputs.t, source_tape.outputs.near, source_tape.outputs.far})
            ++uses_[static_cast<std::size_t>(o)];
        result_.tape.formats = source_tape.formats;
    }
    [[nodiscard]] const TapeNode& source_node(NodeId i) const { return source_[i]; }
    [[nodiscard]] bool is_used_once(NodeId i) const { return uses_[static_cast<std::size_t>(i)] == 1; }
    [[nodiscard]] NodeId copy_of(NodeId i) const { return copies_[static_cast<std::size_t>(i)]; }
    NodeId add(TapeOp op, NodeId model, std::array<NodeId, 3> operands) {
        result_.tape.nodes.push_back({op, source_[model].format, operands, 0});
        result_.origins.push_back(origins_[static_cast<std::size_t>(model)]);
        return result_.tape.size() - 1;
    }
    void set_copy(NodeId copied) { copies_.push_back(copied); }
    void copy_node(NodeId i) {
        TapeNode n = source_[i];
        if (!is_given(n.op))
            for (NodeId& o : n.operands)
                if (o != no_node) o = copy_of(o);
        result_.tape.nodes.push_back(n);
        result_.origins.push_back(origins_[static_cast<std::size_t>(i)]);
        set_copy(result_.tape.size() - 1);
    }
    DerivedTape finish() {
        const auto [hit, t, near, far] = source_.outputs;
        result_.tape.outputs = {copy_of(hit), copy_of(t), copy_of(near), copy_of(far)};
        return std::move(result_);
    }

private:
    const Tape& source_;
    const std::vector<NodeId>& origins_;
    DerivedTape result_;
    std::vector<int> uses_;
    std::vector<NodeId> copies_;
};

/// Returns the new node that replaces node i, or nothing if the rewriting does not apply there.
using Rewrite = std::optional<NodeId>(TapeCopy& c, NodeId i);

std::optional<NodeId> fuse_product(TapeCopy& c, NodeId i) {
    const TapeNode& n = c.source_node(i);
    if (n.op != TapeOp::add && n.op != TapeOp::sub) return {};
    for (const std::size_t k : {0, 1}) {
        const NodeId product = n.operands[k], other = n.operands[1 - k];
        if (c.source_node(product).op != TapeOp::mul || !c.is_used_once(product)) continue;
        NodeId a = c.copy_of(c.source_node(product).operands[0]), addend = c.copy_of(other);
        if (n.op == TapeOp::sub && k == 0) addend = c.add(TapeOp::neg, i, {addend, no_node, no_node});
        if (n.op == TapeOp::sub && k == 1) a = c.add(TapeOp::neg, i, {a, no_node, no_node});
        return c.add(TapeOp::fma, i, {a, c.copy_of(c.source_node(product).operands[1]), addend});
    }
    return {};
}

std::optional<NodeId> reorder_sum(TapeCopy& c, NodeId i) {
    const TapeNode& n = c.source_node(i);
    if (n.op != TapeOp::add) return {};
    const NodeId left = n.operands[0];
    if (c.source_node(left).op != TapeOp::add || !c.is_used_once(left)) return {};
    const NodeId last =
        c.add(TapeOp::add, i, {c.copy_of(c.source_node(left).operands[1]), c.copy_of(n.operands[1]), no_node});
    return c.add(TapeOp::add, i, {c.copy_of(c.source_node(left).operands[0]), last, no_node});
}

std::optional<NodeId> round_twice(TapeCopy& c, NodeId i) {
    const TapeNode& n = c.source_node(i);
    if (n.op != TapeOp::fma) return {};
    const NodeId product = c.add(TapeOp::mul, i, {c.copy_of(n.operands[0]), c.copy_of(n.operands[1]), no_node});
    return c.add(TapeOp::add, i, {product, c.copy_of(n.operands[2]), no_node});
}

std::optional<NodeId> multiply_by_reciprocal(TapeCopy& c, NodeId i) {
    const TapeNode& n = c.source_node(i);
    if (n.op != TapeOp::div || c.source_node(n.operands[0]).op == TapeOp::constant) return {};
    const NodeId one = c.add(TapeOp::constant, i, {1, no_node, no_node});
    const NodeId inverse = c.add(TapeOp::div, i, {one, c.copy_of(n.operands[1]), no_node});
    return c.add(TapeOp::mul, i, {c.copy_of(n.operands[0]), inverse, no_node});
}

std::optional<NodeId> extract_common_factor(TapeCopy& c, NodeId i) {
    const TapeNode& n = c.source_node(i);
    if (n.op != TapeOp::add && n.op != TapeOp::sub) return {};
    const TapeNode &a = c.source_node(n.operands[0]), &b = c.source_node(n.operands[1]);
    if (a.op != TapeOp::mul || b.op != TapeOp::mul) return {};
    for (const std::size_t k : {0, 1})
        for (const std::size_t l : {0, 1})
            if (a.operands[k] == b.operands[l]) {
                const NodeId sum =
                    c.add(n.op, i, {c.copy_of(a.operands[1 - k]), c.copy_of(b.operands[1 - l]), no_node});
                return c.add(TapeOp::mul, i, {c.copy_of(a.operands[k]), sum, no_node});
            }
    return {};
}

std::optional<NodeId> remove_root(TapeCopy& c, NodeId i) {
    const TapeNode& n = c.source_node(i);
    if (n.op != TapeOp::mul || n.operands[0] != n.operands[1] || c.source_node(n.operands[0]).op != TapeOp::sqrt)
        return {};
    return c.copy_of(c.source_node(n.operands[0]).operands[0]);
}

struct DriverRow {
    const char* name;
    Rewrite* rewrite;
};
constexpr std::array driver_rows{DriverRow{"adds x + (y + z) in place of (x + y) + z", reorder_sum},
                                 DriverRow{"rounds fma(a, b, c) twice", round_twice},
                                 DriverRow{"rounds a*b + c once", fuse_product},
                                 DriverRow{"multiplies by 1/y in place of dividing by y", multiply_by_reciprocal},
                                 DriverRow{"takes a common factor out of a sum", extract_common_factor},
                                 DriverRow{"takes x in place of sqrt(x)*sqrt(x)", remove_root}};

}  // namespace

std::vector<std::string> driver_rewritings() {
    std::vector<std::string> names;
    for (const DriverRow& row : driver_rows) names.emplace_back(row.name);
    return names;
}

DerivedTape rewritten_by_driver(const DerivedTape& source, std::size_t rewriting, const std::vector<NodeId>* sites,
                                std::vector<NodeId>& changed) {
    TapeCopy copy(source);
    for (NodeId i = 0; i < source.tape.size(); ++i) {
        const NodeId origin = source.origins[static_cast<std::size_t>(i)];
        const bool is_selected = sites == nullptr || std::ranges::find(*sites, origin) != sites->end();
        const auto rewritten =
            is_selected && !is_given(source.tape[i].op) ? driver_rows.at(rewriting).rewrite(copy, i) : std::nullopt;
        if (rewritten) copy.set_copy(*rewritten), changed.push_back(origin);
        else copy.copy_node(i);
    }
    return copy.finish();
}

}  // namespace lostbits::measure::tape
