// A tree of boxes never leaves out a solid that the ray meets: over all exponents, for every shape that it takes.
#include <algorithm>
#include <cmath>

#include "catch.hpp"
#include "measure/culling/box_tree.hpp"
#include "measure/truth/truth_columns.hpp"
#include "number/random.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::test::test_box_tree {

using measure::culling::BoxTree;
using measure::truth::find_truth;
using measure::truth::Truth;
using scene::rays::SolidList;

namespace {

class Draw {
public:
    explicit Draw(std::uint64_t seed) : engine_(seed) {}
    double in(double low, double high) { return low + (high - low) * engine_.unit(); }
    /// From −1 to 1, a third of the time 0 or an end, as vertices and directions of real scenes are.
    double component() {
        const double x = in(-1.5, 1.5);
        return x < -1 ? -1 : x > 1 ? 1 : std::fabs(x) < 0.1 ? 0 : x;
    }
    Vec<double> point(double size) { return {size * component(), size * component(), size * component()}; }

private:
    Random engine_;
};

std::vector<Solid<double>> solids_of(Draw& draw, double size) {
    std::vector<Solid<double>> all;
    while (all.size() < 96) {
        const Vec<double> at = draw.point(size);
        const double part = size * std::exp2(-draw.in(0, 6));
        Solid<double> solid(all.size() % 2 == 0 ? Shape::triangle : Shape::box);
        if (solid.shape == Shape::triangle) {
            solid = Triangle<double>{at + draw.point(part), at + draw.point(part), at + draw.point(part)};
        } else {
            const Vec<double> lo = at + draw.point(part), more = draw.point(part);
            solid = Box<double>{lo, lo + Vec<double>(std::fabs(more.x), std::fabs(more.y), std::fabs(more.z))};
        }
        if (!broken_limit(solid)) all.push_back(solid);
    }
    return all;
}

}  // namespace

TEST_CASE("a tree of boxes names every solid that a ray meets", "[culling]") {
    std::size_t met = 0, asked = 0, pairs = 0;
    for (int round = 0; round < 60; ++round) {
        Draw draw(static_cast<std::uint64_t>(round) + 1);
        // Squares of the truth's polynomials must not leave the doubles' range only in the tree: sizes 2^-90 to 2^90.
        const double size = std::exp2(std::floor(draw.in(-90, 90))), away = size * std::exp2(draw.in(-2, 20));
        const std::vector<Solid<double>> solids = solids_of(draw, size);
        scene::rays::RayBlock rays;
        for (int i = 0; i < 40; ++i) {
            const Vec<double> origin = i % 4 == 0 ? solids[static_cast<std::size_t>(i)].point(0) : draw.point(away);
            const std::size_t at = static_cast<std::size_t>(draw.in(0, 95.9));
            Vec<double> direction = i % 5 == 0 ? draw.point(1) : solids[at].point(i % 2 == 0 ? 0 : 3) - origin;
            if (direction == Vec<double>(0, 0, 0)) direction = {0, 0, 1};
            rays.push({origin, direction * std::exp2(std::floor(draw.in(-60, 60)))});
        }
        rays.width = 40, rays.y1 = 1;
        const auto tree = BoxTree::make(SolidList<double>(solids), measure::culling::bounds_of(rays), nullptr);
        REQUIRE(tree);
        std::vector<std::uint32_t> found;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            tree->candidates(rays[i], found);
            CHECK(std::ranges::is_sorted(found));
            CHECK(std::ranges::adjacent_find(found) == found.end());
            asked += found.size(), pairs += solids.size();
            for (std::uint32_t s = 0; s < solids.size(); ++s) {
                if (!find_truth(rays[i], solids[s]).is_hit()) continue;
                ++met;
                INFO("round " << round << ", ray " << i << ", solid " << s);
                CHECK(std::ranges::binary_search(found, s));
            }
        }
    }
    CHECK(met > 2000);
    CHECK(asked < pairs / 2);  // and it spares most of the others
}

TEST_CASE("the truth through a tree is the truth among all solids", "[culling]") {
    Draw draw(7);
    const std::vector<Solid<double>> solids = solids_of(draw, 1);
    scene::rays::RayBlock rays;
    for (int i = 0; i < 500; ++i) {
        const Vec<double> origin = draw.point(4),
                          to = solids[static_cast<std::size_t>(i) % 96].point(i % 2 == 0 ? 0 : 3);
        if (to != origin) rays.push({origin, to - origin});
    }
    rays.width = static_cast<int>(rays.size()), rays.y1 = 1;
    const SolidList<double> list(solids);
    const auto tree = BoxTree::make(list, measure::culling::bounds_of(rays), nullptr);
    measure::truth::RayTruths quick, slow;
    find_truths({rays, list, tree.get()}, {}, quick);
    find_truths({rays, list}, {}, slow);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        CHECK(quick[i].decision == slow[i].decision);
        CHECK(quick[i].object == slow[i].object);
        CHECK(compare(quick[i].t, slow[i].t) == 0);
    }
}

TEST_CASE("no tree is made of what has no box", "[culling]") {
    const measure::culling::RayBounds bounds{1, 1, 1};
    const Solid<double> ball = Sphere<double>{{0, 0, 0}, 1}, flat = Triangle<double>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    CHECK(BoxTree::make(SolidList<double>({flat}), bounds, nullptr));
    CHECK_FALSE(BoxTree::make(SolidList<double>({flat, ball}), bounds, nullptr));
    CHECK_FALSE(BoxTree::make(SolidList<double>({flat}), {HUGE_VAL, 1, 1}, nullptr));
    CHECK_FALSE(BoxTree::make(SolidList<double>(std::vector<Solid<double>>{}), bounds, nullptr));
}

}  // namespace lostbits::test::test_box_tree
