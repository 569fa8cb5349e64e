#include "scene/sweep/search_file.hpp"

#include "catch.hpp"
#include "scene/scene_text.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace test_search_file {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::rays;
using namespace lostbits::scene::sweep;
using namespace lostbits::scene::test;

namespace {

/// Keep the line numbers.
const std::string good_search = sweep_head + R"([search]
origin = [-8, 8]
direction = [-1, 1]
centre = [-2, 2]
radius = [0.5, 2]
distance_radii = [2, 5]
impact_radii = [0, 0.5]
)";

SearchFile loaded_search(const std::string& text) { return read_as<SearchFile>("s.toml", text); }
std::string broken(const std::string& from, const std::string& to) {
    return error_as<SearchFile>("s.toml", replace_text(good_search, from, to));
}

}  // namespace

TEST_CASE("a search has a range for every number of ray and primitive") {
    const SearchFile s = loaded_search(good_search);
    CHECK(s.id == "s");
    CHECK(s.shape == Shape::sphere);
    REQUIRE(s.ranges.size() == 10);
    CHECK(s.ranges[2].high == 8);
    CHECK(s.ranges[5].low == -1);
    CHECK(s.ranges[8].high == 2);
    CHECK(s.ranges[9].low == 0.5);
    CHECK(s.metric == "lost_bits");
    CHECK(s.seed == 1);
    const SearchFile box = loaded_search(replace_text(
        replace_text(replace_text(replace_text(good_search, "centre", "lo"), "radius = [0.5, 2]", "hi = [1, 3]"),
                     "distance_radii = [2, 5]\n", ""),
        "impact_radii = [0, 0.5]\n", "metric = \"ulp_error\"\nseed = 7\nstarts = 3\ngenerations = 5\n"));
    CHECK(box.shape == Shape::box);
    REQUIRE(box.ranges.size() == 12);
    CHECK(box.ranges[11].high == 3);
    CHECK(box.metric == "ulp_error");
    CHECK((box.seed == 7 && box.start_count == 3 && box.generation_count == 5));
    const Ray<double> ray{{0, 0, 0}, {1, 0, 0}};
    CHECK(box.contains(ray, Box<double>{{0, 0, 0}, {1, 1, 1}}));
    CHECK(box.contains(ray, Box<double>{{2, 0, 0}, {2, 1, 1}}));  // a side of no thickness
    CHECK_FALSE(box.contains(ray, Box<double>{{2, 0, 0}, {1, 1, 1}}));
    CHECK_FALSE(box.contains(ray, Box<double>{{0, 0, 0}, {1, 1, 3.5}}));
    CHECK_FALSE(box.contains(Ray<double>{{0, 0, 0}, {0, 0, 0}}, Box<double>{{0, 0, 0}, {1, 1, 1}}));
}

TEST_CASE("a search can draw free significands, draw rays at edges, and minimise") {
    const SearchFile plain = loaded_search(good_search);
    CHECK_FALSE((plain.exponents.has_value() || plain.at_edge || plain.is_minimised || plain.hits_only));
    const SearchFile free =
        loaded_search(replace_text(good_search, "impact_radii = [0, 0.5]", "exponents = [-20, 3]\nsmallest = true"));
    CHECK((free.is_minimised && free.hits_only));
    CHECK(loaded_search(replace_text(good_search, "impact_radii = [0, 0.5]", "hits_only = true")).hits_only);
    REQUIRE(free.exponents);
    CHECK((free.exponents->low == -20 && free.exponents->high == 3));
    CHECK(broken("impact_radii = [0, 0.5]", "exponents = [-20, 0.5]")
              .starts_with("s.toml:10:13: search.exponents must be two whole numbers"));
    CHECK(broken("impact_radii = [0, 0.5]", "exponents = [-2000, 0]")
              .starts_with("s.toml:10:13: search.exponents must be two whole numbers"));
    CHECK(has(broken("impact_radii = [0, 0.5]", "at_edge = true"), "needs a box"));
    for (const char* const key : {"smallest", "hits_only"})
        CHECK(has(broken("impact_radii = [0, 0.5]", key + std::string(" = true\nnearest = true")),
                  std::string("search.") + key + " cannot be combined"));
}

