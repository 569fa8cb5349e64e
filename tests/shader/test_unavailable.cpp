// Shaders that cannot run: clear words, the right exit status, and no half-written file.
#include <initializer_list>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"

namespace test_unavailable {

using namespace lostbits::test;

namespace {

const std::string examples = std::string(LOSTBITS_SOURCE_DIR) + "/examples/shaders/";

Outcome map_by(const Scratch& folder, const std::string& shader, const std::string& more = "",
               const std::string& before = "") {
    const std::string size = has(more, "--size") ? "" : " --size 32x24";
    return run("map near-benign" + size + " -i 'shader.*' -f f32 -o out --shader " + shader + " " + more, folder.path(),
               before);
}

}  // namespace

TEST_CASE("shader: a compile error is reported with the user's lines on each driver", "[shader-device]") {
    struct Fault {
        std::string text, place, says;
    };
    const std::string head = "#version 300 es\n// a comment\n";
    for (const Fault& f : std::initializer_list<Fault>{
             {head + "float f(vec3 ro, vec3 rd, vec4 s) {\n    float b = 1.0;\n    return b + nope;\n}\n",
              "mine.glsl:5:16: ", "nope"},
             {head + "float f(vec3 ro, vec3 rd, vec4 s) {\n    return vec3(1.0);\n}\n", "mine.glsl:4:5: ", ""},
             {head + "#if 0\nfloat f(vec3 ro, vec3 rd, vec4 s) { return 1.0; }\n#endif\n", "mine.glsl:4:7: ", "`f`"}}) {
        for (const std::string device : {"opengl", "vulkan"}) {
            const Scratch folder;
            const std::string file = folder.write("mine.glsl", f.text);
            const Outcome o = map_by(folder, file, "--device " + device);
            INFO(device << ": " << o.err);
            CHECK(o.code == 2);
            CHECK(has(o.err, f.place));
            CHECK(has(o.err, f.says));
            CHECK(folder.files() == std::vector<std::string>{"mine.glsl"});
        }
    }
}

TEST_CASE("shader: a missing driver is reported in a sentence", "[shader-device]") {
    const std::string no_gl = "__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null ", no_vulkan = "VK_ICD_FILENAMES=/dev/null ";
    const std::string no_mesa = "LIBGL_DRIVERS_PATH=/nonexistent GALLIUM_DRIVER=none ";
    // Modules that do not load, as if the libraries that they were linked with were missing.
    const Scratch broken;
    for (const char* module : {"lostbits_opengl.so", "lostbits_vulkan.so"}) (void)broken.write(module, "no library");
    struct Closed {
        std::string before, device, says;
    };
    for (const Closed& c : std::initializer_list<Closed>{
             {no_gl, "--device opengl", "opengl: no driver with OpenGL 4.3 works without a window"},
             {no_mesa, "--device opengl", "opengl: no driver with OpenGL 4.3 works without a window"},
             {no_vulkan, "--device vulkan", "vulkan: no driver works"},
             {no_gl + no_vulkan, "", "no driver can run shaders here"},
             {no_gl + no_vulkan, "--device all", "no driver can run shaders here"},
             {"PATH=/nonexistent ", "--device vulkan", "glslangValidator is missing"},
             {"LOSTBITS_DEVICE_MODULES=" + broken.path().string() + " ", "--device opengl",
              "install its libraries (Debian: libegl1 libopengl0)"},
             {"LOSTBITS_DEVICE_MODULES=" + broken.path().string() + " ", "", "no driver can run shaders here"}}) {
        const Scratch folder;
        const Outcome o = map_by(folder, examples + "sphere.glsl", c.device, c.before);
        INFO(c.before << c.device << ": " << o.err);
        CHECK(o.code == 3);
        CHECK(has(o.err, c.says));
        CHECK(folder.files().empty());
    }
    const Scratch folder;
    const Outcome devices = run("devices", folder.path(), no_gl + no_vulkan);
    CHECK(devices.code == 3);
    CHECK(has(devices.out, "opengl\n  not available: no driver with OpenGL 4.3 works"));
    const Outcome list = must("list devices", folder.path(), no_gl + no_vulkan);
    CHECK(has(list.err, "no driver can run shaders here; `lostbits devices` says"));
    // Everything except shaders works.
    must("map near-benign --size 16x12 -i sphere.press -f f32 -o out", folder.path(), no_gl + no_vulkan);
    // The other driver is used instead, and the output says so.
    const Outcome other = map_by(folder, examples + "sphere.glsl", "", no_gl);
    INFO(other.err);
    CHECK(other.code == 0);
    CHECK(has(contents(folder.path() / "out" / "near-benign" / "datapackage.json"), "Vulkan"));
}

TEST_CASE("shader: an endless shader is stopped and named", "[shader-device]") {
    const Scratch folder;
    std::string body = "n = pow(abs(sin(n * 1.37 + rd.x)), 1.01);";
    for (int k = 0; k < 6; ++k) body += body;
    // No driver's limit on iterations ends this soon: 60000 times 64 powers of sines, for each of 12288 rays.
    const std::string file = folder.write("slow.glsl",
                                          "float f(vec3 ro, vec3 rd, vec4 s) {\n    float n = 1.0;\n"
                                          "    for (int i = 0; i < 60000; ++i) {" +
                                              body + "}\n    return n;\n}\n");
    const Outcome o = map_by(folder, file, "--size 128x96 --time-limit 4");
    INFO(o.err);
    CHECK(o.code == 3);
    CHECK(has(o.err, "slow.glsl"));
    CHECK(has(o.err, "within the time limit"));
    CHECK(folder.files() == std::vector<std::string>{"slow.glsl"});
}

TEST_CASE("shader: a compiler of shaders that is killed leaves no temporary folder", "[shader-device]") {
    const Scratch folder, temporary;
    const std::string compiler = folder.write("bin/glslangValidator", "#!/bin/sh\nexec sleep 60\n");
    fs::permissions(compiler, fs::perms::owner_all);
    const Outcome o = map_by(folder, examples + "sphere.glsl", "--device vulkan --time-limit 1",
                             "export TMPDIR='" + temporary.path().string() + "' PATH=\"$PWD/bin:$PATH\";");
    INFO(o.err);
    CHECK(o.code == 3);
    CHECK(has(o.err, "within the time limit"));
    CHECK(fs::is_empty(temporary.path()));
}

TEST_CASE("shader: a lost device ends the run with a message, and nothing is half-written", "[shader-device]") {
    for (const std::string device : {"opengl", "vulkan"}) {
        for (const std::string silently : {"", "SILENTLY=1 "}) {
            // Its first work is the driver's probe, later ones are batches of rays; the last value is more than there
            // are.
            int lost = 0, named = 0;
            for (int at = 1;; at *= 4) {
                const Scratch folder;
                const Outcome o =
                    map_by(folder, examples + "sphere.glsl", "--size 192x128 --device " + device,
                           silently + "LOST_AT=" + std::to_string(at) + " LD_PRELOAD=" LOSTBITS_LOST_DEVICE);
                INFO(device << ' ' << silently << at << ": " << o.err);
                if (o.code == 0) break;
                ++lost;
                REQUIRE(at < 1000);
                CHECK(o.code == 3);
                named += has(o.err, "sphere.glsl");  // of a batch; a probe is the driver's affair
                CHECK(has(o.err, device + ": the device is lost"));
                CHECK(folder.files().empty());
            }
            CHECK(lost > 1);
            CHECK(named > 0);
        }
    }
}

TEST_CASE("shader: a loop beyond the driver's limit is reported", "[shader-device]") {
    const Scratch folder;
    const std::string text =
        "#define STEPS 100000\nfloat f(vec3 ro, vec3 rd, vec4 s) {\n    float t = 0.0;\n"
        "    for (int i = 0; i < STEPS; ++i) t += 1.0;\n    return t;\n}\n";
    const std::string limits = run("devices --json --device opengl").out;
    const Outcome o = map_by(folder, folder.write("long.glsl", text), "--device opengl");
    INFO(o.err);
    CHECK(o.code == 0);
    CHECK(has(o.err, "long.glsl:4: this loop may run 100000 times") == has(limits, "65535 iterations, silently"));
    for (const char* endless : {"while (true)", "for (;;)"}) {
        std::string other = text;
        other.replace(other.find("for (int"), other.find(") t +=") + 1 - other.find("for (int"), endless);
        const Outcome none = map_by(folder, folder.write("endless.glsl", other), "--device opengl --force");
        INFO(none.err);
        CHECK(has(none.err, "endless.glsl:4: this loop has no limit") == has(limits, "iterations, silently"));
    }
    const std::string nested =
        text.substr(0, text.find("STEPS 100000")) + "STEPS 1000" + text.substr(text.find("STEPS 100000") + 12);
    const Outcome both =
        map_by(folder,
               folder.write("nested.glsl",
                            "void g() { for (int i = 0; i < 300; ++i) for (int k = 0; k < 300; ++k) ; }\n" + nested),
               "--device opengl --force");
    INFO(both.err);
    CHECK(has(both.err, "nested.glsl:1: this loop may run 90000 times") == has(limits, "count together"));
    CHECK_FALSE(has(both.err, "nested.glsl:5:"));
}

TEST_CASE("shader: code from shader sites and pixel programs is accepted unchanged", "[shader-device]") {
    const Scratch folder;
    const std::string site = folder.write("site.glsl", R"(#define AA 2
uniform float speed;
float nearest( in vec3 ro, in vec3 rd, in vec4 ball )
{
    vec3 f = ro - ball.xyz;
    float b = dot( rd, f ), disc = b*b - ( dot( f, f ) - ball.w*ball.w );
    return disc < 0.0 ? -1.0 : -b - sqrt( disc );
}
void mainImage( out vec4 fragColor, in vec2 fragCoord )
{
    vec2 p = (2.0*fragCoord - iResolution.xy)/iResolution.y + texture(iChannel0, iMouse.xy).xy;
    fragColor = vec4(nearest(vec3(0.0, 0.0, speed*sin(iTime)), normalize(vec3(p, -2.0)), vec4(0, 0, 0, 1)));
}
)");
    const std::string pixels = folder.write("pixels.glsl", R"(#version 330 core
layout(location = 0) out vec4 color;
in vec2 uv;
bool hit(vec3 orig, vec3 dir, vec3 boxMin, vec3 boxMax, out float tmin, out float tmax) {
    vec3 a = (boxMin - orig) / dir, b = (boxMax - orig) / dir, n = min(a, b), f = max(a, b);
    tmin = max(max(n.x, n.y), n.z);
    tmax = min(min(f.x, f.y), f.z);
    return tmax >= max(tmin, 0.0);
}
void main() {
    float a, b;
    color = vec4(hit(vec3(uv, 0), vec3(1), vec3(0), vec3(1), a, b), a, b, gl_FragCoord.x);
    gl_FragDepth = a;
}
)");
    for (const std::string& file : {site, pixels}) {
        const Outcome o =
            must("plugin check -q --device all --shader " + file + ":touching=" + (file == site ? "hit" : "miss"),
                 folder.path());
        CHECK(has(o.out, ".vulkan in binary32"));
        CHECK(has(o.out, ".opengl in binary32"));
    }
}

TEST_CASE("shader: NaN and infinities come back unchanged", "[shader-device]") {
    const Scratch folder;
    const std::string nan =
        folder.write("nan.glsl", "float f(vec3 ro, vec3 rd, vec4 s) { return uintBitsToFloat(0x7fc00000u); }");
    const std::string infinite =
        folder.write("inf.glsl", "float f(vec3 ro, vec3 rd, vec4 s) { return uintBitsToFloat(0x7f800000u); }");
    const Outcome o = map_by(folder, nan, "--device all --pixels csv --shader " + infinite);
    INFO(o.err);
    REQUIRE(o.code == 0);
    int nans = 0, others = 0;
    for (const auto& row : read_csv(folder.path() / "out" / "near-benign" / "summary.csv")) {
        INFO(row.at("form"));
        const bool is_nan = has(row.at("form"), "shader.nan");
        (is_nan ? nans : others) += 1;
        if (is_nan) CHECK(row.at("not_a_number") == row.at("rays"));
        else CHECK(row.at("agree_miss") == "0");
    }
    CHECK(nans > 0);
    CHECK(others > 0);
}

TEST_CASE("shader: explain says why it cannot look inside, and judge, sweep, diff and choose accept a shader",
          "[shader-device]") {
    const Scratch folder;
    const std::string option = " --shader " + examples + "sphere.glsl";
    const Outcome o = must("explain near-benign --pixel 3,3 -i shader.sphere -f f32" + option, folder.path());
    CHECK(has(o.out, "Its operations are not known"));
    must("sweep extremes/contact -i shader.sphere -i sphere.unit_half_b -f f32 -o sweep" + option, folder.path());
    const Outcome choose = must(
        "choose near-benign --bits 12 -i shader.sphere -i sphere.unit_half_b -f f32 -o choose" + option, folder.path());
    CHECK(has(contents(folder.path() / "choose" / "near-benign" / "choose.csv"), "shader.sphere,f32"));
    const std::string rays =
        folder.write("rays.csv", "ox,oy,oz,dx,dy,dz,cx,cy,cz,r\n0,0,-5,0,0,1,0,0,0,1\n3,0,-5,0,0,1,0,0,0,1\n");
    must("judge " + rays + " -i shader.sphere -f f32 -o judge" + option, folder.path());
    const auto summary = read_csv(folder.path() / "judge" / "rays" / "summary.csv");
    REQUIRE(summary.size() == 1);
    CHECK(summary[0].at("agree_hit") == "1");
    CHECK(summary[0].at("agree_miss") == "1");
}

}  // namespace test_unavailable
