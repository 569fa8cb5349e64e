// All transform methods: a line and an include for each.
#pragma once

#include "intersect/transform/adjugate.hpp"
#include "intersect/transform/bevy.hpp"
#include "intersect/transform/cycles.hpp"
#include "intersect/transform/cycles_3_3.hpp"
#include "intersect/transform/embree.hpp"
#include "intersect/transform/in_double.hpp"
#include "intersect/transform/mitsuba.hpp"
#include "intersect/transform/pbrt.hpp"
#include "intersect/transform/plain.hpp"
#include "intersect/transform/relative.hpp"
#include "intersect/transform/rigid.hpp"
#include "intersect/transform/three.hpp"
#include "intersect/transform/two_words.hpp"
#include "intersect/transform/unreal.hpp"

namespace lostbits::intersect::transform {

/// Calls `visit.template operator()<PlainTransform>()`, and so on for each method in turn.
template <class Visit>
constexpr void for_each_transform_method(const Visit& visit) {
    const auto visit_all = [&visit]<class... Method>() { (visit.template operator()<Method>(), ...); };
    visit_all.template operator()<PlainTransform,     //
                                  PbrtTransform,      //
                                  EmbreeTransform,    //
                                  MitsubaTransform,   //
                                  CyclesTransform,    //
                                  Cycles33Transform,  //
                                  ThreeJsTransform,   //
                                  BevyTransform,      //
                                  RigidTransform,     //
                                  RelativeTransform,  //
                                  AdjugateTransform,  //
                                  UnrealTransform,    //
                                  InDoubleTransform,  //
                                  TwoWordsTransform>();
}

}  // namespace lostbits::intersect::transform
