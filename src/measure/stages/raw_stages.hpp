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

/// Where findings go, one of each for a problem.
struct RawFindings {
    std::uint8_t *settled, *hit;                         ///< 0 or 1
    double *hi, *lo, *bound;                             ///< of t*, or of the distance if that alone is asked for
    double *distance_hi, *distance_lo, *distance_bound;  ///< where both are
};

/// Whole packs of problems and room for what is found: `size` is a multiple of a register's doubles.
template <class S>
struct RawProblems {
    RawColumn<S> ray[6], solid[most_numbers];
    RawColumn<S> ray_low[6], solid_low[most_numbers];  ///< second words, where there are any
    RawColumn<S> tmin, tmax;                           ///< read by the stages of rays that have a range
    OpenEnds open;
    RawFindings out;
    std::size_t size;
};

/// As many problems, their columns still to be named.
template <class S>
RawProblems<S> raw_problems(std::size_t size, const RawFindings& out) {
    return {{}, {}, {}, {}, {}, {}, {}, out, size};
}

/// Which lengths are asked for: t*, in lengths of the direction, the distance t* |d|, or both.
enum class Wanted { parameter, distance, both };

/// Directions to be made unit: whole packs.
struct RawDirections {
    const double* in[3];
    double* out[3];
    std::uint8_t* settled;  ///< 0 or 1
    bool binary32;          ///< rounded to binary32; else to binary64
    double scale;           ///< of the errors that the lemma allows for: 1, but where a test widens them
    std::size_t size;
};

/// What proves answers, by [Wanted].
struct StageKernels {
    void (*binary64[3])(const RawProblems<float>&);        ///< binary32 inputs
    void (*double_double[3])(const RawProblems<double>&);  ///< one word a number
    void (*of_two_words[3])(const RawProblems<double>&);   ///< two
};

/// The stages of one shape.
struct RawStages {
    StageKernels ahead;                             ///< of rays of which all counts that lies ahead
    StageKernels ranged;                            ///< of rays with a range
    void (*unit_directions)(const RawDirections&);  ///< the same for every shape
};

/// One function a register width, each in an object of its own: those of every shape, in the order of the list.
void fill_stages_w128(RawStages* of_shape);
void fill_stages_w256(RawStages* of_shape);
void fill_stages_w512(RawStages* of_shape);

}  // namespace lostbits::measure::stages
