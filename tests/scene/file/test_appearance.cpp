// Light, paint and shadows in scene files; the camera with pixels at z = 0.
#include "scene/file/appearance.hpp"

#include "catch.hpp"
#include "number/real.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/rays.hpp"
#include "scene/scene_text.hpp"

namespace test_appearance {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::file;
using namespace lostbits::scene::rays;
using namespace lostbits::scene::test;

namespace {

const std::string painted = R"(schema = "lostbits-scene/1"
title = "A test"
size = [8, 4]
background = [0.25, 0.5, 1]
[camera]
kind = "pixel_plane"
eye = [1, 2, 10]
extent = [-4, -1, 4, 3]
[light]
position = [5, 6, 7]
[shadows]
own = true
offset = "ulp"
ulps = 4
[material]
ka = 0.125
ks = 0.5
n = 7
[[sphere]]
centre = [0, 0, 1]
radius = 1
colour = [1, 0.5, 0]
[[sphere]]
centre = [2, 0, 1]
radius = 0.5
ka = 0
ks = 0
)";

std::string broken(const std::string& from, const std::string& to) {
    return scene_error(replace_text(painted, from, to));
}

bool equal(const Vec<Real>& v, double x, double y, double z) { return v.x == x && v.y == y && v.z == z; }

}  // namespace

TEST_CASE("a scene without appearance keys asks for no stage") {
    const Scene s = load_text(good_scene);
    CHECK(s.appearance.last_stage() == Stage::visible);
    REQUIRE(s.appearance.materials.size() == 1);
    CHECK(equal(s.appearance.materials[0].colour, 1, 1, 1));
    CHECK(s.appearance.materials[0].ambient == Real(1) / 5);
    CHECK(s.appearance.materials[0].diffuse == Real(4) / 5);
    CHECK(s.appearance.materials[0].specular == 0);
    CHECK(equal(s.appearance.background, 0, 0, 0));
}

TEST_CASE("a sphere's own appearance keys override those of its material") {
    const Scene s = load_text(painted);
    const Appearance& look = s.appearance;
    CHECK(look.last_stage() == Stage::phong);
    CHECK(equal(look.background, 0.25, 0.5, 1));
    CHECK(equal(*look.light, 5, 6, 7));
    CHECK(look.shadows->tests_departed_sphere);
    CHECK(look.shadows->offset == ShadowRule::ShadowOffset::ulp);
    CHECK(look.shadows->ulps == 4);
    CHECK(look.shadows->background == Real(1) / 2);
    CHECK_FALSE(look.shadows->keeps_half_diffuse);
    REQUIRE(look.materials.size() == 2);
    CHECK(equal(look.materials[0].colour, 1, 0.5, 0));
    CHECK(look.materials[0].ambient == Real(1) / 8);
    CHECK(look.materials[0].diffuse == Real(4) / 5);
    CHECK(look.materials[0].exponent == 7);
    CHECK(equal(look.materials[1].colour, 1, 1, 1));
    CHECK(look.materials[1].ambient == 0);
    CHECK(look.materials[1].specular == 0);
    CHECK(look.materials[1].exponent == 7);
    const Scene eps =
        load_text(replace_text(painted, "offset = \"ulp\"\nulps = 4",
                               "offset = \"epsilon\"\nepsilon = 1e-3\nsurface = \"half_diffuse\"\nbackground = 0.25"));
    CHECK(eps.appearance.shadows->epsilon == Real(1) / 1000);
    CHECK(eps.appearance.shadows->keeps_half_diffuse);
    CHECK(eps.appearance.shadows->background == Real(1) / 4);
}

TEST_CASE("a scene asks for every stage that it has the inputs for, and stages do not replace each other") {
    const Appearance phong = load_text(painted).appearance;
    for (const Stage s : {Stage::visible, Stage::diffuse, Stage::shadows, Stage::phong})
        CHECK(phong.last_stage_up_to(s) == s);
    const Appearance matte = load_text(replace_text(painted, "ks = 0.5", "ks = 0")).appearance;
    CHECK(matte.last_stage() == Stage::shadows);
    CHECK_FALSE(matte.has_stage(Stage::phong));
    const Appearance plain =
        load_text(replace_text(painted, "[shadows]\nown = true\noffset = \"ulp\"\nulps = 4\n", "")).appearance;
    CHECK(plain.last_stage() == Stage::phong);
    CHECK(plain.last_stage_up_to(Stage::shadows) == Stage::diffuse);
}

