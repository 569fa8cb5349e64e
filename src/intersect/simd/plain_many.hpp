// One ray against many boxes by the simplest loop: a form's scalar source for each box in turn,
// left to the compiler to vectorise, with the instructions that the packs have. What packs are worth is measured
// against it.
#pragma once

#include <cstddef>
#include <span>

#include "intersect/info.hpp"

namespace lostbits::intersect::simd {

/// lo x, y, z, hi x, y, z.
struct PlainBox {
    float numbers[6];
};

/// A box form in binary32; ray: ox, oy, oz, dx, dy, dz; t as in `ManyKernel`. Any n.
struct PlainRow {
    const Info* info;
    void (*columns)(const float* ray, const float* const* columns, float* t, std::size_t n);
    void (*structs)(const float* ray, const PlainBox* boxes, float* t, std::size_t n);
};

/// The box forms, in the order of the catalogue, at -O3 with AVX2 and FMA (and no contraction), but for those that call
/// wider arithmetic on some rays: no loop over them is vectorised. Empty where this build or this processor has none.
std::span<const PlainRow> plain_rows();

/// The translation unit with those flags; fills a row for each box form, but for `info`; null where there is no loop.
void fill_plain_w256(PlainRow* rows);

}  // namespace lostbits::intersect::simd
