#include "shapes/sphere/flake/sphereflake.hpp"

#include <cmath>

#include "catch.hpp"
#include "scene/rays/rays.hpp"
#include "scene/scene_text.hpp"

namespace test_sphereflake {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::file;
using namespace lostbits::scene::rays;
using namespace lostbits::scene::sphere;
using namespace lostbits::scene::test;

namespace {

std::vector<Sphere<double>> spheres_of(const scene::sphere::Sphereflake& flake) {
    std::vector<Sphere<double>> all;
    scene::sphere::for_each_solid(flake, [&all](const Solid<double>& s) { all.push_back(s.sphere()); });
    return all;
}

double apart(const Vec<double>& a, const Vec<double>& b) { return length(a - b); }

}  // namespace

TEST_CASE("a sphereflake has nine times as many spheres a level") {
    CHECK(scene::sphere::Sphereflake{.levels = 0}.size() == 1);
    CHECK(Sphereflake{.levels = 2}.size() == 91);
    CHECK(Sphereflake{.levels = 5}.size() == 66430);
    CHECK(Sphereflake{.levels = 8}.size() == 48427561);
    CHECK(spheres_of({.levels = 4}).size() == Sphereflake{.levels = 4}.size());
}

TEST_CASE("children touch their parent, six about its equator and three above it") {
    const auto all = spheres_of({.levels = 1, .centre = {1, 2, 3}, .radius = 0.75, .axis = {0.2, 0.9, 0.4}});
    REQUIRE(all.size() == 10);
    const Vec<double> w = Vec<double>(0.2, 0.9, 0.4) / std::sqrt(0.04 + 0.81 + 0.16);
    for (std::size_t i = 1; i < 10; ++i) {
        CHECK(all[i].radius == 0.25);
        CHECK(apart(all[i].centre, all[0].centre) == Approx(1.0).epsilon(1e-14));
        CHECK(dot(all[i].centre - all[0].centre, w) == Approx(i < 7 ? 0.0 : std::sqrt(2.0 / 3.0)).margin(1e-14));
        for (std::size_t k = 1; k < i; ++k) CHECK(apart(all[i].centre, all[k].centre) > 0.5);  // they do not meet
    }
    CHECK(apart(all[1].centre, all[2].centre) == Approx(1.0).epsilon(1e-14));  // 60 degrees
    CHECK(apart(all[7].centre, all[8].centre) == Approx(1.0).epsilon(1e-14));  // 120 degrees on the smaller circle
}

TEST_CASE("the flake of two levels is the one that the scene of ninety-one spheres writes out") {
    const scene::file::Scene written = load_scene(fs::path(LOSTBITS_DATA_DIR) / "scenes/rtg-fig-7-6-near.toml").front();
    const auto all = spheres_of({.levels = 2, .axis = {0.2, 0.9, 0.4}});
    REQUIRE(written.listed.size() == all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        CHECK(std::fabs(static_cast<double>(written.listed[i].sphere().radius) - all[i].radius) < 1e-9);
        for (int k = 0; k < 3; ++k)
            CHECK(std::fabs(static_cast<double>(written.listed[i].sphere().centre[k]) - all[i].centre[k]) < 2e-9);
    }
}

TEST_CASE("a flake stands behind the other spheres of its scene, and is refused with its place") {
    const std::string text = replaced(good_scene, "[[sphere]]", "[sphereflake]\nlevels = 1\nradius = 0.5\n[[sphere]]");
    const Scratch folder;
    const scene::file::Scene s = load_scene(folder.write("scene.toml", text)).front();
    CHECK(s.shapes() == std::vector{Shape::sphere});
    CHECK(s.solids().size() == 11);
    const auto shared = scene::rays::shared_solids(s);
    REQUIRE(shared.size() == 11);
    CHECK(shared[0].sphere().radius == 1);
    CHECK(shared[1].sphere().radius == 0.5);
    CHECK(shared[10].sphere().radius == static_cast<double>(static_cast<float>(0.5 / 3)));
    const auto broken = [&](const std::string& from, const std::string& to) {
        return scene_error(replaced(text, from, to));
    };
    CHECK(broken("levels = 1", "levels = 10")
              .find("scene.toml:14:10: sphereflake.levels must be a whole number from 0 to 9") == 0);
    CHECK(broken("levels = 1", "levels = 1.5").find("sphereflake.levels must be a whole number") != std::string::npos);
    CHECK(broken("radius = 0.5", "radius = 0").find("scene.toml:15:10: sphereflake.radius must lie between") == 0);
    CHECK(broken("radius = 0.5", "axis = [0, 0, 0]").find("sphereflake.axis is not a direction") != std::string::npos);
    CHECK(broken("radius = 0.5", "radios = 0.5").find("did you mean \"radius\"") != std::string::npos);
}

TEST_CASE(
    "the constants of a march have the seed's values where they are not given, and are refused with their place") {
    const std::string text = replaced(good_scene, "[[sphere]]", "[march]\nhit_eps = 0.01\n[[sphere]]");
    const Scratch folder;
    const scene::file::Scene s = load_scene(folder.write("scene.toml", text)).front();
    REQUIRE(s.march);
    CHECK(s.march->hit_eps == Real("0.01"));
    CHECK(s.march->max_dist == 20);
    CHECK(s.march->max_steps == 64);
    CHECK(s.meets(Shape::sdf));
    CHECK(s.meets(Shape::sphere));
    const auto broken = [&](const std::string& to) { return scene_error(replaced(text, "hit_eps = 0.01", to)); };
    CHECK(broken("hit_eps = 0").find("scene.toml:14:11: march.hit_eps must be greater than 0") == 0);
    CHECK(broken("hit_eps = 1e-50").find("march.hit_eps must be greater than 0 as it is stored") != std::string::npos);
    CHECK(broken("max_dist = 1e39").find("march.max_dist overflows binary32") != std::string::npos);
    CHECK(broken("max_steps = 0").find("march.max_steps must be a whole number from 1 to 100000") != std::string::npos);
    CHECK(broken("max_steps = 2.5").find("march.max_steps must be a whole number") != std::string::npos);
    CHECK(broken("over_relaxation = 2").find("march.over_relaxation must lie in [1, 2)") != std::string::npos);
    CHECK(broken("hit_epsilon = 1").find("march.hit_epsilon") != std::string::npos);
    CHECK(replaced(text, "hit_eps = 0.01", "") != text);
}

}  // namespace test_sphereflake
