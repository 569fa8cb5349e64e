// Where a plot's numbers stop meaning anything: too few hits for a quantile, or a sphere that is too far for any t.
#pragma once

#include <optional>
#include <string>

#include "measure/map/map.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::output::sweep {

/// A quantile of a metric over agreed hits; NaN, which is a gap in a line, where too few hits agree.
[[nodiscard]] double drawn_quantile(const measure::map::MapSummary& s, std::size_t metric, double q);
/// What a gap is, here and on the page.
[[nodiscard]] std::string gap_means();

/// The part of an axis, ends included.
struct AxisPart {
    double from, to;
};

/// Where along a sweep of one axis an ulp of t is at least as long as the one sphere is wide: ulp_F(t)·|d| ≥ 2r, with t
/// of the sphere's nearest point. No t of the format then tells front from back, whatever the form. Found by bisection,
/// to 2^-9 of the value; of random rays by the first. Nothing where that never happens, where it happens away from both
/// ends alone, and where there is not one sphere.
[[nodiscard]] std::optional<AxisPart> too_far(const scene::sweep::SweepFile& sweep, const FloatFormat& format);
inline constexpr const char* too_far_means = "shaded: an ulp of t is as wide as the sphere, or wider";

}  // namespace lostbits::output::sweep
