// The interface between space.cpp and the objects of the register widths: plain pointers.
#pragma once

#include <cstddef>

namespace lostbits::intersect::space {

/// Whole packs of rays, structure of arrays: `size` is a multiple of the lanes.
template <class F>
struct RawSteps {
    const F* maps;      ///< to the world, then to the primitive, each three rows of four
    const F* world[6];  ///< ox, oy, oz, dx, dy, dz
    F* object[6];       ///< the same in the space of the primitive
    F *length, *scale;  ///< a length for each ray; one scale for all
    F* told[3];         ///< t, near and far, converted back in place
    std::size_t size;
};

template <class F>
struct RawWay {
    void (*to_object)(const RawSteps<F>&);
    void (*back)(const RawSteps<F>&);
};
struct RawSpace {
    RawWay<float> f32;
    RawWay<double> f64;
};

/// One function for each register width, each in its own object. It fills a row for each method, in the order of the
/// list.
void fill_spaces_w128(RawSpace* rows);
void fill_spaces_w256(RawSpace* rows);
void fill_spaces_w512(RawSpace* rows);

}  // namespace lostbits::intersect::space
