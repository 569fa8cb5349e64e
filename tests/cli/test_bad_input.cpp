// Every way to be wrong: the place, the remedy, the exit code, and nothing written.
#include <utility>

#include "catch.hpp"
#include "program.hpp"

namespace test_bad_input {

using namespace lostbits::test;

namespace {

struct BadScene {
    const char* what;
    std::string text;
    const char* place;   ///< line:column
    const char* remedy;  ///< part of the message
};

const BadScene bad_scenes[] = {
    {"unknown key", spoilt("title =", "titel ="), ":2:1:", "title"},
    {"unknown key in a table", spoilt("look_at", "lookat"), ":11:1:", "look_at"},
    {"wrong type", spoilt("radius = 1", "radius = true"), ":17:10:", "number"},
    {"a vector of two", spoilt("up = [0, 1, 0]", "up = [0, 1]"), ":12:6:", "3"},
    {"radius zero", spoilt("radius = 1", "radius = 0"), ":17:10:", "radius"},
    {"radius negative", spoilt("radius = 1", "radius = -2"), ":17:10:", "radius"},
    {"radius that vanishes in binary32", spoilt("radius = 1", "radius = 1e-60"), ":17:10:", "binary32"},
    {"zero direction", spoilt("look_at = [0, 0, 0]", "look_at = [0.1, 0.2, 5]"), ":11:", "eye"},
    {"up along the view", spoilt("up = [0, 1, 0]", "up = [0.1, 0.2, 5]"), ":12:", "up"},
    {"not a number", spoilt("radius = 1", "radius = nan"), ":17:10:", "finite"},
    {"infinite", spoilt("width = 3", "width = inf"), ":13:9:", "finite"},
    {"beyond binary32", spoilt("centre = [0, 0, 0]", "centre = [0, 1e39, 0]"), ":16:", "binary32"},
    {"a string that is no number", spoilt("radius = 1", "radius = \"big\""), ":17:10:", "number"},
    {"size zero", spoilt("size = [24, 16]", "size = [0, 16]"), ":6:", "size"},
    {"size absurd", spoilt("size = [24, 16]", "size = [1000000, 1000000]"), ":6:", "65536"},
    {"no sphere", spoilt("[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\n", ""), ":1:1:", "sphere"},
    {"syntax", spoilt("kind = \"orthographic\"", "kind = \"orthographic"), ":9:", ""},
    {"another schema", spoilt("lostbits-scene/1", "lostbits-scene/9"), ":1:", "lostbits-scene/1"},
    {"unknown camera", spoilt("\"orthographic\"", "\"orthografic\""), ":9:8:", "orthographic"},
    {"a book for a title", spoilt("title = \"", "title = \"" + std::string(400, 'x')), ":2:9:", "400 are enough"},
    {"unknown inputs", spoilt("\"shared\"", "\"sharde\""), ":5:10:", "shared"},
};

}  // namespace

TEST_CASE("a bad scene is refused with its place and a remedy, and nothing is written") {
    for (const BadScene& bad : bad_scenes) {
        INFO(bad.what);
        const Scratch scratch;
        const std::string file = scratch.write("scene.toml", bad.text);
        const auto r = run("map '" + file + "'" + into(scratch));
        INFO(r.err);
        CHECK(r.code == 2);
        CHECK(r.out.empty());
        CHECK(r.err.find("scene.toml" + std::string(bad.place)) != std::string::npos);
        CHECK(r.err.find(bad.remedy) != std::string::npos);
        CHECK(scratch.files() == std::vector<std::string>{"scene.toml"});
        CHECK_FALSE(std::filesystem::exists(scratch.path() / "out"));
    }
}

TEST_CASE("the scene that the bad ones were made from is right") {
    const Scratch scratch;
    const std::string file = scratch.write("scene.toml", good_scene);
    CHECK(run("map '" + file + "' -i sphere.press -f f32 -o '" + scratch.path().string() + "'").code == 0);
}

TEST_CASE("bad words on the command line: exit code and what was meant") {
    const Scratch scratch;
    const std::string scene = "'" + scratch.write("scene.toml", good_scene) + "'";
    const std::string out = into(scratch);
    struct Case {
        std::string arguments;
        int code;
        const char* says;
    };
    const Case cases[] = {
        {"map " + scene + " -i sphere.schoolbok" + out, 2, "sphere.schoolbook"},
        {"map " + scene + " -i 'box.*'" + out, 4, "sphere.*"},
        {"map " + scene + " -i 'prism.*'" + out, 4, "list forms"},
        {"map " + scene + " -f f23" + out, 2, "f32"},
        {"map " + scene + " -f p1" + out, 2, "pN"},
        {"map " + scene + " -f p54" + out, 2, "pN"},
        {"map " + scene + " -f p12..p5" + out, 2, "pN"},
        {"map " + scene + " -i sphere.double_inside -f f64" + out, 4, "formats"},
        {"map " + scene + " --metric lost_bit" + out, 2, "lost_bits"},
        {"map " + scene + " --size 100" + out, 2, "512x384"},
        {"map " + scene + " --size 0x100" + out, 2, "size"},
        {"map " + scene + " --size 100000x100000" + out, 2, "65536"},
        {"map " + scene + " --set sphere[0].radus=2" + out, 2, "radius"},
        {"map " + scene + " --set sphere[7].radius=2" + out, 2, "sphere"},
        {"map " + scene + " --set sphere[0].radius=-1" + out, 2, "radius"},
        {"map " + scene + " --variant v1" + out, 2, "variant"},
        {"map " + scene + " " + scene + out, 2, "twice"},
        {"map rtg-fig-7-5" + out, 2, "rtg-fig-7-4"},
        {"map missing.toml" + out, 2, "missing.toml"},
        {"map '" + scratch.path().string() + "'" + out, 2, "folder"},
        {"map rtg-fig-7-4.r1e9" + out, 2, "r1e3"},
        {"map " + scene, 2, "--out"},
        {"map " + scene + " -j 0" + out, 2, "threads"},
        {"map " + scene + " --pixels exr" + out, 2, "csv"},
        {"explain " + scene + " --ranges -i sphere.press --range d.x=0..1 --range d.x=0..2", 2, "has a range already"},
        {"explain " + scene + " --ranges -i sphere.press --range =0..1", 2, "NAME=LOW..HIGH"},
        {"explain " + scene + " --ranges -i sphere.press --range d.x=nan..1", 2, "--range d.x=nan..1: \"nan\""},
        {"explain " + scene + " --ranges -i sphere.press --range d.q=0..1", 2, "d.x"},
        {"explain " + scene + " --ranges -i sphere.press --at 4", 2, "is a step of a sweep"},
        {"explain none.toml --ranges -i sphere.press --at 4", 2, "none.toml: there is no such file"},
        {"explain sphere-distance --ranges -i sphere.press", 2, "--at distance_radii"},
        {"mpa", 2, "map"},
        {"list intersector", 2, "intersectors"},
        {"", 2, ""},
    };
    for (const Case& c : cases) {
        INFO(c.arguments);
        const auto r = run(c.arguments);
        INFO(r.err);
        CHECK(r.code == c.code);
        CHECK(r.out.empty());
        CHECK(r.err.find(c.says) != std::string::npos);
        CHECK(r.err.find("lostbits: ") == 0);
        CHECK(scratch.files() == std::vector<std::string>{"scene.toml"});
    }
}

TEST_CASE("a folder that cannot be written ends the run before the work, with 3") {
    const Scratch scratch;
    const std::string scene = "'" + scratch.write("scene.toml", good_scene) + "'";
    for (const std::string& out : {std::string("/proc/nowhere"), (scratch.path() / "scene.toml").string()}) {
        const auto r = run("map " + scene + " -o '" + out + "'");
        INFO(r.err);
        CHECK(r.code == 3);
        CHECK(r.err.find(out) != std::string::npos);
        CHECK(scratch.files() == std::vector<std::string>{"scene.toml"});
    }
}

TEST_CASE("a missing image module is named, with 3, and nothing is written") {
    const Scratch scratch;
    const std::string scene = "'" + scratch.write("scene.toml", good_scene) + "'";
    const auto r = run("map " + scene + into(scratch), ".", "LOSTBITS_IMAGE_MODULE=/nowhere.so");
    INFO(r.err);
    CHECK(r.code == 3);
    CHECK(r.err.find("/nowhere.so") != std::string::npos);
    CHECK(scratch.files() == std::vector<std::string>{"scene.toml"});
}

TEST_CASE("a disk that fills up leaves no half-written file") {
    const Scratch scratch;
    const std::string scene = "'" + scratch.write("scene.toml", good_scene) + "'";
    // The limit on a file's size stands in for the full disk: 8 blocks of 1024 bytes in bash, 512 in others.
    const auto r = run("map " + scene + " --size 400x400 -i sphere.press -f f32" + into(scratch), ".", "ulimit -f 8;");
    INFO(r.err);
    CHECK(r.code == 3);
    CHECK(r.err.find("cannot write") != std::string::npos);
    CHECK(scratch.files() == std::vector<std::string>{"scene.toml"});
}

TEST_CASE("what once broke it: endless keys, ids that leave the folder, closed streams, an end from outside") {
    const Scratch scratch;
    const std::string out = " -i sphere.press -f f32" + into(scratch);
    std::string endless = "schema = \"lostbits-scene/1\"\nx";
    for (int i = 0; i < 60000; ++i) endless += ".a";
    const auto deep = run("map '" + scratch.write("deep.toml", endless + " = 1\n") + "'" + out);
    CHECK(deep.code == 2);
    CHECK(deep.err.find("deep.toml:2:1:") != std::string::npos);
    CHECK(run("map '" + scratch.write("...toml", good_scene) + "'" + out).code == 2);
    const std::string scene = scratch.write("scene.toml", good_scene);
    CHECK(run("map '" + scene + "' -i sphere.press -f f32 -o ''").code == 2);
    CHECK(run("list metrics >&- 2>&-").code == 3);
    const auto ended = run("map '" + scene + "' --size 3000x3000 -j 1 -o '" + (scratch.path() / "out").string() +
                           "' & child=$!; sleep 1; kill -TERM $child; wait $child; exit $?");
    CHECK(ended.code == 130);
    CHECK(scratch.files() == std::vector<std::string>{"...toml", "deep.toml", "scene.toml"});
}

TEST_CASE("an axis that is named like a column of the results is refused before the work") {
    for (const char* name : {"form", "worst_explain", "hex", "views"}) {
        const Scratch scratch;
        std::string text = small_sweep;
        text.replace(text.find("distance_radii"), 14, name);
        const auto r = run("sweep " + scratch.write("s.toml", text) + " -i sphere.press -f f32 -o out", scratch.path());
        INFO(name << ": " << r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err,
                  "s.toml:11:8: an axis that is named \"" + std::string(name) + "\" gives the results two columns"));
        CHECK(scratch.files().size() == 1);
    }
}

