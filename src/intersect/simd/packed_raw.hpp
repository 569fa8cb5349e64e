// The interface between packed.cpp and the translation units of the instruction sets: plain pointers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "intersect/march.hpp"
#include "shapes/solid.hpp"

namespace lostbits::intersect::simd {

/// The target of a form.
template <class F>
struct RawTarget {
    const F* numbers;            ///< `most_numbers` a solid, in the order of `Solid`
    const std::uint8_t* shapes;  ///< of each solid, as `Shape` counts them
    std::size_t solids;          ///< one for the forms of a sphere or a box
    MarchConstants<F> march;     ///< for the forms that march
};

/// Whole packs of rays, structure of arrays: `size` is a multiple of the lanes.
template <class F>
struct RawBatch {
    const F* rays[6];  ///< ox, oy, oz, dx, dy, dz
    const F* tmax;     ///< where each ray ends; null: nowhere
    const RawTarget<F>* target;
    F *t, *near, *far;
    std::uint8_t* hit;
    std::size_t size;
};

/// One ray against whole packs of solids, structure of arrays: `size` is a multiple of the lanes.
template <class F>
struct RawSolids {
    const F* ray;                    ///< ox, oy, oz, dx, dy, dz
    const F* numbers[most_numbers];  ///< a column for each number of the form's shape, in the order of `Solid`
    F* t;                            ///< spheres: written; boxes: the ray's end on the way in, tmin after a hit
    std::uint8_t* hit;               ///< spheres only
    std::size_t size;
};

/// The shapes of which one ray is asked about many at once in binary64 too: the spheres of a flake, the boxes of a
/// hierarchy. Many of the others come in sweeps over every float of a solid's number alone, in binary32, which take
/// four to seven times as long without a kernel.
constexpr bool come_in_many(Shape shape) { return shape == shape_as<Sphere> || shape == shape_as<Box>; }

struct RawManyRow {
    void (*f32)(const RawSolids<float>&);
    void (*f64)(const RawSolids<double>&);
};

struct RawRow {
    void (*f32)(const RawBatch<float>&);
    void (*f64)(const RawBatch<double>&);
};

/// One function a register width, each in an object of its own: fills a row for each form, in the order of the tables.
void fill_packed_w128(RawRow* rows);
void fill_packed_w256(RawRow* rows);
void fill_packed_w512(RawRow* rows);
/// The same for many solids.
void fill_many_w128(RawManyRow* rows);
void fill_many_w256(RawManyRow* rows);
void fill_many_w512(RawManyRow* rows);

}  // namespace lostbits::intersect::simd
