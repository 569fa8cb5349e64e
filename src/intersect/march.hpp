// Sphere tracing: the constants of a march, and the record of a march beside its answer.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace lostbits::intersect {

/// The constants of a march, as numbers of the arithmetic in which it runs. Lengths and t are in world units, because
/// forms that march receive unit directions. Each form says which constants it uses.
template <class S>
struct MarchConstants {
    S hit_eps;              ///< a field value below it is a hit
    S max_dist;             ///< a t above it is a miss
    S relative_eps;         ///< a field value below relative_eps·t is a hit
    S cone;                 ///< radius of a pixel at distance 1; a field value below cone·t is a hit
    S over_relaxation;      ///< ω: a step is ω times the field value
    int max_steps = 64;     ///< number of samples of the field after which the march ends as a miss
    int secant_steps = 2;   ///< steps of the secant method after the hit
    int bisect_steps = 16;  ///< steps of bisection after the hit
};

/// Names of the constants that are numbers, in the order of the struct.
inline constexpr std::array<std::string_view, 5> march_number_names{"hit_eps", "max_dist", "relative_eps", "cone",
                                                                    "over_relaxation"};

/// Converts each number by `lift`, in order. The counts are the same in any arithmetic.
template <class S, class Lift>
auto convert_numbers(const MarchConstants<S>& constants, Lift lift) {
    using T = std::decay_t<std::invoke_result_t<Lift, const S&>>;
    return MarchConstants<T>{.hit_eps = lift(constants.hit_eps),
                             .max_dist = lift(constants.max_dist),
                             .relative_eps = lift(constants.relative_eps),
                             .cone = lift(constants.cone),
                             .over_relaxation = lift(constants.over_relaxation),
                             .max_steps = constants.max_steps,
                             .secant_steps = constants.secant_steps,
                             .bisect_steps = constants.bisect_steps};
}

/// Why a march ended. If two reasons hold, the first in this list counts.
///
///   hit         the form answers a hit.
///   max_dist    the step after the last sample led beyond max_dist. A step that does so after sample max_steps counts.
///   max_steps   max_steps samples are used, and the step after the last of them led to another t, or was not a number.
///   stagnated   max_steps samples are used, and the step after the last of them led nowhere: t + d == t in the
///               arithmetic of the march (over_relaxed: t + ω·d == t), so that no number of further samples would
///               change the answer. `accumulated` moves its point by itself: both t and the point must stand.
enum class StopReason : std::uint8_t { hit, max_dist, max_steps, stagnated };

inline constexpr std::array<std::string_view, 4> stop_names{"hit", "max_dist", "max_steps", "stagnated"};

/// Record of a march beside its answer.
struct MarchRecord {
    int iterations = 0;  ///< number of samples of the field, without those of a refinement
    StopReason stop = StopReason::max_steps;
    double least = 0;  ///< the smallest |field| of the samples; NaN if every sample was NaN
    /// The smallest field value of the samples, with its sign: if negative, the march went through the surface.
    double deepest = 0;
};

}  // namespace lostbits::intersect
