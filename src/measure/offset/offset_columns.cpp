// The columns of the summary of offsets.

#include "measure/offset/offsets.hpp"

namespace lostbits::measure::offset {

using metric::Distribution;
using truth::fraction;

namespace {

using S = OffsetSummary;

double number(std::uint64_t n) { return static_cast<double>(n); }

const StrategySummary& of(const S& s, Side side, std::size_t k) { return s.on(side).strategies[k]; }

template <Fault f>
double share(const S& s, Side side, std::size_t k) {
    return fraction(of(s, side, k)[f], s.on(side).rays);
}

template <Distribution SideSummary::*d, int percent>
double needed(const S& s, Side side, std::size_t) {
    return (s.on(side).*d).quantile(percent / 100.0);
}

template <Distribution StrategySummary::*d, int percent>
double taken(const S& s, Side side, std::size_t k) {
    return (of(s, side, k).*d).quantile(percent / 100.0);
}

template <std::uint64_t SideSummary::*n>
double share_of_points(const S& s, Side side, std::size_t) {
    return fraction(s.on(side).*n, s.points);
}

using D = SideSummary;
using E = StrategySummary;

constexpr OffsetColumn table[] = {
    {"points", "", "pixels where the form answers the solid that the ray truly meets first, and the point is finite",
     true, [](const S& s, Side, std::size_t) { return number(s.points); }},
    {"rays", "", "respawned rays of these points to this side", true,
     [](const S& s, Side side, std::size_t) { return number(s.on(side).rays); }},
    {"bad_fraction", "", "share of rays with any fault but a start on the wrong side, which alone harms nothing", false,
     [](const S& s, Side side, std::size_t k) { return fraction(of(s, side, k).bad, s.on(side).rays); }},
    {"self_hit_fraction", "",
     "share of rays that meet by truth the solid that they leave, but for its far wall; into the solid: the surface at "
     "which they start",
     false, share<Fault::self_hit>},
    {"self_hit_by_form_fraction", "", "share of rays of which the form's own arithmetic says so", false,
     share<Fault::self_hit_by_form>},
    {"lost_occluder_fraction", "",
     "share of rays that start behind the surface of another solid, or a far wall of their own, which they should have "
     "met",
     false, share<Fault::lost_occluder>},
    {"begins_in_neighbour_fraction", "",
     "share of rays that start inside another solid, whose point does not lie there", false,
     share<Fault::begins_in_neighbour>},
    {"lost_exit_fraction", "", "share of rays into the solid that are by truth past its far side, or never ask it",
     false, share<Fault::lost_exit>},
    {"lost_exit_by_form_fraction", "", "share of rays into the solid for which the form tells no way out", false,
     share<Fault::lost_exit_by_form>},
    {"wrong_side_fraction", "", "share of rays that start inside the solid (outside), or not in it (inside)", false,
     share<Fault::wrong_side>},
    {"not_finite_fraction", "", "share of rays whose new origin is not finite", false, share<Fault::not_finite>},
    {"offset_p50", "world units", "median of the largest way from p to a new origin, of each point", false,
     taken<&E::size, 50>},
    {"offset_max", "world units", "the largest of them", false, taken<&E::size, 100>},
    {"oversize_points", "", "points whose smallest safe offset is finite and not 0", true,
     [](const S& s, Side side, std::size_t k) { return number(of(s, side, k).oversize.count()); }},
    {"oversize_p50", "", "of these, how many times larger the offset is than the smallest safe one: median", false,
     taken<&E::oversize, 50>},
    {"oversize_p99", "", "the same: 99th percentile", false, taken<&E::oversize, 99>},
    {"oversize_max", "", "the same: largest", false, taken<&E::oversize, 100>},
    {"too_small_fraction", "", "share of these points whose offset is less than the smallest safe one", false,
     [](const S& s, Side side, std::size_t k) {
         return fraction(of(s, side, k).too_small, of(s, side, k).oversize.count());
     }},
    {"already_safe_fraction", "", "share of points that need no offset", false, share_of_points<&D::already_safe>},
    {"never_safe_fraction", "", "share of points that no offset along the normal makes safe", false,
     share_of_points<&D::never_safe>},
    {"safe_p50", "world units", "smallest safe offset of the points that have one, 0 among them: median", false,
     needed<&D::safe, 50>},
    {"safe_p99", "world units", "the same: 99th percentile", false, needed<&D::safe, 99>},
    {"safe_max", "world units", "the same: largest", false, needed<&D::safe, 100>},
    {"safe_ulps_p50", "ulp", "the same in ulps of the largest coordinate of p: median", false,
     needed<&D::safe_ulps, 50>},
    {"safe_ulps_p99", "ulp", "the same: 99th percentile", false, needed<&D::safe_ulps, 99>},
    {"safe_ulps_max", "ulp", "the same: largest", false, needed<&D::safe_ulps, 100>},
    {"never_quiet_fraction", "",
     "share of points that no offset along the normal makes safe with the form's own arithmetic as well", false,
     share_of_points<&D::never_quiet>},
    {"quiet_p50", "world units", "smallest offset that is safe by truth and by the form's arithmetic: median", false,
     needed<&D::quiet, 50>},
    {"quiet_p99", "world units", "the same: 99th percentile", false, needed<&D::quiet, 99>},
    {"quiet_max", "world units", "the same: largest", false, needed<&D::quiet, 100>},
};

}  // namespace

std::span<const OffsetColumn> offset_columns() { return table; }

}  // namespace lostbits::measure::offset
