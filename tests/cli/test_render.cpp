// `lostbits render` from the outside: files, agreement between them, and what it refuses.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "measure/picture/render.hpp"
#include "output/image/image.hpp"
#include "program.hpp"

namespace test_render {

using namespace lostbits::test;
using lostbits::measure::picture::Seen;
using lostbits::measure::picture::Shadow;
using lostbits::output::image::ExrImage;

namespace {

auto& backend() {
    draw_pictures();
    return lostbits::output::image::image_backend();
}

template <class T>
const std::vector<T>& channel(const ExrImage& exr, const std::string& name) {
    const auto* found = exr.find(name);
    CAPTURE(name);
    REQUIRE(found != nullptr);
    return std::get<std::vector<T>>(found->samples);
}

const std::string spheres = R"(
[light]
position = [4, 6, 9]
[shadows]
)";

std::string with(const std::string& what) { return good_scene + what; }

}  // namespace

TEST_CASE("render writes what it says: pictures, references, difference maps, layers, a sheet and a table") {
    const Scratch scratch;
    const auto r =
        run("render raycast-course.small --size 40x30 --stage visible,phong -i sphere.expanded -i sphere.unit_half_b "
            "-f f32 -f bf16 --pictures all -o '" +
            scratch.path().string() + "'");
    INFO(r.err);
    REQUIRE(r.code == 0);
    const auto folder = scratch.path() / "raycast-course.small";
    CHECK(r.out == (folder / "contact.png").string() + "\n");
    std::vector<std::string> expected{"contact.png", "datapackage.json",      "manifest.json",
                                      "summary.csv", "visible.reference.png", "phong.reference.png"};
    for (const char* form : {"sphere.expanded", "sphere.unit_half_b"}) {
        for (const char* format : {".f32", ".bf16"}) {
            const std::string stem = std::string(form) + format;
            for (const char* end : {".exr", ".residual.png", ".normal.png", ".shadow.png"})
                expected.push_back(stem + end);
            for (const char* stage : {"visible.", "phong."}) {
                expected.push_back(stage + stem + ".png");
                expected.push_back(stage + stem + ".colour.png");
            }
        }
    }
    for (auto& name : expected) name = "raycast-course.small/" + name;
    std::ranges::sort(expected);
    CHECK(scratch.files() == expected);
    const auto package = nlohmann::json::parse(contents(folder / "datapackage.json"));
    const auto table = read_csv(folder / "summary.csv");
    CHECK(table.size() == 8);
    CHECK(package.at("resources").at(0).at("schema").at("fields").size() == table.front().size());
    CHECK(table.front().at("stage") == "visible");
    CHECK(table.front().at("own_shadow").empty());  // no shadow is cast there
    CHECK(table.back().at("own_shadow") == "0");
}

