#include "scene/rays/family.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "number/error.hpp"
#include "scene/rays/random.hpp"

namespace lostbits::scene::rays {
namespace {

struct Quadruple {
    int a, b, c, n;
};
constexpr Quadruple quadruples[] = {{1, 2, 2, 3},    {2, 3, 6, 7},    {1, 4, 8, 9},   {4, 4, 7, 9},
                                    {2, 6, 9, 11},   {6, 6, 7, 11},   {3, 4, 12, 13}, {2, 5, 14, 15},
                                    {2, 10, 11, 15}, {1, 12, 12, 17}, {8, 9, 12, 17}, {6, 10, 15, 19}};

double to_12_bits(double x) {
    if (x == 0) return 0;
    const int shift = 11 - std::ilogb(x);
    return std::ldexp(std::nearbyint(std::ldexp(x, shift)), -shift);
}

/// A view direction (a, b, c) in whole numbers, of length n.
struct View {
    Vec<double> w;
    double n;
};

View draw_view(Random& random, const Family& f) {
    if (f.directions == Family::Views::axis) {
        Vec<double> w(0, 0, 0);
        w[random.below(3)] = random.below(2) == 0 ? 1 : -1;
        return {w, 1};
    }
    if (f.directions == Family::Views::tilted) {
        const Vec<double> w(1, to_12_bits(f.tilt), to_12_bits(0.6875 * f.tilt));
        return {w, length(w)};
    }
    const Quadruple& q = quadruples[random.below(static_cast<int>(std::size(quadruples)))];
    std::array<int, 3> parts{q.a, q.b, q.c};
    std::swap(parts[0], parts[static_cast<std::size_t>(random.below(3))]);
    std::swap(parts[1], parts[1 + static_cast<std::size_t>(random.below(2))]);
    for (int& p : parts) p = random.below(2) == 0 ? p : -p;
    return {Vec<double>(parts[0], parts[1], parts[2]), static_cast<double>(q.n)};
}

Vec<double> unit(const Vec<double>& v) {
    const double size = length(v);
    return {v.x / size, v.y / size, v.z / size};
}

/// Where a line passes the centre: its distance in radii and a direction across w.
struct Impact {
    double s;
    Vec<double> across;
};

Impact draw_impact(Random& random, const Family& f, const View& view) {
    const double u = random.unit();
    double s = 0;
    if (f.silhouette_gap > 0) {
        s = 1 - f.silhouette_gap;
    } else if (f.weighting == Family::Weighting::silhouette) {
        // 1 − s falls by powers of two from 1 − impact_from to 1 − impact_to; by MPFR, for libm's pow differs by
        // machine.
        const Real ratio = Real(1 - f.impact_to) / Real(1 - f.impact_from);
        s = 1 - (1 - f.impact_from) * static_cast<double>(Real(pow(ratio, Real(u))));
    } else {
        s = std::sqrt(f.impact_from * f.impact_from + u * (f.impact_to * f.impact_to - f.impact_from * f.impact_from));
    }
    Vec<double> side(2 * random.unit() - 1, 2 * random.unit() - 1, 2 * random.unit() - 1);
    const Vec<double> w(view.w.x / view.n, view.w.y / view.n, view.w.z / view.n);
    return {s, unit(side - dot(side, w) * w)};
}

void push(RayGroup& group, const Vec<double>& o, const Vec<double>& d) {
    const auto stored = [](double x) { return static_cast<double>(static_cast<float>(x)); };
    RayBlock& r = group.rays;
    r.ox.push_back(stored(o.x));
    r.oy.push_back(stored(o.y));
    r.oz.push_back(stored(o.z));
    r.dx.push_back(stored(d.x));
    r.dy.push_back(stored(d.y));
    r.dz.push_back(stored(d.z));
}

RayGroup view_rays(Random& random, const Family& f) {
    const View view = draw_view(random, f);
    const Vec<double> w(view.w.x / view.n, view.w.y / view.n, view.w.z / view.n);
    const Vec<double> away = f.offset * Vec<double>(1, 0.6875, -0.4375);
    const double magnitude = std::ldexp(1.0, std::ilogb(f.direction_magnitude * std::sqrt(2.0)));
    const bool parallel = f.projection == Family::Projection::parallel;
    // Whole multiples of (a, b, c): |centre| = multiple·n exactly.
    const double multiple = to_12_bits((parallel ? f.distance * f.radius : f.radius) / view.n);
    const double radius = parallel ? f.radius : multiple * view.n;
    const Vec<double> centre = (parallel ? multiple : -multiple) * view.w + away;
    const auto stored = [](double x) { return static_cast<double>(static_cast<float>(x)); };

    RayGroup group;
    group.solids.push_back(Sphere<double>{{stored(centre.x), stored(centre.y), stored(centre.z)}, stored(radius)});
    group.rays.width = f.rays;
    group.rays.y1 = 1;
    for (int i = 0; i < f.rays; ++i) {
        const Impact impact = draw_impact(random, f, view);
        if (parallel) {
            // The direction is (a, b, c) over a power of two near n: exact, and along the centre's.
            const double scale = magnitude * std::ldexp(1.0, -std::ilogb(view.n));
            push(group, away + (impact.s * radius) * impact.across, scale * view.w);
        } else {
            // From height h a line that passes the centre at s·r leaves the vertical by asin(s r/(r + h)).
            const double sine = std::clamp(impact.s * radius / (radius + f.height), -1.0, 1.0);
            const double cosine = std::sqrt((1 - sine) * (1 + sine));
            push(group, away + f.height * w, magnitude * (sine * impact.across - (f.away ? -cosine : cosine) * w));
        }
    }
    return group;
}

}  // namespace

Family read_family(toml::TableReader table) {
    using P = Family::Projection;
    using V = Family::Views;
    using W = Family::Weighting;
    static constexpr std::pair<std::string_view, P> projections[] = {{"parallel", P::parallel}, {"point", P::point}};
    static constexpr std::pair<std::string_view, V> views[] = {
        {"oblique", V::oblique}, {"axis", V::axis}, {"tilted", V::tilted}};
    static constexpr std::pair<std::string_view, W> weightings[] = {{"disc", W::disc}, {"silhouette", W::silhouette}};
    Family f;
    f.projection = table.optional_one_of<P>("projection", projections).value_or(f.projection);
    f.directions = table.optional_one_of<V>("directions", views).value_or(f.directions);
    f.weighting = table.optional_one_of<W>("weighting", weightings).value_or(f.weighting);
    const auto number = [&](const char* key, double& target, double low, double high) {
        const auto x = table.optional_number(key);
        if (!x) return;
        target = static_cast<double>(*x);
        if (!(target >= low && target <= high))
            table.fail_at(key, "must lie between " + std::to_string(low) + " and " + std::to_string(high));
    };
    number("radius", f.radius, 0x1p-126, 0x1p+126);
    number("distance", f.distance, 0, 0x1p+126);
    number("height", f.height, -0x1p+126, 0x1p+126);
    number("impact_from", f.impact_from, 0, 4);
    number("impact_to", f.impact_to, 0, 4);
    number("silhouette_gap", f.silhouette_gap, 0, 1);
    f.away = table.optional_boolean("away").value_or(false);
    number("direction_magnitude", f.direction_magnitude, 0x1p-120, 0x1p+120);
    number("tilt", f.tilt, 0, 1);
    number("offset", f.offset, -0x1p+100, 0x1p+100);
    if (f.weighting == W::silhouette && f.impact_to >= 1)
        table.fail_at("impact_to", "must be below 1 with weighting = \"silhouette\"");
    f.views = static_cast<int>(table.optional_integer("views", 1, 4096).value_or(f.views));
    f.rays = static_cast<int>(table.optional_integer("rays", 1, 65536).value_or(f.rays));
    f.seed = static_cast<std::uint64_t>(table.optional_integer("seed", 0, 1LL << 53).value_or(1));
    table.reject_unknown_keys();
    return f;
}

std::vector<RayGroup> family_rays(const Family& family) {
    Random random(family.seed);
    std::vector<RayGroup> groups;
    for (int v = 0; v < family.views; ++v) groups.push_back(view_rays(random, family));
    return groups;
}

}  // namespace lostbits::scene::rays
