// All forms: those of each shape, which the folder of the shape lists, and the closed list of those that march, with a
// line and an include for each. Every table of forms is generated from these lists.
#pragma once

#include <iterator>
#include <numeric>

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

/// Every form of every shape, in the order of the tables.
#define LOSTBITS_LINE(folder, S) folder::S##Forms::size,
inline constexpr std::size_t form_counts[] = {LOSTBITS_SHAPES(LOSTBITS_LINE) SdfForms::size};
#undef LOSTBITS_LINE
inline constexpr std::size_t form_count =
    std::accumulate(std::begin(form_counts), std::end(form_counts), std::size_t{0});
template <class Visitor>
void for_each_form(Visitor&& visit) {
#define LOSTBITS_LINE(folder, S) folder::S##Forms::for_each(visit);
    LOSTBITS_SHAPES(LOSTBITS_LINE)
#undef LOSTBITS_LINE
    SdfForms::for_each(visit);
}

}  // namespace lostbits::intersect
