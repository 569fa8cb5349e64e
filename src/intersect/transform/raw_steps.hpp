// The interface between transform_method.cpp and the objects that are compiled once for each register width: plain
// pointers.
#pragma once

#include <cstddef>

namespace lostbits::intersect::transform {

/// Arrays of whole packs of rays, structure of arrays. `size` is a multiple of the number of lanes.
template <class F>
struct RawSteps {
    const F* maps;          ///< the matrix to the world, then the one to the primitive, each three rows of four
    const F* world[6];      ///< ox, oy, oz, dx, dy, dz in the world
    F* object[6];           ///< the same in the space of the primitive
    F *length, *scale;      ///< `length` has one number for each ray, `scale` one for all
    F* line_parameters[3];  ///< t, near and far, converted back in place
    std::size_t size;
};

template <class F>
struct RawTransform {
    void (*to_object)(const RawSteps<F>&);
    void (*back)(const RawSteps<F>&);
};
struct RawTransformKernels {
    RawTransform<float> f32;
    RawTransform<double> f64;
};

/// One function for each register width, each in its own object. It fills a row for each method, in the order of
/// list.hpp.
void fill_transforms_w128(RawTransformKernels* rows);
void fill_transforms_w256(RawTransformKernels* rows);
void fill_transforms_w512(RawTransformKernels* rows);

}  // namespace lostbits::intersect::transform
