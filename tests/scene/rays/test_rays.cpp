#include "scene/rays/rays.hpp"

#include <cmath>

#include "catch.hpp"
#include "scene/rays/camera.hpp"
#include "scene/scene_text.hpp"
#include "scene/toml/round.hpp"

namespace test_rays {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::file;
using namespace lostbits::scene::rays;
using namespace lostbits::scene::toml;
using namespace lostbits::scene::test;

namespace {

const std::string pinhole_scene = replaced(
    replaced(replaced(good_scene, "kind = \"orthographic\"", "kind = \"pinhole\""), "width = 2.5", "fov_deg = 40"),
    "eye = [0, 0, 0]", "eye = [0.1, 0.2, 0.3]");

bool same(const std::vector<double>& a, const std::vector<double>& b) { return a == b; }

bool same(const scene::rays::RayBlock& a, const scene::rays::RayBlock& b) {
    return same(a.ox, b.ox) && same(a.oy, b.oy) && same(a.oz, b.oz) && same(a.dx, b.dx) && same(a.dy, b.dy) &&
           same(a.dz, b.dz);
}

bool all_binary32(const std::vector<double>& v) {
    for (const double x : v)
        if (static_cast<double>(static_cast<float>(x)) != x) return false;
    return true;
}

}  // namespace

TEST_CASE("shared rays are the camera's doubles rounded once to binary32") {
    const scene::file::Scene s = loaded(pinhole_scene);
    const scene::rays::RayBlock block = make_shared_rays(s, 0, s.height);
    REQUIRE(block.size() == 32);
    CHECK(block.width == 8);
    const scene::rays::CameraFrame<double> frame = make_frame<double>(s);
    int rounded = 0;
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 8; ++x) {
            const auto i = static_cast<std::size_t>(y * 8 + x);
            const Ray<double> r = scene::rays::ray(frame, x, y);
            REQUIRE(block.ox[i] == static_cast<double>(static_cast<float>(r.origin.x)));
            REQUIRE(block.dx[i] == static_cast<double>(static_cast<float>(r.direction.x)));
            REQUIRE(block.dy[i] == static_cast<double>(static_cast<float>(r.direction.y)));
            REQUIRE(block.dz[i] == static_cast<double>(static_cast<float>(r.direction.z)));
            rounded += block.dz[i] != r.direction.z;
        }
    }
    CHECK(rounded > 16);
}

TEST_CASE("a band of rows is that part of the picture") {
    const scene::file::Scene s = loaded(pinhole_scene);
    const scene::rays::RayBlock whole = make_shared_rays(s, 0, 4);
    const scene::rays::RayBlock band = make_shared_rays(s, 1, 3);
    REQUIRE(band.size() == 16);
    CHECK(band.y0 == 1);
    CHECK(band.y1 == 3);
    for (std::size_t i = 0; i < band.size(); ++i) {
        CHECK(band[i].direction == whole[i + 8].direction);
        CHECK(band[i].origin == whole[i + 8].origin);
    }
    CHECK(scene::rays::make_shared_rays(s, 2, 2).size() == 0);
    CHECK(scene::rays::make_own_rays(s, 1, 3).size() == 16);
}

TEST_CASE("own rays are the ideal ones, rounded once to each format") {
    const scene::file::Scene s = loaded(pinhole_scene);
    const scene::rays::IdealRayBlock ideal = make_own_rays(s, 0, 4);
    const scene::rays::RayBlock single = round_rays(ideal, binary32);
    const scene::rays::RayBlock half = round_rays(ideal, binary16);
    CHECK(all_binary32(single.dx));
    CHECK(single.ox[0] == static_cast<double>(0.1f));
    CHECK(scene::rays::round_rays(ideal, binary64).ox[0] == 0.1);
    CHECK(half.ox[0] == 0x1.998p-4);
    for (std::size_t i = 0; i < ideal.size(); ++i) {
        REQUIRE(single.dy[i] == scene::toml::round_to_format(ideal.dy[i], binary32));
        REQUIRE(half.dz[i] == round_to_format(ideal.dz[i], binary16));
        REQUIRE(abs(Real(single.dy[i]) - ideal.dy[i]) <= 0x1p-25);
    }
}

