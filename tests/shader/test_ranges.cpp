// Shaders that take the range of a ray.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "catch.hpp"
#include "cli/program.hpp"
#include "shapes/primitive.hpp"

namespace test_ranges {

using namespace lostbits;
using namespace lostbits::test;

namespace {

const std::string examples = std::string(LOSTBITS_SOURCE_DIR) + "/examples/shaders/";

std::string scene(const std::string& range, const std::string& primitive) {
    return scene_text("[rays]\n" + range + "\n" + primitive, "inputs = \"shared\"\n");
}

const std::string sphere = "[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\n";

/// A primitive in a scene, the function parameters for it, and whether these have its numbers.
struct WrittenShader {
    std::string toml, parameters, holds = "true";

    explicit WrittenShader(const Primitive<double>& primitive)
        : toml("[[" + std::string(name_of(primitive.shape)) + "]]\n") {
        const auto text = [](double x) {
            char digits[40];
            std::snprintf(digits, sizeof digits, "%.9f", x);
            return std::string(digits);
        };
        for_each_key(primitive.shape, [&](const Key& key, std::size_t first) {
            const std::string name(key.name);
            std::string numbers;
            for (std::size_t k = 0; k < key.count(); ++k)
                numbers += (k == 0 ? "" : ", ") + text(primitive.numbers[first + k]);
            const bool one = key.count() == 1;
            toml += name + " = " + (one ? numbers : "[" + numbers + "]") + "\n";
            parameters += (one ? "float " : "vec3 ") + name + ", ";
            holds += " && " + name + " == " + (one ? numbers : "vec3(" + numbers + ")");
        });
    }
};

}  // namespace

TEST_CASE("shader ranges: ray ranges are respected on every driver and in HLSL", "[shader-device]") {
    const Scratch folder;
    folder.write("closed.toml", scene("tmin = 4.5\ntmax = 5.5", sphere));
    folder.write("open.toml", scene("tmin = 4.5\ntmax = 5.5\nopen_ends = \"both\"", sphere));
    folder.write("segment.toml", scene("tmax = 4.125", sphere));
    std::string text = contents(examples + "sphere_in_range.glsl");
    // A function that ignores where rays begin.
    folder.write("ends_alone.glsl", replace_text(replace_text(text, "h < tmin", "h < 0.0"), "t < tmin || ", ""));
    for (std::size_t at = 0; (at = text.find("vec3", at)) != std::string::npos;) text.replace(at, 4, "float3");
    const std::string both = " format=both";
    text.erase(text.find(both), both.size());
    folder.write("range.hlsl", text);
    const std::string shaders = " --shader ends_alone.glsl --shader " + examples + "sphere_in_range.glsl -i 'shader.*'";
    for (const std::string name : {"closed", "open", "segment"}) {
        const std::string map = "map " + name + ".toml --size 48x32 -o out";
        must(map + " -f f32 -f f64 --device all" + shaders, folder.path());
        auto rows = read_csv(folder / ("out/" + name + "/summary.csv"));
        REQUIRE(rows.size() == 8);
        must(map + "_hlsl -f f32 -i 'shader.*' --shader range.hlsl", folder.path());
        const auto of_hlsl = read_csv(folder / ("out_hlsl/" + name + "/summary.csv"));
        REQUIRE(of_hlsl.size() == 1);
        rows.push_back(of_hlsl.front());
        for (auto& row : rows) {
            INFO(row["form"] << ' ' << row["format"]);
            const bool forgets = has(row["form"], "ends_alone") && name != "segment";
            CHECK((row["false_hit"] != "0") == forgets);  // roots before the range are not removed for it
            CHECK(row["false_miss"] == "0");
            CHECK(std::stoi(row["agree_hit"]) > 20);
            CHECK(std::stoi(row["agree_miss"]) > 20);
        }
    }
    const Outcome told = must("plugin check --device all --shader " + examples + "sphere_in_range.glsl", folder.path());
    CHECK(has(told.out, "a range that begins behind the primitive, at t = 8, misses"));
    const Outcome forgets = run("plugin check --shader ends_alone.glsl", folder.path());
    INFO(forgets.out << forgets.err);
    CHECK(forgets.code == 1);
    CHECK(has(forgets.out,
              "a range that begins behind the primitive, at t = 8, hits; it should miss: `starts` says where"));
}

TEST_CASE("shader ranges: a primitive of every shape works with a range, in floats and doubles", "[shader-device]") {
    for (const ShapeRow& row : shape_rows) {
        const Scratch folder;
        const WrittenShader primitive(primitive_around(row.shape, Vec<double>(0.25, -0.5, 0.125), 1.5));
        folder.write("one.toml", scene("tmin = 0.5\ntmax = 64", primitive.toml));
        // 5/8 if everything is right.
        folder.write("told.glsl", "// lostbits: roots=first flags=range direction=any format=both\nfloat told(" +
                                      primitive.parameters +
                                      "vec3 ro, vec3 rd, float tmin, float tmax) {\n"
                                      "    return ro.z == 5.0 && rd.z < 0.0 && " +
                                      primitive.holds + " ? tmin + tmax / 512.0 : tmin;\n}\n");
        must("map one.toml --size 4x3 --pixels csv -o out --shader told.glsl -i 'shader.*' -f f32 -f f64",
             folder.path());
        std::size_t pixels = 0;
        for (const std::string format : {"f32", "f64"})
            for (auto& pixel : read_csv(folder / ("out/one/shader.told." + format + ".csv"))) {
                INFO(format);
                CHECK(std::strtod(pixel["t_hex"].c_str(), nullptr) == 0.625);
                ++pixels;
            }
        CHECK(pixels == 24);
    }
}

}  // namespace test_ranges
