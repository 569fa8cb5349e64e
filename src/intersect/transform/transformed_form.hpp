// Forms with a transform method, as rows of the table. Scenes with primitives under matrices are measured by them.
#pragma once

#include "intersect/transform/transform_method.hpp"

namespace lostbits::intersect::transform {

/// The row `sphere.unified@pbrt` for a form of one shape. It takes the ray into the space of the primitive, asks the
/// form there, and converts t back, all in the arithmetic of the row. A primitive without a matrix is asked as it is.
/// Each row is made once and kept, as enrolled rows are. InputError for a form that marches and for a set.
const table::Intersector& through(const TransformMethod& space, const table::Intersector& form);

/// The parts of such a row.
struct TransformedFormParts {
    const TransformMethod* method;
    const table::Intersector* form;
};
/// The parts of a row; nulls if it was not made here.
TransformedFormParts transformed_parts_of(const table::Intersector& row);

}  // namespace lostbits::intersect::transform
