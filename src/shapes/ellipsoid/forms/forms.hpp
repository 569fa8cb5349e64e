// All forms of the ellipsoid: one line for each, and its include.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/ellipsoid/forms/cesium.hpp"
#include "shapes/ellipsoid/forms/filtered.hpp"
#include "shapes/ellipsoid/forms/half_b.hpp"
#include "shapes/ellipsoid/forms/line_of_sight.hpp"
#include "shapes/ellipsoid/forms/moment.hpp"
#include "shapes/ellipsoid/forms/perpendicular.hpp"
#include "shapes/ellipsoid/forms/press.hpp"
#include "shapes/ellipsoid/forms/scaled.hpp"
#include "shapes/ellipsoid/forms/scaled_unit.hpp"
#include "shapes/ellipsoid/forms/schoolbook.hpp"
#include "shapes/ellipsoid/forms/two_words.hpp"

namespace lostbits::intersect::ellipsoid {

using EllipsoidForms = FormList<     //
    ellipsoid::WeightedSchoolbook,   //
    ellipsoid::WeightedHalfB,        //
    ellipsoid::WeightedPress,        //
    ellipsoid::ScaledHalfB,          //
    ellipsoid::ScaledUnit,           //
    ellipsoid::CesiumInterval,       //
    ellipsoid::ScaledPerpendicular,  //
    ellipsoid::LineOfSight,          //
    ellipsoid::MomentDiscriminant,   // own forms of lostbits
    ellipsoid::TwoWordsEllipsoid,    //
    ellipsoid::FilteredEllipsoid     //
    >;

}  // namespace lostbits::intersect::ellipsoid
