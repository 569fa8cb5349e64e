// Functions in GLSL, HLSL and SPIR-V as they are: the forms they become, the places of their operations, and messages
// about damaged files.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"
#include "intersect/function/signature.hpp"
#include "intersect/spirv/llvm_text.hpp"
#include "user_functions.hpp"

namespace test_spirv {

using namespace lostbits;
using namespace lostbits::test;
using intersect::function::load_function;

namespace {

const std::string& folder = functions_folder;

void shell(const std::string& command) { REQUIRE(std::system(command.c_str()) == 0); }

/// Compiles a file to SPIR-V as a user would, in a fragment shader.
std::string compile_to_spirv(const Scratch& made, const std::string& glsl, const std::string& options) {
    std::ofstream(made.path() / "own.frag") << glsl;
    const std::string to = made.path().string() + "/own.spv";
    shell("cd " + made.path().string() + " && glslangValidator -V --keep-uncalled " + options + " -o " + to +
          " own.frag >/dev/null");
    return to;
}

constexpr const char* sphere = R"(#version 450
layout(location = 0) out vec4 colour;
float ball(vec3 ro, vec3 rd, vec4 s) {
    vec3 f = ro - s.xyz;
    float b = dot(f, rd), c = dot(f, f) - s.w * s.w;
    float h = b * b - c;
    return h < 0.0 ? -1.0 : -b - sqrt(h);
}
void main() { colour = vec4(ball(vec3(0), vec3(1), vec4(2))); }
)";

}  // namespace

TEST_CASE("spirv: signatures of GLSL and HLSL, and bits in both formats", "[external]") {
    struct Case {
        const char *named, *says;
    };
    int in_both = 0;
    for (const auto& [named, says] :
         {Case{"public.glsl:sphere",
               "centre = center, radius = radius; t = its x, far = its y; hit where t is not neg"},
          Case{"public.glsl:capsule", "start = start, end = end, radius = radius; t = the result"},
          Case{"public.glsl:hit_box",
               "1/direction = invDir, lo = boxMin, hi = boxMax; hit where the result is not 0, t"},
          Case{"public.glsl:triangle", "a = v0, b = v1, c = v2; t = its x; hit where t is not negative"},
          Case{"public.hlsl:hit_triangle", "origin = ray.origin, direction = ray.direction, a = v0, b = v1, c = v2"},
          Case{"public.hlsl:sphere_roots", "hit where the result is not 0, t = near, far = far"},
          Case{"features.glsl:many@59", "centre = ball, radius = r"},
          Case{"features.glsl:whole", "centre = ball, radius = ball.w"},
          Case{"features.glsl:odd", "centre = ball, radius = ball.w; t = the result"},
          Case{"features.glsl:odd:sphere(o, d, c, r)", "centre = ball, radius = ball.w; t = the result"},
          Case{"../../../examples/shaders/box.glsl:slabs",
               "t = its x, far = its y; hit where t <= far and far is not"}}) {
        CAPTURE(named);
        const auto f = load_function(folder + named, {});
        CHECK(f->signature_text.find(says) != std::string::npos);
        CHECK(count_differences(*f) == 0);
        if (!std::string(named).starts_with("public")) continue;
        in_both += agrees_in_other_format(folder + named, f->bits) ? 1 : 0;
    }
    CHECK(in_both >= 1);
}

TEST_CASE("spirv: the culprit is a line and a column of the user's file", "[external]") {
    const auto run_explain = [](const std::string& named, const std::string& form) {
        return must("explain rtg-fig-7-3-4100-oblique --pixel 128,40 -f f32 -i function." + form + " --function " +
                    named)
            .out;
    };
    for (const char* const ending : {"glsl", "hlsl"}) {
        const std::string said =
            run_explain(std::string(LOSTBITS_SOURCE_DIR) + "/examples/shaders/sphere." + ending + ":sphere", "sphere");
        CHECK(said.find(":37\n " + std::string(ending[0] == 'g' ? "8" : "7") +
                        " |     float disc = b * b - (dot(f, f) - radius * radius);\n"
                        "   |                           ~~~~~~~~~~^~~~~~~~~~~~~~~~~\n") != std::string::npos);
    }
    const auto odd = load_function(folder + "features.glsl:odd", {});
    CHECK(std::ranges::any_of(odd->places, [](const auto& p) { return p.line == 36 && p.column == 87; }));
    // Rounding inside this function is a part of its error only: no operation is to blame, and none is quoted.
    const std::string unblamed = run_explain(folder + "features.glsl:odd", "odd");
    CHECK(unblamed.find("No operation is to blame") != std::string::npos);
    CHECK(unblamed.find("features.glsl:") == std::string::npos);
    // A SPIR-V file names lines of its source if it has them, and otherwise lines of its assembly.
    const Scratch made;
    const std::string with = run_explain(compile_to_spirv(made, sphere, "-g") + ":ball", "ball");
    CHECK(with.find("own.frag:5:41\n 5 |     float b = dot(f, rd), c = dot(f, f) - s.w * s.w;") != std::string::npos);
    // Newer debug information has the same names, and lines without columns.
    const std::string newer = run_explain(compile_to_spirv(made, sphere, "-gV") + ":ball", "ball");
    CHECK(newer.find("own.frag:5") != std::string::npos);
    compile_to_spirv(made, sphere, "-g");
    shell("spirv-opt --strip-debug " + made.path().string() + "/own.spv -o " + made.path().string() + "/none.spv");
    CHECK(find_refusal(made.path().string() + "/none.spv:ball").find("has no function") != std::string::npos);
    const std::string without = run_explain(compile_to_spirv(made, sphere, "") + ":ball", "ball");
    CHECK(without.find(" = OpFSub %float ") != std::string::npos);
}

