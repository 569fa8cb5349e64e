// Forms that are asked only where the box around their solid is hit, as rows of the table: what a traversal of a
// hierarchy asks.
#pragma once

#include <string>
#include <vector>

#include "intersect/hull/hulls.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::intersect::hull {

/// The row `triangle.undivided^box.signs~nearest` of a form of one shape and a form of boxes: a hit where the form hits
/// the solid and the other one the box around it, both in the format and with the ray's end; t is the form's. The usual
/// way is not named. `through(space, behind(…))` has its box in the space of the solid, `behind(…, through(…))` in the
/// world. What ends the ray is its own end alone: no hit found before is. Made once and kept, as enrolled rows
/// are. Its tape has the operations of the box, whose numbers are inputs as they are stored, and those of the form;
/// without rounding it is the form. InputError for what has no box around it, and for what is no form of boxes.
const table::Intersector& behind(const HullWay& way, const table::Intersector& box, const table::Intersector& form);

/// What a row was made of.
struct HullParts {
    const HullWay* way;
    const table::Intersector *box, *form;
};
/// Nulls for a row that was not made here.
HullParts made_of(const table::Intersector& row);

/// Whether a row is behind a box, in the space of its solid or in the world; of a set whether any of its forms is.
bool has_box(const table::Intersector& row);

/// A row for solids under matrices without its boxes in the world: one that `space::through` made.
const table::Intersector& within_boxes(const table::Intersector& row);

/// What the inputs on a row's tape are called: those of the form, then the numbers of each box from the outside in.
std::vector<std::string> names_on_tape(const table::Intersector& row, const Target<double>& target);

/// The form itself, behind all boxes and spaces.
const table::Intersector& innermost(const table::Intersector& row);
/// The same boxes and spaces around another form of that shape.
const table::Intersector& around(const table::Intersector& row, const table::Intersector& form);

}  // namespace lostbits::intersect::hull
