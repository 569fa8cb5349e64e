// Forms with a transform method, as rows of the table. They measure scenes with primitives under matrices.
#pragma once

#include "intersect/transform/transform_method.hpp"

namespace lostbits::intersect::transform {

/// The row `sphere.unified@pbrt` for a form of one shape. It converts the ray to the space of the primitive, runs the
/// form there, and converts t back, all in the arithmetic of the row. For a primitive without a matrix, it runs the
/// form only. Each row is created once and kept, as registered rows are. Throws InputError for a form that marches and
/// for a set.
const table::Intersector& transformed_form(const TransformMethod& method, const table::Intersector& form);

/// The parts of a row that `through` created.
struct TransformedFormParts {
    const TransformMethod* method;
    const table::Intersector* form;
};
/// The parts of a row; null pointers if `through` did not create it.
TransformedFormParts transformed_parts_of(const table::Intersector& form);

}  // namespace lostbits::intersect::transform
