// All forms of the torus: one line for each, and its include.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/torus/forms/bracketed.hpp"
#include "shapes/torus/forms/bracketed_double.hpp"
#include "shapes/torus/forms/brl_cad.hpp"
#include "shapes/torus/forms/closest_approach.hpp"
#include "shapes/torus/forms/double_inside.hpp"
#include "shapes/torus/forms/filtered.hpp"
#include "shapes/torus/forms/graphics_gems.hpp"
#include "shapes/torus/forms/pov_ray.hpp"
#include "shapes/torus/forms/quilez.hpp"
#include "shapes/torus/forms/sturm.hpp"

namespace lostbits::intersect::torus {

using TorusForms = FormList<   //
    torus::GraphicsGems,       //
    torus::QuilezTorus,        //
    torus::PovRay,             //
    torus::BrlCad,             //
    torus::SturmTorus,         //
    torus::TorusDoubleInside,  //
    torus::TorusFromClosest,   //
    torus::Bracketed,          //
    torus::BracketedInDouble,  //
    torus::FilteredTorus       //
    >;

}  // namespace lostbits::intersect::torus
