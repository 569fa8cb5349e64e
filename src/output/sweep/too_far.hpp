// Where a plot's numbers stop meaning anything: too few hits for a quantile, or a sphere that is too far for any t.
#pragma once

#include <optional>
#include <string>

#include "measure/evaluate/evaluate.hpp"
#include "output/plot/line_plot.hpp"
#include "output/sweep/sweep_plots.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::output::sweep {

/// A quantile of a metric over agreed hits; NaN, which is a gap in a line, where too few hits agree.
[[nodiscard]] double drawn_quantile(const measure::evaluate::FormSummary& s, std::size_t metric, double q);
/// What a gap is, here and on the page.
[[nodiscard]] std::string gap_means();

/// The part of an axis, ends included.
struct AxisPart {
    double from, to;
};

/// Where along a sweep of one axis an ulp of the distance D of the one sphere is at least as long as the sphere is
/// wide: ulp_F(D) ≥ 2r, which is from 2^p radii on. No t along a unit direction then tells front from back, whatever
/// the form. Found by bisection, to 2^-9 of the value, of the first ray: rays of a family are all as far away as each
/// other. Nothing where that is so at neither end of the axis, and where there is not one sphere.
[[nodiscard]] std::optional<AxisPart> too_far(const scene::sweep::SweepFile& sweep, const FloatFormat& format);
inline constexpr const char* too_far_means = "shaded: an ulp of the distance is as wide as the sphere, or wider";

/// Both in a plot along a sweep: what is too far is shaded, and gaps, which lines over agreed hits have, are explained.
void shade_and_note(plot::LinePlotSpec& spec, const MeasuredSweep& sweep, const Format& format, bool over_hits);

}  // namespace lostbits::output::sweep
