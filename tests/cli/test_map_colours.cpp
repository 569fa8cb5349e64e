// The wrong solid and the outcomes of a mesh in every file of a map, and colour bars that someone asked for.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catch.hpp"
#include "output/image/colour.hpp"
#include "pictures.hpp"
#include "program.hpp"

namespace test_map_colours {

using namespace lostbits::test;
using lostbits::output::image::outcome_colours;

TEST_CASE("the wrong solid has a colour, a column, a place in the table, and a ray that explains it") {
    draw_pictures();
    const Scratch scratch;
    const auto r = must("map rtg-fig-7-6-far --size 96x96 -i sphere.schoolbook -f f32 --pixels csv --pictures all -v" +
                        into(scratch, ""));
    CHECK(has(r.out, "wrong solid"));
    const auto folder = scratch / "rtg-fig-7-6-far";
    const auto row = read_csv(folder / "summary.csv").front();
    const auto wrong = std::strtol(row.at("wrong_object").c_str(), nullptr, 10);
    CHECK(wrong > 500);
    CHECK(has(r.out, row.at("wrong_object")));
    CHECK(row.at("fault_outcome") == "wrong_object");
    CHECK(row.at("fault_explain").starts_with("lostbits explain "));
    long pixels = 0;
    for (const auto& pixel : read_csv(folder / "sphere.schoolbook.f32.csv")) {
        if (pixel.at("outcome") != "wrong_object") continue;
        ++pixels;
        CHECK(pixel.at("object") != pixel.at("truth_object"));
        CHECK(pixel.at("lost_bits").empty());
    }
    CHECK(pixels == wrong);
    // 96 samples across are drawn four pixels a side; the legend's swatch comes on top.
    const auto picture = backend().read_png(folder / "sphere.schoolbook.f32.png");
    const auto drawn = std::ranges::count(picture.pixels, outcome_colours[6]);
    CHECK(drawn >= 16 * wrong + 100);
    CHECK(drawn <= 16 * wrong + 200);
}

TEST_CASE("map --range sets the ends of the bar, and says what is no range") {
    draw_pictures();
    const Scratch scratch;
    const std::string what = "map near-benign --size 32x24 -i sphere.schoolbook -f f32 ";
    const auto picture = [&](const std::string& range) {
        must(what + range + " -o there --force", scratch.path());
        return backend().read_png(scratch / "there/near-benign/contact.png").pixels;
    };
    const auto near = picture("--range 0:2");
    CHECK(near != picture(""));
    CHECK(near != picture("--range 0:20"));
    std::vector<Refused> rows;
    for (const char* wrong : {"4:1", "0", "0:", ":3", "a:b", "0:inf", "1:1", "0:8 --metric ulp_error",
                              "0:8 --metric culprit", "1:8 --metric ulp_error --metric lost_bits"})
        rows.push_back({std::string("--range ") + wrong, "--range "});
    check_refused(scratch, what + "-o out", rows);
}

TEST_CASE("what a sheet shows is drawn alone only with --pictures all, whatever the command") {
    const std::string rays = (fs::path(LOSTBITS_DATA_DIR) / "dumps/far-sphere.csv").string();
    for (const std::string& words :
         {std::string("map near-benign --size 8x6 -i sphere.press -f f32"),
          std::string("offsets near-benign --size 8x6 --strategy offset.none --points computed"),
          std::string("consistency near-benign --size 8x6 -i sphere.press --check segment"),
          std::string("render raycast-acne --variant none --size 8x6 -i sphere.press"),
          std::string("sweep sphere-height -i sphere.press -f f32 --steps 3,2 --set views=8"),
          "judge '" + rays + "' --format f32 --sphere 0,0,0,1 --size 48x32"}) {
        INFO(words);
        const auto pictures = [&words](const std::string& more) {
            const Scratch scratch;
            must(words + more + into(scratch));
            std::vector<std::string> names;
            for (const std::string& file : scratch.files())
                if (file.ends_with(".png")) names.push_back(fs::path(file).filename().string());
            return names;
        };
        CHECK(pictures("") == std::vector<std::string>{"contact.png"});
        const auto all = pictures(" --pictures all");
        CHECK(all.size() >= 2);
        CHECK(std::ranges::find(all, "contact.png") != all.end());
    }
}

namespace {

const std::string square = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n";

std::string scene_of(const std::string& file) {
    return scene_text("[[mesh]]\nfile = \"" + file + "\"\n", "size = [9, 9]\n",
                      "kind = \"pixel_plane\"\neye = [0, 0, 4]\nextent = [-1.125, -1.125, 1.125, 1.125]\n");
}

}  // namespace

TEST_CASE("rays through the seam of a square are double hits in every file") {
    const Scratch folder;
    folder.write("square.obj", square);
    const auto scene = folder.write("square.toml", scene_of("square.obj"));
    const auto out = folder / "out";
    const auto r = must("map '" + scene + "' -i triangle.woop -f f32 --pixels csv -v" + into(folder));
    CHECK(has(r.out, "double hit"));
    CHECK_FALSE(has(r.err, "no area"));
    const auto row = read_csv(out / "square" / "summary.csv").front();
    // The nine pixels of the diagonal lie on the square, its corners too, and each is a tie of its two triangles.
    CHECK(row.at("double_hit") == "9");
    CHECK(row.at("crack") == "0");
    CHECK(row.at("fault_outcome") == "double_hit");
    long seen = 0;
    for (const auto& pixel : read_csv(out / "square" / "triangle.woop.f32.csv"))
        seen += pixel.at("outcome") == "double_hit";
    CHECK(seen == 9);
    const auto told = must("explain '" + scene + "' --pixel 4,4 -i triangle.woop -f f32");
    CHECK(has(told.out, "Of the mesh this is a double hit: the form claims a triangle beside it too"));
}

TEST_CASE("explain calls a ray at a mesh what a map calls it") {
    const Scratch folder;
    const std::string form = " -i triangle.undivided -f f32";
    const auto check = [&](const std::string& scene, const std::vector<std::string>& outcomes) {
        must("map " + scene + " --pixels csv" + form + into(folder, ""));
        std::map<std::string, std::string> pixels;
        for (const auto& pixel : read_csv(folder.path() / scene / "triangle.undivided.f32.csv"))
            pixels.try_emplace(pixel.at("outcome"), pixel.at("x") + "," + pixel.at("y"));
        for (const std::string& outcome : outcomes) {
            const auto told = must("explain " + scene + " --pixel " + pixels.at(outcome) + form + " --json");
            const auto json = nlohmann::json::parse(told.out);
            CHECK(json.value("in_mesh", json.at("outcome").get<std::string>()) == outcome);
        }
    };
    check("mesh-icosphere-edges", {"crack", "double_hit", "wrong_neighbour", "false_miss", "agree_hit"});
    check("mesh-sheets-far", {"out_of_order", "agree_hit"});
}

TEST_CASE("faces without area are told of, and a bad mesh ends before anything is written") {
    const Scratch folder;
    const auto out = folder / "out";
    const auto map_of = [&](const std::string& text) {
        folder.write("a.obj", text);
        return run("map '" + folder.write("a.toml", scene_of("a.obj")) + "' -i triangle.woop -f f32" + into(folder));
    };
    const auto bad = map_of(square + "f 1 2 9\n");
    CHECK(bad.code == 2);
    CHECK(has(bad.err, "a.obj:7: names vertex 9, and 4 stand above"));
    CHECK_FALSE(fs::exists(out));
    const auto flat = map_of(square + "f 1 2 2\n");
    CHECK(flat.code == 0);
    CHECK(has(flat.err, "1 of 3 faces of its meshes have no area and are left out; the first is "));
    CHECK(has(flat.err, "a.obj:7"));
}

}  // namespace test_map_colours
