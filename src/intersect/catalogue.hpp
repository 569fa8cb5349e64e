// The closed list of forms: one line each (and its include). Everything else follows from it.
#pragma once

#include "intersect/box/baseline.hpp"
#include "intersect/box/divide.hpp"
#include "intersect/box/embree_fma.hpp"
#include "intersect/box/embree_robust.hpp"
#include "intersect/box/exclusive.hpp"
#include "intersect/box/filtered.hpp"
#include "intersect/box/ieee_minmax.hpp"
#include "intersect/box/inclusive.hpp"
#include "intersect/box/max_mult.hpp"
#include "intersect/box/pbrt_padded.hpp"
#include "intersect/box/signs.hpp"
#include "intersect/sdf/accumulated.hpp"
#include "intersect/sdf/bisect_refined.hpp"
#include "intersect/sdf/cone_eps.hpp"
#include "intersect/sdf/over_relaxed.hpp"
#include "intersect/sdf/relative_eps.hpp"
#include "intersect/sdf/secant_refined.hpp"
#include "intersect/sdf/sphere_trace.hpp"
#include "intersect/sphere/closest_approach.hpp"
#include "intersect/sphere/cross_product.hpp"
#include "intersect/sphere/double_inside.hpp"
#include "intersect/sphere/early_exit.hpp"
#include "intersect/sphere/embree_point.hpp"
#include "intersect/sphere/expanded.hpp"
#include "intersect/sphere/factored_c.hpp"
#include "intersect/sphere/filtered.hpp"
#include "intersect/sphere/half_b.hpp"
#include "intersect/sphere/hearn_baker.hpp"
#include "intersect/sphere/kahan_discriminant.hpp"
#include "intersect/sphere/newton_refined.hpp"
#include "intersect/sphere/pbrt_factored.hpp"
#include "intersect/sphere/pbrt_interval.hpp"
#include "intersect/sphere/press.hpp"
#include "intersect/sphere/pythagoras.hpp"
#include "intersect/sphere/schoolbook.hpp"
#include "intersect/sphere/schoolbook_strict.hpp"
#include "intersect/sphere/two_step.hpp"
#include "intersect/sphere/unified.hpp"
#include "intersect/sphere/unified_unit.hpp"
#include "intersect/sphere/unit_half_b.hpp"

namespace lostbits::intersect {

/// A list of form types, in the order in which every table shows them.
template <class... Form>
struct FormList {
    static constexpr std::size_t size = sizeof...(Form);
    /// Calls `visit.operator()<Form>()` for each.
    template <class Visitor>
    static void for_each(Visitor&& visit) {
        (visit.template operator()<Form>(), ...);
    }
};

using SphereForms = FormList<   //
    sphere::Schoolbook,         // from the seeds
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
    sphere::Filtered            // of the laboratory itself
    >;

using BoxForms = FormList<  //
    box::Baseline,          // from the seeds
    box::Exclusive,         //
    box::Inclusive,         //
    box::Signs,             //
    box::Divide,            // from renderers and the literature
    box::IeeeMinmax,        //
    box::PbrtPadded,        //
    box::MaxMult,           //
    box::EmbreeFma,         //
    box::EmbreeRobust,      //
    box::FilteredSlabs      // of the laboratory itself
    >;

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
inline constexpr std::size_t form_count = SphereForms::size + BoxForms::size + SdfForms::size;
template <class Visitor>
void for_each_form(Visitor&& visit) {
    SphereForms::for_each(visit);
    BoxForms::for_each(visit);
    SdfForms::for_each(visit);
}

}  // namespace lostbits::intersect
