// The constants of sphere tracing in scene and sweep files.
#pragma once

#include "intersect/march.hpp"
#include "number/format.hpp"
#include "number/real.hpp"
#include "scene/scene.hpp"
#include "scene/toml_reader.hpp"

namespace lostbits::scene {

/// Reads `[march]`. Where a key is missing: hit_eps 0.001, max_steps 64 and max_dist 20 as seed 003 has them; relative_eps and cone
/// 0.001, over_relaxation 1.4, secant_steps 2, bisect_steps 16. InputError with a position for anything out of range: lengths and
/// thresholds > 0 (also in binary32 where inputs are shared), over_relaxation in [1, 2), counts in [1, 100000] and [0, 200].
MarchConstants<Real> read_march(TableReader table, Inputs inputs);

/// Each constant rounded once to F.
MarchConstants<double> round_march(const MarchConstants<Real>& ideal, const FloatFormat& f);
MarchConstants<double> round_march(const MarchConstants<double>& constants, const FloatFormat& f);

}  // namespace lostbits::scene
