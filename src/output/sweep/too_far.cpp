// The part of a sweep in which an ulp is as long as the sphere is wide.
#include "output/sweep/sweep_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lostbits::output::sweep {

namespace {

constexpr double relative_bracket = 0x1p-9;  // the bisection ends when its bracket is this narrow
/// Largest number of steps of the bisection. On a linear axis whose ends are n octaves apart, it needs n + 9 steps; on
/// a logarithmic axis, fewer.
constexpr int max_steps = 60;

bool is_too_far(const scene::sweep::SweepFile& sweep, const FloatFormat& format, double value) {
    const auto groups = sweep.rays({value});
    if (groups.empty() || groups.front().primitives.size() != 1 || groups.front().rays.size() == 0) return false;
    const Primitive<double>& primitive = groups.front().primitives.front();
    if (!row_of(primitive.shape).is_ball) return false;
    const auto [centre, radius] = ball_around(primitive);
    const Vec<double> to_centre = centre - groups.front().rays[0].origin;
    // The nearest point is |distance to the centre − r| away, also for an eye inside the sphere.
    const double distance = std::fabs(std::hypot(to_centre.x, to_centre.y, to_centre.z) - radius);
    if (!(distance > 0) || !std::isfinite(distance)) return false;
    return std::ldexp(1, static_cast<int>(ulp_exponent(format, std::ilogb(distance)))) >= 2 * radius;
}

}  // namespace

double drawn_quantile(const FormSummary& summary, std::size_t metric, double q) {
    return summary.agreement().is_enough() ? summary.metrics[metric].quantile(q)
                                           : std::numeric_limits<double>::quiet_NaN();
}

std::string gap_text() {
    return fmt::format("no value where fewer than {:.0f} % of the hits agree", 100 * measure::metric::min_agreement);
}

std::optional<AxisPart> too_far_part(const scene::sweep::SweepFile& sweep, const FloatFormat& format) {
    const scene::sweep::Axis& axis = sweep.axes.front();
    const auto [low, high] = std::ranges::minmax(axis.values);
    const auto is_far = [&](double value) { return is_too_far(sweep, format, value); };
    const bool is_far_at_low = is_far(low);
    const bool is_far_at_high = is_far(high);
    if (is_far_at_low && is_far_at_high) return AxisPart{low, high};
    if (!is_far_at_low && !is_far_at_high) return {};

    // Bisect between the end that is near and the end that is too far.
    double near_end = is_far_at_low ? high : low;
    double far_end = is_far_at_low ? low : high;
    for (int k = 0; k < max_steps && std::fabs(far_end - near_end) > relative_bracket * std::fabs(far_end); ++k) {
        const double middle = axis.middle(near_end, far_end);
        if (middle == near_end || middle == far_end) break;
        (is_far(middle) ? far_end : near_end) = middle;
    }
    return is_far_at_low ? AxisPart{low, far_end} : AxisPart{far_end, high};
}

void add_shade_and_notes(plot::LinePlotSpec& spec, const MeasuredSweep& sweep, const Format& format,
                         bool is_over_hits) {
    if (const auto part = too_far_part(sweep.request.sweep, format.parameters)) {
        // Built in place, because gcc 12 warns without cause about a moved temporary.
        plot::PlotShade& shade = spec.shades.emplace_back();
        shade.from = part->from;
        shade.to = part->to;
        shade.label = too_far_text;
    }

    const auto is_withheld = [&](const SweepStep& step) {
        for (std::size_t r = 0; r < step.summaries.size(); ++r) {
            const FormSummary& s = step.summaries[r];
            if (sweep.request.tested_forms[r].format == format && s.true_hit_count > 0 && !s.agreement().is_enough())
                return true;
        }
        return false;
    };
    if (is_over_hits && std::ranges::any_of(sweep.steps, is_withheld))
        spec.notes.push_back("A gap in a line means " + gap_text() + ".");
}

}  // namespace lostbits::output::sweep
