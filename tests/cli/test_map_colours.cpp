// The wrong primitive and the outcomes of a mesh in every file of a map, and colour bars that someone asked for.
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

TEST_CASE("a hit of the wrong primitive has a colour, a column, a table entry and a ray that explains it") {
    draw_pictures();
    const Scratch scratch;
    const auto r = must("map rtg-fig-7-6-far --size 96x96 -i sphere.schoolbook -f f32 --pixels csv --pictures all -v" +
                        into(scratch, ""));
    CHECK(has(r.out, "wrong primitive"));
    const auto folder = scratch / "rtg-fig-7-6-far";
    const auto row = read_csv(folder / "summary.csv").front();
    const auto wrong = std::strtol(row.at("wrong_primitive").c_str(), nullptr, 10);
    CHECK(wrong > 500);
    CHECK(has(r.out, row.at("wrong_primitive")));
    CHECK(row.at("fault_outcome") == "wrong_primitive");
    CHECK(row.at("fault_explain").starts_with("lostbits explain "));
    long pixels = 0;
    for (const auto& pixel : read_csv(folder / "sphere.schoolbook.f32.csv")) {
        if (pixel.at("outcome") != "wrong_primitive") continue;
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

TEST_CASE("map --range sets the ends of the bar") {
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
}

TEST_CASE("rays through the seam of a square are double hits in every file") {
    const Scratch folder;
    folder.write("square.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\nf 1 2 2\n");
    const auto scene =
        folder.write("square.toml",
                     scene_text("[[mesh]]\nfile = \"square.obj\"\n", "size = [9, 9]\n",
                                "kind = \"pixel_plane\"\neye = [0, 0, 4]\nextent = [-1.125, -1.125, 1.125, 1.125]\n"));
    const auto out = folder / "out";
    const auto r = must("map '" + scene + "' -i triangle.woop -f f32 --pixels csv -v" + into(folder));
    CHECK(has(r.out, "double hit"));
    CHECK(has(r.err, "1 of 3 faces of its meshes have no area and are left out; the first is "));
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
    CHECK(has(told.out, "In the mesh this is a double hit: the form also claims a neighbouring triangle"));
}

TEST_CASE("explain gives a ray at a mesh the same outcome as map") {
    const Scratch folder;
    const std::string form = " -i triangle.undivided -f f32";
    const auto check = [&](const std::string& scene, const std::vector<std::string>& outcomes) {
        must("map " + scene + " --pixels csv" + form + into(folder, ""));
        std::map<std::string, std::string> pixels;
        for (const auto& pixel : read_csv(folder.path() / scene / "triangle.undivided.f32.csv"))
            pixels.try_emplace(pixel.at("outcome"), pixel.at("x") + "," + pixel.at("y"));
        for (const std::string& outcome : outcomes) {
            const auto explained = must("explain " + scene + " --pixel " + pixels.at(outcome) + form + " --json");
            const auto json = nlohmann::json::parse(explained.out);
            CHECK(json.value("in_mesh", json.at("outcome").get<std::string>()) == outcome);
        }
    };
    check("mesh-icosphere-edges", {"crack", "double_hit", "wrong_neighbour", "false_miss", "agree_hit"});
    check("mesh-sheets-far", {"out_of_order", "agree_hit"});
}

}  // namespace test_map_colours
