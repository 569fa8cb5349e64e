// Rays and boxes chosen to break a slab test: each distribution aims at one way of being wrong.
#pragma once

#include <string>

#include "measure/seeded.hpp"

namespace lostbits::test {

struct BoxSample {
    Ray<double> ray;
    Box<double> box;
    double tmax = HUGE_VAL;
    double tmin = 0;
    OpenEnds open_ends = {};

    [[nodiscard]] Range<double> range() const { return {tmin, tmax, open_ends}; }
};

struct BoxDistribution {
    const char* name;
    /// Checked exactly, so that a generator that misses its aim is a failure too.
    enum class Promise {
        none,
        touches,      ///< the line meets the closed box and not the open one
        inside,       ///< the origin lies in the open box
        on_boundary,  ///< the origin lies in the closed box and not in the open one
        flat,         ///< the box has no inside
        at_end,       ///< the ray ends exactly where it enters
    } promise;
    BoxSample (*draw)(Seeded&, const FloatFormat& storage);
    int ray_count;  ///< for each storage format
};

extern const BoxDistribution box_distributions[19];

/// The inputs as C++ that compiles.
std::string paste(const BoxSample& sample);

}  // namespace lostbits::test
