// Reads the constants of sphere tracing from scene and sweep files, and rounds them to formats.
#pragma once

#include <string>
#include <vector>

#include "intersect/march.hpp"
#include "number/format.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::file {

/// Reads `[march]`. A missing hit_eps, max_steps or max_dist has the value of SDF Sphere Marching (lesson P0-C1).
/// Throws InputError with a position for anything out of range, also in binary32 if inputs are shared.
intersect::MarchConstants<Real> read_march(toml::TableReader table, InputRounding inputs);

/// Rounds each constant once to F.
intersect::MarchConstants<double> round_march(const intersect::MarchConstants<Real>& ideal, const FloatFormat& format);
intersect::MarchConstants<double> round_march(const intersect::MarchConstants<double>& constants,
                                              const FloatFormat& format);

/// The constants that F rounds to 0 or infinity, in words: "hit_eps = 1e-09 rounds to 0". A form receives these
/// constants anyway, and the measurement shows what the form makes of them.
std::vector<std::string> find_unrepresentable_constants(const Scene& scene, const FloatFormat& format);

}  // namespace lostbits::scene::file
