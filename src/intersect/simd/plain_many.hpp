// One ray against many boxes by the simplest loop: a form's scalar source for each box in turn. The compiler may
// vectorise it with the instructions that the packs use. It is the baseline that shows what packs gain.
#pragma once

#include <cstddef>
#include <span>

#include "intersect/info.hpp"

namespace lostbits::intersect::simd {

/// A box: lo x, y, z, hi x, y, z.
struct PlainBox {
    float numbers[6];
};

/// A box form in binary32; ray: ox, oy, oz, dx, dy, dz; t as in `ManyKernel`. Any n.
struct PlainRow {
    const Info* info;
    void (*columns)(const float* ray, const float* const* columns, float* t, std::size_t n);
    void (*structs)(const float* ray, const PlainBox* boxes, float* t, std::size_t n);
};

/// The box forms, in the order of the catalogue, compiled at -O3 with AVX2 and FMA and without contraction. Forms that
/// call wider arithmetic on some rays are left out, since no loop over them is vectorised. Empty if this build or this
/// processor has none.
std::span<const PlainRow> plain_rows();

/// Fills a row for each box form, except `info`; null for a form without a loop. It is in the translation unit with
/// those flags.
void fill_plain_w256(PlainRow* rows);

}  // namespace lostbits::intersect::simd
