// Contraction: what a compiler makes of a formula where a product that is added may be rounded together with the sum.
#pragma once

#include "intersect/table/table.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::tape {

/// The tape as GCC compiles it at -O2 with -ffp-contract=fast and FMA. Operations that are the same of the same
/// operands are one. A product is fused where all that takes it, or takes its negative, adds it or subtracts it: a b ±
/// c and c ± a b are rounded once. Of two products that are added the one on the left is fused, and the other is its
/// addend; but a product within what has a name of its own stands before. A product that is also compared, chosen,
/// multiplied or answered stays as it is. clang fuses the same ones, but none that is taken twice. Values are those of
/// the tape that is given.
Tape contracted(const Tape& tape);

/// The row `FORM+fma`: the form's operations, contracted, in every arithmetic; without rounding it is the form. Its
/// kernels run the operations one by one over columns, so that their bits are those of compiled code and their time is
/// not. Made once and kept. InputError as of `tape_of`, and for a form through a space: a name has its space last.
const intersect::table::Intersector& contracted_row(const intersect::table::Intersector& form);

/// Whether a row was made so.
bool is_contracted(const intersect::table::Intersector& row);

}  // namespace lostbits::measure::tape
