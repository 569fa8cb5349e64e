// How far a choice holds: the scene, or the rays, stretched one way until the wish fails. And where, with the choice,
// the next ray may start.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "measure/choice/candidates.hpp"
#include "measure/choice/ideal_rays.hpp"
#include "measure/offset/offsets.hpp"

namespace lostbits::measure::choice {

/// A scene that has grown one way, and the length or angle that stands for it.
struct Stretched {
    scene::file::Scene scene;
    double value;  ///< distance: from the eye to the solids' middle, along the view; radius: of the largest solid (of a
                   ///< box half its longest side); offset: of what moved: world units. view: degrees
};

/// Nothing where the way means nothing for the scene: no distance, offset or view of the pixel plane, no distance of
/// solids that lie behind, no radius of a sphereflake, no view of parallel rays, and none wider than 170 degrees. The
/// offset at a factor k is (k − 1) times the distance from the eye to the solids' middle. `factor` ≥ 1.
std::optional<Stretched> stretched(const scene::file::Scene& scene, Growth way, double factor);

/// What ended the search along a way.
enum class End {
    fails,        ///< the wish
    nothing_hit,  ///< no ray hits anything there
    other_scene,  ///< the format in which inputs are stored (binary32 where a scene shares them, that of a file) holds
                  ///< another scene there: for more than a tenth of the rays, the decision or a tenth of t is not what
                  ///< was meant
    none          ///< nothing, up to the largest factor or the widest view
};
inline constexpr std::array<std::string_view, 4> end_names{"fails", "nothing_hit", "other_scene", "none"};

struct Room {
    Growth way = Growth::distance;
    double holds = 0, value = 0;  ///< the largest factor at which the wish was seen to hold below the end, and what it
                                  ///< stands for; 0: it fails as the scene is
    double beyond = 0;            ///< the first factor seen at the end; 0 where there is none
    End end = End::none;
    Worth broken{};  ///< there, where the wish fails
};

/// Doubles the factor until the wish fails or the way ends, at most to 2^64, and halves the last step until it is known
/// to 2 %. What fails in between and holds again is not seen. On a picture of at most `pixels`, or on the sample of the
/// files' rays (see `StretchedRays` for what the ways are there).
std::vector<Room> rooms_of(const ChoiceRequest& request, const evaluate::TestedForm& row, int pixels = 4096);

/// The strategies of offset that are right for every ray that leaves what a form has hit on a scene.
struct SafeOffsets {
    std::vector<offset::SafeStrategy> outside;  ///< for the rays away from the solid; the cheapest first
    std::vector<offset::SafeStrategy> both;     ///< also for those into it
    std::uint64_t points = 0, rays = 0;         ///< that this was measured on
};

/// On a picture of at most `pixels`, fewer where there are many solids. Nothing where the scene has too many, or the
/// form cannot be asked.
std::optional<SafeOffsets> safe_offsets(const scene::file::Scene& scene, const evaluate::TestedForm& row,
                                        truth::TruthLimit limit = {}, int pixels = 1024);

}  // namespace lostbits::measure::choice
