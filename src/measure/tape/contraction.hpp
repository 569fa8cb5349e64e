// Contraction: what a compiler makes of a formula if it may round a product together with the sum that takes it.
#pragma once

#include "intersect/table/table.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::tape {

/// Contracts a tape as GCC compiles it at -O2 with -ffp-contract=fast and FMA. Equal operations on the same operands
/// are merged. A product is fused where every operation that takes it, or takes its negative, is an addition or
/// subtraction: a b ± c and c ± a b are rounded once. Of two products that are added the left one is fused, and the
/// other is its addend; but a product inside an expression with a name of its own comes first. A product that is also
/// compared, chosen, multiplied or answered stays as it is. clang fuses the same ones, except those that are taken
/// twice. Values are those of the given tape.
Tape contracted(const Tape& tape);

/// The row `FORM+fma`: the form's operations, contracted, in every arithmetic. Without rounding it is the form. Its
/// kernels run the operations one by one over columns: their bits are those of compiled code, but their time is not.
/// Each row is made once and kept. InputError as for `tape_of`, and for a form with a transform method, which comes
/// last in a name.
const intersect::table::Intersector& contracted_row(const intersect::table::Intersector& form);

/// True for a row that was made so.
bool is_contracted(const intersect::table::Intersector& row);

}  // namespace lostbits::measure::tape
