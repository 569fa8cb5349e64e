#include "shapes/sphere/distribution/distribution.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "number/real.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::scene::sphere {

using rays::direction_length;
using rays::offset_of;
using rays::Random;
using rays::RayGroup;
using rays::stored;
using toml::round_to_12_bits;

namespace {

struct Quadruple {
    int a, b, c, n;
};

/// Returns all a ≤ b ≤ c without a common factor and with a² + b² + c² = n², n ≤ 127. There are 559, each with up to 48
/// directions, so a thousand views rarely share one. The numbers are so small that their products with a number of
/// twelve bits are exact in binary32.
std::vector<Quadruple> pythagorean_quadruples() {
    std::vector<Quadruple> quadruples;
    for (int n = 3; n <= 127; n += 2) {  // n is odd: squares are 0 or 1 modulo 4
        for (int a = 1; a < n; ++a) {
            for (int b = a; b < n; ++b) {
                const int c2 = n * n - a * a - b * b, c = static_cast<int>(std::sqrt(c2 < 0 ? 0 : c2));
                if (c >= b && c * c == c2 && std::gcd(std::gcd(a, b), c) == 1) quadruples.push_back({a, b, c, n});
            }
        }
    }
    return quadruples;
}

/// A view direction (a, b, c) in whole numbers. Its length is n.
struct View {
    Vec<double> w;
    double n;
};

/// Returns one of the 48 images of a vector under permutations and reflections of the axes.
Vec<double> permute_and_reflect(Random& random, std::array<double, 3> parts) {
    std::swap(parts[0], parts[random.below(3)]);
    std::swap(parts[1], parts[1 + static_cast<std::size_t>(random.below(2))]);
    for (double& p : parts) p = random.below(2) == 0 ? p : -p;
    return {parts[0], parts[1], parts[2]};
}

/// Draws a point of the unit circle without sine and cosine, which differ between machines.
std::pair<double, double> draw_on_circle(Random& random) {
    for (;;) {
        const double y = random.between(-1, 1), z = random.between(-1, 1), radius2 = y * y + z * z;
        if (radius2 <= 1 && radius2 > 0x1p-20) return {y / std::sqrt(radius2), z / std::sqrt(radius2)};
    }
}

View draw_view(Random& random, const SphereDistribution& settings) {
    if (settings.directions == SphereDistribution::ViewDirections::axis) {
        Vec<double> w(0, 0, 0);
        w[random.below(3)] = random.below(2) == 0 ? 1 : -1;
        return {w, 1};
    }
    if (settings.directions == SphereDistribution::ViewDirections::tilted) {
        const auto [y, z] = draw_on_circle(random);
        const Vec<double> w =
            permute_and_reflect(random, {1, round_to_12_bits(settings.tilt * y), round_to_12_bits(settings.tilt * z)});
        return {w, length(w)};
    }
    static const std::vector<Quadruple> quadruples = pythagorean_quadruples();
    const Quadruple& q = quadruples[random.below(static_cast<int>(quadruples.size()))];
    return {permute_and_reflect(random, {double(q.a), double(q.b), double(q.c)}), static_cast<double>(q.n)};
}

/// Returns a factor near 1 for views along an axis or near one. Such views have few centres, and without the factor all
/// of them would share the rounding of c.
double view_jitter(Random& random, const SphereDistribution& settings) {
    return settings.directions == SphereDistribution::ViewDirections::oblique ? 1 : 1 + 0x1p-5 * (random.unit() - 0.5);
}

/// Position of a line relative to the centre: its distance in radii, and a unit direction across w.
struct Impact {
    double s;
    Vec<double> across;
};

Impact draw_impact(Random& random, const SphereDistribution& settings, const View& view) {
    const double u = random.unit();
    double s = 0;
    if (settings.silhouette_gap > 0) {
        s = 1 - settings.silhouette_gap;
    } else if (settings.weighting == SphereDistribution::Weighting::silhouette) {
        // 1 − s falls exponentially from 1 − impact_from to 1 − impact_to. It is computed in MPFR because libm's pow
        // differs between machines.
        const Real ratio = Real(1 - settings.impact_to) / Real(1 - settings.impact_from);
        s = 1 - (1 - settings.impact_from) * static_cast<double>(Real(pow(ratio, Real(u))));
    } else {
        s = std::sqrt(settings.impact_from * settings.impact_from +
                      u * (settings.impact_to * settings.impact_to - settings.impact_from * settings.impact_from));
    }
    // The numbers are drawn in separate statements, because compilers evaluate arguments in any order, and clang and
    // gcc differ.
    const double z = 2 * random.unit() - 1, y = 2 * random.unit() - 1, x = 2 * random.unit() - 1;
    const Vec<double> side(x, y, z);
    const Vec<double> w(view.w.x / view.n, view.w.y / view.n, view.w.z / view.n);
    const Vec<double> across = side - dot(side, w) * w;
    return {s, across / length(across)};
}

/// Returns the unit direction of a line from a point at `distance` from the centre, where w leads to the centre. The
/// line passes the centre at s radii, so its angle to w is asin(s r/distance).
Vec<double> line_past_centre(const Impact& impact, const Vec<double>& w, double radius, double distance) {
    const double sine = std::clamp(impact.s * radius / distance, -1.0, 1.0);
    return sine * impact.across + std::sqrt((1 - sine) * (1 + sine)) * w;
}

/// Adds rays from the surface of a second sphere.
void add_rays_from_other(Random& random, const SphereDistribution& settings, RayGroup& group) {
    const Sphere<double> sphere = group.primitives[0].sphere();
    const Sphere<double> other{
        stored(sphere.centre + (settings.distance * sphere.radius) * rays::draw_direction(random)), sphere.radius};
    group.primitives.emplace_back(other);
    for (int i = 0; i < settings.ray_count; ++i) {
        const Vec<double> origin = stored(rays::draw_on_surface(random, other)), to_centre = sphere.centre - origin;
        const double distance = length(to_centre);
        const Vec<double> w = distance > 0 ? to_centre / distance : rays::draw_direction(random);
        const Impact impact = draw_impact(random, settings, {w, 1});
        group.rays.push(
            {origin, stored(direction_length(settings) * line_past_centre(impact, w, sphere.radius, distance))});
    }
}

RayGroup draw_rays_of_view(Random& random, const SphereDistribution& settings) {
    const View view = draw_view(random, settings);
    const Vec<double> w(view.w.x / view.n, view.w.y / view.n, view.w.z / view.n);
    const Vec<double> shift = offset_of(settings);
    const double magnitude = direction_length(settings);
    const bool is_parallel = settings.projection == SphereDistribution::Projection::parallel;
    // Whole multiples of (a, b, c): |centre| = multiple·n exactly.
    const double multiple = round_to_12_bits((is_parallel ? settings.distance * settings.radius : settings.radius) /
                                             view.n * view_jitter(random, settings));
    const double radius = is_parallel ? settings.radius : multiple * view.n;
    const Vec<double> centre = (is_parallel ? multiple : -multiple) * view.w + shift;

    RayGroup group;
    group.primitives.push_back(Sphere<double>{stored(centre), stored(radius)});
    if (settings.start == rays::RayStart::on_other) {
        add_rays_from_other(random, settings, group);
        return group;
    }
    for (int i = 0; i < settings.ray_count; ++i) {
        const Impact impact = draw_impact(random, settings, view);
        if (is_parallel) {
            // The direction is (a, b, c) over a power of two near n: exact, and parallel to the centre's direction.
            const double scale = magnitude * std::ldexp(1.0, -std::ilogb(view.n));
            group.rays.push({stored(shift + (impact.s * radius) * impact.across), stored(scale * view.w)});
        } else {
            const Vec<double> towards =
                line_past_centre(impact, settings.away ? w : -w, radius, radius + settings.height);
            group.rays.push({stored(shift + settings.height * w), stored(magnitude * towards)});
        }
    }
    return group;
}

}  // namespace

