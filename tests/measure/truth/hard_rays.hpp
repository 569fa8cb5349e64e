// Rays that were chosen to break an intersection test, at spheres, boxes and triangles alike.
#pragma once

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "intersect/triangle/triangle_rays.hpp"
#include "measure/truth/box_distributions.hpp"
#include "measure/truth/ray_distributions.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::test {

/// A ray and its primitive, in numbers of a format.
struct HardRay {
    Ray<double> ray;
    Primitive<double> primitive;
    Range<double> range = {};
};

struct HardDistribution {
    std::string name;
    FloatFormat storage;
    std::function<HardRay(Seeded&)> draw;
};

/// Spheres whose exponents may have any size, or only ordinary ones.
enum class Wide { no, yes };

/// The distributions of a shape in these formats; the one first that is random. Triangles are of floats.
inline std::vector<HardDistribution> hard_distributions(Shape shape, std::initializer_list<FloatFormat> formats,
                                                        Wide wide = Wide::no) {
    std::vector<HardDistribution> all;
    for (const FloatFormat& storage : formats) {
        const auto keep = [storage](double x) { return stored(x, storage); };  // some scale their rounded numbers
        const auto add_spheres = [&](const auto& distributions) {
            for (const RayDistribution& distribution : distributions)
                all.push_back({distribution.name, storage, [&distribution, storage](Seeded& rng) {
                                   const RaySample s = distribution.draw(rng, storage);
                                   return HardRay{s.ray, s.sphere};
                               }});
        };
        if (shape == Shape::sphere) {
            add_spheres(narrow_distributions), add_spheres(power_distributions);
            if (wide == Wide::yes) add_spheres(wide_distributions);
        } else if (shape == Shape::box) {
            for (const BoxDistribution& distribution : box_distributions)
                all.push_back({distribution.name, storage, [&distribution, storage, keep](Seeded& rng) {
                                   const BoxSample s = distribution.draw(rng, storage);
                                   return HardRay{{stored(s.ray.origin, storage), stored(s.ray.direction, storage)},
                                                  convert_numbers(Primitive<double>(s.box), keep),
                                                  {.tmax = keep(s.tmax)}};
                               }});
        } else {
            for (const test::TriangleDistribution& distribution : test::triangle_distributions)
                all.push_back({distribution.name, storage, [&distribution](Seeded& rng) {
                                   const test::TriangleSample s = test::in_floats(distribution.draw(rng));
                                   return HardRay{s.ray, s.triangle};
                               }});
        }
    }
    return all;
}

}  // namespace lostbits::test
