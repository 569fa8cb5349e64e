// Shaders in HLSL, which Vulkan runs.
#include <initializer_list>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"

namespace test_hlsl {

using namespace lostbits::test;

namespace {

const std::string examples = std::string(LOSTBITS_SOURCE_DIR) + "/examples/shaders/";

Outcome map_by(const Scratch& folder, const std::string& scene, const std::string& words) {
    return run("map " + scene + " --size 96x64 -f f32 --pixels csv -o out " + words, folder.path());
}

}  // namespace

TEST_CASE("hlsl: the analytic sphere has the same bits as in GLSL", "[shader-device]") {
    for (const std::string scene : {"near-benign", "rtg-fig-7-3-4100-oblique"}) {
        const Scratch folder;
        const Outcome o = map_by(folder, scene,
                                 "-i 'shader.*' --device vulkan --shader " + examples +
                                     "sphere.hlsl:name=hlsl --shader " + examples + "sphere.glsl:name=glsl");
        INFO(o.err);
        REQUIRE(o.code == 0);
        const auto out = folder.path() / "out" / scene;
        const std::string glsl = contents(out / "shader.glsl.vulkan.f32.csv");
        CHECK(glsl.size() > 100'000);
        CHECK(glsl == contents(out / "shader.hlsl.vulkan.f32.csv"));
    }
}

TEST_CASE("hlsl: boxes, fields, out parameters and other entry points are accepted, without options on Vulkan",
          "[shader-device]") {
    const Scratch folder;
    const std::string box = folder.write("box.hlsl", R"(cbuffer Frame : register(b0) { float time; };
Texture2D<float4> picture : register(t0);
SamplerState smooth : register(s0);
float4 main(float4 at : SV_POSITION, float2 uv : TEXCOORD0) : SV_TARGET {
    return picture.Sample(smooth, uv) + lerp(0, time, at.x);
}
bool hit(float3 orig, float3 dir, float3 boxMin, float3 boxMax, out float tmin, out float tmax) {
    float3 a = (boxMin - orig) / dir, b = (boxMax - orig) / dir, n = min(a, b), f = max(a, b);
    tmin = max(max(n.x, n.y), n.z);
    tmax = min(min(f.x, f.y), f.z);
    return tmax >= max(tmin, 0.0);
}
)");
    const Outcome boxes = must("plugin check --shader " + box + ":touching=miss", folder.path());
    CHECK(has(boxes.out, "shader.box in binary32"));
    CHECK(has(boxes.out, "Vulkan"));
    const std::string field = folder.write("field.hlsl",
                                           "float map(float3 p, float4 s) { float3 q = p - s.xyz;\n"
                                           "return sqrt(q.x * q.x + q.y * q.y + q.z * q.z) - s.w; }\n");
    const Outcome marched = map_by(
        folder, "sdf-sphere",
        "-i 'shader.*' --device vulkan --shader " + field + ":name=hlsl --shader " + examples + "field.glsl:name=glsl");
    INFO(marched.err);
    REQUIRE(marched.code == 0);
    const auto out = folder.path() / "out" / "sdf-sphere";
    CHECK(contents(out / "shader.glsl.vulkan.f32.csv") == contents(out / "shader.hlsl.vulkan.f32.csv"));
}

TEST_CASE("hlsl: a shader that does not run is reported with the user's line or a sentence", "[shader-device]") {
    const std::string head = "float f(float3 ro, float3 rd, float4 s) {\n    ";
    struct Fault {
        std::string text, words, says;
        int code;
    };
    for (const Fault& fault : std::initializer_list<Fault>{
             {head + "return ro.x + nope;\n}\n", "", "mine.hlsl:2:19: 'nope' : unknown variable", 2},
             {"float speed;\n" + head + "return speed;\n}\n", "",
              "no host program sets it when lostbits runs the shader; declare it `static const`", 2},
             {"cbuffer Frame { float time; };\n" + head + "return time;\n}\n", "",
              "is read, but no host program sets it", 2},
             {head + "return 1;\n}\n", ":format=f64", "HLSL is measured in floats", 2},
             {head + "return 1;\n}\n", " --device opengl", "opengl: takes only GLSL; --device vulkan takes HLSL too",
              3}}) {
        const Scratch folder;
        const Outcome o =
            map_by(folder, "near-benign", "--shader " + folder.write("mine.hlsl", fault.text) + fault.words);
        INFO(fault.text << o.err);
        CHECK(o.code == fault.code);
        CHECK(has(o.err, fault.says));
        CHECK(folder.files() == std::vector<std::string>{"mine.hlsl"});
    }
}

}  // namespace test_hlsl
