// Interface between stages.cpp and the objects of the register widths: plain pointers.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>

#include "geometry/range.hpp"
#include "number/wide/column_program.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::stages {

/// Column: the numbers of the pack at `i` lie at `from + i * step`. A step of 0 repeats the same register.
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
    /// As in `Truth`; only `RawStages::ties` sets them, since the other stages settle no such ray.
    std::uint8_t *touches = nullptr, *on_surface = nullptr;
};

/// Matrices of a batch of primitives: if `placed`, each primitive is under a matrix, which follows its numbers. All
/// matrices of a batch are of one kind.
struct UnderMatrix {
    bool placed = false, is_inverse = false;
    int orientation = 1;
    friend auto operator<=>(const UnderMatrix&, const UnderMatrix&) = default;
};

/// Whole packs of problems, and buffers for the findings. `size` is a multiple of the doubles in a register.
template <class S>
struct RawProblems {
    RawColumn<S> ray[6], primitive[most_stored];
    RawColumn<S> ray_low[6], primitive_low[most_stored];  ///< second words
    bool two_words;                                       ///< true if there are second words; always false for floats
    RawColumn<S> tmin, tmax;
    bool ranged;  ///< if false, tmin is 0 and tmax infinite for every ray
    OpenEnds open;
    UnderMatrix matrix;
    RawFindings out;
    std::size_t size;
};

/// Problems without columns: `size` of them, whose columns are set later.
template <class S>
RawProblems<S> raw_problems(std::size_t size, const RawFindings& out) {
    return {{}, {}, {}, {}, false, {}, {}, false, {}, {}, out, size};
}

/// Directions to be made unit, in whole packs.
struct RawDirections {
    const double* in[3];
    double* out[3];
    std::uint8_t* settled;  ///< 0 or 1
    bool binary32;          ///< true: rounded to binary32; false: to binary64
    double scale;           ///< factor on the error bounds of the lemma: 1, unless a test widens them
    std::size_t size;
};

/// An operand of an instruction: where its column begins in a buffer of doubles, and how far apart its packs are. The
/// distance is 0 if the operand is the same for every ray.
struct ColumnOperand {
    std::uint32_t offset, step;
};

/// The packs of a column, and how far apart they are.
struct CellsOfColumn {
    const double* from;
    std::size_t step;
};

/// The instructions of column programs in registers of one width.
struct ColumnKernels {
    using Kernel = void (*)(double* scratch, const ColumnOperand* operands, std::size_t packs);
    using OfOperation = std::array<Kernel, 64>;  ///< indexed by the set of exact operands
    using OfWords = std::array<OfOperation, number::wide::column_operations>;

    std::size_t lanes;
    std::array<OfWords, 2> of{};  ///< for bounded numbers of one word, and of two

    /// Copy packs of a column, from the ray `first` on.
    void (*load_floats)(const RawColumn<float>& from, std::size_t first, double* to, std::size_t packs);
    void (*load_doubles)(const RawColumn<double>& from, std::size_t first, double* to, std::size_t packs);
    void (*repeat)(double x, double* to);
    bool (*is_any)(const double* mask, std::size_t packs);
    void (*store_mask)(const CellsOfColumn& mask, std::uint8_t* to, std::size_t packs);
    /// Stores 0 in lanes in which the mask is not set.
    void (*store_where)(const CellsOfColumn& mask, const CellsOfColumn& x, double* to, std::size_t packs);
};

/// Functions that are compiled for a register width. (Each shape's stage is a program of columns.)
struct RawStages {
    ColumnKernels columns;
    void (*unit_directions)(const RawDirections&);
    /// Functions that use exact sums, in the order of the list of shapes: for a shape that lies flat between points, of
    /// rays that touch; for a surface of degree four, of rays that begin near it. One word for each number, no matrix,
    /// no range. Null for the other shapes.
    std::array<void (*)(const RawProblems<double>&), shape_rows.size()> ties;
};

/// One function for registers of 128 bits and one for wider ones, each in an object file of its own.
void fill_stages_w128(RawStages& kernels);
void fill_stages_w256(RawStages& kernels);

}  // namespace lostbits::measure::stages
