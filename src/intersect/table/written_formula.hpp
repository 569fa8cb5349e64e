// A formula given as a list of operations: the recorded operations of a program in another language. It makes the form
// available in every arithmetic, as those of the catalogue are.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// One operation of such a list.
struct WrittenOperation {
    TapeOp op = TapeOp::constant;
    /// Indices in the list, all before its own. For an input, the first is the number of the input: o.x o.y o.z d.x d.y
    /// d.z, then the numbers of the primitive, then the end of the ray.
    std::array<std::int32_t, 3> operands{no_node, no_node, no_node};
    double value = 0;     ///< of a constant: any number, or infinite
    std::string label{};  ///< as `named` would give it; empty: none
    /// The result is of the next wider format: double in a formula of float (`Wider`). Only `convert` takes a number of
    /// the other format.
    bool wide = false;
    /// A decision that a part of the formula depends on (`decide`). Where it is open, enclosures follow both sides.
    bool has_sides = false;
};

/// The operations, and the indices of the decision, of t, and of the line parameters of both intersections.
struct WrittenFormula {
    std::string name;  ///< for messages
    Shape shape{};
    std::vector<WrittenOperation> operations;
    NodeId hit = no_node, t = no_node;
    NodeId near = no_node, far = no_node;  ///< none: t
};

/// Throws InputError, which names the operation, for an unknown operation, for an operand that comes later, or for a
/// decision in place of a number or the other way round.
void require_sense(const WrittenFormula& formula);

/// A tape as a list, for the primitives of a shape. It must be of a form that does the same operations for every ray:
/// without calls and loops. Throws as `require_sense` does.
WrittenFormula written(const Tape& tape, Shape shape, std::string name);

/// The formula of a form in binary32 and the one in binary64. They may differ: array libraries add the same numbers in
/// another order if a register holds more of them. Every other arithmetic takes that of binary32.
class WrittenForm {
public:
    /// Either may be null; both are of one shape.
    WrittenForm(std::shared_ptr<const WrittenFormula> of32, std::shared_ptr<const WrittenFormula> of64);
    /// The formula that `record_all` of a row records, at its first use. The row's `info` is kept.
    explicit WrittenForm(const Intersector& recorded);
    /// Fills formats at run time and enclosures. The row points here.
    void fill_arithmetics(Intersector& row);
    /// Fills the kernels of a row other than the native ones, in every arithmetic; the row points here.
    void fill(Intersector& row);
    /// A row whose answers in f32 and f64 are also those of the formula.
    [[nodiscard]] Intersector row(const Info& info);
    [[nodiscard]] const WrittenFormula& in(const Format& format) const;
    /// The node of each operation on the tapes of a format.
    [[nodiscard]] std::vector<NodeId> nodes_on_tape(const Format& format) const;

private:
    std::optional<Intersector> recorded_ = {};
    mutable std::once_flag once_;
    mutable std::shared_ptr<const WrittenFormula> of32_;
    std::shared_ptr<const WrittenFormula> of64_;
};

}  // namespace lostbits::intersect::table
