// Finds the margins of a choice by stretching the scene, or the rays, until the requirement fails. Also finds
// strategies for the origin of the next ray with the chosen form.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "measure/choose/candidates.hpp"
#include "measure/choose/ideal_rays.hpp"
#include "measure/offset/offsets.hpp"

namespace lostbits::measure::choose {

/// A scene stretched by one kind of growth, and the length or angle that has grown.
struct StretchedScene {
    scene::file::Scene scene;
    double value;  ///< distance: from the eye to the centre of the primitives, along the view; radius: of the
                   ///< largest primitive (for a box, half its longest side); offset: length of the move; all in world
                   ///< units. view: degrees
};

/// Stretches a scene; `factor` ≥ 1. Returns nothing if the growth does not apply: distance, offset and view do not
/// apply to the pixel plane, distance does not to primitives behind the eye, radius to a sphereflake, and view to
/// parallel rays or beyond 170 degrees. The offset at a factor k is (k − 1) times the distance from the eye to the
/// centre of the primitives.
std::optional<StretchedScene> stretch(const scene::file::Scene& scene, Growth growth, double factor);

/// Reason why the search along one kind of growth ended.
enum class MarginEnd {
    fails,        ///< the requirement is not met
    nothing_hit,  ///< no ray hits anything there
    other_scene,  ///< the storage format (binary32 if a scene shares its inputs, the file's format for a file)
                  ///< represents another scene there: for more than a tenth of the rays, the decision differs or t is
                  ///< off by more than a tenth
    none          ///< no end up to the largest factor or the widest view
};
inline constexpr std::array<std::string_view, 4> margin_end_names{"fails", "nothing_hit", "other_scene", "none"};

struct GrowthMargin {
    Growth growth = Growth::distance;
    /// Largest measured factor below the end at which the requirement holds; 0: it fails without any growth.
    double holding_factor = 0;
    double value = 0;       ///< length or angle at `holding_factor`, as in `StretchedScene`
    double end_factor = 0;  ///< least measured factor at the end; 0 if there is no end
    MarginEnd end = MarginEnd::none;
    FormQuality end_quality{};  ///< measurements at `end_factor`, if the requirement fails there
};

/// Finds the margin of each kind of growth that applies. Multiplies the factor until the requirement fails or the
/// growth ends, at most to 2^64, and narrows the last step down to 2 %. A failure between two steps is not found if the
/// requirement holds at both. Works on a picture of at most `pixels`, or on the sample of the files' rays
/// (`StretchedRays` says how those grow).
std::vector<GrowthMargin> find_margins(const ChoiceRequest& request, const evaluate::TestedForm& tested_form,
                                       int pixels = 4096);

/// Offset strategies that are right for every ray that leaves a hit of a form on a scene.
struct SafeOffsets {
    std::vector<offset::SafeStrategy> outside;     ///< right for rays that leave the primitive; cheapest first
    std::vector<offset::SafeStrategy> both_sides;  ///< right for these rays and for rays that enter it
    std::uint64_t point_count = 0, ray_count = 0;  ///< number of points and rays measured
};

/// Finds the strategies on a picture of at most `pixels`, fewer if there are many primitives. Returns nothing if the
/// scene has too many primitives, or if the form marches or computes no t.
std::optional<SafeOffsets> find_safe_offsets(const scene::file::Scene& scene, const evaluate::TestedForm& tested_form,
                                             truth::ProofLimit limit = {}, int pixels = 1024);

}  // namespace lostbits::measure::choose
