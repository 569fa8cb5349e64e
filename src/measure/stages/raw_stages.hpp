// Interface between stages.cpp and the code that is compiled for each register width. It has only plain pointers.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>

#include "geometry/range.hpp"
#include "number/wide/column_program.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::stages {

/// A column. The numbers of the pack at `i` lie at `from + i * step`. A step of 0 repeats the same register.
template <class S>
struct RawColumn {
    const S* from;
    std::size_t step;
};

/// Destination of a length; null if it is not requested.
struct RawLength {
    double *hi = nullptr, *lo = nullptr, *bound = nullptr;
};

/// Destinations of the findings, one of each kind for each problem.
struct RawFindings {
    std::uint8_t *settled, *hit;  ///< 0 or 1
    RawLength t, distance;        ///< t*, in lengths of the direction, and t* |d|; at least one of them
    /// As in `Truth`. Only `RawStages::ties` sets these, since the other stages leave such rays open.
    std::uint8_t *touches = nullptr, *on_surface = nullptr;
};

/// Kind of the matrices of the primitives of a batch, if they have any (`exists`). All matrices of one batch are of the
/// same kind. In the columns, the numbers of a matrix follow the numbers of its primitive.
struct MatrixKind {
    bool exists = false, is_inverse = false;
    int orientation = 1;
    friend auto operator<=>(const MatrixKind&, const MatrixKind&) = default;
};

/// Whole packs of problems, and buffers for the findings. `size` is a multiple of the number of doubles in a register.
template <class S>
struct RawProblems {
    RawColumn<S> ray[6], primitive[max_primitive_number_count];
    RawColumn<S> ray_low[6], primitive_low[max_primitive_number_count];  ///< second words
    bool two_words;  ///< true if there are second words; always false for floats
    RawColumn<S> tmin, tmax;
    bool has_ranges;  ///< if false, tmin is 0 and tmax infinite for every ray
    OpenEnds open_ends;
    MatrixKind matrix;
    RawFindings out;
    std::size_t size;
};

/// Problems without columns: `size` of them, whose columns are set later.
template <class S>
RawProblems<S> make_raw_problems(std::size_t size, const RawFindings& out) {
    return {{}, {}, {}, {}, false, {}, {}, false, {}, {}, out, size};
}

/// Directions to normalise, in whole packs.
struct RawDirections {
    const double* in[3];
    double* out[3];
    std::uint8_t* settled;  ///< 0 or 1
    bool binary32;          ///< true: round to binary32; false: round to binary64
    double scale;           ///< factor on the error bounds of the lemma: 1, unless a test widens them
    std::size_t size;
};

/// An operand of an instruction: the offset of its column in a buffer of doubles, and the step from one pack to the
/// next. The step is 0 if the operand is the same for every ray.
struct ColumnOperand {
    std::uint32_t offset, step;
};

/// The packs of a column, and the step from one pack to the next.
struct ColumnCells {
    const double* from;
    std::size_t step;
};

/// Kernels for the instructions of column programs, in registers of one width.
struct ColumnKernels {
    using Kernel = void (*)(double* scratch, const ColumnOperand* operands, std::size_t pack_count);
    using OperationKernels = std::array<Kernel, 64>;  ///< indexed by the set of exact operands
    using WordKernels = std::array<OperationKernels, number::wide::column_operation_count>;

    std::size_t lanes;
    std::array<WordKernels, 2> by_words{};  ///< for bounded numbers of one word, and of two

    /// Copy `pack_count` packs of a column, from the ray `first` on.
    void (*load_floats)(const RawColumn<float>& from, std::size_t first, double* to, std::size_t pack_count);
    void (*load_doubles)(const RawColumn<double>& from, std::size_t first, double* to, std::size_t pack_count);
    void (*repeat)(double x, double* to);
    bool (*is_any)(const double* mask, std::size_t pack_count);
    void (*store_mask)(const ColumnCells& mask, std::uint8_t* to, std::size_t pack_count);
    /// Stores 0 in lanes in which the mask is not set.
    void (*store_where)(const ColumnCells& mask, const ColumnCells& x, double* to, std::size_t pack_count);
};

/// Functions that are compiled for one register width. (The stage of a shape is a column program, which `columns`
/// runs.)
struct RawStages {
    ColumnKernels columns;
    void (*unit_directions)(const RawDirections&);
    /// Functions that use exact sums, one for each shape in the order of `shape_rows`; null if the shape has none.
    ///
    /// - For a shape that lies flat between points, the function settles rays that touch the shape.
    /// - For a surface of degree four, it settles rays that begin near the surface.
    ///
    /// These functions take only problems whose numbers have one word, without a matrix and without a range of t.
    std::array<void (*)(const RawProblems<double>&), shape_rows.size()> ties;
};

/// Fill the table for registers of 128 bits, and for wider registers. Each function is in an object file of its own.
void fill_stages_w128(RawStages& kernels);
void fill_stages_w256(RawStages& kernels);

}  // namespace lostbits::measure::stages
