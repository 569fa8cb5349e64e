// Rewritings that drivers apply to a program. In real arithmetic, none of them changes the results.
#include <algorithm>
#include <array>
#include <optional>

#include "measure/tape/driver_difference.hpp"

namespace lostbits::measure::tape {
namespace {

/// Copies a tape node by node, in order. `copy_of` finds the copy of a node of the source tape.
class TapeCopy {
public:
    explicit TapeCopy(const DerivedTape& source)
        : source_(source.tape), origins_(source.origins), uses_(source_.nodes.size()) {
        const Tape& source_tape = source.tape;
        for (const TapeNode& node : source_tape.nodes)
            if (!is_given(node.op))
                for (const NodeId operand : node.operands)
                    if (operand != no_node) ++uses_[operand];
        for (const NodeId operand :
             {source_tape.outputs.hit, source_tape.outputs.t, source_tape.outputs.near, source_tape.outputs.far})
            ++uses_[operand];
        result_.tape.formats = source_tape.formats;
    }
    [[nodiscard]] const TapeNode& source_node(NodeId i) const { return source_[i]; }
    [[nodiscard]] bool is_used_once(NodeId i) const { return uses_[i] == 1; }
    [[nodiscard]] NodeId copy_of(NodeId i) const { return copies_[i]; }
    NodeId add(TapeOp op, NodeId model, std::array<NodeId, 3> operands) {
        result_.tape.nodes.push_back({op, source_[model].format, operands, 0});
        result_.origins.push_back(origins_[model]);
        return result_.tape.size() - 1;
    }
    /// Makes `new_node` the copy of the next node of the source tape.
    void append_copy(NodeId new_node) { copies_.push_back(new_node); }
    void copy_node(NodeId i) {
        TapeNode node = source_[i];
        if (!is_given(node.op))
            for (NodeId& operand : node.operands)
                if (operand != no_node) operand = copy_of(operand);
        result_.tape.nodes.push_back(node);
        result_.origins.push_back(origins_[i]);
        append_copy(result_.tape.size() - 1);
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
using Rewrite = std::optional<NodeId>(TapeCopy& copy, NodeId i);

std::optional<NodeId> fuse_product(TapeCopy& copy, NodeId i) {
    const TapeNode& node = copy.source_node(i);
    if (node.op != TapeOp::add && node.op != TapeOp::sub) return {};
    for (const std::size_t k : {0, 1}) {
        const NodeId product = node.operands[k], other = node.operands[1 - k];
        if (copy.source_node(product).op != TapeOp::mul || !copy.is_used_once(product)) continue;
        NodeId a = copy.copy_of(copy.source_node(product).operands[0]), addend = copy.copy_of(other);
        if (node.op == TapeOp::sub && k == 0) addend = copy.add(TapeOp::neg, i, {addend, no_node, no_node});
        if (node.op == TapeOp::sub && k == 1) a = copy.add(TapeOp::neg, i, {a, no_node, no_node});
        return copy.add(TapeOp::fma, i, {a, copy.copy_of(copy.source_node(product).operands[1]), addend});
    }
    return {};
}

std::optional<NodeId> reorder_sum(TapeCopy& copy, NodeId i) {
    const TapeNode& node = copy.source_node(i);
    if (node.op != TapeOp::add) return {};
    const NodeId first_sum = node.operands[0];
    if (copy.source_node(first_sum).op != TapeOp::add || !copy.is_used_once(first_sum)) return {};
    const NodeId last =
        copy.add(TapeOp::add, i,
                 {copy.copy_of(copy.source_node(first_sum).operands[1]), copy.copy_of(node.operands[1]), no_node});
    return copy.add(TapeOp::add, i, {copy.copy_of(copy.source_node(first_sum).operands[0]), last, no_node});
}

std::optional<NodeId> round_twice(TapeCopy& copy, NodeId i) {
    const TapeNode& node = copy.source_node(i);
    if (node.op != TapeOp::fma) return {};
    const NodeId product =
        copy.add(TapeOp::mul, i, {copy.copy_of(node.operands[0]), copy.copy_of(node.operands[1]), no_node});
    return copy.add(TapeOp::add, i, {product, copy.copy_of(node.operands[2]), no_node});
}

std::optional<NodeId> multiply_by_reciprocal(TapeCopy& copy, NodeId i) {
    const TapeNode& node = copy.source_node(i);
    if (node.op != TapeOp::div || copy.source_node(node.operands[0]).op == TapeOp::constant) return {};
    const NodeId one = copy.add(TapeOp::constant, i, {1, no_node, no_node});
    const NodeId inverse = copy.add(TapeOp::div, i, {one, copy.copy_of(node.operands[1]), no_node});
    return copy.add(TapeOp::mul, i, {copy.copy_of(node.operands[0]), inverse, no_node});
}

std::optional<NodeId> extract_common_factor(TapeCopy& copy, NodeId i) {
    const TapeNode& node = copy.source_node(i);
    if (node.op != TapeOp::add && node.op != TapeOp::sub) return {};
    const TapeNode &a = copy.source_node(node.operands[0]), &b = copy.source_node(node.operands[1]);
    if (a.op != TapeOp::mul || b.op != TapeOp::mul) return {};
    for (const std::size_t k : {0, 1})
        for (const std::size_t m : {0, 1})
            if (a.operands[k] == b.operands[m]) {
                const NodeId sum =
                    copy.add(node.op, i, {copy.copy_of(a.operands[1 - k]), copy.copy_of(b.operands[1 - m]), no_node});
                return copy.add(TapeOp::mul, i, {copy.copy_of(a.operands[k]), sum, no_node});
            }
    return {};
}

std::optional<NodeId> remove_root(TapeCopy& copy, NodeId i) {
    const TapeNode& node = copy.source_node(i);
    if (node.op != TapeOp::mul || node.operands[0] != node.operands[1] ||
        copy.source_node(node.operands[0]).op != TapeOp::sqrt)
        return {};
    return copy.copy_of(copy.source_node(node.operands[0]).operands[0]);
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

std::vector<std::string> driver_rewriting_names() {
    std::vector<std::string> names;
    for (const DriverRow& row : driver_rows) names.emplace_back(row.name);
    return names;
}

DerivedTape rewrite_as_driver(const DerivedTape& source, std::size_t rewriting, const std::vector<NodeId>* sites,
                              std::vector<NodeId>& changed) {
    TapeCopy copy(source);
    for (NodeId i = 0; i < source.tape.size(); ++i) {
        const NodeId origin = source.origins[i];
        const bool is_selected = sites == nullptr || std::ranges::find(*sites, origin) != sites->end();
        const auto rewritten =
            is_selected && !is_given(source.tape[i].op) ? driver_rows.at(rewriting).rewrite(copy, i) : std::nullopt;
        if (!rewritten) {
            copy.copy_node(i);
            continue;
        }
        copy.append_copy(*rewritten);
        changed.push_back(origin);
    }
    return copy.finish();
}

}  // namespace lostbits::measure::tape
