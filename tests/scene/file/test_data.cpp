// The scenes that come with the program: every one loads and shows what it is there to show.
#include <algorithm>
#include <cmath>
#include <map>

#include "catch.hpp"
#include "counts.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/rays.hpp"
#include "scene/scene_text.hpp"

namespace test_data {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::file;
using namespace lostbits::scene::rays;

namespace {

std::vector<Scene> all_scenes() {
    std::vector<Scene> all;
    for (const auto& file : scene_files(LOSTBITS_DATA_DIR))
        for (Scene& each : load_scene(file)) all.push_back(std::move(each));
    return all;
}

Scene find(const std::string& id) {
    for (Scene& each : all_scenes())
        if (each.id == id) return each;
    throw std::logic_error("no scene " + id);
}

/// Every eighth pixel each way is plenty for a fraction of the picture. Of a mesh, whose triangles are asked one by
/// one, it is every sixteenth.
double hit_fraction(const Scene& scene) {
    const auto frame = make_frame<double>(scene);
    std::vector<Solid<double>> solids;
    for (const Solid<Real>& solid : scene.mesh ? scene.solids() : scene.listed)
        solids.push_back(round_solid(solid, binary64));
    const int step = scene.mesh ? 16 : lostbits::test::is_long() ? 4 : 8;
    int hit = 0, seen = 0;
    for (int y = 1; y < scene.height; y += step) {
        for (int x = 1; x < scene.width; x += step) {
            ++seen;
            hit += std::ranges::any_of(solids, [&](const Solid<double>& solid) {
                const auto ends = with_span(ray(frame, x, y), solid, [](const auto& span) { return ends_of(span); });
                return ends && ends->near <= ends->far && ends->far >= 0;
            });
        }
    }
    return static_cast<double>(hit) / seen;
}

Real distance(const Scene& scene) {
    const Vec<Real> to = scene.listed.at(0).sphere().centre - scene.camera.eye;
    return length(to);
}

bool has_zero_or_equal_components(const Vec<double>& v) {
    const double x = std::fabs(v.x), y = std::fabs(v.y), z = std::fabs(v.z);
    return x == 0 || y == 0 || z == 0 || x == y || y == z || x == z;
}

}  // namespace

TEST_CASE("every scene is described and shows hits and misses") {
    for (const Scene& each : all_scenes()) {
        CAPTURE(each.id);
        CHECK_FALSE(each.title.empty());
        CHECK_FALSE(each.source.empty());
        CHECK_FALSE(each.note.empty());
        if (each.width * each.height == 1) continue;  // one ray, to be explained
        const double hit = hit_fraction(each);
        CHECK(hit >= 0.1);
        if (each.id == "camera-inside" || each.id == "sphereflake-far" || each.id == "offset-shells.inside" ||
            each.id == "consistency-on-surface" || each.id == "triangle-edge.close" ||
            each.id == "cylinder-along.inside")
            CHECK(hit == 1);  // there the ground, the solid around or under the eye, or a seam fills the picture
        else CHECK(hit <= 0.98);
    }
}

TEST_CASE("the spheres of figure 7-3 stand where they should, straight and oblique") {
    for (const int d : {100, 2000, 4100, 8000}) {
        const Scene straight = find("rtg-fig-7-3-" + std::to_string(d));
        const Scene oblique = find("rtg-fig-7-3-" + std::to_string(d) + "-oblique");
        CAPTURE(d);
        CHECK(distance(straight) == d);
        CHECK(abs(distance(oblique) - d) < 1e-14);
        CHECK(straight.listed[0].sphere().radius == 1);
        CHECK(hit_fraction(straight) == Approx(3.14159265 / 6.25).margin(0.01));
        CHECK(hit_fraction(oblique) == Approx(3.14159265 / 6.25).margin(0.01));
        const RayBlock straight_rays = make_shared_rays(straight, 100, 101);
        const RayBlock oblique_rays = make_shared_rays(oblique, 100, 101);
        CHECK(straight_rays[7].direction == Vec<double>(0, 0, -1));
        CHECK_FALSE(has_zero_or_equal_components(oblique_rays[7].direction));
    }
}

TEST_CASE("figure 7-4 stands on ever larger spheres, with no zero components") {
    for (const auto& [name, radius] : std::map<std::string, int>{
             {"r1e3", 1000}, {"r1e4", 10000}, {"r1e5", 100000}, {"r1e6", 1000000}, {"r6371000", 6371000}}) {
        const Scene s = find("rtg-fig-7-4." + name);
        CAPTURE(name);
        CHECK(s.listed[0].sphere().radius == radius);
        CHECK(s.listed[0].sphere().centre.y == -radius);  // the ground's top is at y = 0
        CHECK(s.width == 320);
        CHECK(s.height == 240);
        const RayBlock rays = make_shared_rays(s, 0, s.height);
        std::size_t special = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) special += rays.dx[i] == 0 || rays.dy[i] == 0 || rays.dz[i] == 0;
        CHECK(special == 0);
    }
}

