// All forms of the disc: one line for each, and its include.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/disc/forms/after_point.hpp"
#include "shapes/disc/forms/filtered.hpp"
#include "shapes/disc/forms/framed.hpp"
#include "shapes/disc/forms/moment.hpp"
#include "shapes/disc/forms/quilez.hpp"

namespace lostbits::intersect::disc {

using DiscForms = FormList<  //
    disc::AfterPointDisc,    //
    disc::QuilezDisc,        //
    disc::FramedDisc,        //
    disc::MomentDisc,        //
    disc::FilteredDisc       //
    >;

}  // namespace lostbits::intersect::disc
