// Everything that is measured at one point where a form met a solid.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/offset/leaving.hpp"
#include "measure/offset/strategy.hpp"

namespace lostbits::measure::offset {

/// What can be wrong with a respawned ray; several can at once.
///
///   self_hit            by truth: the exact half-line from the new origin, beyond t_min, meets inner points of the
///                       solid that it leaves before half of the way to its next wall (`next_wall`); of a surface
///                       without an inside, it crosses that. Into the solid: it meets the surface at which it starts
///                       once more.
///   self_hit_by_form    by the form's own arithmetic: it tells a t in (tmin, tmax) for the solid that the ray leaves,
///                       before half of the way to its next wall.
///                       Into the solid: one that comes before half of the true way to the other side.
///   lost_occluder       past a neighbour: the exact ray from p meets another solid, whose surface lies between p and
///                       where the new ray starts.
///                       So is the next wall of what it leaves, also where that is not asked.
///   begins_in_neighbour the new ray starts inside another solid, and p does not lie in it.
///   lost_exit           into the solid: the exact half-line meets no inner points of the solid, or it is not asked.
///   lost_exit_by_form   into the solid: the form tells no t in (tmin, tmax).
///   wrong_side          the new origin is an inner point of the solid (outside), or not in it (inside); of a surface,
///                       behind it.
///   not_finite          the new origin or direction is not finite; nothing else is asked then.
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

/// A ray as a strategy makes it; numbers of the format.
struct NewRay {
    Ray<double> ray{};
    double tmin = 0, tmax = 0;
    bool asks_own = true;
    unsigned faults = 0;  ///< `bit_of` each

    [[nodiscard]] bool has(Fault f) const { return (faults & bit_of(f)) != 0; }
    /// Has a fault that shows in a picture: any but `wrong_side`, which alone harms nothing.
    [[nodiscard]] bool is_bad() const { return (faults & ~bit_of(Fault::wrong_side)) != 0; }
};

/// A strategy at a point, over the rays to one side.
struct StrategyAtPoint {
    std::array<std::uint8_t, fault_names.size()> count{};
    std::uint8_t bad = 0;  ///< rays with a fault but `wrong_side`
    double size = 0;       ///< the largest |new origin − p|, world units; of `tmin` the t that is skipped

    [[nodiscard]] std::uint8_t operator[](Fault f) const { return count[static_cast<std::size_t>(f)]; }
};

/// What is known of one side of a point.
struct SideOfPoint {
    std::uint8_t rays = 0;
    double safe = truth::missing;   ///< the smallest safe offset; infinite where there is none
    double quiet = truth::missing;  ///< the same where the form's arithmetic finds no self-hit either
};

/// Where a form met a solid: its ray and answer, and the solids of its format.
struct MetPoint {
    Ray<double> ray{};
    double t = 0;
    std::size_t own = 0;
};

/// Asks everything about points of one form in one format. The scene's solids and light are numbers of the format.
class PointWork {
public:
    PointWork(const evaluate::TestedForm& row, HitPoint point, std::span<const Solid<double>> solids,
              std::optional<Vec<double>> light, std::span<const Strategy* const> strategies)
        : row_(row), point_(point), solids_(solids), light_(light), strategies_(strategies) {}

    /// Both sides; a strategy's place in `by_strategy` is side·strategies + its own. False where the computed point or
    /// its normal is not finite: nothing is filled in then.
    /// `quiet`: whether that offset is looked for; it stays missing otherwise.
    bool measure(const MetPoint& met, std::array<SideOfPoint, 2>& sides, std::span<StrategyAtPoint> by_strategy,
                 bool quiet = true) const;

    /// The rays of one strategy to one side, with their faults.
    [[nodiscard]] std::vector<NewRay> rays(const MetPoint& met, const Strategy& strategy, Side side) const;

    /// Whether all rays to a side that start at p + side·e·n are safe by truth, and, where `by_form`, by the form's
    /// arithmetic as well.
    [[nodiscard]] bool is_safe(const MetPoint& met, Side side, double e, bool by_form) const;
    /// The point and its normal; nothing where they are not finite.
    struct Start {
        Vec<double> p, n;
    };
    [[nodiscard]] std::optional<Start> start(const MetPoint& met) const;

private:
    const evaluate::TestedForm& row_;
    HitPoint point_;
    std::span<const Solid<double>> solids_;
    std::optional<Vec<double>> light_;
    std::span<const Strategy* const> strategies_;

    template <class T>
    friend class TypedPoint;
};

}  // namespace lostbits::measure::offset