SphereDistribution SphereDistribution::read(toml::TableReader table) {
    using P = SphereDistribution::Projection;
    using V = SphereDistribution::ViewDirections;
    using W = SphereDistribution::Weighting;
    static constexpr std::pair<std::string_view, P> projections[] = {{"parallel", P::parallel}, {"point", P::point}};
    static constexpr std::pair<std::string_view, V> views[] = {
        {"oblique", V::oblique}, {"axis", V::axis}, {"tilted", V::tilted}};
    static constexpr std::pair<std::string_view, W> weightings[] = {{"disc", W::disc}, {"silhouette", W::silhouette}};

    // Origins and directions of the rays.
    SphereDistribution settings;
    settings.projection = table.optional_one_of<P>("projection", projections).value_or(settings.projection);
    table.read("begin", settings.start, rays::ray_start_names);
    if (settings.start == rays::RayStart::on_other && settings.projection == P::point)
        table.fail_at("begin",
                      "is \"other\", but with projection = \"point\" the rays begin above the sphere itself; "
                      "leave one of the two out");
    settings.directions = table.optional_one_of<V>("directions", views).value_or(settings.directions);
    settings.weighting = table.optional_one_of<W>("weighting", weightings).value_or(settings.weighting);

    // The size and the position of the sphere.
    table.read_number("radius", settings.radius, 0x1p-126, 0x1p+126);
    table.read_number("distance", settings.distance, 0, 0x1p+126);
    table.read_number("height", settings.height, -0x1p+126, 0x1p+126);

    // Places where the rays pass the sphere.
    table.read_number("impact_from", settings.impact_from, 0, 4);
    table.read_number("impact_to", settings.impact_to, 0, 4);
    table.read_number("silhouette_gap", settings.silhouette_gap, 0, 1);
    settings.away = table.optional_boolean("away").value_or(false);
    table.read_number("tilt", settings.tilt, 0, 1);
    if (settings.weighting == W::silhouette && settings.impact_to >= 1)
        table.fail_at("impact_to", "must be below 1 with weighting = \"silhouette\"");

    rays::read_common_keys(table, settings);
    return settings;
}

