// The scenes of the program: every scene loads and shows what it is meant to show.
#include <algorithm>
#include <cmath>

#include "catch.hpp"
#include "counts.hpp"
#include "number/real.hpp"
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
    for (const auto& file : list_scene_files(LOSTBITS_DATA_DIR))
        for (Scene& each : load_scene(file)) all.push_back(std::move(each));
    return all;
}

/// Every eighth pixel in each direction is enough for a fraction of the picture. For a mesh, whose triangles are tested
/// one by one, it is every sixteenth.
double hit_fraction(const Scene& scene) {
    const auto frame = make_frame<double>(scene);
    std::vector<Primitive<double>> primitives;
    for (const Primitive<Real>& primitive : scene.mesh ? scene.primitives() : scene.listed)
        primitives.push_back(round_primitive(primitive, binary64));
    const int step = scene.mesh ? 16 : lostbits::test::is_long() ? 4 : 8;
    int hit = 0, seen = 0;
    for (int y = 1; y < scene.height; y += step) {
        for (int x = 1; x < scene.width; x += step) {
            ++seen;
            hit += std::ranges::any_of(primitives, [&](const Primitive<double>& primitive) {
                const auto ends =
                    with_span(ray(frame, x, y), primitive, [](const auto& span) { return ends_of(span); });
                return ends && ends->near <= ends->far && ends->far >= 0;
            });
        }
    }
    return static_cast<double>(hit) / seen;
}

}  // namespace

TEST_CASE("every scene in data has a description, and shows hits and misses") {
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
            CHECK(hit == 1);  // there the ground, the primitive around or under the eye, or a seam fills the picture
        else CHECK(hit <= 0.98);
    }
}

}  // namespace test_data
