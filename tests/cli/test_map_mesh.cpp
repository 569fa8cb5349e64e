// A mesh from a file: its outcomes in every file of a map, and what is wrong with it told before anything is written.
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"

namespace test_map_mesh {

using namespace lostbits::test;

namespace {

const std::string square = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n";

std::string scene_of(const std::string& file) {
    return "schema = \"lostbits-scene/1\"\ntitle = \"A square\"\nsource = \"-\"\nnote = \"-\"\nsize = [9, "
           "9]\n[camera]\n"
           "kind = \"pixel_plane\"\neye = [0, 0, 4]\nextent = [-1.125, -1.125, 1.125, 1.125]\n[[mesh]]\nfile = \"" +
           file + "\"\n";
}

fs::path written(const Scratch& folder, const std::string& name, const std::string& text) {
    std::ofstream(folder.path() / name) << text;
    return folder.path() / name;
}

}  // namespace

TEST_CASE("rays through the seam of a square are double hits in every file") {
    const Scratch folder;
    written(folder, "square.obj", square);
    const auto scene = written(folder, "square.toml", scene_of("square.obj"));
    const auto out = folder / "out";
    const auto r =
        must("map '" + scene.string() + "' -i triangle.woop -f f32 --pixels csv -v -o '" + out.string() + "'");
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
    const auto told = must("explain '" + scene.string() + "' --pixel 4,4 -i triangle.woop -f f32");
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
        written(folder, "a.obj", text);
        return run("map '" + written(folder, "a.toml", scene_of("a.obj")).string() + "' -i triangle.woop -f f32 -o '" +
                   out.string() + "'");
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

}  // namespace test_map_mesh
