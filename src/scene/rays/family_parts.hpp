// What the families have in common: how many rays there are, how long their directions are and where they lie.
#pragma once

#include <cmath>
#include <string_view>
#include <vector>

#include "scene/rays/random.hpp"
#include "scene/rays/rays.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::rays {

/// Rays on which forms of a shape are compared.
struct RaySet {
    std::string_view name;   ///< in files
    std::string_view title;  ///< what the rays are
    std::vector<RayGroup> (*groups)();
};

/// Rays at one solid that all hit it, and that all miss it, on which forms are timed.
struct HitsAndMisses {
    RayGroup hits, misses;
};

/// The family with one view, of many rays. Its first draw is the solid: the same seed gives the same one.
template <class F>
F of_one_view(F family) {
    family.views = 1;
    family.rays = 4096;
    family.seed = 7;
    return family;
}

/// Rounded once to binary32.
inline double stored(double x) { return static_cast<double>(static_cast<float>(x)); }
inline Vec<double> stored(const Vec<double>& v) { return {stored(v.x), stored(v.y), stored(v.z)}; }

/// Reads the keys that every family has, and rejects what nothing asked for: call it last. What a missing key stands
/// for is in `family`.
template <class F>
void read_common_keys(toml::TableReader& table, F& family) {
    table.read_number("direction_magnitude", family.direction_magnitude, 0x1p-120, 0x1p+120);
    table.read_number("offset", family.offset, -0x1p+100, 0x1p+100);
    table.read("views", family.views, 1, 4096);
    table.read("rays", family.rays, 1, 65536);
    table.read("seed", family.seed, 0, 1LL << 53);
    table.reject_unknown_keys();
}

/// By how much everything is moved: in no special direction.
template <class F>
Vec<double> offset_of(const F& family) {
    return family.offset * Vec<double>(1, 0.6875, -0.4375);
}

/// The power of two that is nearest to the length asked for.
template <class F>
double direction_length(const F& family) {
    return std::ldexp(1.0, std::ilogb(family.direction_magnitude * std::sqrt(2.0)));
}

/// `draw(random, family)` once a view.
template <class F, class Draw>
std::vector<RayGroup> draw_views(const F& family, Draw draw) {
    Random random(family.seed);
    std::vector<RayGroup> groups;
    for (int v = 0; v < family.views; ++v) {
        groups.push_back(draw(random, family));
        groups.back().rays.be_list();
    }
    return groups;
}

}  // namespace lostbits::scene::rays
