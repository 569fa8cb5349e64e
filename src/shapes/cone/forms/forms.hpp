// All forms of the cone: one line for each, and its include.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/cone/forms/crossed.hpp"
#include "shapes/cone/forms/dot_products.hpp"
#include "shapes/cone/forms/embree.hpp"
#include "shapes/cone/forms/filtered.hpp"
#include "shapes/cone/forms/framed.hpp"
#include "shapes/cone/forms/moment.hpp"
#include "shapes/cone/forms/quilez.hpp"

namespace lostbits::intersect::cone {

using ConeForms = FormList<  //
    cone::DotProductsCone,   //
    cone::QuilezCone,        //
    cone::CrossedCone,       //
    cone::FramedCone,        //
    cone::MomentCone,        //
    cone::EmbreeCone,        //
    cone::FilteredCone       //
    >;

}  // namespace lostbits::intersect::cone