TEST_CASE("the layers, the pictures and the table say the same") {
    draw_pictures();
    const Scratch scratch;
    REQUIRE(run("render raycast-acne.none --size 48x36 --stage visible --stage shadows -i sphere.unified -f f32 "
                "--pictures all -o '" +
                scratch.path().string() + "'")
                .code == 0);
    const auto folder = scratch.path() / "raycast-acne.none";
    const auto exr = backend().read_exr(folder / "sphere.unified.f32.exr");
    const auto picture = backend().read_png(folder / "shadows.sphere.unified.f32.png"),
               reference = backend().read_png(folder / "shadows.reference.png");
    REQUIRE(picture.width == 48);
    REQUIRE(reference.height == 36);
    const auto& seen = channel<std::uint32_t>(exr, "class.seen");
    const auto& shadow = channel<std::uint32_t>(exr, "class.shadow");
    const auto row = read_csv(folder / "summary.csv").at(1);
    std::array<int, 7> seen_counts{}, shadow_counts{};
    int changed = 0;
    float worst = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        ++seen_counts.at(seen[i]);
        ++shadow_counts.at(shadow[i]);
        changed += !(picture.pixels[i] == reference.pixels[i]);
        const float error = channel<float>(exr, "shadows.difference")[i];
        if (seen[i] <= 1) worst = std::max(worst, error);
        const char* const ends[] = {".r", ".g", ".b"};
        const std::uint8_t bytes[] = {picture.pixels[i].r, picture.pixels[i].g, picture.pixels[i].b};
        float largest = 0;
        for (int k = 0; k < 3; ++k) {
            const float c = channel<float>(exr, std::string("shadows") + ends[k])[i],
                        truth = channel<float>(exr, std::string("shadows_true") + ends[k])[i];
            CHECK(bytes[k] == static_cast<int>(std::clamp(std::floor(255.0 * c + 0.5), 0.0, 255.0)));
            largest = std::max(largest, 255 * std::fabs(c - truth));
        }
        CHECK(error == Approx(largest).margin(5e-5));
    }
    for (const auto kind : {Seen::same_sphere, Seen::background, Seen::other_sphere, Seen::lost_sphere,
                            Seen::extra_sphere, Seen::not_a_number}) {
        const auto k = static_cast<std::size_t>(kind);
        CHECK(number_in(row.at(std::string(lostbits::measure::picture::seen_names[k]))) == seen_counts[k]);
    }
    CHECK(number_in(row.at("own_shadow")) == shadow_counts[static_cast<std::size_t>(Shadow::own_shadow)]);
    CHECK(number_in(row.at("own_shadow")) > 100);
    CHECK(number_in(row.at("surface_lit")) == shadow_counts[1] + shadow_counts[3] + shadow_counts[4]);
    CHECK(number_in(row.at("changed")) == changed);
    CHECK(static_cast<float>(number_in(row.at("colour_error_max"))) == worst);
}

TEST_CASE("render -v names both shares of wrong pixels, and they are those of the summary") {
    const Scratch scratch;
    const auto r = run("render raycast-course.small --size 64x48 -i sphere.expanded -f fp16 -v -o out", scratch.path());
    REQUIRE(r.code == 0);
    CHECK(has(r.out, "wrong colour wrong sphere "));
    const auto row = read_csv(scratch.path() / "out/raycast-course.small/summary.csv").at(0);
    double wrong = 0;
    for (const char* column : {"other_sphere", "lost_sphere", "extra_sphere", "not_a_number"})
        wrong += number_in(row.at(column));
    CHECK(wrong > 0);
    CHECK(wrong < number_in(row.at("changed")));
    std::istringstream line(r.out.substr(r.out.find("sphere.expanded  ")));
    std::string form, format;
    double colour = 0, sphere = 0;
    line >> form >> format >> colour >> sphere;
    CHECK(colour == number_in(row.at("changed")));
    CHECK(sphere == wrong);
}

TEST_CASE("a scene without paint is drawn as what it asks for, and a stage beyond that is said to be") {
    const Scratch scratch;
    const std::string scene = "'" + scratch.write("scene.toml", good_scene) + "'",
                      out = " -o '" + scratch.path().string() + "'";
    const auto r = run("render " + scene + " --stage phong --pictures all" + out);
    CHECK(r.code == 0);
    CHECK(r.err.find("has no stage phong; drawing stage visible instead") != std::string::npos);
    CHECK(std::filesystem::exists(scratch.path() / "scene/visible.sphere.expanded.f32.png"));
    CHECK_FALSE(std::filesystem::exists(scratch.path() / "scene/sphere.expanded.f32.normal.png"));
    CHECK(run("render " + scene + " --stage phong -q" + out).err.empty());
    const std::string lit = "'" + scratch.write("lit.toml", with(spheres)) + "'";
    REQUIRE(run("render " + lit + out).code == 0);
    CHECK(read_csv(scratch.path() / "lit/summary.csv").front().at("stage") == "shadows");
    REQUIRE(run("render " + lit + " --stage diffuse" + out).code == 0);
    CHECK(read_csv(scratch.path() / "lit/summary.csv").front().at("stage") == "diffuse");
}

