// The forms of the second part of `shapes/list.hpp`, and the closed list of those that march, with a line and an
// include for each.
#pragma once

#include "intersect/form_list.hpp"
#include "intersect/sdf/accumulated.hpp"
#include "intersect/sdf/bisect_refined.hpp"
#include "intersect/sdf/cone_eps.hpp"
#include "intersect/sdf/over_relaxed.hpp"
#include "intersect/sdf/relative_eps.hpp"
#include "intersect/sdf/secant_refined.hpp"
#include "intersect/sdf/sphere_trace.hpp"
#include "shapes/primitive.hpp"
// clang-format off
#define LOSTBITS_SHAPE_FILE(folder) LOSTBITS_PATH(folder/forms/forms.hpp)
#define LOSTBITS_SHAPE_PART 2
// clang-format on
#include "shapes/list.hpp"

namespace lostbits::intersect {

using SdfForms = FormList<  //
    sdf::SphereTrace,       // from the seeds
    sdf::RelativeEps,       // from shaders and the literature
    sdf::ConeEps,           //
    sdf::OverRelaxed,       //
    sdf::Accumulated,       //
    sdf::SecantRefined,     //
    sdf::BisectRefined      //
    >;

#define LOSTBITS_LINE(folder, S) folder::S##Forms,
struct SecondForms : JoinedLists<LOSTBITS_SECOND_SHAPES(LOSTBITS_LINE) SdfForms> {};
#undef LOSTBITS_LINE

}  // namespace lostbits::intersect
