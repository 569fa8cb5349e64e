// All forms of the tube: one line for each, and its include.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/tube/forms/celeritas.hpp"
#include "shapes/tube/forms/detray.hpp"
#include "shapes/tube/forms/filtered.hpp"
#include "shapes/tube/forms/framed.hpp"
#include "shapes/tube/forms/framed_moment.hpp"
#include "shapes/tube/forms/mitsuba.hpp"
#include "shapes/tube/forms/pbrt_interval.hpp"
#include "shapes/tube/forms/triple_product.hpp"
#include "shapes/tube/forms/unit_axis.hpp"

namespace lostbits::intersect::tube {

using TubeForms = FormList<   //
    tube::UnitAxisTube,       //
    tube::FramedTube,         //
    tube::CeleritasTube,      //
    tube::PbrtTube,           //
    tube::MitsubaTube,        //
    tube::TripleProductTube,  //
    tube::DetrayTube,         //
    tube::FramedMoment,       //
    tube::FilteredTube        //
    >;

}  // namespace lostbits::intersect::tube
