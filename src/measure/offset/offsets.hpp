// Measures offsets over a picture. Each point where a form hits the primitive that the ray truly hits first gets its
// smallest safe offset, and every strategy is compared with this offset.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measure/metric/statistics.hpp"
#include "measure/offset/at_point.hpp"
#include "measure/shard/share.hpp"

namespace lostbits::measure::offset {

inline constexpr std::array<std::string_view, 2> point_kind_names{"computed", "projected"};
inline constexpr std::string_view name_of(HitPointKind p) { return point_kind_names[static_cast<std::size_t>(p)]; }

/// New ray with a fault, and everything needed to reproduce it.
struct FaultyRay {
    int x = -1, y = -1;
    int primitive_index = -1;
    NewRay ray{};
    Primitive<double> primitive{};
};

LOSTBITS_FIELDS(FaultyRay, x, y, primitive_index, ray, primitive)

/// Results of one strategy to one side, over all points.
struct StrategySummary {
    std::array<std::uint64_t, fault_names.size()> fault_counts{};  ///< rays with each fault
    /// First ray with each fault, by pixel.
    std::array<std::optional<FaultyRay>, fault_names.size()> first_faulty_rays = {};
    std::uint64_t bad_ray_count = 0;   ///< rays with a fault besides `wrong_side` (`wrong_side` by itself is harmless)
    metric::Distribution offset_size;  ///< largest |new origin − p| of each point
    metric::Distribution size_ratio;   ///< `offset_size` over the smallest safe offset, where this is finite and not 0
    /// Points of `size_ratio` whose `offset_size` is less than the smallest safe offset.
    std::uint64_t too_small_point_count = 0;

    [[nodiscard]] std::uint64_t operator[](Fault f) const { return fault_counts[static_cast<std::size_t>(f)]; }
    [[nodiscard]] const std::optional<FaultyRay>& first_with(Fault f) const {
        return first_faulty_rays[static_cast<std::size_t>(f)];
    }
};

LOSTBITS_FIELDS(StrategySummary, fault_counts, first_faulty_rays, bad_ray_count, offset_size, size_ratio,
                too_small_point_count)

/// Results on one side of all points of a tested form. A quiet offset is safe and has no fault by the form's own
/// arithmetic.
struct SideSummary {
    std::uint64_t ray_count = 0;
    std::uint64_t already_safe_point_count = 0;  ///< points that need no offset
    std::uint64_t never_safe_point_count = 0;    ///< points that no offset along the normal makes safe
    std::uint64_t never_quiet_point_count = 0;   ///< points without a quiet offset
    metric::Distribution safe_offset;   ///< smallest safe offset of the points that have one, 0 among them; world units
    metric::Distribution safe_ulps;     ///< the same in ulps of max |p|
    metric::Distribution quiet_offset;  ///< smallest offset at which the form's arithmetic finds no fault either
    std::vector<StrategySummary> strategies;
};

LOSTBITS_FIELDS(SideSummary, ray_count, already_safe_point_count, never_safe_point_count, never_quiet_point_count,
                safe_offset, safe_ulps, quiet_offset, strategies)

/// A form in a format, and the kind of its hit points.
struct OffsetForm {
    evaluate::TestedForm tested_form;
    HitPointKind point_kind = HitPointKind::computed;
    friend bool operator==(const OffsetForm&, const OffsetForm&) = default;
};

struct OffsetSummary {
    std::uint64_t pixels = 0;
    /// Pixels where the form hits the primitive that the ray truly hits first, beyond its origin, and the computed
    /// point is finite. Everything below is about these.
    std::uint64_t points = 0;
    std::uint64_t unresolved = 0;  ///< pixels whose truth is not proved
    std::array<SideSummary, 2> sides;

    [[nodiscard]] const SideSummary& side_summary(Side side) const { return sides[static_cast<std::size_t>(side)]; }
};

LOSTBITS_FIELDS(OffsetSummary, pixels, points, unresolved, sides)

/// Results of a tested form over some scanlines, pixel by pixel. A pixel with `is_point` set has results for both
/// sides, and for each strategy to the outside and then to the inside.
struct OffsetBand {
    int y0 = 0, scanlines = 0, width = 0;
    std::vector<std::uint8_t> is_point;
    std::vector<std::int32_t> primitive;  ///< index of the primitive; −1 where there is no point
    std::vector<double> ulp;              ///< ulp of max |p|
    std::vector<std::array<SideOfPoint, 2>> sides;
    std::vector<StrategyAtPoint> by_strategy;
    std::size_t strategy_count = 0;

    [[nodiscard]] const StrategyAtPoint& at(std::size_t pixel, Side side, std::size_t strategy) const {
        return by_strategy[both_sides.size() * pixel * strategy_count + index_at_point(side, strategy, strategy_count)];
    }
};

/// A study, see measure/study/study.hpp.
struct OffsetStudy {
    using Band = OffsetBand;
    using Summary = OffsetSummary;
    static constexpr int pixels_per_band = 1;  ///< few, because every pixel takes some kilobytes

    const scene::file::Scene& scene;
    std::vector<OffsetForm> tested_forms;  ///< their forms are of primitives and report t
    std::vector<const Strategy*> strategies;
    truth::ProofLimit limit{};
    /// True to search for the smallest quiet offset as well, which takes as long as all the rest.
    bool search_quiet_offset = true;
    shard::Share share = {};
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    /// Throws InputError for a scene with too many primitives.
    void require() const;
    [[nodiscard]] OffsetSummary begin(std::size_t form_index) const;
    [[nodiscard]] static const truth::Band& prepare(const truth::Band& band) { return band; }
    OffsetBand measure(const truth::Band& band, std::size_t form_index, OffsetSummary& summary) const;
};

/// Returns the forms that are measured if the user names none: one for each shape, in the order of the shapes.
/// `usual_format` is the format that is measured then.
const std::vector<std::string_view>& usual_forms();
inline constexpr std::string_view usual_format = "f32";

/// Largest number of primitives of a scene outside its meshes. Each point is compared with all of them.
inline constexpr std::size_t max_primitives = 1000;
/// Throws InputError for a scene with more than `max_primitives` outside its meshes. The message names the scene.
void require_few_primitives(const scene::file::Scene& scene);
/// True if offsets of a form can be measured: the form intersects a primitive and reports t.
bool can_measure_offsets(const intersect::table::Intersector& form);

/// A strategy that makes no bad ray (`StrategySummary::bad_rays` is 0).
struct SafeStrategy {
    const Strategy* strategy;
    /// Number of operations for one new ray as the rule is written (`Strategy::operation_count`); not a time.
    std::uint64_t operation_count;
    double size_ratio;  ///< median of `StrategySummary::size_ratio`, the largest over the sides; NaN if no side has a
                        ///< ratio
};

/// Returns the strategies of a measured form that are safe to all of these sides, the cheapest first, and equally cheap
/// ones in the order of the table. Safe means `StrategySummary::bad_rays` = 0: no self-hit by truth or by the form, no
/// lost occluder and no lost exit. The result is empty if no strategy is safe, or if the form has no points.
std::vector<SafeStrategy> find_safe_strategies(const OffsetSummary& summary,
                                               const std::vector<const Strategy*>& strategies, Shape shape,
                                               std::span<const Side> sides = both_sides);

}  // namespace lostbits::measure::offset
