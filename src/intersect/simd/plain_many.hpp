// One ray against many boxes by the simplest loop: a form's scalar source for each box in turn. The compiler may
// vectorise the loop with the instructions that the packs use. The loop is the baseline that shows what packs gain.
#pragma once

#include <cstddef>
#include <span>

#include "intersect/info.hpp"

namespace lostbits::intersect::simd {

/// The numbers of a box: lo x, y, z, hi x, y, z.
struct PlainBox {
    float numbers[6];
};

/// The two loops of a box form in binary32, over columns and over structs. `ray` holds ox, oy, oz, dx, dy, dz; t is as
/// in `ManyKernel`; n may be any number.
struct PlainFormKernels {
    const Info* info;
    void (*columns)(const float* ray, const float* const* columns, float* t, std::size_t n);
    void (*structs)(const float* ray, const PlainBox* boxes, float* t, std::size_t n);
};

/// The rows of the box forms, in the order of the catalogue, compiled at -O3 with AVX2 and FMA and without contraction.
/// Forms that call wider arithmetic on some rays are left out, since no loop over them is vectorised. Empty if this
/// build has no such code or this processor cannot run it.
std::span<const PlainFormKernels> all_plain_kernels();

/// Fills a row for each box form, except `info`; null for a form without a loop. The function is in the translation
/// unit that is compiled with those flags.
void fill_plain_w256(PlainFormKernels* rows);

}  // namespace lostbits::intersect::simd
