// All forms of the cylinder: one line for each, and its include.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/cylinder/forms/crossed.hpp"
#include "shapes/cylinder/forms/dot_products.hpp"
#include "shapes/cylinder/forms/filtered.hpp"
#include "shapes/cylinder/forms/framed.hpp"
#include "shapes/cylinder/forms/quilez.hpp"
#include "shapes/cylinder/forms/triple_product.hpp"

namespace lostbits::intersect::cylinder {

using CylinderForms = FormList<       //
    cylinder::DotProductsCylinder,    //
    cylinder::QuilezCylinder,         //
    cylinder::CrossedCylinder,        //
    cylinder::FramedCylinder,         //
    cylinder::TripleProductCylinder,  //
    cylinder::FilteredCylinder        //
    >;

}  // namespace lostbits::intersect::cylinder
