// All forms of the capsule: one line for each, and its include.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/capsule/forms/filtered.hpp"
#include "shapes/capsule/forms/half_b.hpp"
#include "shapes/capsule/forms/perpendicular.hpp"
#include "shapes/capsule/forms/quilez.hpp"

namespace lostbits::intersect::capsule {

using CapsuleForms = FormList<      //
    capsule::QuilezCapsule,         //
    capsule::CapsuleHalfB,          //
    capsule::CapsulePerpendicular,  //
    capsule::FilteredCapsule        //
    >;

}  // namespace lostbits::intersect::capsule
