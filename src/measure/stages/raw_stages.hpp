// What stages.cpp and the objects of the register widths say to each other: plain pointers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "geometry/range.hpp"
#include "shapes/solid.hpp"

namespace lostbits::measure::stages {

/// A column: the numbers of the pack at `i` lie at `from + i * step`. A step of 0 repeats the same register.
template <class S>
struct RawColumn {
    const S* from;
    std::size_t step;
};

/// Where a length goes; nowhere where it is not asked for.
struct RawLength {
    double *hi = nullptr, *lo = nullptr, *bound = nullptr;
};

/// Where findings go, one of each for a problem.
struct RawFindings {
    std::uint8_t *settled, *hit;  ///< 0 or 1
    RawLength t, distance;        ///< t*, in lengths of the direction, and t* |d|: one of them at least
    /// As `Truth` has them, of `RawStages::ties` alone: the others settle no such ray.
    std::uint8_t *touches = nullptr, *on_surface = nullptr;
};

/// Whether the solids of a batch stand under matrices, which follow their numbers, all of them of one kind.
struct UnderMatrix {
    bool placed = false, is_inverse = false;
    int orientation = 1;
    friend bool operator==(const UnderMatrix&, const UnderMatrix&) = default;
};

/// Whole packs of problems and room for what is found: `size` is a multiple of a register's doubles.
template <class S>
struct RawProblems {
    RawColumn<S> ray[6], solid[most_stored];
    RawColumn<S> ray_low[6], solid_low[most_stored];  ///< second words
    bool two_words;                                   ///< whether there are any; never of floats
    RawColumn<S> tmin, tmax;
    bool ranged;  ///< else these are 0 and endless for every ray
    OpenEnds open;
    UnderMatrix matrix;
    RawFindings out;
    std::size_t size;
};

/// As many problems, their columns still to be named.
template <class S>
RawProblems<S> raw_problems(std::size_t size, const RawFindings& out) {
    return {{}, {}, {}, {}, false, {}, {}, false, {}, {}, out, size};
}

/// Directions to be made unit: whole packs.
struct RawDirections {
    const double* in[3];
    double* out[3];
    std::uint8_t* settled;  ///< 0 or 1
    bool binary32;          ///< rounded to binary32; else to binary64
    double scale;           ///< of the errors that the lemma allows for: 1, but where a test widens them
    std::size_t size;
};

/// The stages of one shape: what proves answers. Each is a function that takes seconds to compile a shape and a width,
/// so what need not be compiled apart is said by `RawProblems`.
struct RawStages {
    void (*binary64)(const RawProblems<float>&);        ///< binary32 inputs
    void (*double_double)(const RawProblems<double>&);  ///< one word a number, or two
    void (*unit_directions)(const RawDirections&);      ///< the same for every shape
    /// Also of rays that touch, by exact sums: one word a number, no matrix and no range. Null where there is none.
    void (*ties)(const RawProblems<double>&) = nullptr;
};

/// One function for registers of 128 bits and one for wider ones, each in an object of its own: those of every shape,
/// in the order of the list.
void fill_stages_w128(RawStages* of_shape);
void fill_stages_w256(RawStages* of_shape);

}  // namespace lostbits::measure::stages
