// Columns of the summary of offsets.

#include "measure/offset/offsets.hpp"

namespace lostbits::measure::offset {

using metric::Distribution;
using truth::fraction;

namespace {

using S = OffsetSummary;

double to_double(std::uint64_t n) { return static_cast<double>(n); }

const StrategySummary& strategy_of(const S& s, Side side, std::size_t k) { return s.side_summary(side).strategies[k]; }

template <Fault f>
double fault_fraction(const S& s, Side side, std::size_t k) {
    return fraction(strategy_of(s, side, k)[f], s.side_summary(side).rays);
}

template <Distribution SideSummary::*d, int percent>
double side_percentile(const S& s, Side side, std::size_t) {
    return (s.side_summary(side).*d).quantile(percent / 100.0);
}

template <Distribution StrategySummary::*d, int percent>
double offset_percentile(const S& s, Side side, std::size_t k) {
    return (strategy_of(s, side, k).*d).quantile(percent / 100.0);
}

template <std::uint64_t SideSummary::*n>
double fraction_of_points(const S& s, Side side, std::size_t) {
    return fraction(s.side_summary(side).*n, s.points);
}

using OfSide = SideSummary;
using OfStrategy = StrategySummary;

constexpr OffsetColumn table[] = {
    {"points", "", "pixels where the form hits the primitive that the ray truly hits first, and the point is finite",
     true, [](const S& s, Side, std::size_t) { return to_double(s.points); }},
    {"rays", "", "next rays that leave these points to this side", true,
     [](const S& s, Side side, std::size_t) { return to_double(s.side_summary(side).rays); }},
    {"bad_fraction", "", "share of rays with any fault other than a start on the wrong side, which alone harms nothing",
     false,
     [](const S& s, Side side, std::size_t k) {
         return fraction(strategy_of(s, side, k).bad_rays, s.side_summary(side).rays);
     }},
    {"self_hit_fraction", "",
     "share of rays that truly meet the primitive that they leave, except for its far wall; for rays into the "
     "primitive: the surface at which they start",
     false, fault_fraction<Fault::self_hit>},
    {"self_hit_by_form_fraction", "", "share of rays with a self-hit by the form's own arithmetic", false,
     fault_fraction<Fault::self_hit_by_form>},
    {"lost_occluder_fraction", "",
     "share of rays that start behind a surface that they should have met: that of another primitive, or a far wall of "
     "their own",
     false, fault_fraction<Fault::lost_occluder>},
    {"begins_in_neighbour_fraction", "",
     "share of rays that start inside another primitive, though their point does not lie there", false,
     fault_fraction<Fault::begins_in_neighbour>},
    {"lost_exit_fraction", "",
     "share of rays into the primitive that truly start past its far side, or are not tested against it", false,
     fault_fraction<Fault::lost_exit>},
    {"lost_exit_by_form_fraction", "", "share of rays into the primitive for which the form finds no exit", false,
     fault_fraction<Fault::lost_exit_by_form>},
    {"wrong_side_fraction", "",
     "share of rays to the outside that start inside the primitive, or of rays to the inside that do not start in it",
     false, fault_fraction<Fault::wrong_side>},
    {"not_finite_fraction", "", "share of rays whose new origin is not finite", false,
     fault_fraction<Fault::not_finite>},
    {"offset_p50", "world units", "median over the points of the largest distance from p to a new origin", false,
     offset_percentile<&OfStrategy::offset_size, 50>},
    {"offset_max", "world units", "maximum over the points of the largest distance from p to a new origin", false,
     offset_percentile<&OfStrategy::offset_size, 100>},
    {"oversize_points", "", "points whose smallest safe offset is finite and not 0", true,
     [](const S& s, Side side, std::size_t k) { return to_double(strategy_of(s, side, k).size_ratio.count()); }},
    {"oversize_p50", "", "of these, how many times larger the offset is than the smallest safe one: median", false,
     offset_percentile<&OfStrategy::size_ratio, 50>},
    {"oversize_p99", "", "the same: 99th percentile", false, offset_percentile<&OfStrategy::size_ratio, 99>},
    {"oversize_max", "", "the same: largest", false, offset_percentile<&OfStrategy::size_ratio, 100>},
    {"too_small_fraction", "", "share of these points whose offset is less than the smallest safe one", false,
     [](const S& s, Side side, std::size_t k) {
         return fraction(strategy_of(s, side, k).too_small_points, strategy_of(s, side, k).size_ratio.count());
     }},
    {"already_safe_fraction", "", "share of points that need no offset", false,
     fraction_of_points<&OfSide::already_safe_points>},
    {"never_safe_fraction", "", "share of points that no offset along the normal makes safe", false,
     fraction_of_points<&OfSide::never_safe_points>},
    {"safe_p50", "world units", "smallest safe offset of the points that have one, 0 among them: median", false,
     side_percentile<&OfSide::safe_offset, 50>},
    {"safe_p99", "world units", "the same: 99th percentile", false, side_percentile<&OfSide::safe_offset, 99>},
    {"safe_max", "world units", "the same: largest", false, side_percentile<&OfSide::safe_offset, 100>},
    {"safe_ulps_p50", "ulp", "the same in ulps of the largest coordinate of p: median", false,
     side_percentile<&OfSide::safe_ulps, 50>},
    {"safe_ulps_p99", "ulp", "the same: 99th percentile", false, side_percentile<&OfSide::safe_ulps, 99>},
    {"safe_ulps_max", "ulp", "the same: largest", false, side_percentile<&OfSide::safe_ulps, 100>},
    {"never_quiet_fraction", "",
     "share of points that no offset along the normal makes safe both by truth and by the form's own arithmetic", false,
     fraction_of_points<&OfSide::never_quiet_points>},
    {"quiet_p50", "world units", "smallest offset that is safe by truth and by the form's arithmetic: median", false,
     side_percentile<&OfSide::quiet_offset, 50>},
    {"quiet_p99", "world units", "the same: 99th percentile", false, side_percentile<&OfSide::quiet_offset, 99>},
    {"quiet_max", "world units", "the same: largest", false, side_percentile<&OfSide::quiet_offset, 100>},
};

}  // namespace

std::span<const OffsetColumn> offset_columns() { return table; }

}  // namespace lostbits::measure::offset
