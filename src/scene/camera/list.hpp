// The closed list of ways to make a ray: for each a line, and an include.
#pragma once

#include "scene/camera/babylon.hpp"
#include "scene/camera/bevy.hpp"
#include "scene/camera/bevy_view.hpp"
#include "scene/camera/differentials.hpp"
#include "scene/camera/dxr.hpp"
#include "scene/camera/glm.hpp"
#include "scene/camera/godot.hpp"
#include "scene/camera/nvpro.hpp"
#include "scene/camera/optix.hpp"
#include "scene/camera/pbrt.hpp"
#include "scene/camera/relative.hpp"
#include "scene/camera/three.hpp"
#include "scene/camera/unreal.hpp"
#include "scene/camera/weekend.hpp"

namespace lostbits::scene::camera {

/// `act.template operator()<ThreeRay>()` for each in turn.
template <class Act>
constexpr void for_each_maker(const Act& act) {
    const auto all = [&act]<class... M>() { (act.template operator()<M>(), ...); };
    all.template operator()<ThreeRay,          //
                            BabylonRay,        //
                            GlmRay,            //
                            DxrRay,            //
                            UnrealRay,         //
                            BevyRay,           //
                            BevyViewRay,       //
                            NvproRay,          //
                            GodotRay,          //
                            OptixRay,          //
                            WeekendRay,        //
                            PbrtRay,           //
                            DifferentialsRay,  //
                            RelativeRay>();
}

}  // namespace lostbits::scene::camera
