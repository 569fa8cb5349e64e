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

/// Draws a box near `away`. Each side is between half of the size and all of it, and one side has the stated thickness.
/// The centre is not a special point.
Box<double> draw_box(Random& random, const BoxDistribution& f, const Vec<double>& away) {
    Box<double> box;
    const int thin = random.below(3);
    for (int i = 0; i < 3; ++i) {
        const double side = f.size * (i == thin && f.thickness < 1 ? f.thickness : random.between(0.5, 1));
        box.lo[i] = stored(away[i] + f.size * random.between(-0.75, -0.25));
        box.hi[i] = stored(box.lo[i] + side);
    }
    return box;
}

/// The eight boxes into which a point inside a box cuts it.
std::vector<Primitive<double>> cut(const Box<double>& box, const Vec<double>& at) {
    std::vector<Primitive<double>> parts;
    for (int n = 0; n < 8; ++n) {
        Box<double> part = box;
        for (int i = 0; i < 3; ++i) ((n >> i & 1) != 0 ? part.lo : part.hi)[i] = at[i];
        parts.emplace_back(part);
    }
    return parts;
}

/// A point of a face, edge or corner, and the directions (±1, or 0 for an axis) in which the box ends there.
struct Feature {
    Vec<double> point;
    Vec<double> outward;
};

Feature draw_feature(Random& random, const BoxDistribution& f, const Box<double>& box) {
    using A = BoxDistribution::Aim;
    const int fixed = f.aim == A::inside ? 0 : f.aim == A::face ? 1 : f.aim == A::edge ? 2 : 3;
    const int first = random.below(3);
    Feature feature{{0, 0, 0}, {0, 0, 0}};
    for (int k = 0; k < 3; ++k) {
        const int axis = (first + k) % 3;
        const double share = random.between(0.05, 0.95);
        feature.point[axis] = box.lo[axis] + share * (box.hi[axis] - box.lo[axis]);
        if (k >= fixed) continue;
        feature.outward[axis] = random.sign();
        feature.point[axis] = feature.outward[axis] > 0 ? box.hi[axis] : box.lo[axis];
    }
    return feature;
}

/// Draws a direction of length about 1 whose line meets the box only in the feature. It goes in across one of the
/// faces that meet there and out across another. If there is only one face, it runs along it.
Vec<double> draw_direction(Random& random, const Feature& feature) {
    Vec<double> d(0, 0, 0);
    int ends = 0;
    double last = 0;
    for (int i = 0; i < 3; ++i) {
        const double sign = random.sign();  // by itself: the order of operands is the compiler's choice
        d[i] = sign * random.between(0.1, 1);
        if (feature.outward[i] == 0) continue;
        // The line leaves the second face the other way than the first. A third face keeps the drawn sign.
        if (++ends == 2) d[i] = -std::copysign(d[i], last * feature.outward[i]);
        last = d[i] * feature.outward[i];
    }
    if (ends == 1) {
        for (int i = 0; i < 3; ++i) d[i] = feature.outward[i] != 0 ? 0 : d[i];
    }
    return d / length(d);
}

RayGroup box_rays(Random& random, const BoxDistribution& f) {
    const Box<double> box = draw_box(random, f, offset_of(f));
    Vec<double> middle(0, 0, 0);
    for (int i = 0; i < 3; ++i) middle[i] = stored(box.lo[i] + random.between(0.3, 0.7) * (box.hi[i] - box.lo[i]));
    RayGroup group;
    if (f.adjoining) group.primitives = cut(box, middle);
    else group.primitives.emplace_back(box);
    const bool on_other = f.begin == rays::Begin::on_other;
    if (on_other)
        group.primitives.emplace_back(
            draw_box(random, f, offset_of(f) + (f.distance * f.size) * rays::draw_direction(random)));
    const double magnitude = rays::direction_length(f);
    for (int i = 0; i < f.rays; ++i) {
        Feature feature = draw_feature(random, f, box);
        Vec<double> d = draw_direction(random, feature);
        if (f.adjoining) {
            // The shared points lie on the planes through the middle. The line continues to the inside of the whole
            // box.
            for (int k = 0; k < 3; ++k) {
                if (feature.outward[k] != 0) feature.point[k] = middle[k];
            }
        }
        const Vec<double> moved = feature.point + (f.gap * f.size) * feature.outward;
        if (on_other) {
            group.rays.push(rays::ray_from_surface(random, f, group.primitives.back(), moved, d));
            continue;
        }
        group.rays.push({stored(moved - (f.distance * f.size) * d), stored(magnitude * d)});
    }
    return group;
}

}  // namespace

rays::AimedPlace BoxDistribution::aimed_at(Random& random, const Primitive<double>& primitive, int feature) {
    Vec<double> share(0, 0, 0);
    const int free = random.below(3);
    for (int k = 0; k < 3; ++k) share[k] = feature == edge && k == free ? random.unit() : random.below(2);
    return primitive.box().point_at(share);
}

BoxDistribution BoxDistribution::read(toml::TableReader table) {
    using A = BoxDistribution::Aim;
    static constexpr std::pair<std::string_view, A> aims[] = {
        {"face", A::face}, {"edge", A::edge}, {"corner", A::corner}, {"inside", A::inside}};
    BoxDistribution f;
    f.aim = table.optional_one_of<A>("aim", aims).value_or(f.aim);
    table.read("begin", f.begin, rays::begins);
    f.adjoining = table.optional_boolean("adjoining").value_or(false);
    table.read_number("size", f.size, 0x1p-100, 0x1p+100);
    table.read_number("thickness", f.thickness, 0, 1);
    table.read_number("distance", f.distance, 0, 0x1p+100);
    table.read_number("gap", f.gap, -0.25, 0.25);
    if (f.adjoining && f.thickness == 0) table.fail_at("thickness", "must be above 0 with adjoining boxes");
    rays::read_common_keys(table, f);
    return f;
}

std::vector<RayGroup> BoxDistribution::draw() const { return rays::draw_views(*this, box_rays); }

std::span<const rays::RaySet> BoxDistribution::sets() {
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

rays::HitsAndMisses BoxDistribution::timed() {
    const BoxDistribution hits = rays::of_one_view(BoxDistribution{.aim = BoxDistribution::Aim::inside});
    BoxDistribution misses = hits;
    misses.aim = BoxDistribution::Aim::edge;
    misses.gap = 0.25;
    return {hits.draw().front(), misses.draw().front()};
}

}  // namespace lostbits::scene::box
