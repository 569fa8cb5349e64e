// Families that a shape draws with what all shapes have: what is aimed at is met, and from where it was meant.
#include <cmath>

#include "catch.hpp"
#include "scene/scene_text.hpp"
#include "scene/sweep/families.hpp"
#include "scratch.hpp"
#include "shapes/triangle/family/family.hpp"

namespace lostbits::test::test_aimed_family {

using scene::rays::RayGroup;
using scene::triangle::TriangleFamily;

namespace {

TriangleFamily family_of(const std::string& text) {
    const Scratch folder;
    const scene::toml::Node root = scene::toml::read_toml(folder.write("f.toml", text));
    return TriangleFamily::read(scene::toml::TableReader(root));
}

}  // namespace

TEST_CASE("rays at the inside of triangles hit them, from as far as was asked for") {
    for (const double distance : {4.0, 4096.0}) {
        TriangleFamily f = family_of("views = 64\nrays = 4\n");
        f.distance = distance;
        int hits = 0;
        for (const RayGroup& g : f.draw()) {
            const Triangle<double> t = g.solids.front().triangle();
            CHECK(std::fabs(length(t.a - t.middle()) - 1) < 1);
            for (std::size_t i = 0; i < g.rays.size(); ++i) {
                const auto ends = ends_of(t.span(g.rays[i]));
                hits += ends.has_value();
                if (ends) CHECK(std::fabs(ends->near * length(g.rays[i].direction) - distance) < 1e-3 * distance);
            }
        }
        CHECK(hits >= 250);  // of 256: rounded to binary32, a ray at the rim may pass it
    }
}

TEST_CASE("rays at edges pass them by roundings alone, and those at vertices both edges that meet there") {
    for (const auto& [aim, least] : {std::pair("edge", 1), std::pair("vertex", 2)}) {
        for (const RayGroup& g : family_of(std::string("aim = \"") + aim + "\"\nviews = 64\nrays = 2\n").draw()) {
            const Triangle<double> t = g.solids.front().triangle();
            for (std::size_t i = 0; i < g.rays.size(); ++i) {
                const Ray<double> ray = g.rays[i];
                const Vec<double> p[] = {t.a - ray.origin, t.b - ray.origin, t.c - ray.origin};
                int close = 0;
                for (int k = 0; k < 3; ++k) close += std::fabs(dot(ray.direction, cross(p[k], p[(k + 1) % 3]))) < 1e-4;
                CHECK(close >= least);
            }
        }
    }
}

TEST_CASE("every shape has a family, with a table of its own and an easy set") {
    CHECK(scene::sweep::families().size() == shape_rows.size());
    for (const auto& row : scene::sweep::families()) {
        INFO(row.table);
        CHECK(row.sets().front().name == "easy");
        const auto timed = row.timed();
        REQUIRE(timed.hits.rays.size() == 4096);
        REQUIRE(timed.misses.rays.size() == 4096);
        int hit = 0, missed = 0;
        const auto meets = [](const RayGroup& g, std::size_t i) {
            const auto ends = with_span(g.rays[i], g.solids.front(), [](const auto& span) { return ends_of(span); });
            return ends && ends->near <= ends->far && ends->far >= 0;
        };
        for (std::size_t i = 0; i < 4096; ++i) hit += meets(timed.hits, i), missed += !meets(timed.misses, i);
        CHECK(hit > 4000);
        CHECK(missed == 4096);
    }
}

}  // namespace lostbits::test::test_aimed_family
