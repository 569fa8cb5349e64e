// Rays of ray generators in each format, from the command line: the generators, their measurements, and messages on
// wrong input.
#include <set>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"
#include "scene/camera/ray_generators.hpp"

namespace test_cli_made_rays {

namespace {

/// Generators that do not subtract two points of the world.
const std::set<std::string_view> stay_apart{"bevy_view", "nvpro",         "godot",   "optix",
                                            "pbrt",      "differentials", "relative"};

}  // namespace

using namespace lostbits;
using namespace lostbits::test;

TEST_CASE("12 km from the origin only generators that subtract world points lose the direction") {
    const Scratch folder;
    must(
        "map camera-far.zero_to_one -i 'sphere.unified@ray-*' -f f32 --size 24x24 --metric pixel_error --metric "
        "direction_lost_bits --metric origin_lost_bits --metric origin_error" +
        into(folder));
    const auto rows = read_csv(folder / "out/camera-far.zero_to_one/summary.csv");
    REQUIRE(rows.size() == scene::camera::ray_generators().size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const auto& row = rows[k];
        const scene::camera::RayGenerator& generator = scene::camera::ray_generators()[k];
        CAPTURE(row.at("form"));
        CHECK(row.at("form") == "sphere.unified@ray-" + std::string(generator.info->name));
        const bool apart = stay_apart.contains(generator.info->name);
        CHECK((apart ? number_in(row.at("direction_lost_bits_max")) < 5
                     : number_in(row.at("direction_lost_bits_p50")) > 6));
        // The eye consists of numbers of the format, but a point of the near plane does not.
        if (generator.info->name != "nvpro")
            CHECK((number_in(row.at("origin_error_max")) > 0) == generator.info->starts_on_near_plane);
    }
}

TEST_CASE("a ray generator in the form's name and the same one in the scene give one map") {
    const Scratch folder;
    const auto mapped = [&folder](const std::string& words, const std::string& name) {
        must("map camera-far.endless " + words +
             " -f f32 -f fp16 --size 16x16 --metric lost_bits --metric pixel_error" + into(folder, name));
        return read_csv(folder.path() / name / "camera-far.endless/summary.csv");
    };
    for (const std::string generator : {"three", "bevy"}) {
        CAPTURE(generator);
        const auto behind = mapped("-i sphere.unified@ray-" + generator, "behind-" + generator),
                   inside = mapped("-i sphere.unified --set camera.rays=" + generator, "inside-" + generator);
        REQUIRE(behind.size() == 2);
        for (std::size_t k = 0; k < behind.size(); ++k)
            for (const auto& [column, value] : behind[k])
                if (column != "form" && !value.starts_with("lostbits explain")) CHECK(inside[k].at(column) == value);
    }
}

TEST_CASE("explain uses the ray of the ray generator") {
    const auto x = nlohmann::json::parse(
        run("explain camera-far.endless --pixel 90,100 -i sphere.unified@ray-bevy -f f32 --json").out);
    const auto y = nlohmann::json::parse(
        run("explain camera-far.endless --set camera.rays=bevy --pixel 90,100 -i sphere.unified -f f32 --json").out);
    const auto z =
        nlohmann::json::parse(run("explain camera-far.endless --pixel 90,100 -i sphere.unified -f f32 --json").out);
    CHECK(x["t"] == y["t"]);
    CHECK(x["truth"] == y["truth"]);
    CHECK(x["inputs"] == y["inputs"]);
    // The tape begins with the numbers of the camera that the generator uses, and not with the ray.
    CHECK(x["inputs"].contains("to_world.r0c3"));
    CHECK(x["inputs"].contains("pixel.x"));
    CHECK_FALSE(x["inputs"].contains("view.r0c0"));
    CHECK_FALSE(x["inputs"].contains("d.x"));
    CHECK(z["inputs"].contains("d.x"));
}

}  // namespace test_cli_made_rays
