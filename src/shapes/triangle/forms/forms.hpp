// All forms of the triangle: one line for each, and its include.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/triangle/forms/baldwin_weber.hpp"
#include "shapes/triangle/forms/filtered.hpp"
#include "shapes/triangle/forms/havel_herout.hpp"
#include "shapes/triangle/forms/moller_trumbore.hpp"
#include "shapes/triangle/forms/moller_trumbore_culling.hpp"
#include "shapes/triangle/forms/pbrt.hpp"
#include "shapes/triangle/forms/plane_barycentric.hpp"
#include "shapes/triangle/forms/plucker.hpp"
#include "shapes/triangle/forms/plucker_band.hpp"
#include "shapes/triangle/forms/precomputed_normal.hpp"
#include "shapes/triangle/forms/projection.hpp"
#include "shapes/triangle/forms/reciprocal_first.hpp"
#include "shapes/triangle/forms/signed_volumes.hpp"
#include "shapes/triangle/forms/undivided.hpp"
#include "shapes/triangle/forms/woop.hpp"
#include "shapes/triangle/forms/woop_double.hpp"
#include "shapes/triangle/forms/woop_once.hpp"

namespace lostbits::intersect::triangle {

using TriangleForms = FormList<       //
    triangle::MollerTrumbore,         // determinants
    triangle::MollerTrumboreCulling,  //
    triangle::ReciprocalFirst,        //
    triangle::Undivided,              //
    triangle::PrecomputedNormal,      //
    triangle::SignedVolumes,          //
    triangle::Plucker,                // each edge separately
    triangle::PluckerBand,            //
    triangle::Woop,                   //
    triangle::WoopDouble,             //
    triangle::WoopOnce,               //
    triangle::Pbrt,                   //
    triangle::BaldwinWeber,           // first the plane, then coordinates in it
    triangle::HavelHerout,            //
    triangle::Projection,             //
    triangle::PlaneBarycentric,       //
    triangle::FilteredTriangle        // exact signs
    >;

}  // namespace lostbits::intersect::triangle