TEST_CASE("wrong values of light and paint are refused with their line") {
    CHECK(broken("[0.25, 0.5, 1]", "[0.25, 0.5, 255]") ==
          "scene.toml:4:14: background is not between 0 and 1; a colour is [red, green, blue], each from 0 to 1 (a "
          "byte divided by 255)");
    CHECK(broken("colour = [1, 0.5, 0]", "colour = [1, -0.5, 0]")
              .starts_with("scene.toml:22:10: sphere[0].colour is not between 0 and 1"));
    CHECK(broken("ka = 0.125", "ka = -1") ==
          "scene.toml:16:6: material.ka is negative and would take light away; write 0 or more");
    CHECK(broken("n = 7", "n = 0").starts_with("scene.toml:18:5: material.n"));
    CHECK(broken("ks = 0.5", "ks = 4e38").starts_with("scene.toml:17:6: material.ks overflows binary32"));
    CHECK(broken("position = [5, 6, 7]", "position = [5, 6, 4e38]")
              .starts_with("scene.toml:10:12: light.position overflows binary32"));
    CHECK(has(broken("[light]\nposition = [5, 6, 7]\n", ""), "shadows need a light to cast them; add [light]"));
    const std::string dark = replace_text(replace_text(painted, "[light]\nposition = [5, 6, 7]\n", ""),
                                          "[shadows]\nown = true\noffset = \"ulp\"\nulps = 4\n", "");
    CHECK(has(scene_error(dark), "ks above 0 asks for a highlight, which needs a light; add [light]"));
    CHECK(broken("own = true\n", "").starts_with("scene.toml:12:1: shadows.offset needs own = true"));
    CHECK(broken("ulps = 4", "epsilon = 4").starts_with("scene.toml:14:1: shadows.epsilon needs offset = \"epsilon\""));
    CHECK(
        broken("ulps = 4", "ulps = 4\nbackground = 2").starts_with("scene.toml:15:14: shadows.background is above 1"));
}

TEST_CASE("rays of the pixel plane run from the eye through pixel centres at z = 0, where t = 1") {
    const Scene s = load_text(painted);  // 8 × 4 pixels over [-4, 4] × [-1, 3]: one unit each
    const auto frame = make_frame<double>(s);
    for (const auto& [x, y] : {std::pair{0, 0}, {7, 3}, {3, 1}}) {
        const Vec<double> p = pixel_point(frame, x, y);
        CHECK(p == Vec<double>(-3.5 + x, 2.5 - y, 0));
        const Ray<double> r = ray(frame, x, y);
        CHECK(r.origin == Vec<double>(1, 2, 10));
        CHECK(r.origin + r.direction == p);  // not normalised
    }
    const RayBlock rays = make_shared_rays(s, 1, 2);
    CHECK(rays.dx[2] == -1.5 - 1);
    CHECK(rays.dz[2] == -10);
    const Scene oblong = load_text(replace_text(painted, "extent = [-4, -1, 4, 3]", "extent = [0, 0, 4, 8]"));
    CHECK(pixel_point(make_frame<double>(oblong), 1, 0) == Vec<double>(0.75, 7, 0));
}

TEST_CASE("wrong values of the pixel plane are refused with their line") {
    CHECK(broken("eye = [1, 2, 10]", "eye = [1, 2, 0]")
              .starts_with("scene.toml:7:7: camera.eye lies in the plane of the pixels"));
    CHECK(broken("eye = [1, 2, 10]", "eye = [1, 2, 1e-60]")
              .starts_with("scene.toml:7:7: camera.eye lies in the plane of the pixels"));
    CHECK(broken("extent = [-4, -1, 4, 3]", "extent = [4, -1, 4, 3]")
              .starts_with("scene.toml:8:10: camera.extent covers nothing"));
    CHECK(broken("extent = [-4, -1, 4, 3]", "extent = [-4, -1, 4, 3]\nlook_at = [0, 0, 0]")
              .starts_with("scene.toml:9:1: camera.look_at has no meaning"));
    CHECK(scene_error(replace_text(good_scene, "width = 2.5", "width = 2.5\nextent = [0, 0, 1, 1]"))
              .starts_with("scene.toml:13:1: camera.extent belongs to kind"));
}

}  // namespace test_appearance
