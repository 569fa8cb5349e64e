// `lostbits render` from the outside: files, agreement between them, and what it refuses.
#include <algorithm>
#include <cmath>
#include <sstream>

#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "measure/render/render.hpp"
#include "pictures.hpp"
#include "program.hpp"

namespace test_render {

using namespace lostbits::test;
using lostbits::measure::render::SeenContent;
using lostbits::measure::render::Shadow;

namespace {

const std::string spheres = R"(
[light]
position = [4, 6, 9]
[shadows]
)";

std::string with(const std::string& what) { return good_scene + what; }

}  // namespace

TEST_CASE("render writes pictures, references, difference maps, layers, a sheet and a table") {
    const Scratch scratch;
    const auto r = must(
        "render raycast-course.small --size 40x30 --stage visible,phong -i sphere.expanded -i sphere.unit_half_b "
        "-f f32 -f bf16 --pictures all" +
        into(scratch, ""));
    const auto folder = scratch / "raycast-course.small";
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

TEST_CASE("the layers, the pictures and the table of render agree") {
    draw_pictures();
    const Scratch scratch;
    must(
        "render raycast-acne.none --size 48x36 --stage visible --stage shadows -i sphere.unified -f f32 "
        "--pictures all" +
        into(scratch, ""));
    const auto folder = scratch / "raycast-acne.none";
    const auto exr = backend().read_exr(folder / "sphere.unified.f32.exr");
    const auto picture = backend().read_png(folder / "shadows.sphere.unified.f32.png"),
               reference = backend().read_png(folder / "shadows.reference.png");
    REQUIRE(picture.width == 48);
    REQUIRE(reference.height == 36);
    const auto& seen = samples<std::uint32_t>(exr, "class.seen");
    const auto& shadow = samples<std::uint32_t>(exr, "class.shadow");
    const auto row = read_csv(folder / "summary.csv").at(1);
    std::array<int, 7> seen_counts{}, shadow_counts{};
    int changed = 0;
    float worst = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        ++seen_counts.at(seen[i]);
        ++shadow_counts.at(shadow[i]);
        changed += !(picture.pixels[i] == reference.pixels[i]);
        const float error = samples<float>(exr, "shadows.difference")[i];
        if (seen[i] <= 1) worst = std::max(worst, error);
        const char* const ends[] = {".r", ".g", ".b"};
        const std::uint8_t bytes[] = {picture.pixels[i].r, picture.pixels[i].g, picture.pixels[i].b};
        float largest = 0;
        for (int k = 0; k < 3; ++k) {
            const float c = samples<float>(exr, std::string("shadows") + ends[k])[i],
                        truth = samples<float>(exr, std::string("shadows_true") + ends[k])[i];
            CHECK(bytes[k] == static_cast<int>(std::clamp(std::floor(255.0 * c + 0.5), 0.0, 255.0)));
            largest = std::max(largest, 255 * std::fabs(c - truth));
        }
        CHECK(error == Approx(largest).margin(5e-5));
    }
    for (const auto kind : {SeenContent::same_sphere, SeenContent::background, SeenContent::other_sphere,
                            SeenContent::lost_sphere, SeenContent::extra_sphere, SeenContent::not_a_number}) {
        const auto k = static_cast<std::size_t>(kind);
        CHECK(number_in(row.at(std::string(lostbits::measure::render::seen_names[k]))) == seen_counts[k]);
    }
    CHECK(number_in(row.at("own_shadow")) == shadow_counts[static_cast<std::size_t>(Shadow::own_shadow)]);
    CHECK(number_in(row.at("own_shadow")) > 100);
    CHECK(number_in(row.at("surface_lit")) == shadow_counts[1] + shadow_counts[3] + shadow_counts[4]);
    CHECK(number_in(row.at("changed")) == changed);
    CHECK(static_cast<float>(number_in(row.at("colour_error_max"))) == worst);
}

TEST_CASE("render -v prints both shares of wrong pixels, and they agree with the summary") {
    const Scratch scratch;
    const auto r =
        must("render raycast-course.small --size 64x48 -i sphere.expanded -f fp16 -v -o out", scratch.path());
    CHECK(has(r.out, "wrong colour wrong sphere "));
    const auto row = read_csv(scratch / "out/raycast-course.small/summary.csv").at(0);
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

TEST_CASE("a scene without paint is rendered up to the stage it asks for, and the output says so") {
    const Scratch scratch;
    const std::string scene = "'" + scratch.write("scene.toml", good_scene) + "'", out = into(scratch, "");
    const auto r = must("render " + scene + " --stage phong --pictures all" + out);
    CHECK(has(r.err, "has no stage phong; drawing stage visible instead"));
    CHECK(fs::exists(scratch / "scene/visible.sphere.expanded.f32.png"));
    CHECK_FALSE(fs::exists(scratch / "scene/sphere.expanded.f32.normal.png"));
    CHECK(run("render " + scene + " --stage phong -q" + out).err.empty());
    const std::string lit = "'" + scratch.write("lit.toml", with(spheres)) + "'";
    must("render " + lit + out);
    CHECK(read_csv(scratch / "lit/summary.csv").front().at("stage") == "shadows");
    must("render " + lit + " --stage diffuse" + out);
    CHECK(read_csv(scratch / "lit/summary.csv").front().at("stage") == "diffuse");
}

TEST_CASE("a claim about a rendered picture has its number, and impossible ones are refused") {
    const Scratch scratch;
    const auto given = [](const std::string& words) { return words + "\n" + form_keys("sphere.expanded"); };
    const auto check = [&](const std::string& metric) {
        const std::string text =
            make_claim_file({{"a", given("render = \"raycast-course.pixels\"\nstage = \"visible\""),
                              metric_keys(metric, "[49152, 49152]")}});
        return run("check '" + scratch.write("claims.toml", text) + "'");
    };
    CHECK(check("pixels").code == 0);
    const auto wrong = check("changed");
    CHECK(wrong.code == 1);
    CHECK(has(wrong.out, "lostbits render raycast-course.pixels --stage visible -i sphere.expanded -f f32 -o out"));
    const std::string pixels = metric_keys("pixels");
    check_refused_claims(scratch, {{given("render = \"raycast-curse.pixels\""), pixels, "raycast-course"},
                                   {given("render = \"raycast-course\""), pixels, "has variants"},
                                   {given("render = \"raycast-far.at0\"\nstage = \"phongg\""), pixels, "phong"},
                                   {given("render = \"raycast-acne.none\"\nstage = \"phong\""), pixels,
                                    "has no row with form = \"sphere.expanded\", format = \"f32\", stage = \"phong\""},
                                   {given("render = \"box-one\""), pixels, "cannot handle box-one"},
                                   {given("render = \"raycast-far.at0\"\nat = 3"), pixels, "at"},
                                   {given("scene = \"grazing\"\nstage = \"phong\""), pixels, "stage"},
                                   {given("render = \"raycast-far.at0\""), metric_keys("pixel"), "pixels"}});
}

}  // namespace test_render
