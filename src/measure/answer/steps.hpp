// Attributes a loss to the transform steps and to the levels of an answer. The steps transform a ray into the space of
// a primitive and the answer back; for each k, the first k steps are rounded and the others exact. The levels are the
// boxes around a primitive, in the world and in its own space, and the form itself; the first level that misses loses
// the hit.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "geometry/range.hpp"
#include "intersect/bounding_box/behind.hpp"
#include "intersect/table/table.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/truth/truth.hpp"

namespace lostbits::measure::answer {

/// Returns the t that a row answers; empty if it misses. The inputs are numbers of the format.
std::optional<double> evaluate_one(const intersect::table::Intersector& form, const Format& format,
                                   const Ray<double>& ray, const Primitive<double>& primitive, double tmax);

inline constexpr std::size_t step_count = intersect::transform::step_names.size();

/// Categories of a ray: a step, or `nothing` if form and truth miss or there is no error.
inline constexpr auto step_categories = [] {
    std::array<std::string_view, step_count + 1> names{"nothing"};
    std::ranges::copy(intersect::transform::step_names, names.begin() + 1);
    return names;
}();

/// Let tₖ be the answer where the first k steps are rounded and the others are exact. t₀ is the truth for the stored
/// numbers, and the last is the form's answer. Step k is assigned tₖ − tₖ₋₁, and these sum to the whole error.
struct Steps {
    /// Indices of `t`, each named by the last step that is rounded.
    enum Index : std::size_t {
        none_rounded,
        inverse_rounded,
        origin_rounded,
        direction_rounded,
        finish_rounded,
        form_rounded,
        all_rounded
    };
    /// t₀ to t₆, in the unit of the row's answers; empty where the ray misses.
    std::array<std::optional<truth::CertifiedNumber>, step_count + 1> t;

    /// Error assigned to step k, in units of 2^exponent; NaN if the ray misses before or after the step.
    [[nodiscard]] double error(std::size_t k, std::int64_t exponent) const;
    /// The step with the largest error if all tₖ are hits. If a decision is wrong, the first step that makes it so.
    /// Empty if all tₖ are misses or the error is 0.
    [[nodiscard]] std::optional<std::size_t> worst() const;
};

/// Measures the steps of a row that `transform::transformed_form` made from one of our own templates. The ray is given
/// as the form received it, and the transformed primitive. Uses the convention of the row, within a range.
Steps measure_steps(const intersect::table::Intersector& form, const Format& format, const Ray<double>& ray,
                    const Primitive<double>& primitive, const Range<double>& range = {});

enum class Level {
    nothing,    ///< the hit is found
    world_box,  ///< false cull: the ray misses the box in the world around a transformed primitive
    space,      ///< the ray, transformed into the space of the primitive, truly misses the primitive
    box,        ///< false cull: the ray misses the box in the primitive's space, or the box around one without a matrix
    form        ///< the form itself
};
inline constexpr std::array<std::string_view, 5> level_names{"nothing", "world_box", "space", "box", "form"};

struct Levels {
    Level lost_to = Level::nothing;
    /// A box that is tested and the ray that it is tested with; from the outside in.
    struct BoxTest {
        Ray<double> ray;
        BoundingBox<double> box;
    };
    std::vector<BoxTest> boxes;
};

/// Finds the level to which a row behind a box loses the hit, for a ray that truly hits the primitive in its range,
/// both as the form received them. It is the first level, from the outside in, that misses.
Levels find_lost_level(const intersect::table::Intersector& form, const Format& format, const Ray<double>& ray,
                       const Primitive<double>& primitive, const Range<double>& range);

/// Returns the margin, in ulps of t, that an earlier and farther hit must leave for the row to find this hit: the
/// earlier hit ends the ray. The margin is the least k for which the row hits when the ray ends at t + k ulp(t), where
/// t is the row's own answer. 0: the row hits even if the ray ends at t. Infinite if no k up to 2^p is enough; NaN if
/// the row misses with the range's own end.
double find_end_margin(const intersect::table::Intersector& form, const Format& format, const Ray<double>& ray,
                       const Primitive<double>& primitive, const Range<double>& range);

}  // namespace lostbits::measure::answer