std::vector<RayGroup> SphereDistribution::draw() const { return rays::draw_views(*this, draw_rays_of_view); }

std::span<const rays::RaySet> SphereDistribution::ray_sets() {
    static constexpr rays::RaySet all[] = {
        {"easy", "a sphere 4 radii away, hit within 0.9 radii of its middle",
         [] { return SphereDistribution{.distance = 4, .impact_to = 0.9}.draw(); }},
        {"far-small", "a sphere 4096 radii away, hit within 0.9 radii of its middle",
         [] { return SphereDistribution{.distance = 4096, .impact_to = 0.9}.draw(); }},
        {"near-huge", "a sphere of radius 1e6, seen from 1 above its surface",
         [] {
             return SphereDistribution{
                 .projection = SphereDistribution::Projection::point, .radius = 1e6, .height = 1, .impact_to = 0.9}
                 .draw();
         }},
        {"grazing", "a sphere 4 radii away, hit 2^-10 radii inside its silhouette",
         [] { return SphereDistribution{.distance = 4, .silhouette_gap = 0x1p-10}.draw(); }},
    };
    return all;
}

rays::HitsAndMisses SphereDistribution::draw_timed_rays() {
    SphereDistribution hits = rays::with_single_view(SphereDistribution{.distance = 4, .impact_to = 0.9}),
                       misses = hits;
    misses.impact_from = 1.1;
    misses.impact_to = 1.5;
    return {hits.draw().front(), misses.draw().front()};
}

}  // namespace lostbits::scene::sphere