TEST_CASE("a scene that a sweep or a search names and that is not there is told with its place") {
    const std::string head = "schema = \"lostbits-sweep/1\"\ntitle = \"t\"\nsource = \"-\"\nnote = \"-\"\n";
    const std::string search = head + "[edge_search]\nscene = \"near-bening\"\n";
    const std::string axis =
        head + "scene = \"near-bening\"\n[[axis]]\nname = \"a\"\nfrom = 1\nto = 2\nset = [\"sphere[0].radius\"]\n";
    for (const auto& [text, place] : {std::pair(search, ":6:9: edge_search.scene"), std::pair(axis, ":5:9: scene")}) {
        const Scratch scratch;
        const auto r = run("sweep " + scratch.write("s.toml", text) + (text == search ? " --worst" : "") + " -o out",
                           scratch.path());
        INFO(r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err, "s.toml" + std::string(place) + " cannot be found: no scene \"near-bening\""));
        CHECK(has(r.err, "near-benign"));
        CHECK(scratch.files().size() == 1);
    }
}

TEST_CASE("an index that no array has is too large, not no number") {
    const auto r = run("map near-benign --set 'sphere[99999999999999999999].radius=1' -o out");
    CHECK(r.code == 2);
    CHECK(has(r.err, "has an index that is too large"));
}

}  // namespace test_bad_input
