// The interface between packed.cpp and the translation units of the instruction sets. It consists of plain pointers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "intersect/march.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::intersect::simd {

/// The target of a form as plain pointers.
template <class F>
struct RawTarget {
    const F* numbers;             ///< `max_number_count` numbers for each primitive, in the order of `Primitive`
    const std::uint8_t* shapes;   ///< the shape of each primitive, as the integer value of `Shape`
    std::size_t primitive_count;  ///< number of primitives; 1 for a form that does not march
    MarchConstants<F> march;      ///< only for forms that march
};

/// Whole packs of rays, structure of arrays: `size` is a multiple of the lanes.
template <class F>
struct RawBatch {
    const F* rays[6];  ///< ox, oy, oz, dx, dy, dz
    const F* tmax;     ///< end of each ray; null if no ray has an end
    const RawTarget<F>* target;
    F *t, *near, *far;
    std::uint8_t* hit;
    std::size_t size;
};

/// One ray against whole packs of primitives, structure of arrays: `size` is a multiple of the lanes.
template <class F>
struct RawPrimitives {
    const F* ray;                        ///< ox, oy, oz, dx, dy, dz
    const F* numbers[max_number_count];  ///< a column for each number of the form's shape, in the order of `Primitive`
    F* t;                                ///< for spheres written; for boxes, tmax at the call, and tmin after a hit
    std::uint8_t* hit;                   ///< only for spheres
    std::size_t size;
};

/// True for the shapes that have kernels for many primitives also in binary64: spheres, as in a sphere flake, and
/// boxes, as in a hierarchy. Many primitives of another shape occur only in sweeps over every float value of one of its
/// numbers, in binary32. Without a kernel such a sweep takes four to seven times as long.
constexpr bool has_many_kernels(Shape shape) { return shape == shape_as<Sphere> || shape == shape_as<Box>; }

struct RawManyFormKernels {
    void (*f32)(const RawPrimitives<float>&);
    void (*f64)(const RawPrimitives<double>&);
};

struct RawFormKernels {
    void (*f32)(const RawBatch<float>&);
    void (*f64)(const RawBatch<double>&);
};

/// One function for each register width and each part of the catalogue (`FirstForms`, `SecondForms`), each in its own
/// object file. It fills a row for each form of the part, in the order of the catalogue, and returns the place after
/// the last.
template <class Forms>
RawFormKernels* fill_packed_w128(RawFormKernels* rows);
template <class Forms>
RawFormKernels* fill_packed_w256(RawFormKernels* rows);
template <class Forms>
RawFormKernels* fill_packed_w512(RawFormKernels* rows);
/// The same functions for many primitives.
template <class Forms>
RawManyFormKernels* fill_many_w128(RawManyFormKernels* rows);
template <class Forms>
RawManyFormKernels* fill_many_w256(RawManyFormKernels* rows);
template <class Forms>
RawManyFormKernels* fill_many_w512(RawManyFormKernels* rows);

}  // namespace lostbits::intersect::simd
