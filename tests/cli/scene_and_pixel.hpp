// For each shape, a scene with a primitive of this shape and a pixel that hits it.
#pragma once

#include <array>
#include <string>

#include "shapes/primitive.hpp"

namespace lostbits::test {

/// Returns the name of the scene and the option that selects the pixel.
inline std::string scene_and_pixel_of(Shape shape) {
    if (shape == Shape::sphere) return "rtg-fig-7-3-100-oblique --pixel 128,100";
    if (shape == Shape::box) return "box-one --pixel 128,100";
    if (shape == Shape::triangle) return "triangle-edge.plain --pixel 100,80";
    if (shape == Shape::ellipsoid) return "ellipsoid-far --pixel 96,92";
    if (shape == Shape::cylinder) return "cylinder-near --pixel 96,92";
    if (shape == Shape::capsule) return "capsule-near --pixel 96,92";
    if (shape == Shape::tube) return "tube-near --pixel 96,92";
    if (shape == Shape::cone) return "cone-near --pixel 96,92";
    if (shape == Shape::disc) return "disc-near --pixel 110,92";
    if (shape == Shape::plane) return "plane-floor.floor --pixel 96,150";
    if (shape == Shape::torus) return "torus-near --pixel 96,100";
    return "sdf-sphere --pixel 100,100";
}

/// Rays that `FORM.filtered` decides in its exact step: from a point of the sphere and of the cylinder, and through an
/// edge of the box and of the triangle.
inline constexpr std::array exact_step_rays{"--sphere=0,0,0,5 --ray=3,4,0,-1,0,0 -i sphere.filtered",
                                            "--box=-1,-1,-1,1,1,1 --ray=-2,0,0,1,1,0 -i box.filtered",
                                            "--triangle=0,0,0,1,0,0,0,1,0 --ray=0.5,0.5,3,0,0,-1 -i triangle.filtered",
                                            "--cylinder=0,0,-2,0,0,2,5 --ray=3,4,0,-1,0,0 -i cylinder.filtered"};

inline std::string scene_of(Shape shape) {
    const std::string options = scene_and_pixel_of(shape);
    return options.substr(0, options.find(' '));
}

}  // namespace lostbits::test