TEST_CASE("a search can aim at the places of its shape") {
    const std::string of_cylinder = sweep_head + R"([search]
origin = [-1e7, 1e7]
direction = [-1, 1]
base = [-2, 2]
top = [-2, 2]
radius = [0.5, 2]
aim = "rim"
)";
    const SearchFile rim = loaded_search(of_cylinder);
    REQUIRE(rim.aim);
    CHECK((rim.distance.low == 0x1p-10 && rim.distance.high == 0x1p20));
    const SearchFile axis = loaded_search(replace_text(of_cylinder, "\"rim\"", "\"axis\"\ndistance = [1, 2]"));
    REQUIRE(axis.aim);
    CHECK(*axis.aim != *rim.aim);
    CHECK((axis.distance.low == 1 && axis.distance.high == 2));
    const auto wrong = [&](const std::string& from, const std::string& to) {
        return error_as<SearchFile>("s.toml", replace_text(of_cylinder, from, to));
    };
    CHECK(has(wrong("\"rim\"", "\"rime\""), "did you mean \"rim\""));
    CHECK(has(wrong("\"rim\"", "\"rim\"\ndistance = [0, 1]"), "s.toml:11:12: search.distance must lie above 0"));
    CHECK(has(wrong("aim = \"rim\"", "distance = [1, 2]"), "distance"));
    CHECK(has(wrong("\"rim\"", "\"rim\"\nexponents = [0, 1]"), "places the ray by itself"));
    CHECK(has(broken("impact_radii = [0, 0.5]", "aim = \"rim\""), "spheres have none"));
}

TEST_CASE("a search accepts rays within all its ranges, derived ones included") {
    const SearchFile s = loaded_search(good_search);
    const auto holds = [&](const Vec<double>& o, const Vec<double>& d, double r) {
        return s.contains({o, d}, Sphere<double>{{0, 0, 0}, r});
    };
    CHECK(holds({0, 0, 4}, {0, 0, -1}, 1));
    CHECK(holds({0.5, 0, 4}, {0, 0, -1}, 1));  // impact 0.5
    CHECK_FALSE(holds({0.5, 0.125, 4}, {0, 0, -1}, 1));
    CHECK(holds({0.5, 0.125, 4}, {0, 0, -1}, 2));  // in radii
    CHECK(holds({0.5, 0, 4}, {0, 0, -0.25}, 1));   // whatever the direction's length
    CHECK(holds({0, 0, 5}, {0, 0, -1}, 1));
    CHECK(holds({0, 0, 8}, {0, 0, -1}, 2));
    CHECK_FALSE(holds({0, 0, 5.5}, {0, 0, -1}, 1));  // too far
    CHECK_FALSE(holds({0, 0, 1.5}, {0, 0, -1}, 1));  // too near
    CHECK_FALSE(holds({0, 0, 4}, {0, 0, -1.5}, 1));
    CHECK_FALSE(holds({0, 0, 4}, {0, 0, -1}, 0.25));
    CHECK_FALSE(holds({0, 0, 4}, {0, 0, 0}, 1));
    CHECK_FALSE(s.contains({{0, 0, 4}, {0, 0, -1}}, Sphere<double>{{0, 0, 3}, 1}));
}

TEST_CASE("a wrong search file is refused with its line") {
    CHECK(broken("title", "title") == "no error");
    CHECK(broken("origin = [-8, 8]", "origin = [8, -8]") ==
          "s.toml:5:10: search.origin must be [low, high] with low <= high");
    CHECK(broken("impact_radii = [0, 0.5]", "starts = 0").starts_with("s.toml:10:10: search.starts is the integer 0"));
    CHECK(broken("centre = [-2, 2]", "lo = [-2, 2]").starts_with("s.toml:4:1: search.hi is missing"));
    CHECK(broken("[search]", "[serch]").starts_with("s.toml:4:2: search is missing, but there is serch"));
}

