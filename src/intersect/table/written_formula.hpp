// A formula given as a list of operations, such as the recorded operations of a program in another language. With this
// list the form is available in every arithmetic, like the forms of the catalogue.
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

/// One operation of a written formula.
struct WrittenOperation {
    TapeOp op = TapeOp::constant;
    /// Indices in the list, all smaller than the index of this operation. The first operand of an input is the index of
    /// that input: o.x o.y o.z d.x d.y d.z, then the numbers of the primitive, then the end of the ray.
    std::array<std::int32_t, 3> operands{no_node, no_node, no_node};
    double value = 0;     ///< value of a constant: any number, or infinite
    std::string label{};  ///< name that `named` gives the result; may be empty
    /// True if the result is a number of the next wider format: double in a formula of float (`Wider`). Only `convert`
    /// takes a number of the other format.
    bool wide = false;
    /// True for a decision that a part of the formula depends on (`decide`). If it is undecided, enclosures follow both
    /// sides.
    bool has_sides = false;
};

/// The operations of a formula, and the indices of the decision, of t, and of the line parameters of both
/// intersections.
struct WrittenFormula {
    std::string name;  ///< for messages
    Shape shape{};
    std::vector<WrittenOperation> operations;
    NodeId hit = no_node, t = no_node;
    NodeId near = no_node, far = no_node;  ///< if absent, t
};

/// Throws InputError, which names the operation, if an operation is unknown, if an operand does not come earlier, or if
/// an operand is a decision where a number is needed, or the other way round.
void require_valid(const WrittenFormula& formula);

/// Converts a tape to a formula, for the primitives of a shape. The form must perform the same operations for every
/// ray, without calls and loops. Throws as `require_valid` does.
WrittenFormula formula_from_tape(const Tape& tape, Shape shape, std::string name);

/// The formulas of a form in binary32 and in binary64. They may differ, because array libraries add the same numbers in
/// another order if a register holds more of them. Every other arithmetic uses the formula of binary32.
class WrittenForm {
public:
    /// Either formula may be null; both have the same shape.
    WrittenForm(std::shared_ptr<const WrittenFormula> formula32, std::shared_ptr<const WrittenFormula> formula64);
    /// Uses the formula that `record_all` of a form records, and records it at its first use. The form's `info` must
    /// live as long.
    explicit WrittenForm(const Intersector& recorded_form);
    /// Fills the functions of a form for formats chosen at run time and for enclosures. The form then points to this
    /// object.
    void fill_arithmetics(Intersector& form);
    /// Fills all functions of a form except the native kernels. The form then points to this object.
    void fill(Intersector& form);
    /// Returns a form all of whose functions evaluate the formula, the kernels in f32 and f64 included.
    [[nodiscard]] Intersector make_intersector(const Info& info);
    [[nodiscard]] const WrittenFormula& formula_in(const Format& format) const;
    /// Returns the index of each operation's node on a tape of this format.
    [[nodiscard]] std::vector<NodeId> find_nodes_on_tape(const Format& format) const;

private:
    std::optional<Intersector> recorded_form_ = {};
    mutable std::once_flag once_;
    mutable std::shared_ptr<const WrittenFormula> formula32_;
    std::shared_ptr<const WrittenFormula> formula64_;
};

}  // namespace lostbits::intersect::table
