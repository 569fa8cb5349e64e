// Forms through a way into the space of their solid, as rows of the table: what a scene of solids under matrices is
// measured by.
#pragma once

#include "intersect/space/space.hpp"

namespace lostbits::intersect::space {

/// The row `sphere.unified@pbrt` of a form of one shape: the ray is taken into the space of the solid, the form is
/// asked there, t is taken back, all in the arithmetic of the row. A solid that stands under no matrix is asked as it
/// is. Made once and kept, as enrolled rows are. InputError for a form that marches and for a set.
const table::Intersector& through(const Space& space, const table::Intersector& form);

/// Which two a row was made of.
struct Made {
    const Space* space;
    const table::Intersector* form;
};
/// Nulls for a row that was not made here.
Made made_of(const table::Intersector& row);

}  // namespace lostbits::intersect::space
