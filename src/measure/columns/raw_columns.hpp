// Interface between columns.cpp and the translation units of the instruction sets: plain pointers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shapes/primitive.hpp"

namespace lostbits::measure::columns {

/// Number of doubles in the widest registers.
inline constexpr std::size_t max_lanes = 8;

/// Rays that a kernel cannot handle and leaves to the scalar functions: `count` indices in ascending order.
struct RawUnhandledRays {
    std::uint32_t* indices;
    std::size_t count;
};

/// Differences between answers and truths. A ray whose `answer` is NaN is not measured, and its results are NaN.
struct RawErrors {
    enum In { answer, hi, lo, inverse_binade, columns_in };
    enum Out { ulp, lost, correct, relative, absolute, columns_out };

    std::size_t size;
    const double* in[columns_in];  ///< for the truth, hi is NaN if doubles do not hold it
    double* out[columns_out];      ///< null for columns that are not requested; `ulp` is required
    double precision;              ///< p
    double ulps_of_binade;         ///< 2^(p − 1)
    double max_inverse_binade;     ///< 2^−emin
    double largest;                ///< input and output: the largest |ulp| so far
    RawUnhandledRays unhandled;
};

/// Distances of hit points from primitives of one shape.
struct RawResiduals {
    enum In { answer, ox, oy, oz, dx, dy, dz, primitive, columns_in = primitive + max_number_count };

    std::size_t size;
    const double* in[columns_in];  ///< from `primitive` on, in the order of `Primitive::numbers`
    double* out;
    bool binary32;  ///< true: the hit point is computed in float; false: in double
    RawUnhandledRays unhandled;
};

/// Sums of the sizes |x| of a column, without NaN; a kernel adds to them.
struct RawAbsoluteSums {
    std::size_t size;
    const double* values;
    double hi[max_lanes], lo[max_lanes];  ///< sums over sizes up to `largest_summed`: sample i in lane i mod 8
    double largest;
    std::uint64_t count, zeros, beyond;  ///< `beyond` counts sizes above `largest_summed`, including infinity
};
inline constexpr double largest_summed = 0x1p+900;

/// Hits with one primitive. A kernel keeps each hit that comes before the nearest hit so far.
template <class F>
struct RawHits {
    std::size_t size;
    const F* t;
    const std::uint8_t* hit;
    F* nearest;                        ///< NaN if nothing is hit yet, or if the hit is at NaN
    std::int32_t* nearest_primitives;  ///< −1 if nothing is hit yet
    std::int32_t primitive;            ///< index of this primitive
};

struct RawKernels {
    void (*errors)(RawErrors&);
    void (*residuals[shape_rows.size()])(RawResiduals&);  ///< one for each shape
    void (*absolute_sums)(RawAbsoluteSums&);
    void (*hits32)(const RawHits<float>&);
    void (*hits64)(const RawHits<double>&);
};

/// One function for each register width, each in an object file of its own.
RawKernels raw_kernels_w128();
RawKernels raw_kernels_w256();
RawKernels raw_kernels_w512();

}  // namespace lostbits::measure::columns
