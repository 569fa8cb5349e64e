// Rays that each format makes, from the command line: which ways there are, what is measured of them, and what is said
// of mistakes.
#include <set>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"
#include "scene/camera/makers.hpp"

namespace test_cli_made_rays {

namespace {

/// Ways that take no difference of two points of the world.
const std::set<std::string_view> stay_apart{"bevy_view", "nvpro",         "godot",   "optix",
                                            "pbrt",      "differentials", "relative"};

}  // namespace

using namespace lostbits;
using namespace lostbits::test;

TEST_CASE("twelve kilometres out the ways that subtract points of the world lose the direction, and no other does") {
    const Scratch folder;
    must(
        "map camera-far.zero_to_one -i 'sphere.unified@ray-*' -f f32 --size 24x24 --metric pixel_error --metric "
        "direction_lost_bits --metric origin_lost_bits --metric origin_error" +
        into(folder));
    const auto rows = read_csv(folder / "out/camera-far.zero_to_one/summary.csv");
    REQUIRE(rows.size() == scene::camera::makers().size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const auto& row = rows[k];
        const scene::camera::Maker& maker = scene::camera::makers()[k];
        CAPTURE(row.at("form"));
        CHECK(row.at("form") == "sphere.unified@ray-" + std::string(maker.info->name));
        const bool apart = stay_apart.contains(maker.info->name);
        CHECK((apart ? number_in(row.at("direction_lost_bits_max")) < 5
                     : number_in(row.at("direction_lost_bits_p50")) > 6));
        // The eye is made of numbers of the format, and a point of the near plane is not.
        if (maker.info->name != "nvpro") CHECK((number_in(row.at("origin_error_max")) > 0) == maker.info->from_near);
    }
}

TEST_CASE("a way behind the form and the same way in the scene are one map") {
    const Scratch folder;
    const auto mapped = [&folder](const std::string& words, const std::string& name) {
        must("map camera-far.endless " + words +
             " -f f32 -f fp16 --size 16x16 --metric lost_bits --metric pixel_error" + into(folder, name));
        return read_csv(folder.path() / name / "camera-far.endless/summary.csv");
    };
    for (const std::string maker : {"three", "bevy"}) {
        CAPTURE(maker);
        const auto behind = mapped("-i sphere.unified@ray-" + maker, "behind-" + maker),
                   inside = mapped("-i sphere.unified --set camera.rays=" + maker, "inside-" + maker);
        REQUIRE(behind.size() == 2);
        for (std::size_t k = 0; k < behind.size(); ++k)
            for (const auto& [column, value] : behind[k])
                if (column != "form" && !value.starts_with("lostbits explain")) CHECK(inside[k].at(column) == value);
    }
}

TEST_CASE("explain looks at the ray that the way makes") {
    const auto x = nlohmann::json::parse(
        run("explain camera-far.endless --pixel 90,100 -i sphere.unified@ray-bevy -f f32 --json").out);
    const auto y = nlohmann::json::parse(
        run("explain camera-far.endless --set camera.rays=bevy --pixel 90,100 -i sphere.unified -f f32 --json").out);
    const auto z =
        nlohmann::json::parse(run("explain camera-far.endless --pixel 90,100 -i sphere.unified -f f32 --json").out);
    CHECK(x["t"] == y["t"]);
    CHECK(x["truth"] == y["truth"]);
    CHECK(x["inputs"] == y["inputs"]);
    // The tape begins with the camera's numbers, those that the way takes, and not with the ray.
    CHECK(x["inputs"].contains("to_world.r0c3"));
    CHECK(x["inputs"].contains("pixel.x"));
    CHECK_FALSE(x["inputs"].contains("view.r0c0"));
    CHECK_FALSE(x["inputs"].contains("d.x"));
    CHECK(z["inputs"].contains("d.x"));
}

TEST_CASE("what is wrong with a way to make rays is said, and nothing is written") {
    const std::string own = "gives forms the camera's own rays", each = "each format makes the rays of this scene";
    const Scratch folder;
    check_refused(folder, "map -f f32 -o out",
                  {{"camera-far.endless -i sphere.unified@ray-thre", "unknown maker; did you mean \"three\"?"},
                   {"camera-far.endless -i sphere.unified@ray-three@ray-dxr", "stands behind one form"},
                   {"instance-far.sphere -i sphere.unified@plain@ray-dxr", "camera.rays = \"dxr\""},
                   {"camera-far.endless -i sphere.unified@ray-dxr^box.signs", "the rays stands last"},
                   {"instance-far.sphere -i sphere.unified@ray-dxr@pbrt", "the rays stands last"},
                   {"spheres-on-floor -i sphere.unified@ray-dxr+box.signs", "of several shapes"},
                   {"near-benign -i sphere.unified@ray-dxr", "need the planes of a projection"},
                   {"camera-far.endless --set camera.projection.near=0", "must be greater than 0"},
                   {"camera-far.gl --set camera.projection.far=0.125", "is not beyond near"},
                   {"camera-far.endless -i sphere.unified@ray-dxr --bits-needed 12", own}});
    check_refused(folder, "",
                  {{"sweep sphere-distance -i sphere.unified@ray-dxr -f f32 -o out",
                    "are not those of a camera with a projection"},
                   {"offsets camera-far.endless -i sphere.unified@ray-dxr -o out", own},
                   {"offsets camera-far.endless --set camera.rays=dxr -o out", each},
                   {"choose camera-far.endless --set camera.rays=dxr --bits 12 -o out", each},
                   {"trade -i sphere.unified@ray-dxr -o out", own},
                   {"explain camera-far.endless --ray 0,0,0,0,0,1 -i sphere.unified@ray-dxr", "no camera makes it"}});
}

}  // namespace test_cli_made_rays
