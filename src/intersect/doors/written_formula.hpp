// A formula that comes as a list of operations: what a program in another language did to its numbers, written down.
// With it the form is there in every arithmetic, as those of the catalogue are.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "intersect/table/table.hpp"

namespace lostbits::intersect::doors {

/// One operation of such a list.
struct WrittenOperation {
    TapeOp op = TapeOp::constant;
    /// Places in the list, all before its own; of an input its number first: o.x o.y o.z d.x d.y d.z, then the numbers
    /// of the solid, then where the ray ends.
    std::array<std::int32_t, 3> operands{no_node, no_node, no_node};
    double value = 0;     ///< of a constant: any number, or infinite
    std::string label{};  ///< as `named` would give it; empty: none
};

/// The operations, and which of them are the decision, the t, and the line parameters of both intersections.
struct WrittenFormula {
    std::string name;  ///< for messages
    Shape shape{};
    std::vector<WrittenOperation> operations;
    NodeId hit = no_node, t = no_node;
    NodeId near = no_node, far = no_node;  ///< none: t
};

/// InputError, which names the operation, for one that is unknown, that takes what comes after it, or a decision where
/// a number is needed or the other way round.
void require_sense(const WrittenFormula& formula);

/// The formula of a form in binary32 and that in binary64: libraries of arrays add the same numbers up in another order
/// where a register holds more of them. Every other arithmetic takes that of binary32.
class WrittenForm {
public:
    /// Either may be null; both are of one shape.
    WrittenForm(std::shared_ptr<const WrittenFormula> of32, std::shared_ptr<const WrittenFormula> of64);
    /// What a row has beside its native kernels, in every arithmetic; it points here.
    void fill(table::Intersector& row);
    /// A row whose answers are the formula's in f32 and f64 too.
    [[nodiscard]] table::Intersector row(const Info& info);
    [[nodiscard]] const WrittenFormula& in(const Format& format) const;

private:
    std::shared_ptr<const WrittenFormula> of32_, of64_;
};

}  // namespace lostbits::intersect::doors
