// Formulas as terms: of all that rewriting makes every operation once, each of which knows what it was before.
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

/// The components of a vector, which need not be one: an identity of vectors holds for any three numbers.
using Triple = std::array<NodeId, 3>;

/// A growing tape in which equal operations are one node, so that two formulas are the same where their outputs are.
/// Beside each node stands the oldest one that it equals in real arithmetic: what it means.
class Terms {
public:
    /// All of a form's tape, which is computed in one format.
    explicit Terms(const Tape& form);

    [[nodiscard]] const TapeNode& operator[](NodeId i) const { return tape_[i]; }
    [[nodiscard]] NodeId size() const { return tape_.size(); }
    /// Of the form.
    [[nodiscard]] const TapeOutputs& outputs() const { return tape_.outputs; }
    /// The format of the answer, which everything that rules add is computed in.
    [[nodiscard]] const FloatFormat& format() const { return format_; }
    /// Whether it is computed in that format.
    [[nodiscard]] bool is_own(NodeId i) const { return tape_.format_of(i) == format_; }

    NodeId add(TapeOp op, const TapeOperands& of, std::string_view label = {});
    NodeId constant(std::int32_t x);
    /// Gives a node a name, if it has none.
    NodeId named(NodeId i, std::string_view label) { return label.empty() ? i : (tape_.name(i, label), i); }
    /// a·b = a.x b.x + a.y b.y + a.z b.z, summed from the first.
    NodeId dot(const Triple& a, const Triple& b, std::string_view label = {});
    Triple cross(const Triple& a, const Triple& b);

    [[nodiscard]] NodeId meaning(NodeId i) const;
    /// They are equal in real arithmetic, for rays that meet what the form and its rules ask for.
    void unite(NodeId a, NodeId b);

    /// The factors of a node that is a sum of three products.
    [[nodiscard]] std::optional<std::pair<Triple, Triple>> factors_of(NodeId i) const;
    /// The first node that is their dot product, in whichever order.
    [[nodiscard]] std::optional<NodeId> known_dot(const Triple& a, const Triple& b) const;

    /// The outputs of a formula with some nodes in place of others; what is computed from these is made anew.
    TapeOutputs with(const TapeOutputs& outputs, const std::vector<std::pair<NodeId, NodeId>>& replaced);
    /// What outputs are computed from, in order; inputs among it.
    [[nodiscard]] std::vector<NodeId> needed(const TapeOutputs& outputs) const;
    /// A formula as a tape of its own, with all inputs of the form; `origins`: which of these each of its nodes is.
    [[nodiscard]] Tape tape(const TapeOutputs& outputs, std::vector<NodeId>* origins = nullptr) const;

private:
    using Key = std::tuple<TapeOp, int, NodeId, NodeId, NodeId>;
    NodeId known_or_new(TapeNode n);
    void note_dot(NodeId i);
    NodeId renewed(NodeId i, std::map<NodeId, NodeId>& done);

    Tape tape_;
    FloatFormat format_;
    std::map<Key, NodeId> known_;
    std::map<std::pair<Triple, Triple>, NodeId> dots_;
    std::vector<NodeId> meaning_;
};

/// The direction of the ray.
Triple direction_of(const Terms& terms);

inline std::array<NodeId, 4> all_of(const TapeOutputs& o) { return {o.hit, o.t, o.near, o.far}; }

}  // namespace lostbits::measure::identity
