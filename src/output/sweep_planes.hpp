// The planes of sweeps with two axes: a picture and an EXR a row.
#pragma once

#include <filesystem>

#include "measure/sweep.hpp"
#include "output/image.hpp"
#include "output/plot_axis.hpp"

namespace lostbits::output {

/// A sweep's axis as a plot shows it.
Axis plot_axis(const scene::Axis& axis);
/// Rays with a wrong decision or NaN, among all.
double wrong_share(const MapSummary& s);

/// `<form>.<format>.png`: the 99th percentile of lost bits, the colour of the most frequent wrong outcome where most rays
/// have one, paler where the envelope explains the loss. `<form>.<format>.exr`: columns are the first axis's values in
/// rising order, rows the second's from the top, the highest first; the values stand in the attributes.
void write_plane(ImageBackend& backend, const std::filesystem::path& folder, const SweepRequest& request, const std::vector<SweepStep>& steps, std::size_t row);

/// The picture alone.
void write_plane_picture(ImageBackend& backend, const std::filesystem::path& path, const SweepRequest& request, const std::vector<SweepStep>& steps, std::size_t row);

}  // namespace lostbits::output
