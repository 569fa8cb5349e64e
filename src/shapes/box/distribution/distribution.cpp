#include "shapes/box/distribution/distribution.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace lostbits::scene::box {

using rays::offset_of;
using rays::Random;
using rays::RayGroup;
using rays::stored;

namespace {

/// Draws a box near `position`. Each side is between half of the size and all of it, but one side has the stated
/// thickness if that is below 1. `position` is not the exact centre.
Box<double> draw_box(Random& random, const BoxDistribution& settings, const Vec<double>& position) {
    Box<double> box;
    const int thin_axis = random.below(3);
    for (int i = 0; i < 3; ++i) {
        const double side =
            settings.size * (i == thin_axis && settings.thickness < 1 ? settings.thickness : random.between(0.5, 1));
        box.lo[i] = stored(position[i] + settings.size * random.between(-0.75, -0.25));
        box.hi[i] = stored(box.lo[i] + side);
    }
    return box;
}

/// Returns the eight boxes into which the planes through a point inside a box cut it.
std::vector<Primitive<double>> cut_into_octants(const Box<double>& box, const Vec<double>& point) {
    std::vector<Primitive<double>> octants;
    for (int octant = 0; octant < 8; ++octant) {
        Box<double> octant_box = box;
        for (int i = 0; i < 3; ++i) ((octant >> i & 1) != 0 ? octant_box.lo : octant_box.hi)[i] = point[i];
        octants.emplace_back(octant_box);
    }
    return octants;
}

/// A point of a face, edge or corner, and for each axis the direction in which the box ends there: ±1, or 0 if it does
/// not.
struct TouchPoint {
    Vec<double> point;
    Vec<double> outward;
};

TouchPoint draw_touch_point(Random& random, const BoxDistribution& settings, const Box<double>& box) {
    using Aim = BoxDistribution::Aim;
    const int fixed_axes = settings.aim == Aim::inside ? 0
                           : settings.aim == Aim::face ? 1
                           : settings.aim == Aim::edge ? 2
                                                       : 3;
    const int first = random.below(3);
    TouchPoint touch{{0, 0, 0}, {0, 0, 0}};
    for (int k = 0; k < 3; ++k) {
        const int axis = (first + k) % 3;
        const double fraction = random.between(0.05, 0.95);
        touch.point[axis] = box.lo[axis] + fraction * (box.hi[axis] - box.lo[axis]);
        if (k >= fixed_axes) continue;
        touch.outward[axis] = random.sign();
        touch.point[axis] = touch.outward[axis] > 0 ? box.hi[axis] : box.lo[axis];
    }
    return touch;
}

/// Draws a unit direction. At an edge or a corner, its line meets the box only in the touch point: relative to the
/// planes of the faces, it comes in across one and goes out across another. On a face, it runs along the face.
Vec<double> draw_direction(Random& random, const TouchPoint& touch) {
    Vec<double> d(0, 0, 0);
    int face_count = 0;
    double last_side = 0;
    for (int i = 0; i < 3; ++i) {
        const double sign = random.sign();  // in a statement of its own: compilers may evaluate operands in any order
        d[i] = sign * random.between(0.1, 1);
        if (touch.outward[i] == 0) continue;
        // The line crosses the plane of the second face in the opposite sense to the first. The drawn sign stays for a
        // third face.
        if (++face_count == 2) d[i] = -std::copysign(d[i], last_side * touch.outward[i]);
        last_side = d[i] * touch.outward[i];
    }
    if (face_count == 1) {
        for (int i = 0; i < 3; ++i) d[i] = touch.outward[i] != 0 ? 0 : d[i];
    }
    return d / length(d);
}

RayGroup draw_rays_at_box(Random& random, const BoxDistribution& settings) {
    const Box<double> box = draw_box(random, settings, offset_of(settings));
    Vec<double> middle(0, 0, 0);
    for (int i = 0; i < 3; ++i) middle[i] = stored(box.lo[i] + random.between(0.3, 0.7) * (box.hi[i] - box.lo[i]));

    RayGroup group;
    if (settings.adjoining) group.primitives = cut_into_octants(box, middle);
    else group.primitives.emplace_back(box);
    const bool starts_on_other_box = settings.start == rays::RayStart::on_other;
    if (starts_on_other_box)
        group.primitives.emplace_back(
            draw_box(random, settings,
                     offset_of(settings) + (settings.distance * settings.size) * rays::draw_direction(random)));

    const double magnitude = rays::direction_length(settings);
    for (int i = 0; i < settings.ray_count; ++i) {
        TouchPoint touch = draw_touch_point(random, settings, box);
        Vec<double> d = draw_direction(random, touch);
        if (settings.adjoining) {
            // The shared points lie on the planes through the middle. The line continues inside the whole box.
            for (int k = 0; k < 3; ++k) {
                if (touch.outward[k] != 0) touch.point[k] = middle[k];
            }
        }

        const Vec<double> moved_point = touch.point + (settings.gap * settings.size) * touch.outward;
        if (starts_on_other_box) {
            group.rays.push(rays::ray_from_surface(random, settings, group.primitives.back(), moved_point, d));
            continue;
        }
        group.rays.push({stored(moved_point - (settings.distance * settings.size) * d), stored(magnitude * d)});
    }
    return group;
}

}  // namespace

