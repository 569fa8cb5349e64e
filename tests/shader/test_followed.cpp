// Functions of shaders as `--function` follows them: on Vulkan's driver they have the bits of `--shader`.
#include <map>
#include <string>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"

namespace test_followed {

using namespace lostbits::test;

TEST_CASE("functions of shaders: their operations have the bits of the driver", "[shader-device]") {
    struct Case {
        std::string file, function, scene;
    };
    const std::string examples = std::string(LOSTBITS_SOURCE_DIR) + "/examples/shaders/",
                      functions = std::string(LOSTBITS_SOURCE_DIR) + "/tests/external/functions/";
    for (const auto& [file, function, scene] : {Case{examples + "sphere.glsl", "sphere", "rtg-fig-7-3-4100-oblique"},
                                                {examples + "sphere.hlsl", "sphere", "near-benign"},
                                                {examples + "sphere_tracer.glsl", "march", "near-benign"},
                                                {examples + "box.glsl", "slabs", "box-far"},
                                                {functions + "public.glsl", "sphere", "rtg-fig-7-3-4100-oblique"},
                                                {functions + "public.glsl", "capsule", "capsule-far"},
                                                {functions + "public.glsl", "hit_box", "box-slabs"},
                                                {functions + "public.hlsl", "hit", "triangle-far"},
                                                {functions + "features.glsl", "odd", "near-benign"}}) {
        CAPTURE(file, function);
        const Scratch folder;
        const std::string named = file + ":" + function;
        must("map " + scene +
                 " --size 104x100 -f f32 --pixels csv -o out -i 'shader.*' -i 'function.*' --device vulkan" +
                 " --shader " + named + ",name=own" + (function == "hit_box" ? ",direction=any" : "") + " --function " +
                 named,
             folder.path());
        const auto out = folder.path() / "out" / scene;
        const auto on_driver = read_csv(out / "shader.own.vulkan.f32.csv");
        const auto followed = read_csv(out / ("function." + function + ".f32.csv"));
        REQUIRE(on_driver.size() == 10'400);
        REQUIRE(followed.size() == on_driver.size());
        std::size_t differ = 0, hits = 0;
        for (std::size_t i = 0; i < followed.size(); ++i) {
            hits += on_driver[i].at("t_hex").empty() ? 0 : 1;
            differ += on_driver[i].at("t_hex") != followed[i].at("t_hex") ? 1 : 0;
        }
        CHECK(differ == 0);
        CHECK(hits > 500);
    }
}

}  // namespace test_followed