TEST_CASE("what render refuses: the place or the word, the exit code, and nothing written") {
    struct Case {
        std::string scene, arguments;
        int code;
        const char* says;
    };
    const Case cases[] = {
        {with("[shadows]\n"), "", 2, "scene.toml:18:1: shadows need a light"},
        {with("ks = 0.5\n"), "", 2, "scene.toml:18:6: sphere[0].ks above 0 asks for a highlight"},
        {with("colour = [2, 0, 0]\n"), "", 2, "scene.toml:18:10: sphere[0].colour is not between 0 and 1"},
        {with("[light]\npositon = [0, 0, 0]\n"), "", 2, "position"},
        {with("[shadows]\nown = 1\n[light]\nposition = [1, 2, 3]\n"), "", 2, "scene.toml:19:7: shadows.own"},
        {good_scene, "--stage fong", 2, "stage"},
        {good_scene, "-i sphere.expandet", 2, "sphere.expanded"},
        {good_scene, "-i 'box.*'", 4, "sphere.*"},
        {good_scene, "-f f31", 2, "f32"},
        {good_scene, "--set light.position=[1,2,3]", 2, "light"},
        {spoilt("[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\n", "[[box]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\n"), "", 2,
         "lostbits map"},
    };
    for (const Case& c : cases) {
        const Scratch scratch;
        const std::string file = scratch.write("scene.toml", c.scene);
        const auto r = run("render '" + file + "' " + c.arguments + into(scratch));
        INFO(c.says << "\n" << r.err);
        CHECK(r.code == c.code);
        CHECK(r.out.empty());
        CHECK(r.err.find(c.says) != std::string::npos);
        CHECK(scratch.files() == std::vector<std::string>{"scene.toml"});
    }
    const Scratch scratch;
    CHECK(run("render raycast-course.small -o /proc/nowhere").code == 3);
}

TEST_CASE("a claim about a rendered picture: its number, and what it cannot be about") {
    const Scratch scratch;
    const auto claim = [&](const std::string& given, const std::string& metric) {
        const std::string file =
            scratch.write("claims.toml",
                          "schema = \"lostbits-claims/1\"\n[[claim]]\nid = \"a\"\nstatement = \"s\"\nsource = "
                          "\"-\"\nverdict = \"holds\"\n[claim.given]\n" +
                              given + "\nform = \"sphere.expanded\"\nformat = \"f32\"\n[claim.expect]\nmetric = \"" +
                              metric + "\"\nin = [49152, 49152]\n");
        return run("check '" + file + "'");
    };
    CHECK(claim("render = \"raycast-course.pixels\"\nstage = \"visible\"", "pixels").code == 0);
    const auto wrong = claim("render = \"raycast-course.pixels\"\nstage = \"visible\"", "changed");
    CHECK(wrong.code == 1);
    CHECK(wrong.out.find("lostbits render raycast-course.pixels --stage visible -i sphere.expanded -f f32 -o out") !=
          std::string::npos);
    for (const auto& [given, metric, says] :
         {std::tuple{"render = \"raycast-curse.pixels\"", "pixels", "raycast-course"},
          {"render = \"raycast-course\"", "pixels", "has variants"},
          {"render = \"raycast-far.at0\"\nstage = \"phongg\"", "pixels", "phong"},
          {"render = \"raycast-acne.none\"\nstage = \"phong\"", "pixels", "has no stage"},
          {"render = \"box-one\"", "pixels", "no spheres"},
          {"render = \"raycast-far.at0\"\nat = 3", "pixels", "at"},
          {"scene = \"grazing\"\nstage = \"phong\"", "pixels", "stage"},
          {"render = \"raycast-far.at0\"", "pixel", "pixels"}}) {
        const auto r = claim(given, metric);
        INFO(given << "\n" << r.err);
        CHECK(r.code == 2);
        CHECK(r.err.find(says) != std::string::npos);
        CHECK(r.err.find("claims.toml:") != std::string::npos);
    }
}

}  // namespace test_render
