// Loops written by hand with intrinsics, to hold the packed kernels against. Plain pointers: each width is a translation unit
// of its own, compiled with its own flags. Whole packs only.
#pragma once

#include <cstddef>

namespace by_hand {

/// Binary32; ray: ox, oy, oz, dx, dy, dz; columns: lo x, y, z, hi x, y, z; t as in seed 002.
using Boxes = void (*)(const float* ray, const float* const columns[6], float* t, std::size_t n);

void signs_w256(const float* ray, const float* const columns[6], float* t, std::size_t n);
void inclusive_w256(const float* ray, const float* const columns[6], float* t, std::size_t n);
void signs_w512(const float* ray, const float* const columns[6], float* t, std::size_t n);
void inclusive_w512(const float* ray, const float* const columns[6], float* t, std::size_t n);

}  // namespace by_hand
