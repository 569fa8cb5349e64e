// All forms of the sphere: one line for each, and its include.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/sphere/forms/closest_approach.hpp"
#include "shapes/sphere/forms/cross_product.hpp"
#include "shapes/sphere/forms/double_inside.hpp"
#include "shapes/sphere/forms/early_exit.hpp"
#include "shapes/sphere/forms/embree_point.hpp"
#include "shapes/sphere/forms/expanded.hpp"
#include "shapes/sphere/forms/factored_c.hpp"
#include "shapes/sphere/forms/filtered.hpp"
#include "shapes/sphere/forms/half_b.hpp"
#include "shapes/sphere/forms/hearn_baker.hpp"
#include "shapes/sphere/forms/kahan_discriminant.hpp"
#include "shapes/sphere/forms/newton_refined.hpp"
#include "shapes/sphere/forms/pbrt_factored.hpp"
#include "shapes/sphere/forms/pbrt_interval.hpp"
#include "shapes/sphere/forms/press.hpp"
#include "shapes/sphere/forms/pythagoras.hpp"
#include "shapes/sphere/forms/schoolbook.hpp"
#include "shapes/sphere/forms/schoolbook_strict.hpp"
#include "shapes/sphere/forms/two_step.hpp"
#include "shapes/sphere/forms/unified.hpp"
#include "shapes/sphere/forms/unified_unit.hpp"
#include "shapes/sphere/forms/unit_half_b.hpp"

namespace lostbits::intersect::sphere {

using SphereForms = FormList<   //
    sphere::Schoolbook,         // from Ray Tracing Gems, course notes and a shader
    sphere::SchoolbookStrict,   //
    sphere::Expanded,           //
    sphere::UnitHalfB,          //
    sphere::HearnBaker,         //
    sphere::Press,              //
    sphere::Unified,            //
    sphere::UnifiedUnit,        //
    sphere::EarlyExit,          //
    sphere::HalfB,              // from renderers and the literature
    sphere::Pythagoras,         //
    sphere::KahanDiscriminant,  //
    sphere::PbrtFactored,       //
    sphere::PbrtInterval,       //
    sphere::ClosestApproach,    //
    sphere::TwoStep,            //
    sphere::CrossProduct,       //
    sphere::EmbreePoint,        //
    sphere::NewtonRefined,      //
    sphere::FactoredC,          //
    sphere::DoubleInside,       //
    sphere::Filtered            // own form of lostbits
    >;

}  // namespace lostbits::intersect::sphere
