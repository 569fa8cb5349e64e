// Common part of the ray distributions: the number of rays, the length of their directions and their offset.
#pragma once

#include <cmath>
#include <string_view>
#include <vector>

#include "scene/rays/random.hpp"
#include "scene/rays/rays.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::rays {

/// A set of rays on which forms of a shape are compared.
struct RaySet {
    std::string_view name;   ///< name in files
    std::string_view title;  ///< description of the rays
    std::vector<RayGroup> (*groups)();
};

/// Rays at one primitive that all hit it, and rays that all miss it, on which forms are timed.
struct HitsAndMisses {
    RayGroup hits, misses;
};

/// Returns the ray distribution with one view of many rays. Its first draw is the primitive, so the same seed gives
/// the same primitive.
template <class F>
F with_single_view(F distribution) {
    distribution.view_count = 1;
    distribution.ray_count = 4096;
    distribution.seed = 7;
    return distribution;
}

/// Rounds once to binary32.
inline double stored(double x) { return static_cast<double>(static_cast<float>(x)); }
inline Vec<double> stored(const Vec<double>& v) { return {stored(v.x), stored(v.y), stored(v.z)}; }

/// Reads the keys that every ray distribution has, and rejects all keys that were not requested; call this function
/// last. Missing keys keep their value in `distribution`.
template <class F>
void read_common_keys(toml::TableReader& table, F& distribution) {
    table.read_number("direction_magnitude", distribution.direction_magnitude, 0x1p-120, 0x1p+120);
    table.read_number("offset", distribution.offset, -0x1p+100, 0x1p+100);
    table.read("views", distribution.view_count, 1, 4096);
    table.read("rays", distribution.ray_count, 1, 65536);
    table.read("seed", distribution.seed, 0, 1LL << 53);
    table.require_known_keys();
}

/// Vector by which everything is moved, in no special direction.
template <class F>
Vec<double> offset_of(const F& distribution) {
    return distribution.offset * Vec<double>(1, 0.6875, -0.4375);
}

/// The power of two nearest to the requested length.
template <class F>
double direction_length(const F& distribution) {
    return std::ldexp(1.0, std::ilogb(distribution.direction_magnitude * std::sqrt(2.0)));
}

/// Calls `draw(random, distribution)` once for each view.
template <class F, class Draw>
std::vector<RayGroup> draw_views(const F& distribution, Draw draw) {
    Random random(distribution.seed);
    std::vector<RayGroup> groups;
    for (int v = 0; v < distribution.view_count; ++v) {
        groups.push_back(draw(random, distribution));
        groups.back().rays.mark_as_list();
    }
    return groups;
}

}  // namespace lostbits::scene::rays
