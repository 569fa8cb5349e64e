// Contraction: the formula that a compiler creates if it may round a product together with the sum that uses it.
#pragma once

#include "intersect/table/table.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::tape {

/// Contracts a tape as GCC compiles it at -O2 with -ffp-contract=fast and FMA. Equal operations on the same operands
/// are merged. A product is fused if every operation that uses it, or uses its negative, is an addition or subtraction:
/// a b ± c and c ± a b are rounded once. If two products are added, the left one is fused and the other is its addend,
/// unless the other is part of an expression with a name of its own, which comes first. A product that is also
/// compared, selected, multiplied or returned is not fused. clang fuses the same products, except those that are used
/// twice. Each node keeps the value that its result has on the given tape, although a fused sum rounds differently.
Tape contract_tape(const Tape& tape);

/// Returns the form `FORM+fma`: the contracted operations of a form, in every arithmetic. Without rounding it equals
/// the form. Its kernels run the operations one by one over columns: they give the bits of compiled code, but not its
/// speed. Each form is created once and kept. Throws InputError as `record_tape` does, and for a form with a transform
/// method, because the transform comes last in a name.
const intersect::table::Intersector& contract_form(const intersect::table::Intersector& form);

/// True for a form that `contract_form` created.
bool is_contracted(const intersect::table::Intersector& form);

/// An operation of a form: its node on the form's tape in `format`.
struct FormOperation {
    const intersect::table::Intersector* form;
    Format format;
    NodeId node;
};

/// Finds the operation of FORM from which an operation of `FORM+fma` was made: for a fused sum, the sum. `node` is its
/// index on a tape of `contracted` in `format`. The node that is returned is `no_node` for an operation that FORM
/// lacks.
FormOperation find_operation_before_contraction(const intersect::table::Intersector& contracted, const Format& format,
                                                NodeId node);

}  // namespace lostbits::measure::tape
