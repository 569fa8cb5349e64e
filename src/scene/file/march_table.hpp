// The constants of sphere tracing in scene and sweep files.
#pragma once

#include <string>
#include <vector>

#include "intersect/march.hpp"
#include "number/format.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::file {

/// Reads `[march]`; a missing hit_eps, max_steps or max_dist is as SDF Sphere Marching (lesson P0-C1) has it.
/// InputError with a position for anything out of range, also in binary32 where inputs are shared.
intersect::MarchConstants<Real> read_march(toml::TableReader table, Inputs inputs);

/// Each constant rounded once to F.
intersect::MarchConstants<double> round_march(const intersect::MarchConstants<Real>& ideal, const FloatFormat& f);
intersect::MarchConstants<double> round_march(const intersect::MarchConstants<double>& constants, const FloatFormat& f);

/// The constants that F makes 0 or infinity of, in words: "hit_eps = 1e-09 rounds to 0". A form is given them all the
/// same: what it makes of them is for the measurement to say.
std::vector<std::string> lost_constants(const Scene& scene, const FloatFormat& f);

}  // namespace lostbits::scene::file
