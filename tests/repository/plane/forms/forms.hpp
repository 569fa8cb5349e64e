// The forms of the plane.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/plane/forms/quotient.hpp"

namespace lostbits::intersect::plane {

using PlaneForms = FormList<plane::Quotient>;

}  // namespace lostbits::intersect::plane
