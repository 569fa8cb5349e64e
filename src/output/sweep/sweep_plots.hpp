// The pictures of a sweep, lines along one axis or a plane over two, and where their numbers stop meaning anything.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "measure/sweep/sweep.hpp"
#include "output/plot/line_plot.hpp"

namespace lostbits::output::sweep {

/// A sweep and what was found along it.
struct MeasuredSweep {
    const measure::sweep::SweepRequest& request;
    const std::vector<measure::sweep::SweepStep>& steps;
    const std::vector<measure::sweep::Onset>& onsets;
};

/// The formats of its rows, each once.
[[nodiscard]] std::vector<Format> formats_of(const MeasuredSweep& sweep);
/// A sweep's axis as a plot shows it.
plot::AxisSpec plot_axis(const scene::sweep::Axis& axis);
/// Rays with a wrong decision or NaN, among all.
double wrong_share(const measure::evaluate::FormSummary& s);

/// One axis: `lost_bits_p50.<format>.png` and `lost_bits_p99.<format>.png` with every form, the conditioning envelope
/// (inherent bits, where the request measures them) and the sweep's own marks; `false_hit.<format>.png` and
/// `false_miss.<format>.png`, the share of rays that are so, and the same of other wrong outcomes that occur; where
/// culprits are measured, `culprit.<form>.<format>.png`, and where steps of spaces are, `steps.<form>.<format>.png`
/// with the place where the median of each is first seen to be an ulp. Two axes: see `write_planes`, which alone asks
/// for `singles`.
void write_sweep_plots(const std::filesystem::path& folder, const MeasuredSweep& sweep, bool singles = false);

/// Of a picture, in pixels.
struct PlotSize {
    int width = 1100, height = 620;
};

/// One of them: the quantile q (0.5 or 0.99) of lost bits in one format.
void write_lost_bits_plot(const std::filesystem::path& path, const MeasuredSweep& sweep, const Format& format, double q,
                          PlotSize size = {});

/// The share of rays with one wrong outcome, in one format, on a log axis, below which 0 has its place.
void write_wrong_plot(const std::filesystem::path& path, const MeasuredSweep& sweep, const Format& format,
                      measure::answer::Outcome outcome, PlotSize size = {});

/// The outcomes that have such a plot: false hits and false misses, and of the other wrong ones those that occur.
[[nodiscard]] std::vector<measure::answer::Outcome> wrong_outcomes(const MeasuredSweep& sweep, const Format& format);
/// `False hits`
[[nodiscard]] std::string wrong_title(measure::answer::Outcome outcome);

/// The steps of a sweep over two axes as a plane: columns by rising first axis, lines by rising second.
class SweepGrid {
public:
    SweepGrid(const measure::sweep::SweepRequest& request, const std::vector<measure::sweep::SweepStep>& steps);
    /// The numbers of one row of the request.
    [[nodiscard]] const measure::evaluate::FormSummary& at(std::size_t row, std::size_t column, std::size_t line) const;
    std::vector<double> x, y;

private:
    const std::vector<measure::sweep::SweepStep>& steps_;
    bool x_falls_, y_falls_;
};

/// What the outline in a plane says, here and on the page.
inline constexpr const char* outlined_means =
    "Outlined: the form loses a bit or more beyond what half an ulp in each input would cost";
inline constexpr const char* nowhere_outlined =
    "Nowhere does the form lose a bit beyond what half an ulp in each input would cost";

/// `contact.png`: a plane of each form and format. With `singles` also each alone, `<form>.<format>.png`: the 99th
/// percentile of lost bits, the colour of the most frequent wrong outcome where most rays have one, outlined where the
/// form is to blame, hatched where too few hits agree. `<form>.<format>.exr`: columns are the first axis's values in
/// rising order, rows the second's from the top, the highest first; the values stand in the attributes.
void write_planes(const std::filesystem::path& folder, const measure::sweep::SweepRequest& request,
                  const std::vector<measure::sweep::SweepStep>& steps, bool singles);
/// One of the single pictures.
void write_plane_picture(const std::filesystem::path& path, const measure::sweep::SweepRequest& request,
                         const std::vector<measure::sweep::SweepStep>& steps, std::size_t row);
/// The sheet. A step has one colour there, paler in place of an outline around the others (`map::paler_means`).
void write_plane_sheet(const std::filesystem::path& path, const measure::sweep::SweepRequest& request,
                       const std::vector<measure::sweep::SweepStep>& steps);

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
