// All forms of the box: one line for each, and its include.
#pragma once

#include "intersect/form_list.hpp"
#include "shapes/box/forms/baseline.hpp"
#include "shapes/box/forms/bvh_robust.hpp"
#include "shapes/box/forms/divide.hpp"
#include "shapes/box/forms/embree_fma.hpp"
#include "shapes/box/forms/embree_padded.hpp"
#include "shapes/box/forms/embree_robust.hpp"
#include "shapes/box/forms/exclusive.hpp"
#include "shapes/box/forms/filtered.hpp"
#include "shapes/box/forms/ieee_minmax.hpp"
#include "shapes/box/forms/inclusive.hpp"
#include "shapes/box/forms/max_mult.hpp"
#include "shapes/box/forms/pbrt_padded.hpp"
#include "shapes/box/forms/signs.hpp"
#include "shapes/box/forms/tinybvh.hpp"

namespace lostbits::intersect::box {

using BoxForms = FormList<  //
    box::Baseline,          // from Barnes' articles
    box::Exclusive,         //
    box::Inclusive,         //
    box::Signs,             //
    box::Divide,            // from renderers and the literature
    box::IeeeMinmax,        //
    box::PbrtPadded,        //
    box::MaxMult,           //
    box::EmbreeFma,         //
    box::EmbreeRobust,      //
    box::EmbreePadded,      //
    box::BvhRobust,         //
    box::TinyBvh,           //
    box::FilteredSlabs      // own form of lostbits
    >;

}  // namespace lostbits::intersect::box
