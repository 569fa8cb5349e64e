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

/// Reads `[march]`. Where a key is missing: hit_eps 0.001, max_steps 64 and max_dist 20 as SDF Sphere Marching (lesson
/// P0-C1) has them; relative_eps and cone 0.001, over_relaxation 1.4, secant_steps 2, bisect_steps 16. InputError with
/// a position for anything out of range: lengths and thresholds > 0 (also in binary32 where inputs are shared),
/// over_relaxation in [1, 2), counts in [1, 100000] and [0, 200].
intersect::MarchConstants<Real> read_march(toml::TableReader table, Inputs inputs);

/// Each constant rounded once to F.
intersect::MarchConstants<double> round_march(const intersect::MarchConstants<Real>& ideal, const FloatFormat& f);
intersect::MarchConstants<double> round_march(const intersect::MarchConstants<double>& constants, const FloatFormat& f);

/// The constants that F makes 0 or infinity of, in words: "hit_eps = 1e-09 rounds to 0". A form is given them all the
/// same: what it makes of them is for the measurement to say.
std::vector<std::string> lost_constants(const Scene& scene, const FloatFormat& f);

}  // namespace lostbits::scene::file
