// All forms: those of each shape, which its own folder lists, and the closed list of those that march, one line each
// (and its include). Everything else follows from these.
#pragma once

#include "intersect/form_list.hpp"
#include "intersect/sdf/accumulated.hpp"
#include "intersect/sdf/bisect_refined.hpp"
#include "intersect/sdf/cone_eps.hpp"
#include "intersect/sdf/over_relaxed.hpp"
#include "intersect/sdf/relative_eps.hpp"
#include "intersect/sdf/secant_refined.hpp"
#include "intersect/sdf/sphere_trace.hpp"
#include "shapes/box/forms/forms.hpp"
#include "shapes/sphere/forms/forms.hpp"

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
inline constexpr std::size_t form_count = sphere::SphereForms::size + box::BoxForms::size + SdfForms::size;
template <class Visitor>
void for_each_form(Visitor&& visit) {
    sphere::SphereForms::for_each(visit);
    box::BoxForms::for_each(visit);
    SdfForms::for_each(visit);
}

}  // namespace lostbits::intersect
