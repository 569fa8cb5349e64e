// Attributes a loss to the steps and levels of an answer. Steps: the way into the space of a primitive and back, where
// the steps are rounded one after the other and the rest is exact. Levels: a form behind boxes, in the world and in the
// space of its primitive, where the first level that misses loses the hit.
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

/// The t that a row answers; nothing if it misses. Inputs are numbers of the format.
std::optional<double> evaluate_one(const intersect::table::Intersector& row, const Format& format,
                                   const Ray<double>& ray, const Primitive<double>& primitive, double tmax);

inline constexpr std::size_t step_count = intersect::transform::step_names.size();

/// Names that a ray can get: a step, or `nothing` where form and truth miss or no error arises.
inline constexpr auto step_categories = [] {
    std::array<std::string_view, step_count + 1> all{"nothing"};
    std::ranges::copy(intersect::transform::step_names, all.begin() + 1);
    return all;
}();

/// Let tₖ be the answer where the first k steps are rounded and the others are exact. t₀ is the truth for the stored
/// numbers, and the last is the form's answer. Step k is assigned tₖ − tₖ₋₁, and these sum to the whole error.
struct Steps {
    /// t₀ to t₆, in the unit of the row's answers; nothing where the ray misses.
    std::array<std::optional<truth::Certified>, step_count + 1> t;

    /// Error assigned to step k, in units of 2^exponent; NaN if the ray misses before or after the step.
    [[nodiscard]] double error(std::size_t k, std::int64_t exponent) const;
    /// The step with the largest error, if all of them hit. If a decision is wrong, the first step that makes it so.
    /// Nothing if all of them miss or the error is 0.
    [[nodiscard]] std::optional<std::size_t> worst() const;
};

/// Steps of a row that `transform::through` made from one of our own templates. The ray is given as the form received
/// it, and the primitive under a matrix. Uses the convention of the row, within a range.
Steps steps_of(const intersect::table::Intersector& row, const Format& format, const Ray<double>& ray,
               const Primitive<double>& primitive, const Range<double>& range = {});

enum class Level {
    nothing,    ///< the hit is found
    world_box,  ///< false cull: the ray misses the box in the world around a primitive under a matrix
    space,      ///< the ray, after its transformation into the space of the primitive, truly misses it
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

/// Levels of a row behind a box, for a ray that truly hits the primitive in its range, both as the form received them.
/// The hit is lost to the first level, from the outside in, that misses.
Levels levels_of(const intersect::table::Intersector& row, const Format& format, const Ray<double>& ray,
                 const Primitive<double>& primitive, const Range<double>& range);

/// Margin by which another hit, found before, must lie behind this one for this one to be found still, in ulps of t. It
/// is the least k for which the row hits when the ray ends at t + k ulp(t), t being its own answer. 0: a hit at the
/// same t is enough. Infinite if no k up to 2^p is enough; missing if the row misses with the range's own end.
double end_margin(const intersect::table::Intersector& row, const Format& format, const Ray<double>& ray,
                  const Primitive<double>& primitive, const Range<double>& range);

}  // namespace lostbits::measure::answer
