// What is lost on the way to an answer: by which step into the space of a solid and back, each done as the format
// rounds it, one after the other, and all that is left to do exactly; and at which level of a hierarchy, a form behind
// boxes, in the world and in the space of its solid, a true hit is lost.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "geometry/range.hpp"
#include "intersect/hull/behind.hpp"
#include "intersect/space/spaced.hpp"
#include "intersect/table/table.hpp"
#include "measure/truth/truth.hpp"

namespace lostbits::measure::answer {

/// The t that a row answers; nothing where it misses. Inputs are numbers of the format.
std::optional<double> ask_one(const intersect::table::Intersector& row, const Format& format, const Ray<double>& ray,
                              const Solid<double>& solid, double tmax);

inline constexpr std::size_t step_count = intersect::space::step_names.size();

/// What a ray is named by: nothing where form and truth miss, or nothing is lost.
inline constexpr auto step_categories = [] {
    std::array<std::string_view, step_count + 1> all{"nothing"};
    std::ranges::copy(intersect::space::step_names, all.begin() + 1);
    return all;
}();

/// With tₖ the answer where the first k steps are rounded and the others are exact, t₀ is true for the stored numbers
/// and the last is the form's answer: step k is assigned tₖ − tₖ₋₁, and these sum to the whole error.
struct Steps {
    /// t₀ to t₆, lengths as the row answers them; nothing for a ray that misses there.
    std::array<std::optional<truth::Certified>, step_count + 1> t;

    /// What step k is assigned, in units of 2^exponent; NaN where it, or what it began with, misses.
    [[nodiscard]] double error(std::size_t k, std::int64_t exponent) const;
    /// The step of the largest error where all of them hit, of a decision that comes out wrong the first that makes it
    /// so; nothing where all of them miss, or nothing is lost.
    [[nodiscard]] std::optional<std::size_t> worst() const;
};

/// Of a row that `space::through` made, one of our own templates; the ray as the form received it, the solid under a
/// matrix. By the convention of the row, and in a range.
Steps steps_of(const intersect::table::Intersector& row, const Format& format, const Ray<double>& ray,
               const Solid<double>& solid, const Range<double>& range = {});

enum class Level {
    nothing,    ///< the hit is found
    world_box,  ///< the box in the world around a solid under a matrix is missed: a false cull
    space,      ///< the ray as it was taken into the space of the solid truly misses it
    box,        ///< the box in the space of the solid, or around a solid that stands under no matrix: a false cull
    form        ///< the form itself
};
inline constexpr std::array<std::string_view, 5> level_names{"nothing", "world_box", "space", "box", "form"};

struct Levels {
    Level lost_to = Level::nothing;
    /// Each box that is asked, from the outside in, and the ray as it is asked there.
    struct Asked {
        Ray<double> ray;
        Hull<double> box;
    };
    std::vector<Asked> boxes;
};

/// Of a row behind a box and a ray that truly hits the solid in its range, both as the form received them. From the
/// outside in, the first level that misses is the one that the hit is lost to.
Levels levels_of(const intersect::table::Intersector& row, const Format& format, const Ray<double>& ray,
                 const Solid<double>& solid, const Range<double>& range);

/// By how many ulps of t another hit, found before, must lie behind this one for it to be found still: the least k for
/// which the row hits where the ray ends at t + k ulp(t), t being its own answer. 0: one at the same t. Infinite where
/// no k up to 2^p is enough; missing where the row misses at the range's own end.
double end_margin(const intersect::table::Intersector& row, const Format& format, const Ray<double>& ray,
                  const Solid<double>& solid, const Range<double>& range);

}  // namespace lostbits::measure::answer
