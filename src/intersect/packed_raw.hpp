// What packed.cpp and the translation units of the instruction sets say to each other: plain pointers.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lostbits {

/// Whole packs of rays against one sphere (centre, radius), structure of arrays: `size` is a multiple of the lanes.
template <class F>
struct RawBatch {
    const F* rays[6];  ///< ox, oy, oz, dx, dy, dz
    const F* sphere;
    F *t, *near, *far;
    std::uint8_t* hit;
    std::size_t size;
};

struct RawRow {
    void (*f32)(const RawBatch<float>&);
    void (*f64)(const RawBatch<double>&);
};

/// One function a register width, each in an object of its own: fills a row for each sphere form, in the catalogue's order.
void fill_packed_w128(RawRow* rows);
void fill_packed_w256(RawRow* rows);
void fill_packed_w512(RawRow* rows);

}  // namespace lostbits
