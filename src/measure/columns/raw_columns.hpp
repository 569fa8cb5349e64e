// What columns.cpp and the translation units of the instruction sets say to each other: plain pointers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shapes/solid.hpp"

namespace lostbits::measure::columns {

/// The widest registers hold so many doubles.
inline constexpr std::size_t most_lanes = 8;

/// Which rays a kernel leaves to the scalar functions: `count` places in rising order.
struct RawLeft {
    std::uint32_t* places;
    std::size_t count;
};

/// Differences between answers and truths. A ray whose `answer` is NaN is not measured: NaN comes out.
struct RawErrors {
    enum In { answer, hi, lo, inverse, columns_in };
    enum Out { ulp, lost, correct, relative, absolute, columns_out };

    std::size_t size;
    const double* in[columns_in];  ///< of the truth: NaN for hi where doubles do not hold it
    double* out[columns_out];      ///< null where not wanted; `ulp` always is
    double precision;              ///< p
    double ulps_of_binade;         ///< 2^(p − 1)
    double most_inverse;           ///< 2^−emin
    double largest;                ///< in and out: the largest |ulp| so far
    RawLeft left;
};

/// How far hit points lie off solids of one shape.
struct RawResiduals {
    enum In { answer, ox, oy, oz, dx, dy, dz, solid, columns_in = solid + most_numbers };

    std::size_t size;
    const double* in[columns_in];  ///< from `solid` on as in `Solid::numbers`
    double* out;
    bool binary32;  ///< the hit point is computed in float; else in double
    RawLeft left;
};

/// Sizes |x| of a column, NaN left out, added to what is known of them.
struct RawSizes {
    std::size_t size;
    const double* values;
    double hi[most_lanes], lo[most_lanes];  ///< sums: sample i in lane i mod 8; of those up to `largest_summed`
    double largest;
    std::uint64_t count, zeros, beyond;  ///< beyond: above `largest_summed`, infinite ones among them
};
inline constexpr double largest_summed = 0x1p+900;

/// Takes the hits of one more solid where they come first.
template <class F>
struct RawHits {
    std::size_t size;
    const F* t;
    const std::uint8_t* hit;
    F* nearest;             ///< NaN where nothing is hit yet, or where that is at NaN
    std::int32_t* objects;  ///< −1 where nothing is hit yet
    std::int32_t object;
};

struct RawKernels {
    void (*errors)(RawErrors&);
    void (*residuals[shape_rows.size()])(RawResiduals&);  ///< of each shape
    void (*sizes)(RawSizes&);
    void (*hits32)(const RawHits<float>&);
    void (*hits64)(const RawHits<double>&);
};

/// One function a register width, each in an object of its own.
RawKernels column_kernels_w128();
RawKernels column_kernels_w256();
RawKernels column_kernels_w512();

}  // namespace lostbits::measure::columns