TEST_CASE("input rays follow the scene's inputs and the format") {
    const scene::file::Scene shared = loaded(pinhole_scene);
    const scene::file::Scene own = loaded(replaced(pinhole_scene, "\"shared\"", "\"own\""));
    const scene::rays::RayBlock stored = make_shared_rays(shared, 0, 4);
    CHECK(same(scene::rays::input_rays(shared, 0, 4, binary32), stored));
    CHECK(same(input_rays(shared, 0, 4, binary64), stored));
    CHECK(same(input_rays(shared, 0, 4, binary16), scene::rays::round_block(stored, binary16)));
    CHECK_FALSE(same(input_rays(shared, 0, 4, binary16), stored));
    CHECK_FALSE(same(input_rays(own, 0, 4, binary64), stored));
    CHECK(same(input_rays(own, 0, 4, binary64),
               scene::rays::round_rays(scene::rays::make_own_rays(own, 0, 4), binary64)));
}

TEST_CASE("a block of rays is rounded to a narrower format, its subnormals and overflow included") {
    const scene::rays::RayBlock block{.width = 3,
                                      .y0 = 0,
                                      .y1 = 1,
                                      .ox = {1e6, -1e6, 1},
                                      .oy = {0x1p-25, 0x1.8p-24, 0},
                                      .oz = {65519, 65520, 1},
                                      .dx = {0.1, 1, -1},
                                      .dy = {0, 0, 1e-9},
                                      .dz = {-1e-9, 1, 1}};
    const scene::rays::RayBlock half = round_block(block, binary16);
    CHECK(half.ox == std::vector<double>{HUGE_VAL, -HUGE_VAL, 1});
    CHECK(half.oy == std::vector<double>{0, 0x1p-23, 0});
    CHECK(half.oz == std::vector<double>{65504, HUGE_VAL, 1});
    CHECK(half.dx == std::vector<double>{0x1.998p-4, 1, -1});
    CHECK(half.dy == std::vector<double>{0, 0, 0});
    CHECK(std::signbit(half.dz[0]));
    CHECK(half.width == 3);
    CHECK(half.y1 == 1);
}

TEST_CASE("spheres are rounded once, and a radius may vanish in a narrow format") {
    const Solid<Real> spec = Sphere<Real>{{real("0.1"), real("-100000.3"), real("1e-50")}, real("1e-8")};
    const Sphere<double> single = scene::rays::round_solid(spec, binary32).sphere();
    CHECK(single.centre.x == static_cast<double>(0.1f));
    CHECK(single.centre.y == static_cast<double>(-100000.3f));
    CHECK(single.centre.z == 0);
    CHECK(single.radius == static_cast<double>(1e-8f));
    CHECK(round_solid(spec, binary64).sphere().centre.z == 1e-50);
    CHECK(round_solid(spec, binary16).sphere().radius == 0);
    CHECK(std::isinf(round_solid(spec, binary16).sphere().centre.y));
    CHECK(round_solid(Solid<double>(single), binary16).sphere().radius == 0);
    CHECK(round_solid(Solid<double>(single), binary64).sphere().radius == single.radius);
}

TEST_CASE("an input sphere follows the scene's inputs and the format") {
    const std::string text = replaced(good_scene, "radius = 1", "radius = 0.1");
    const scene::file::Scene shared = loaded(text);
    const scene::file::Scene own = loaded(replaced(text, "\"shared\"", "\"own\""));
    CHECK(scene::rays::input_solid(shared, 0, binary64).sphere().radius == static_cast<double>(0.1f));
    CHECK(input_solid(own, 0, binary64).sphere().radius == 0.1);
    CHECK(input_solid(own, 0, binary32).sphere().radius == static_cast<double>(0.1f));
    CHECK(input_solid(shared, 0, binary16).sphere().radius == 0x1.998p-4);
}

}  // namespace test_rays