TEST_CASE("the camera of camera-inside is inside, off centre") {
    const Scene s = find("camera-inside");
    CHECK(distance(s) < s.listed[0].sphere().radius);
    CHECK(distance(s) > 0.1);
}

TEST_CASE("grazing rays pass within a thousandth of the limb, half of them hitting") {
    const Scene s = find("grazing");
    CHECK(hit_fraction(s) == Approx(0.5).margin(0.02));
    const RayBlock rays = make_shared_rays(s, 0, s.height);
    const Sphere<Real> sphere = s.listed[0].sphere();
    for (std::size_t i = 0; i < rays.size(); i += 97) {
        const Vec<Real> o(Real(rays.ox[i]), Real(rays.oy[i]), Real(rays.oz[i])),
            d(Real(rays.dx[i]), Real(rays.dy[i]), Real(rays.dz[i]));
        const Vec<Real> c = cross<Real>(sphere.centre - o, d);
        const Real apart = length(c) / length(d);
        REQUIRE(abs(apart - 1) < 1e-3);
    }
}

TEST_CASE("the offset worlds are near-benign, moved exactly") {
    const Scene near = find("near-benign");
    const Vec<Real> offset(scene::test::real("100000"), scene::test::real("100000.3"), scene::test::real("-99999.7"));
    for (const std::string id : {"world-offset", "world-offset-own"}) {
        const Scene moved = find(id);
        CAPTURE(id);
        CHECK(moved.inputs == (id == "world-offset" ? Inputs::shared : Inputs::own));
        const auto is_moved = [&](const Vec<Real>& a, const Vec<Real>& b) {
            const Vec<Real> d = b - a - offset;
            return length(d) < 1e-70;
        };
        CHECK(is_moved(near.camera.eye, moved.camera.eye));
        CHECK(is_moved(near.camera.look_at, moved.camera.look_at));
        REQUIRE(moved.listed.size() == near.listed.size());
        for (std::size_t i = 0; i < near.listed.size(); ++i) {
            CHECK(is_moved(near.listed[i].sphere().centre, moved.listed[i].sphere().centre));
            CHECK(moved.listed[i].sphere().radius == near.listed[i].sphere().radius);
        }
    }
}

TEST_CASE("own inputs show in world-offset-own: binary32 moves the eye by more than double does") {
    const Scene s = find("world-offset-own");
    const IdealRayBlock ideal = make_own_rays(s, 0, 1);
    const auto moved = [&](const FloatFormat& f) { return abs(Real(round_rays(ideal, f).ox[0]) - ideal.ox[0]); };
    CHECK(moved(binary32) > 1e-4);
    CHECK(moved(binary64) < 1e-11);
    CHECK(moved(binary64) > 0);
}

}  // namespace test_data