rays::AimedPlace BoxDistribution::draw_target(Random& random, const Primitive<double>& primitive, int target) {
    Vec<double> fraction(0, 0, 0);
    const int free_axis = random.below(3);
    for (int k = 0; k < 3; ++k) fraction[k] = target == on_edge && k == free_axis ? random.unit() : random.below(2);
    return primitive.box().point_at(fraction);
}

BoxDistribution BoxDistribution::read(toml::TableReader table) {
    using Aim = BoxDistribution::Aim;
    static constexpr std::pair<std::string_view, Aim> aims[] = {
        {"face", Aim::face}, {"edge", Aim::edge}, {"corner", Aim::corner}, {"inside", Aim::inside}};
    BoxDistribution settings;
    settings.aim = table.optional_one_of<Aim>("aim", aims).value_or(settings.aim);
    table.read("begin", settings.start, rays::ray_start_names);
    settings.adjoining = table.optional_boolean("adjoining").value_or(false);
    table.read_number("size", settings.size, 0x1p-100, 0x1p+100);
    table.read_number("thickness", settings.thickness, 0, 1);
    table.read_number("distance", settings.distance, 0, 0x1p+100);
    table.read_number("gap", settings.gap, -0.25, 0.25);
    if (settings.adjoining && settings.thickness == 0)
        table.fail_at("thickness", "must be above 0 with adjoining boxes");
    rays::read_common_keys(table, settings);
    return settings;
}

std::vector<RayGroup> BoxDistribution::draw() const { return rays::draw_views(*this, draw_rays_at_box); }

std::span<const rays::RaySet> BoxDistribution::ray_sets() {
    static constexpr rays::RaySet all[] = {
        {"easy", "boxes 4 sizes away, aimed at the inside",
         [] { return BoxDistribution{.aim = BoxDistribution::Aim::inside}.draw(); }},
        // Half of the rays pass inside the edge by the gap, half outside.
        {"edge-grazing", "boxes 4 sizes away, aimed 2^-23 sizes inside and outside of an edge",
         [] {
             auto groups = BoxDistribution{.aim = BoxDistribution::Aim::edge, .gap = -0x1p-23}.draw();
             std::ranges::move(BoxDistribution{.aim = BoxDistribution::Aim::edge, .gap = 0x1p-23}.draw(),
                               std::back_inserter(groups));
             return groups;
         }},
    };
    return all;
}

rays::HitsAndMisses BoxDistribution::draw_timed_rays() {
    const BoxDistribution hits = rays::with_single_view(BoxDistribution{.aim = BoxDistribution::Aim::inside});
    BoxDistribution misses = hits;
    misses.aim = BoxDistribution::Aim::edge;
    misses.gap = 0.25;
    return {hits.draw().front(), misses.draw().front()};
}

}  // namespace lostbits::scene::box