TEST_CASE("a mark can name the measured onset that is drawn beside it") {
    const std::string head = sweep_head + R"([sphere_rays]
[[axis]]
name = "d"
spacing = "log2"
from = 2
to = 64
steps = 3
set = ["distance"]
[[mark]]
at = 16
label = "here"
)";
    const auto mark = [&](const std::string& line) {
        return read_as<SweepFile>("m.toml", head + line + "\n", LOSTBITS_DATA_DIR).marks.at(0);
    };
    const auto error = [&](const std::string& line) {
        return error_as<SweepFile>("m.toml", head + line + "\n", LOSTBITS_DATA_DIR);
    };
    CHECK(mark("format = \"f32\"").form.empty());
    CHECK(mark("format = \"f32\"").format == "f32");
    const auto plain = mark("measured = { form = \"sphere.press\", threshold = 26.5 }");
    CHECK((plain.form == "sphere.press" && plain.event == "lost_bits" && plain.statistic == "p50" &&
           plain.threshold == 26.5));
    const auto full =
        mark("measured = { form = \"sphere.press\", event = \"lost_bits\", statistic = \"p99\", threshold = 1 }");
    CHECK(full.statistic == "p99");
    const auto miss = mark("measured = { form = \"sphere.press\", event = \"false_miss\", threshold = 1 }");
    CHECK((miss.event == "false_miss" && miss.statistic == "count"));
    CHECK(error("measured = { form = \"sphere.pres\", threshold = 1 }")
              .starts_with("m.toml:15:21: mark[0].measured.form is \"sphere.pres\"; did you mean \"sphere.press\""));
    CHECK(has(error("measured = { form = \"sphere.press\", event = \"lost_bit\", threshold = 1 }"),
              "did you mean \"lost_bits\""));
    CHECK(has(error("measured = { form = \"sphere.press\", statistic = \"p51\", threshold = 1 }"),
              "mark[0].measured.statistic is \"p51\""));
}

TEST_CASE("a sweep is named by its path below data/sweeps, or by its file name if that is unique") {
    const Scratch data;
    const fs::path near = data.write("sweeps/worst/near.toml", ""), one = data.write("sweeps/a/both.toml", "");
    data.write("sweeps/b/both.toml", "");
    const fs::path top = data.write("sweeps/c/top.toml", ""), upper = data.write("sweeps/top.toml", "");
    CHECK(find_sweep("worst/near", data.path()) == near);
    CHECK(find_sweep("near", data.path()) == near);
    CHECK(find_sweep("a/both", data.path()) == one);
    CHECK(find_sweep("top", data.path()) == upper);
    CHECK(find_sweep("c/top", data.path()) == top);
    CHECK(find_sweep(near.string(), "nowhere") == near);
    fs::create_directory(data.path() / "folder.toml");
    CHECK(has(error_of([&] { find_sweep((data.path() / "folder.toml").string(), data.path()); }), "is a folder"));
    CHECK(has(error_of([&] { find_sweep("both", data.path()); }), "\"a/both\""));
    CHECK(error_of([&] { find_sweep("nar", data.path()); }).starts_with("no sweep \"nar\" in "));
}

TEST_CASE("a sweep redrawn has other rays at the same positions, and one over a scene has none to redraw") {
    const std::string axis = "[[axis]]\nname = \"x\"\nspacing = \"linear\"\nfrom = 2\nto = 4\nsteps = 2\nset = [";
    const auto same = [](const RayGroup& a, const RayGroup& b) {
        return a.rays.ox == b.rays.ox && a.rays.dz == b.rays.dz &&
               a.primitives.front().numbers == b.primitives.front().numbers;
    };
    for (const char* distribution : {"sphere_rays", "box_rays"}) {
        const std::string text =
            sweep_head + "[" + distribution + "]\nseed = 7\nviews = 3\n" + axis + "\"distance\"]\n";
        const auto file = read_as<SweepFile>("s.toml", text, LOSTBITS_DATA_DIR);
        CHECK(file.has_random_rays());
        const auto own = file.rays({3}), none = file.with_seed_offset(0).rays({3}),
                   second = file.with_seed_offset(2).rays({3}),
                   twice = file.with_seed_offset(1).with_seed_offset(1).rays({3});
        const auto nine =
            read_as<SweepFile>("s.toml", replace_text(text, "seed = 7", "seed = 9"), LOSTBITS_DATA_DIR).rays({3});
        REQUIRE(own.size() == 3);
        for (std::size_t v = 0; v < own.size(); ++v) {
            CHECK(same(own[v], none[v]));
            CHECK(same(second[v], twice[v]));
            CHECK(same(second[v], nine[v]));
            CHECK_FALSE(same(own[v], second[v]));
        }
    }
    const std::string over_scene = sweep_head + "scene = \"near-benign\"\n" + axis + "\"sphere[0].radius\"]\n";
    const auto scene = read_as<SweepFile>("c.toml", over_scene, LOSTBITS_DATA_DIR);
    CHECK_FALSE(scene.has_random_rays());
    CHECK(same(scene.rays({3}).front(), scene.with_seed_offset(1).rays({3}).front()));
}

}  // namespace test_search_file
