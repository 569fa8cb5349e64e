// The rays that were chosen to break something, at spheres, boxes and triangles alike.
#pragma once

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "intersect/triangle/triangle_rays.hpp"
#include "measure/truth/box_families.hpp"
#include "measure/truth/ray_families.hpp"
#include "shapes/solid.hpp"

namespace lostbits::test {

/// A ray and its solid, in numbers of a format.
struct HardRay {
    Ray<double> ray;
    Solid<double> solid;
    Range<double> range = {};
};

struct HardFamily {
    std::string name;
    FloatFormat storage;
    std::function<HardRay(Seeded&)> draw;
};

/// Those of spheres with exponents anywhere too, or without.
enum class Wide { no, yes };

/// The families of a shape in these formats; the one first that is random. Triangles are of floats.
inline std::vector<HardFamily> hard_families(Shape shape, std::initializer_list<FloatFormat> formats,
                                             Wide wide = Wide::no) {
    std::vector<HardFamily> all;
    for (const FloatFormat& storage : formats) {
        const auto keep = [storage](double x) { return stored(x, storage); };  // some scale what they have rounded
        const auto add_spheres = [&](const auto& families) {
            for (const RayFamily& f : families)
                all.push_back({f.name, storage, [&f, storage](Seeded& rng) {
                                   const RaySample s = f.make(rng, storage);
                                   return HardRay{s.ray, s.sphere};
                               }});
        };
        if (shape == Shape::sphere) {
            add_spheres(near_families), add_spheres(power_families);
            if (wide == Wide::yes) add_spheres(wide_families);
        } else if (shape == Shape::box) {
            for (const BoxFamily& f : box_families)
                all.push_back({f.name, storage, [&f, storage, keep](Seeded& rng) {
                                   const BoxSample s = f.make(rng, storage);
                                   return HardRay{{stored(s.ray.origin, storage), stored(s.ray.direction, storage)},
                                                  transformed(Solid<double>(s.box), keep),
                                                  {.tmax = keep(s.tmax)}};
                               }});
        } else {
            for (const test::TriangleFamily& f : test::triangle_families)
                all.push_back({f.name, storage, [&f](Seeded& rng) {
                                   const test::TriangleSample s = test::in_floats(f.make(rng));
                                   return HardRay{s.ray, s.triangle};
                               }});
        }
    }
    return all;
}

}  // namespace lostbits::test
