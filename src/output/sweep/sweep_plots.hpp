// The pictures of a sweep: lines along one axis, a plane over two.
#pragma once

#include <filesystem>

#include "measure/sweep/sweep.hpp"

namespace lostbits::output::sweep {

/// A sweep and what was found along it.
struct MeasuredSweep {
    const measure::sweep::SweepRequest& request;
    const std::vector<measure::sweep::SweepStep>& steps;
    const std::vector<measure::sweep::Onset>& onsets;
};

/// The formats of its rows, each once.
[[nodiscard]] std::vector<Format> formats_of(const MeasuredSweep& sweep);

/// One axis: `lost_bits_p50.<format>.png` and `lost_bits_p99.<format>.png` with every form, the conditioning envelope
/// (inherent bits, where the request measures them) and the sweep's own marks; `false_hit.<format>.png` and
/// `false_miss.<format>.png`, the share of rays that are so, and the same of other wrong outcomes that occur; where
/// culprits are measured, `culprit.<form>.<format>.png`, and where steps of spaces are, `steps.<form>.<format>.png`
/// with the place where the median of each is first seen to be an ulp. Two axes:
/// `<form>.<format>.png`, the p99 of lost bits over the plane, with the colour of the commonest wrong outcome where
/// more than half of the rays are wrong.
void write_sweep_plots(const std::filesystem::path& folder, const MeasuredSweep& sweep);

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

}  // namespace lostbits::output::sweep
