// Formulas as terms. While rules rewrite a formula, equal operations exist only once, and each operation knows which
// operation it replaces.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "number/tape.hpp"

namespace lostbits::measure::identity {

/// Three numbers, usually the components of a vector. An identity of vectors holds for any three numbers.
using Triple = std::array<NodeId, 3>;

/// A growing tape in which equal operations are one node, so two formulas are the same if their outputs are. The
/// meaning of a node is the oldest node that it equals in real arithmetic.
class Terms {
public:
    /// Copies a form's whole tape. The operations that rules rewrite have the format of the answer.
    explicit Terms(const Tape& form);

    [[nodiscard]] const TapeNode& operator[](NodeId i) const { return tape_[i]; }
    [[nodiscard]] NodeId size() const { return tape_.size(); }
    /// Outputs of the form.
    [[nodiscard]] const TapeOutputs& outputs() const { return tape_.outputs; }
    /// Format of the answer. All operations that rules add are computed in it.
    [[nodiscard]] const FloatFormat& format() const { return format_; }
    /// True if node i is computed in the format of the answer.
    [[nodiscard]] bool has_answer_format(NodeId i) const { return tape_.format_of(i) == format_; }

    NodeId add(TapeOp op, const TapeOperands& operands, std::string_view label = {});
    NodeId constant(std::int32_t x);
    /// Gives a node a name, if it has none and the label is not empty. Returns the node.
    NodeId name_if_unnamed(NodeId i, std::string_view label) { return label.empty() ? i : (tape_.name(i, label), i); }
    /// a·b = a.x b.x + a.y b.y + a.z b.z, summed from the first product on.
    NodeId dot(const Triple& a, const Triple& b, std::string_view label = {});
    Triple cross(const Triple& a, const Triple& b);

    [[nodiscard]] NodeId meaning(NodeId i) const;
    /// Records that two nodes are equal in real arithmetic. The equality holds for rays that satisfy the conditions of
    /// the form and of the rules.
    void unite(NodeId a, NodeId b);

    /// The two vectors of a dot product, for a node that is a sum of three products.
    [[nodiscard]] std::optional<std::pair<Triple, Triple>> factors_of(NodeId i) const;
    /// The first node that is the dot product of a and b, in either order.
    [[nodiscard]] std::optional<NodeId> known_dot(const Triple& a, const Triple& b) const;

    /// Replaces nodes of a formula by others and returns the new outputs. Nodes computed from the replaced nodes are
    /// created again.
    TapeOutputs replace_nodes(const TapeOutputs& outputs, const std::vector<std::pair<NodeId, NodeId>>& replacements);
    /// Nodes that the outputs are computed from, in order, including inputs.
    [[nodiscard]] std::vector<NodeId> nodes_of(const TapeOutputs& outputs) const;
    /// A formula as a separate tape, with all inputs of the form. `origins` receives, for each node of that tape, its
    /// node in these terms.
    [[nodiscard]] Tape tape(const TapeOutputs& outputs, std::vector<NodeId>* origins = nullptr) const;

private:
    using Key = std::tuple<TapeOp, int, NodeId, NodeId, NodeId>;
    NodeId find_or_add(TapeNode n);
    void remember_dot(NodeId i);
    NodeId rebuild_node(NodeId i, std::map<NodeId, NodeId>& renewed_nodes);

    Tape tape_;
    FloatFormat format_;
    std::map<Key, NodeId> known_;
    std::map<std::pair<Triple, Triple>, NodeId> dots_;
    std::vector<NodeId> meaning_;
};

/// Direction of the ray.
Triple direction_of(const Terms& terms);

inline std::array<NodeId, 4> output_nodes(const TapeOutputs& outputs) {
    return {outputs.hit, outputs.t, outputs.near, outputs.far};
}

}  // namespace lostbits::measure::identity
