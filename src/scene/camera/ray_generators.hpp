// Table of the ray generators. Each is compiled for floats, doubles, numbers of any format, and exact numbers.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string_view>

#include "number/format.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"
#include "number/tape.hpp"
#include "scene/camera/numbers.hpp"

namespace lostbits::scene::camera {

/// Rows [first, last) of a picture.
struct RowRange {
    int first, last;
};

/// Makes the rays of every pixel of some rows, and calls `add` with each ray, in the order of the pixels.
template <class T>
using MakeRays = void (*)(const CameraNumbers<T>&, RowRange, const std::function<void(const Ray<T>&)>& add);

/// Column and row of a pixel.
struct PixelCoordinates {
    int x, y;
};

/// Records every operation that makes a ray in a format. The inputs of the tape are the numbers of the camera, in the
/// order of `CameraNumbers::each`, and the x, y and left of the pixel. Returns the nodes of the ray's six numbers.
using RecordRay = std::array<NodeId, 6> (*)(const Format&, const CameraNumbers<double>&, PixelCoordinates, Tape&);

/// A row of the table: what a ray generator is, and the functions that make its rays in each arithmetic.
struct RayGenerator {
    const RayGeneratorInfo* info;
    MakeRays<float> f32;
    MakeRays<double> f64;
    MakeRays<RoundedAny> rounded;
    MakeRays<Real> real;
    RecordRay record;
};

/// All ray generators, in the order of the list.
std::span<const RayGenerator> ray_generators();
/// Returns null if no ray generator has that name.
const RayGenerator* find_ray_generator(std::string_view name);

}  // namespace lostbits::scene::camera
