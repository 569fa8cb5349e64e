// Forms with a transform method, in the table of intersectors. They measure scenes with transformed primitives.
#pragma once

#include "intersect/transform/transform_method.hpp"

namespace lostbits::intersect::transform {

/// The form `sphere.unified@pbrt` for a form of one shape. It converts the ray to the space of the primitive, runs the
/// form there, and converts t back, all in the arithmetic of the form. For a primitive without a matrix, it runs the
/// form only. Each form is created once and kept, as registered forms are. Throws InputError for a form that marches
/// and for a set.
const table::Intersector& transformed_form(const TransformMethod& method, const table::Intersector& form);

/// The parts of a form that `transformed_form` returned.
struct TransformedFormParts {
    const TransformMethod* method;
    const table::Intersector* form;
};
/// The parts of a form; null pointers if `transformed_form` did not return it.
TransformedFormParts find_transformed_parts(const table::Intersector& form);

}  // namespace lostbits::intersect::transform
