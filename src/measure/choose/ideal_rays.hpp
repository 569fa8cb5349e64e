// Rays and primitives in exact numbers, without a camera. They can be stored in formats and stretched.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "measure/truth/band.hpp"
#include "number/real.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::measure::choose {

/// Quantity that grows by a factor while the other quantities stay.
enum class Growth {
    distance,  ///< from the eye to the primitives, straight back along the view; a narrower view keeps their size in
               ///< the picture
    radius,    ///< of each primitive, about its point nearest to the eye, which stays in place
    offset,    ///< eye and primitives together move away from the origin, along (1, 11/16, −7/16)
    view       ///< the tangent of half the field of view
};
inline constexpr std::array<std::string_view, 4> growth_names{"distance", "radius", "offset", "view"};
inline constexpr std::array growths{Growth::distance, Growth::radius, Growth::offset, Growth::view};

struct IdealRays {
    scene::rays::IdealRayBlock rays;
    std::vector<Primitive<Real>> primitives;
    bool is_paired = false;  ///< ray i is aimed only at primitive i

    [[nodiscard]] truth::Band band(truth::ProofLimit limit) const {
        return truth::Band(rays, primitives, is_paired, limit);
    }
};

/// Returns the rays of a file, whose numbers are taken as exact.
IdealRays make_ideal_rays(const scene::rays::RayGroup& group);
/// Returns the rays of a scene before any format rounds them. The scene must not be a flake.
IdealRays make_ideal_rays(const scene::file::Scene& scene);

/// Rounds every number once to the format.
scene::rays::RayGroup store_in_format(const IdealRays& ideal, const FloatFormat& format);

/// Groups of the numbers of a ray and its primitive; each can be stored in a format of its own. `place` is the centre
/// of a sphere and the corners of a box; a box has no `radius`.
enum class Input { origin, direction, place, radius };
inline constexpr std::array input_kinds{Input::origin, Input::direction, Input::place, Input::radius};
/// Format of each group; absent: the numbers stay ideal.
using InputFormats = std::array<std::optional<FloatFormat>, input_kinds.size()>;
/// Rounds the numbers of each group to its format.
IdealRays round_inputs(const IdealRays& ideal, const InputFormats& formats);

struct StretchedRays {
    IdealRays rays;
    double value;  ///< distance: median from the origins to the primitives' centres; others as in `StretchedScene`
};

/// Stretches rays by one kind of growth; `factor` k ≥ 1.
///
/// - `distance`: each ray starts farther back on its own line. The point on the line that is nearest to the centre of
/// its primitive (of all primitives, if rays share several) is then k times as far away. Rays whose primitive lies
/// behind them stay.
/// - `radius`: each primitive grows about its point nearest to the origin of its ray, so rays that share one primitive
/// then have one each. If rays share several, each primitive grows about its point nearest to the mean of all origins.
/// - `offset`: rays and primitives move together, by (k − 1) times the median distance.
///
/// Returns nothing if the growth does not apply: `view`, `distance` if the primitives lie behind all rays, `radius` if
/// the point that stays is the centre of a sphere.
std::optional<StretchedRays> stretch(const IdealRays& rays, Growth growth, double factor);

}  // namespace lostbits::measure::choose
