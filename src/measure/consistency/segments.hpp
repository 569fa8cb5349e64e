// A segment between two stored points as a ray with an end, in the two ways that renderers write it.
#pragma once

#include <span>

#include "measure/consistency/check.hpp"
#include "measure/truth/truth.hpp"

namespace lostbits::measure::consistency {

/// Up to q, or to 1 − 1e-4 of the way, as pbrt's shadow rays end (its ShadowEpsilon).
enum class EndOfSegment : std::uint8_t { whole, shortened };

struct SegmentInTwoWays {
    Ray<double> by_difference;  ///< direction q − p, rounded once
    double difference_end = 1;
    Ray<double>
        by_unit;  ///< direction (q − p)/|q − p| as the format computes it: three products, two sums, root, quotients
    double unit_end = 1;  ///< |q − p| as computed, times the share of the way
};

/// p and q are numbers of the format.
SegmentInTwoWays write_segment(const Vec<double>& p, const Vec<double>& q, const Format& format, EndOfSegment end);

/// Whether a ray that ends there truly meets any of the solids: a sphere at 0 < t < end, a closed (or
/// open) box at 0 ≤ t ≤ end (or <). Of boxes the form is told the end and is held to what it says of touching.
truth::Truth::Decision truly_meets_before(const Ray<double>& ray, double end, std::span<const Solid<double>> solids,
                                          intersect::Convention convention);

}  // namespace lostbits::measure::consistency
