// Every key of a scene, wrong in every way that holds for any: told at its place, by its name, and documented.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <vector>

#include "catch.hpp"
#include "scene/scene_text.hpp"

namespace test_mistakes {

using namespace lostbits;
using namespace lostbits::scene::test;

namespace {

/// Between them they have every key, one a line.
const std::string scenes[] = {
    R"(schema = "lostbits-scene/1"
title = "A test"
source = "-"
note = "nothing"
inputs = "own"
size = [8, 4]
background = [0.5, 0.5, 0.5]
[camera]
kind = "pinhole"
eye = [0, 0, 0]
look_at = [0, 0, -1]
up = [0, 1, 0]
fov_deg = 40
rays = "three"
[camera.projection]
near = 0.5
far = 100
depth = "gl"
[rays]
tmin = 0.5
tmax = 9
open_ends = "both"
[light]
position = [5, 6, 7]
[shadows]
surface = "half_diffuse"
background = 0.25
own = true
offset = "epsilon"
epsilon = 0.5
[material]
colour = [1, 0.5, 0]
ka = 0.5
kd = 0.5
ks = 0.5
n = 7
[march]
hit_eps = 0.5
max_dist = 9
relative_eps = 0.5
cone = 0.5
over_relaxation = 1.5
max_steps = 7
secant_steps = 7
bisect_steps = 7
[sphereflake]
levels = 1
centre = [0, 0, -10]
radius = 1
axis = [0, 1, 0]
[[sphere]]
centre = [0, 0, -10]
radius = 1
[sphere.transform]
stored = "inverse"
matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]
scale = 2
translate = [1, 2, 3]
[sphere.transform.rotate]
axis = [0, 0, 1]
degrees = 30
[sphere.transform.look_at]
from = [0, 0, 1]
to = [0, 0, 5]
up = [0, 1, 0]
[[variant]]
name = "a"
)",
    R"(schema = "lostbits-scene/1"
title = "A test"
[camera]
kind = "orthographic"
eye = [0, 0, 0]
look_at = [0, 0, -1]
width = 2.5
shift = [0.5, 0.5]
[[mesh]]
make = "icosphere"
levels = 1
radius = 1
[[mesh]]
make = "grid"
centre = [1, 2, 3]
parts = [2, 2]
width = 1
height = 1
bump = 0.5
[[mesh]]
make = "tube"
around = 8
along = 8
ring_radius = 2
radius = 0.5
[[mesh]]
make = "fan"
count = 8
)",
    R"(schema = "lostbits-scene/1"
title = "A test"
[camera]
kind = "pinhole"
eye = [0, 0, 0]
look_at = [0, 0, -1]
fov_deg = 40
normalise = false
[light]
position = [5, 6, 7]
[shadows]
own = true
offset = "ulp"
ulps = 4
[[sphere]]
centre = [0, 0, -10]
radius = 1
)",
    R"(schema = "lostbits-scene/1"
title = "A test"
[camera]
kind = "pixel_plane"
eye = [1, 2, 10]
extent = [-4, -1, 4, 3]
[[disc]]
centre = [0, 0, 1]
normal = [0, 0, 1]
outer_radius = 2
inner_radius = 1
)"};

struct Line {
    std::string text, key, table;  ///< `a = 1`, `a`, and the header that it stands under
};

std::vector<Line> lines_of(const std::string& scene) {
    std::vector<Line> lines;
    std::string table;
    for (std::size_t at = 0; at < scene.size(); at = scene.find('\n', at) + 1) {
        const std::string text = scene.substr(at, scene.find('\n', at) - at);
        if (text.starts_with('[')) table = text;
        lines.push_back({text, text.starts_with('[') ? "" : text.substr(0, text.find(' ')), table});
    }
    return lines;
}

/// The scene with another line in the place of one, and its variant, which is one line too many for the other mistakes.
std::string with_line(const std::vector<Line>& lines, std::size_t i, const std::string& text) {
    std::string all;
    for (std::size_t k = 0; k < lines.size(); ++k) {
        all += (k == i ? text : lines[k].text) + '\n';
        if (lines[k].table == "[[variant]]" && k + 1 == lines.size()) all += "set = {}\n";
    }
    return all;
}

template <class Check>
void for_each_key(const Check& check) {
    for (const std::string& scene : scenes) {
        const std::vector<Line> lines = lines_of(scene);
        REQUIRE(scene_error(with_line(lines, 0, lines[0].text)) == "no error");
        for (std::size_t i = 0; i < lines.size(); ++i)
            if (!lines[i].key.empty()) check(lines, i);
    }
}

bool is_at(const std::string& error, std::size_t line) {
    return error.starts_with("scene.toml:" + std::to_string(line + 1) + ":");
}

}  // namespace

TEST_CASE("a value that no key of a scene can have is told at its place, by the name of the key, with what to write") {
    const std::set<std::string> texts{"title", "source", "note"};
    for_each_key([&](const std::vector<Line>& lines, std::size_t i) {
        const std::string& key = lines[i].key;
        for (const char* value : {"nan", "-inf", "1979-05-27", "[[]]", "\"1e400 !\"", "\"\\u009b\""}) {
            const bool may_be_words = *value == '"' && texts.contains(key);
            const std::string error = scene_error(with_line(lines, i, key + " = " + value));
            INFO(lines[i].table << " " << key << " = " << value << "\n" << error);
            if (may_be_words && value != std::string("\"\\u009b\"")) {
                CHECK(error == "no error");
                continue;
            }
            CHECK(is_at(error, i));
            CHECK(has(error, key));
            CHECK((has(error, "; ") || has(error, "expected here")));
        }
    });
}

TEST_CASE("a key that is missing or misspelt is told, or has a value of its own") {
    // Without these nothing else has a meaning, or keys beside them have none and are told first.
    const std::set<std::string> leading{"schema", "own", "offset", "make", "kind"};
    for_each_key([&](const std::vector<Line>& lines, std::size_t i) {
        const std::string& key = lines[i].key;
        if (leading.contains(key)) return;
        INFO(lines[i].table << " " << key);
        const std::string missing = scene_error(with_line(lines, i, "")),
                          misspelt = scene_error(with_line(lines, i, key[0] + lines[i].text)),
                          twice = scene_error(with_line(lines, i, lines[i].text + "\n" + lines[i].text));
        INFO(missing << "\n" << misspelt);
        CHECK((missing == "no error" || (missing.starts_with("scene.toml:") && has(missing, key))));
        CHECK(is_at(misspelt, i));
        CHECK(has(misspelt, "did you mean \"" + key + "\"?"));
        CHECK(is_at(twice, i + 1));
        CHECK(has(twice, key));
    });
}

TEST_CASE("every key that a scene may have stands in data/README.md") {
    std::ifstream file(fs::path(LOSTBITS_DATA_DIR) / "README.md");
    const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    const std::string about = text.substr(0, text.find("## sweeps/"));
    std::set<std::string> known;
    for_each_key([&](const std::vector<Line>& lines, std::size_t i) {
        // An unknown key ends in the names of all that are known there, where they are a dozen at most.
        const std::string error = scene_error(with_line(lines, i, lines[i].text + "\nqqqqqqqq = 1"));
        static const std::regex name("\"([a-z_]+)\"");
        for (std::sregex_iterator at(error.begin(), error.end(), name), end; at != end; ++at) known.insert((*at)[1]);
        known.insert(lines[i].key);
    });
    CHECK(known.size() > 60);
    for (const std::string& key : known) {
        INFO(key);
        CHECK(std::regex_search(about, std::regex("`[^`]*\\b" + key + "\\b")));
    }
}

}  // namespace test_mistakes
