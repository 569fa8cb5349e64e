// All forms of the plane: one line for each, and its include.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/plane/forms/epsilon.hpp"
#include "shapes/plane/forms/filtered.hpp"
#include "shapes/plane/forms/quotient.hpp"
#include "shapes/plane/forms/stored_distance.hpp"
#include "shapes/plane/forms/two_words.hpp"

namespace lostbits::intersect::plane {

using PlaneForms = FormList<  //
    plane::Quotient,          //
    plane::StoredDistance,    //
    plane::EpsilonPlane,      //
    plane::TwoWordsPlane,     //
    plane::FilteredPlane      //
    >;

}  // namespace lostbits::intersect::plane
