#include "shapes/sphere/flake/sphereflake.hpp"

#include <unistd.h>

#include <array>
#include <cmath>

#include "number/error.hpp"
#include "number/real.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::scene::sphere {
namespace {

/// Directions to the nine children, in the parent's (u, v, w).
const std::array<Vec<double>, 9>& child_directions() {
    static const auto directions = [] {
        const double half_root3 = std::sqrt(3.0) / 2, height = std::sqrt(2.0 / 3.0), aside = std::sqrt(1.0 / 3.0);
        return std::array<Vec<double>, 9>{{{1, 0, 0},
                                           {0.5, half_root3, 0},
                                           {-0.5, half_root3, 0},
                                           {-1, 0, 0},
                                           {-0.5, -half_root3, 0},
                                           {0.5, -half_root3, 0},
                                           {aside * half_root3, aside * 0.5, height},
                                           {-aside * half_root3, aside * 0.5, height},
                                           {0, -aside, height}}};
    }();
    return directions;
}

void visit_generations(const Sphere<double>& sphere, const Vec<double>& w, int level_count,
                       const std::function<void(const Sphere<double>&)>& visit) {
    visit(sphere);
    if (level_count == 0) return;
    const Vec<double> e = std::fabs(w.x) > 0.8 ? Vec<double>(0, 1, 0) : Vec<double>(1, 0, 0);
    const Vec<double> u = unit_of(cross(e, w)), v = cross(w, u);
    const double distance = sphere.radius + sphere.radius / 3;
    for (const Vec<double>& child : child_directions()) {
        const Vec<double> child_axis = unit_of(child.x * u + child.y * v + child.z * w);
        visit_generations({sphere.centre + distance * child_axis, sphere.radius / 3}, child_axis, level_count - 1,
                          visit);
    }
}

double to_binary64(const Real& x) { return toml::round_to_format(x, binary64); }
Vec<double> to_binary64(const Vec<Real>& v) { return {to_binary64(v.x), to_binary64(v.y), to_binary64(v.z)}; }

}  // namespace

std::size_t Sphereflake::size() const {
    std::size_t count = 1, generation = 1;
    for (int level = 0; level < levels; ++level) count += generation *= 9;
    return count;
}

Sphereflake read_sphereflake(toml::TableReader table) {
    Sphereflake flake;
    const Real levels = table.number("levels");
    if (levels != floor(levels) || levels < 0 || levels > max_flake_levels) {
        table.fail_at("levels", "must be a whole number from 0 to " + std::to_string(max_flake_levels) +
                                    "; 5 makes 66430 spheres, and each further level nine times as many");
    }
    flake.levels = static_cast<int>(levels);
    if (const auto centre = table.optional_vec3("centre")) flake.centre = to_binary64(*centre);
    if (const auto radius = table.optional_number("radius")) flake.radius = to_binary64(*radius);
    // The smallest sphere must still be representable in binary32.
    if (!(flake.radius >= 0x1p-100) || !(flake.radius <= 0x1p100))
        table.fail_at("radius", "must lie between 2^-100 and 2^100; write 1");
    for (int i = 0; i < 3; ++i) {
        if (!(std::fabs(flake.centre[i]) <= 0x1p100)) table.fail_at("centre", "must lie within 2^100 of the origin");
    }
    if (const auto axis = table.optional_vec3("axis")) {
        const Vec<double> a = to_binary64(*axis);
        const double size = length(a);
        if (!(size > 0) || !std::isfinite(size))
            table.fail_at("axis", "is not a direction in binary64; write [0, 0, 1]");
        flake.axis = a;
    }
    table.require_known_keys();
    return flake;
}

void require_memory_for(const Sphereflake& flake) {
    constexpr double bytes_per_sphere = 40, gigabyte = 1e9;
    const double available =
        0.75 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    const double needed = bytes_per_sphere * static_cast<double>(flake.size());
    if (needed <= available) return;
    Sphereflake smaller = flake;
    while (smaller.levels > 0 && bytes_per_sphere * static_cast<double>(smaller.size()) > available) --smaller.levels;
    throw EnvironmentError(
        "sphereflake.levels = " + std::to_string(flake.levels) + ": a map of its " + std::to_string(flake.size()) +
        " spheres needs about " + std::to_string(static_cast<long>(needed / gigabyte)) +
        " GB, more than three quarters of this machine's memory; levels = " + std::to_string(smaller.levels) + " fits");
}

void for_each_primitive(const Sphereflake& flake, const std::function<void(const Primitive<double>&)>& visit) {
    visit_generations({flake.centre, flake.radius}, unit_of(flake.axis), flake.levels,
                      [&](const Sphere<double>& sphere) {
                          flake.stop.check();
                          visit(sphere);
                      });
}

}  // namespace lostbits::scene::sphere
