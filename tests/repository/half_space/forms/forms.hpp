// The forms of the half space.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/half_space/forms/quotient.hpp"

namespace lostbits::intersect::half_space {

using HalfSpaceForms = FormList<half_space::Quotient>;

}  // namespace lostbits::intersect::half_space