TEST_CASE("spirv: maps of the culprit, contraction and mend take functions of shaders", "[external]") {
    const Scratch made;
    const std::string words =
        " --function " + std::string(LOSTBITS_SOURCE_DIR) + "/examples/shaders/sphere.glsl:sphere ";
    must(
        "map near-benign --size 8x8 -f f32 -f f64 -f fp16 --metric culprit -o out -i function.sphere -i "
        "function.sphere+fma" +
            words,
        made.path());
    CHECK(must("mend rtg-fig-7-3-4100-oblique --bits 16 --size 8x8 -i function.sphere" + words, made.path())
              .out.find("Written another way it keeps") != std::string::npos);
}

TEST_CASE("spirv: what cannot be followed is refused with its place", "[external]") {
    const std::string file = folder + "features.glsl:";
    CHECK(find_refusal(file + "wave").find("features.glsl:44:5: it calls sin, which is not followed") !=
          std::string::npos);
    CHECK(find_refusal(file + "timed")
              .find("features.glsl:45:70: it reads time, which nothing in the file sets to one") != std::string::npos);
    CHECK(find_refusal(file + "endless").find("features.glsl:49:53: a loop has no bound") != std::string::npos);
    CHECK(find_refusal(file + "rounded").find("features.glsl:52:66: a number becomes an integer") != std::string::npos);
    CHECK(find_refusal(file + "nothing")
              .ends_with("it defines \"endless\", \"kind\", \"many\", \"odd\", \"rounded\", "
                         "\"timed\", \"turn\", \"wave\", \"whole\""));
    const std::string many = find_refusal(file + "many");
    CHECK(many.find("has several functions \"many\"; name one by its line: ") != std::string::npos);
    CHECK(many.find("many@58") != std::string::npos);
    CHECK(many.find("many@59") != std::string::npos);
    const Scratch made;
    std::ofstream(made.path() / "broken.glsl") << "float f(vec3 ro) {\n    return rd.x;\n}\n";
    const std::string broken = find_refusal(made.path().string() + "/broken.glsl:f");
    CHECK(broken.find("broken.glsl:2: 'rd' : undeclared identifier") != std::string::npos);
    CHECK(broken.find("Missing entry point") == std::string::npos);
    std::ofstream(made.path() / "empty.spv") << "";
    CHECK(find_refusal(made.path().string() + "/empty.spv:f").find("spirv-val") != std::string::npos);
}

TEST_CASE("spirv: damaged SPIR-V and GLSL give a sentence", "[external]") {
    const Scratch made;
    const std::string spirv = compile_to_spirv(made, sphere, "-g");
    const std::string own = made.path().string() + "/own.spvasm";
    shell("spirv-dis --no-color --no-header -o " + own + " " + spirv);
    const std::string whole = contents(own), binary = contents(spirv);
    const auto read = [](const std::string& assembly) {
        try {
            const std::string text = intersect::spirv::translate_to_llvm(assembly, "/x/own.spv", {}, false);
            intersect::function::Module module(text);
            auto s = intersect::function::read_signature(module, "own.spv", "ball",
                                                         intersect::function::SourceLanguage::llvm);
            intersect::function::guess_signature(s, {}, "own.spv:ball");
            return true;
        } catch (const InputError&) {
            return false;
        }
    };
    REQUIRE(read(whole));
    std::size_t refused = 0;
    for (std::size_t size = 0; size < whole.size(); size += 11) refused += read(whole.substr(0, size)) ? 0 : 1;
    std::mt19937 random(5);
    for (int k = 0; k < 3000; ++k) refused += read(damage(whole, random, "%_0123456789 \"\nOpv", 5)) ? 0 : 1;
    CHECK(refused > 300);
    // The whole way to a form, with real programs.
    const int count = is_long() ? 400 : 40;
    for (int k = 0; k < count; ++k) {
        std::string words = binary;
        for (int changes = 0; changes < 2; ++changes)
            words[20 + random() % (words.size() - 20)] ^= char(1 << random() % 8);
        std::ofstream(made.path() / "some.spv", std::ios::binary) << words;
        std::ofstream(made.path() / "some.glsl") << damage(sphere, random, "(){};,.+-*/0f \n#\\", 5);
        for (const char* const ending : {"spv", "glsl"})
            find_refusal(made.path().string() + "/some." + ending + ":ball");
    }
}

}  // namespace test_spirv
