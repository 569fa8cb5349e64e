// Pictures of a sweep: lines along one axis or a plane over two, and the part of an axis where t cannot be resolved.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "measure/sweep/sweep.hpp"
#include "output/plot/line_plot.hpp"

namespace lostbits::output::sweep {

using measure::answer::Outcome;
using measure::evaluate::FormSummary;
using measure::sweep::SweepRequest;
using measure::sweep::SweepStep;

/// A sweep and its results.
struct MeasuredSweep {
    const SweepRequest& request;
    const std::vector<SweepStep>& steps;
    const std::vector<measure::sweep::Onset>& onsets;
};

/// The formats of the rows of a sweep, each once.
[[nodiscard]] std::vector<Format> list_formats(const MeasuredSweep& sweep);
/// Axis of a plot that shows an axis of a sweep.
plot::AxisSpec plot_axis(const scene::sweep::Axis& axis);
/// Axis of lost bits in the format called `name`: `lost bits, of 24 in f32`.
plot::AxisSpec lost_bits_axis(const FloatFormat& format, std::string_view name);
/// Fraction of the rays that have a wrong decision or NaN.
double wrong_fraction(const FormSummary& summary);

/// Writes the pictures of a sweep. For one axis: `lost_bits_p50.<format>.png` and `lost_bits_p99.<format>.png` with
/// every form, the conditioning envelope (inherent bits, if the request measures them) and the sweep's own marks;
/// `false_hit.<format>.png` and `false_miss.<format>.png` with the fractions of such rays, and the same for other wrong
/// outcomes that occur; `culprit.<form>.<format>.png` if culprits are measured; and `steps.<form>.<format>.png` if
/// steps of transforms are measured, with the value at which the median of each first reaches an ulp. For two axes see
/// `write_planes`; `draws_single_pictures` matters only there.
void write_sweep_plots(const std::filesystem::path& folder, const MeasuredSweep& sweep,
                       bool draws_single_pictures = false);

/// Size of a picture in pixels.
struct PlotSize {
    int width = 1100, height = 620;
};

/// Plot of the quantile q (0.5 or 0.99) of lost bits in one format.
image::Canvas draw_lost_bits_plot(const MeasuredSweep& sweep, const Format& format, double q, PlotSize size = {});

/// Plot of the fraction of rays with one wrong outcome in one format, on a log axis with 0 drawn below it.
image::Canvas draw_outcome_plot(const MeasuredSweep& sweep, const Format& format, Outcome outcome, PlotSize size = {});

/// True if any ray of a form in the format has the outcome.
[[nodiscard]] bool has_outcome(const MeasuredSweep& sweep, const Format& format, Outcome outcome);
/// Outcomes that have a plot of their own: false hits, false misses, and other wrong outcomes that occur.
[[nodiscard]] std::vector<Outcome> wrong_outcomes(const MeasuredSweep& sweep, const Format& format);
/// `False hits`
[[nodiscard]] std::string outcome_title(Outcome outcome);

/// The steps of a sweep over two axes as a plane. Columns are sorted by the first axis and lines by the second, both
/// rising.
class SweepGrid {
public:
    SweepGrid(const SweepRequest& request, const std::vector<SweepStep>& steps);
    /// Results of one row of the request (a form in a format) at a cell of the plane.
    [[nodiscard]] const FormSummary& at(std::size_t form_index, std::size_t x_index, std::size_t y_index) const;
    std::vector<double> x, y;

private:
    const std::vector<SweepStep>& steps_;
    bool x_falls_, y_falls_;
};

/// Meaning of the outline in a plane, here and on the page.
inline constexpr const char* outline_meaning =
    "Outlined: the form loses a bit or more beyond what half an ulp in each input would cost";
inline constexpr const char* no_outline_text =
    "Nowhere does the form lose a bit beyond what half an ulp in each input would cost";

/// Writes `contact.png`: a plane of each form and format. With `draws_single_pictures` also each plane alone, as
/// `<form>.<format>.png`: the 99th percentile of lost bits, or the colour of the most frequent wrong outcome if most
/// rays are wrong. A cell is outlined where the form, not the problem, loses the bits, and hatched where too few hits
/// agree. In `<form>.<format>.exr` the columns are the values of the first axis in rising order. The rows are the
/// values of the second axis, the highest at the top. The attributes hold the values.
void write_planes(const std::filesystem::path& folder, const SweepRequest& request, const std::vector<SweepStep>& steps,
                  bool draws_single_pictures);
/// The plane of one row of the request, as `write_planes` saves it.
image::Canvas draw_plane_picture(const SweepRequest& request, const std::vector<SweepStep>& steps,
                                 std::size_t form_index);
/// Writes the contact sheet of `write_planes`. On the sheet a step is one colour, and cells that the outline would not
/// enclose are paler instead (`map::paler_colour_meaning`).
void write_plane_sheet(const std::filesystem::path& path, const SweepRequest& request,
                       const std::vector<SweepStep>& steps);

/// Quantile of a metric over agreed hits; NaN, a gap in the line, if too few hits agree.
[[nodiscard]] double drawn_quantile(const FormSummary& summary, std::size_t metric, double q);
/// Meaning of a gap, here and on the page.
[[nodiscard]] std::string gap_text();

/// Part of an axis, with its ends.
struct AxisPart {
    double from, to;
};

/// Part of a sweep with one axis and one sphere in which an ulp of the distance D is at least as long as the sphere is
/// wide: ulp_F(D) ≥ 2r, that is, from 2^p radii on. There no form's t along a unit direction tells the front of the
/// sphere from its back.
/// Found by bisection to 2^-9 of the value, on the first ray; the rays of a distribution are all equally far away.
/// Nothing if neither end of the axis is in the part, or if there is not exactly one sphere.
[[nodiscard]] std::optional<AxisPart> too_far_part(const scene::sweep::SweepFile& sweep, const FloatFormat& format);
inline constexpr const char* too_far_text = "shaded: an ulp of the distance is at least as wide as the sphere";

/// Shades the part of `too_far_part` in a plot along a sweep. If `is_over_hits`, the lines are
/// quantiles over agreed hits, and a note explains their gaps if there are any.
void add_shade_and_notes(plot::LinePlotSpec& spec, const MeasuredSweep& sweep, const Format& format, bool is_over_hits);

}  // namespace lostbits::output::sweep
