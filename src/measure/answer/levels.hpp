// Which level of a hierarchy loses a true hit: a form behind boxes, in the world and in the space of its solid.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "geometry/range.hpp"
#include "intersect/hull/behind.hpp"

namespace lostbits::measure::answer {

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
