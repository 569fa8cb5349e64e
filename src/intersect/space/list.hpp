// The closed list of transform methods: a line and an include for each.
#pragma once

#include "intersect/space/adjugate.hpp"
#include "intersect/space/bevy.hpp"
#include "intersect/space/cycles.hpp"
#include "intersect/space/cycles_3_3.hpp"
#include "intersect/space/embree.hpp"
#include "intersect/space/in_double.hpp"
#include "intersect/space/mitsuba.hpp"
#include "intersect/space/pbrt.hpp"
#include "intersect/space/plain.hpp"
#include "intersect/space/relative.hpp"
#include "intersect/space/rigid.hpp"
#include "intersect/space/three.hpp"
#include "intersect/space/two_words.hpp"
#include "intersect/space/unreal.hpp"

namespace lostbits::intersect::space {

/// Calls `act.template operator()<PlainSpace>()` for each in turn.
template <class Act>
constexpr void for_each_space(const Act& act) {
    const auto all = [&act]<class... L>() { (act.template operator()<L>(), ...); };
    all.template operator()<PlainSpace,     //
                            PbrtSpace,      //
                            EmbreeSpace,    //
                            MitsubaSpace,   //
                            CyclesSpace,    //
                            Cycles33Space,  //
                            ThreeSpace,     //
                            BevySpace,      //
                            RigidSpace,     //
                            RelativeSpace,  //
                            AdjugateSpace,  //
                            UnrealSpace,    //
                            InDoubleSpace,  //
                            TwoWordsSpace>();
}

}  // namespace lostbits::intersect::space
