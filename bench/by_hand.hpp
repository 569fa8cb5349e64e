// Loops written by hand with intrinsics, to compare the packed kernels with. Each width is a separate translation unit
// with its own compiler flags, so the interface has only plain pointers. n must be a multiple of the pack size.
#pragma once

#include <cstddef>

namespace by_hand {

/// One ray (ox, oy, oz, dx, dy, dz) against n boxes. `columns`: lo x, y, z, hi x, y, z. t is read as the end of the ray
/// and written as in Barnes, part 3.
template <class F>
using Boxes = void (*)(const F* ray, const F* const columns[6], F* t, std::size_t n);

/// n rays (columns: ox, oy, oz, dx, dy, dz) against one sphere (x, y, z, radius) or triangle (a, b, c). The answers are
/// t, near, far, and hit as a byte 0 or 1.
template <class F>
using OnePrimitive = void (*)(const F* const rays[6], const F* primitive, F* const answers[3], unsigned char* hit,
                              std::size_t n);

/// All loops in one format.
template <class F>
struct Loops {
    Boxes<F> signs, inclusive;
    OnePrimitive<F> schoolbook, unified;
    OnePrimitive<F> moller_trumbore, undivided, woop;
};

/// All loops for one register width.
struct Width {
    Loops<float> f32;
    Loops<double> f64;
};
Width width_256();
Width width_512();

}  // namespace by_hand
