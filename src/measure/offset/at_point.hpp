// Measures offsets at one point where a form hits a primitive: the rays that leave it by each strategy, their faults,
// and the smallest safe offset.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "measure/culling/box_tree.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/offset/leaving.hpp"
#include "measure/offset/strategy.hpp"
#include "measure/study/sums.hpp"
#include "scene/rays/primitive_list.hpp"

namespace lostbits::measure::offset {

/// Faults of a new ray that leaves a hit point. One ray can have several.
///
///   self_hit            Outside: the exact half-line from the new origin, beyond tmin, meets inner points of the
///                       primitive that the ray leaves, before the far side of this primitive begins (`far_side`). For
///                       a surface without an inside: the half-line crosses the surface there.
///                       Inside: the half-line meets the surface at which it starts once more.
///   self_hit_by_form    Outside: the form's own arithmetic finds a t in (tmin, tmax) on the primitive that the ray
///                       leaves, before the far side of this primitive begins.
///                       Inside: the form finds a t before half of the true way to the other side.
///   lost_occluder       The ray starts past a neighbour: the exact ray from p meets another primitive, whose surface
///                       lies between p and the start of the new ray.
///                       The far wall of the primitive that the ray leaves counts too, even if the ray is not tested
///                       against this primitive.
///   begins_in_neighbour The new ray starts inside another primitive, and p does not lie in it.
///   lost_exit           Inside: the exact half-line meets no inner points of the primitive, or only inner points
///                       beyond its exit from the primitive, or the ray is not tested against the primitive.
///   lost_exit_by_form   Inside: the form finds no t in (tmin, tmax).
///   wrong_side          The new origin is an inner point of the primitive (outside), or not in it (inside); for a
///                       surface, it lies behind the surface.
///   not_finite          The new origin or direction is not finite; the other faults are not tested then.
///
/// "Outside" and "inside" are the side to which the ray goes.
enum class Fault : std::uint8_t {
    self_hit,
    self_hit_by_form,
    lost_occluder,
    begins_in_neighbour,
    lost_exit,
    lost_exit_by_form,
    wrong_side,
    not_finite
};
inline constexpr std::array<std::string_view, 8> fault_names{
    "self_hit",  "self_hit_by_form",  "lost_occluder", "begins_in_neighbour",
    "lost_exit", "lost_exit_by_form", "wrong_side",    "not_finite"};
inline constexpr unsigned bit_of(Fault f) { return 1U << static_cast<unsigned>(f); }

/// New ray that a strategy makes, with its faults. Its numbers are numbers of the format.
struct NewRay {
    Ray<double> ray{};
    double tmin = 0, tmax = 0;
    bool tests_departed_primitive = true;
    unsigned faults = 0;  ///< set of faults, by `bit_of`

    [[nodiscard]] bool has(Fault f) const { return (faults & bit_of(f)) != 0; }
    void add_fault_if(bool condition, Fault f) { faults |= condition ? bit_of(f) : 0; }
    /// True if the ray has a fault other than `wrong_side`, which by itself changes no picture.
    [[nodiscard]] bool is_bad() const { return (faults & ~bit_of(Fault::wrong_side)) != 0; }
};

LOSTBITS_FIELDS(NewRay, ray, tmin, tmax, tests_departed_primitive, faults)

/// Results of a strategy at a point, over the rays to one side.
struct StrategyAtPoint {
    std::array<std::uint8_t, fault_names.size()> fault_counts{};  ///< number of rays with each fault
    std::uint8_t bad_ray_count = 0;  ///< number of rays with a fault other than `wrong_side`
    /// The largest |new origin − p|, in world units; for the strategy `tmin`, the t that is skipped.
    double offset_size = 0;

    [[nodiscard]] std::uint8_t operator[](Fault f) const { return fault_counts[static_cast<std::size_t>(f)]; }
};

/// Index of the results of a strategy among those at one point: all strategies to the outside, then all to the inside.
inline std::size_t index_at_point(Side side, std::size_t strategy, std::size_t strategy_count) {
    return static_cast<std::size_t>(side) * strategy_count + strategy;
}

/// Results on one side of a point that do not depend on a strategy.
struct SideOfPoint {
    std::uint8_t ray_count = 0;
    double safe_offset = truth::missing;   ///< the smallest safe offset; infinite if no offset is safe
    double quiet_offset = truth::missing;  ///< the smallest safe offset without a fault by the form's arithmetic
};

/// Hit that a form reports: the ray, its t, and the index of the primitive.
struct FormHit {
    Ray<double> ray{};
    double t = 0;
    std::size_t primitive = 0;
};

/// Measures points of one form in one format. The scene's primitives and light are numbers of the format.
class PointWork {
public:
    /// `tree` finds the primitives near a point. If it is null, every primitive is tested.
    PointWork(const evaluate::TestedForm& tested_form, HitPointKind point_kind,
              const scene::rays::PrimitiveList<double>& primitives, const culling::BoxTree* tree,
              std::optional<Vec<double>> light, std::span<const Strategy* const> strategies)
        : tested_form_(tested_form),
          point_kind_(point_kind),
          primitives_(primitives),
          tree_(tree),
          light_(light),
          strategies_(strategies) {}

    /// Measures both sides. `index_at_point` says where in `by_strategy` each result goes. Returns false and fills in
    /// nothing if the computed point or its normal is not finite. Searches for the quiet offset
    /// (`SideOfPoint::quiet_offset`) only if `search_quiet_offset` is true; otherwise it stays missing.
    bool measure(const FormHit& form_hit, std::array<SideOfPoint, 2>& sides, std::span<StrategyAtPoint> by_strategy,
                 bool search_quiet_offset = true) const;

    /// Returns the rays of one strategy to one side, with their faults.
    [[nodiscard]] std::vector<NewRay> rays(const FormHit& form_hit, const Strategy& strategy, Side side) const;

    /// True if all rays to a side that start at p + side·e·n are safe by truth and, with `by_form`, by the form's
    /// arithmetic as well.
    [[nodiscard]] bool is_safe(const FormHit& form_hit, Side side, double e, bool by_form) const;
    /// Computed point and its normal.
    struct HitPoint {
        Vec<double> p, n;
    };
    /// Returns nothing if the point or its normal is not finite.
    [[nodiscard]] std::optional<HitPoint> hit_point(const FormHit& form_hit) const;

private:
    const evaluate::TestedForm& tested_form_;
    HitPointKind point_kind_;
    const scene::rays::PrimitiveList<double>& primitives_;
    const culling::BoxTree* tree_;
    std::optional<Vec<double>> light_;
    std::span<const Strategy* const> strategies_;

    template <class T>
    friend class TypedPoint;
};

}  // namespace lostbits::measure::offset
