// The closed list of transform methods: a line and an include for each.
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

/// Calls `act.template operator()<PlainTransform>()` for each in turn.
template <class Act>
constexpr void for_each_transform_method(const Act& act) {
    const auto all = [&act]<class... L>() { (act.template operator()<L>(), ...); };
    all.template operator()<PlainTransform,     //
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
