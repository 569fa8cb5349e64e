// Forms that run only if the ray hits the bounding box of their primitive, in the table of intersectors: the query of a
// hierarchy traversal.
#pragma once

#include <string>
#include <vector>

#include "intersect/bounding_box/box_methods.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::intersect::bounding_box {

/// A form composed of a form of one shape and a form of boxes, such as `triangle.undivided^box.signs~nearest` (the
/// default box method is not named). Each form is created once and kept, as registered forms are.
///
/// - The form hits if the form hits the primitive and the box form hits the bounding box, both in the format. Its t is
/// that of the form. Both are tested up to the end of the ray, not up to a closer hit on another primitive.
/// - `transformed_form(method, boxed_form(…))` has its box in the space of the primitive, `boxed_form(…,
/// transformed_form(…))` in the world.
/// - Its tape has the operations of the box form, with the stored numbers of the box as inputs, and those of the form.
/// - In exact arithmetic, its answers are those of the form.
///
/// Throws InputError if the primitive has no bounding box, or if `box` is not a form of boxes.
const table::Intersector& boxed_form(const BoxMethod& method, const table::Intersector& box,
                                     const table::Intersector& form);

/// The parts of a form that `boxed_form` created.
struct BoxedFormParts {
    const BoxMethod* method;
    const table::Intersector *box, *form;
};
/// The parts of a form; null pointers if `boxed_form` did not create it.
BoxedFormParts find_boxed_parts(const table::Intersector& form);

/// True if a form has a box, in the space of its primitive or in the world. A set has a box if any of its forms has
/// one.
bool has_box(const table::Intersector& form);

/// Returns the form without its boxes in the world. For transformed primitives, the result is a form that
/// `transform::transformed_form` created.
const table::Intersector& without_world_boxes(const table::Intersector& form);

/// Names of the inputs on a form's tape: those of the form, then the numbers of each box, the outermost box first.
std::vector<std::string> find_names_on_tape(const table::Intersector& form, const Target<double>& target);

/// Returns the form itself, without boxes and transforms.
const table::Intersector& innermost_form(const table::Intersector& form);
/// Returns the form with the same boxes and transforms around another form of the same shape.
const table::Intersector& with_other_form(const table::Intersector& composed_form, const table::Intersector& form);

}  // namespace lostbits::intersect::bounding_box
