// Families of rays at boxes: what they are aimed at, by arithmetic of their own.
#include <cmath>

#include "catch.hpp"
#include "number/real.hpp"
#include "scene/scene_text.hpp"
#include "shapes/box/family/family.hpp"

namespace test_box_family {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::rays;
using lostbits::scene::box::BoxFamily;

namespace {

/// The largest entry and the smallest exit of a line with no zero component.
std::pair<Real, Real> clipped(const Ray<double>& ray, const Box<double>& box) {
    Real from(-ldexp(Real(1), 1000)), to(ldexp(Real(1), 1000));
    for (int i = 0; i < 3; ++i) {
        if (ray.direction[i] == 0) continue;
        const Real a = (Real(box.lo[i]) - ray.origin[i]) / ray.direction[i],
                   b = (Real(box.hi[i]) - ray.origin[i]) / ray.direction[i];
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
    return {from, to};
}

template <class Check>
void for_each_ray(const scene::box::BoxFamily& family, Check check) {
    int seen = 0;
    for (const scene::rays::RayGroup& group : family.draw()) {
        for (std::size_t i = 0; i < group.rays.size(); ++i, ++seen) check(group.rays[i], group.solids);
    }
    CHECK(seen == family.views * family.rays);
}

}  // namespace

TEST_CASE("a gap inward is a hit of about that depth, outward a miss, at edges and corners") {
    for (const auto aim : {scene::box::BoxFamily::Aim::edge, scene::box::BoxFamily::Aim::corner}) {
        for (const double gap : {-0x1p-8, 0x1p-8}) {
            scene::box::BoxFamily family;
            family.aim = aim;
            family.gap = gap;
            for_each_ray(family, [&](const Ray<double>& ray, const std::vector<Solid<double>>& solids) {
                REQUIRE(solids.size() == 1);
                const auto [from, to] = clipped(ray, solids.front().box());
                if (gap < 0) REQUIRE(from < to);
                else REQUIRE(from > to);
                // The stretch inside (or missing) is as long as the gap allows: directions have components from 0.1
                // to 1.
                REQUIRE(abs(to - from) < 0.3);
                REQUIRE(abs(to - from) > 0x1p-12);
            });
        }
    }
}

TEST_CASE("aimed inside, every ray crosses the box, along a face it has a component of zero") {
    scene::box::BoxFamily family;
    family.aim = BoxFamily::Aim::inside;
    for_each_ray(family, [](const Ray<double>& ray, const auto& solids) {
        const auto [from, to] = clipped(ray, solids.front().box());
        REQUIRE(from > 0);
        REQUIRE(from < to);
    });
    family.aim = BoxFamily::Aim::face;
    for_each_ray(family, [](const Ray<double>& ray, const auto& solids) {
        const Box<double> box = solids.front().box();
        int in_plane = 0;
        for (int i = 0; i < 3; ++i)
            in_plane += ray.direction[i] == 0 && (ray.origin[i] == box.lo[i] || ray.origin[i] == box.hi[i]);
        REQUIRE(in_plane == 1);
    });
}

TEST_CASE("adjoining boxes fill one box and share its planes, and the rays go through what they share") {
    for (const auto aim :
         {scene::box::BoxFamily::Aim::face, scene::box::BoxFamily::Aim::edge, scene::box::BoxFamily::Aim::corner}) {
        scene::box::BoxFamily family;
        family.aim = aim;
        family.adjoining = true;
        for_each_ray(family, [](const Ray<double>& ray, const std::vector<Solid<double>>& solids) {
            REQUIRE(solids.size() == 8);
            Box<double> whole = solids.front().box();
            double volume = 0;
            for (const auto& s : solids) {
                const Box<double> b = s.box();
                double part = 1;
                for (int i = 0; i < 3; ++i) {
                    whole.lo[i] = std::min(whole.lo[i], b.lo[i]);
                    whole.hi[i] = std::max(whole.hi[i], b.hi[i]);
                    part *= b.hi[i] - b.lo[i];
                }
                volume += part;
            }
            double all = 1;
            for (int i = 0; i < 3; ++i) all *= whole.hi[i] - whole.lo[i];
            REQUIRE(volume == Approx(all).epsilon(1e-12));
            const auto [from, to] = clipped(ray, whole);
            REQUIRE(from < to);
        });
    }
}

TEST_CASE("thin boxes are thin, scaled ones scaled, and the same seed gives the same rays") {
    scene::box::BoxFamily family;
    family.thickness = 0x1p-20;
    family.size = 1024;
    family.direction_magnitude = 0x1p10;
    for_each_ray(family, [](const Ray<double>& ray, const auto& solids) {
        const Box<double> b = solids.front().box();
        double least = b.hi.x - b.lo.x, most = least;
        for (int i = 1; i < 3; ++i) {
            least = std::min(least, b.hi[i] - b.lo[i]);
            most = std::max(most, b.hi[i] - b.lo[i]);
        }
        REQUIRE(least <= 0x1p-10 * 1.01);
        REQUIRE(most >= 511);
        REQUIRE(length(ray.direction) > 512);
    });
    const auto once = family.draw(), again = family.draw();
    REQUIRE(once.size() == again.size());
    CHECK(once.back().rays.dx == again.back().rays.dx);
    CHECK(once.back().rays.oz == again.back().rays.oz);
}

}  // namespace test_box_family
