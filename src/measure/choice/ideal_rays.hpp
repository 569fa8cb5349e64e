// Rays and solids as exact numbers, without a camera: stored in formats, and stretched.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "measure/truth/band.hpp"
#include "number/real.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::choice {

/// What grows by a factor while the rest stays.
enum class Growth {
    distance,  ///< from the eye to the solids, straight back along the view; a narrower view keeps the picture
    radius,    ///< of each solid, about its point nearest to the eye, which stays where it is
    offset,    ///< eye and solids together move away from the origin, along (1, 11/16, −7/16)
    view       ///< the tangent of half the field of view
};
inline constexpr std::array<std::string_view, 4> growth_names{"distance", "radius", "offset", "view"};
inline constexpr std::array growths{Growth::distance, Growth::radius, Growth::offset, Growth::view};

struct IdealRays {
    scene::rays::IdealRayBlock rays;
    std::vector<Solid<Real>> solids;
    bool paired = false;  ///< ray i is aimed at solid i alone

    [[nodiscard]] truth::Band band(truth::TruthLimit limit) const { return truth::Band(rays, solids, paired, limit); }
};

/// Those of a file: its numbers are exact.
IdealRays ideal_of(const scene::rays::RayGroup& group);
/// Those of a scene before any format rounds them; a scene without a flake.
IdealRays ideal_of(const scene::file::Scene& scene);

/// Every number rounded once to the format.
scene::rays::RayGroup stored(const IdealRays& ideal, const FloatFormat& format);

/// Where the numbers of a ray and its solid come from: what can be stored in a format of its own. `place` is the centre
/// of a sphere and the corners of a box; a box has no `radius`.
enum class Input { origin, direction, place, radius };
inline constexpr std::array input_kinds{Input::origin, Input::direction, Input::place, Input::radius};
/// The format of each; nothing: the ideal number.
using InputFormats = std::array<std::optional<FloatFormat>, input_kinds.size()>;
/// The numbers as these formats hold them.
IdealRays rounded(const IdealRays& ideal, const InputFormats& formats);

struct StretchedRays {
    IdealRays rays;
    double value;  ///< distance: the median from the origins to the solids' middle; others as in `Stretched`
};

/// Rays stretched one way, `factor` ≥ 1. `distance`: each starts farther back on its own line, as far as takes the
/// place on it that is nearest to the middle of its solid (of all, where they share several) k times away; rays whose
/// solid lies behind them stay. `radius`: each solid about its point nearest to the origin of its ray, so that rays
/// that share one have one each then; rays that share several, about that nearest to the mean of all origins. `offset`:
/// all of it, (k − 1) times the median distance. Nothing where a way means nothing: no view, no distance of solids
/// behind all rays, no radius about a centre.
std::optional<StretchedRays> stretched(const IdealRays& rays, Growth way, double factor);

}  // namespace lostbits::measure::choice
