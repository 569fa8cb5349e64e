// Files of named cases, and search files.
#include "scene/sweep/case_file.hpp"

#include <array>
#include <cmath>
#include <set>

#include "catch.hpp"
#include "scene/scene_text.hpp"
#include "scene/sweep/search_file.hpp"

namespace test_case_file {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::rays;
using namespace lostbits::scene::sweep;
using namespace lostbits::scene::test;

namespace {

/// Keep the line numbers.
const std::string good_cases = sweep_head + R"([[case]]
name = "one"
spheres = [{ centre = [1, 2, 3], radius = 4 }]
rays = [{ origin = [5, 6, 7], direction = [8, 9, 10] }]
[[case]]
name = "two"
lengths = 1
spheres = [{ centre = [1, 2, 3], radius = 4 }, { centre = ["1 + ulp", 0, 0], radius = "min" }]
rays = [{ origin = [0, 0, "nan"], direction = [0, 0, "-inf"] }, { origin = [1, 0, 0], direction = ["tiny", 0, 0] }]
)";

CaseFile loaded_cases(const std::string& text) { return read_as<CaseFile>("c.toml", text); }
std::string case_error(const std::string& text) { return error_as<CaseFile>("c.toml", text); }
std::string broken(const std::string& from, const std::string& to) {
    return case_error(replace_text(good_cases, from, to));
}

using Numbers = std::array<double, 10>;
Numbers numbers_of(const RayGroup& group) {
    const Sphere<double> s = group.primitives.front().sphere();
    return {group.rays.ox[0], group.rays.oy[0], group.rays.oz[0], group.rays.dx[0], group.rays.dy[0],
            group.rays.dz[0], s.centre.x,       s.centre.y,       s.centre.z,       s.radius};
}

}  // namespace

TEST_CASE("cases are read in order, each with its rays and primitives") {
    const CaseFile file = loaded_cases(good_cases);
    CHECK(file.id == "c");
    CHECK(file.right_within_bits == 3);
    REQUIRE(file.size() == 2);
    CHECK(file.name(1) == "two");
    CHECK(file.shapes() == std::vector{Shape::sphere});
    CHECK(file.cases_matching("t*o", {}) == std::vector<std::size_t>{1});
    CHECK(error_of([&] {
              static_cast<void>(file.cases_matching("tow", {"claims.toml", 4, 2}));
          }) == "claims.toml:4:2: no case \"tow\" in c; did you mean \"two\"?");
    const auto first = file.rays(0, binary32);
    REQUIRE(first.size() == 1);
    CHECK(numbers_of(first[0]) == Numbers{5, 6, 7, 8, 9, 10, 1, 2, 3, 4});
    CHECK(loaded_cases("right_within_bits = 0.5\n" + good_cases).right_within_bits == 0.5);
}

TEST_CASE("each format rounds a case itself, and a scale multiplies lengths but not directions") {
    const CaseFile file = loaded_cases(good_cases);
    for (const FloatFormat& format : {binary16, bfloat16, binary32, binary64}) {
        const auto group = file.rays(1, format).at(0);
        REQUIRE(group.primitives.size() == 2);
        REQUIRE(group.rays.size() == 2);
        CHECK(group.rays.width == 2);
        CHECK(group.primitives[0].sphere().centre == Vec<double>(2, 4, 6));
        CHECK(group.primitives[0].sphere().radius == 8);
        CHECK(group.primitives[1].sphere().centre.x == 2 + std::ldexp(1, 2 - format.precision));
        CHECK(group.primitives[1].sphere().radius == std::ldexp(1, format.emin));  // a word, not scaled
        CHECK(std::isnan(group.rays.oz[0]));
        CHECK(group.rays.dz[0] == -INFINITY);
        CHECK(group.rays.ox[1] == 2);
        CHECK(group.rays.dx[1] == std::ldexp(1, format.emin - format.precision + 1));
    }
    const auto turned =
        loaded_cases(replace_text(good_cases, "lengths = 1", "directions = \"emax/2\"")).rays(1, binary32).at(0);
    CHECK(turned.primitives[0].sphere().radius == 4);
    const auto scaled = loaded_cases(replace_text(good_cases, "name = \"one\"",
                                                  "name = \"one\"\nlengths = \"emax/4\"\ndirections = -3"))
                            .rays(0, binary32)
                            .at(0);
    CHECK(numbers_of(scaled) ==
          Numbers{5 * 0x1p31, 6 * 0x1p31, 7 * 0x1p31, 1, 1.125, 1.25, 0x1p31, 0x1p32, 3 * 0x1p31, 0x1p33});
}

TEST_CASE("a symmetric case is run under 48 symmetries of ray and primitive") {
    const auto groups =
        loaded_cases(replace_text(good_cases, "name = \"one\"", "name = \"one\"\nsymmetric = true")).rays(0, binary32);
    REQUIRE(groups.size() == 48);
    std::set<Numbers> images;
    for (const RayGroup& group : groups) {
        const Numbers n = numbers_of(group);
        images.insert(n);
        REQUIRE(group.rays.size() == 1);
        CHECK(n[9] == 4);
        // One signed permutation takes (5, 6, 7), (8, 9, 10) and (1, 2, 3) to the image: read off the origin, checked
        // on the rest.
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double from = std::fabs(n[axis]), sign = std::copysign(1, n[axis]);
            CHECK((from == 5 || from == 6 || from == 7));
            CHECK(n[3 + axis] == sign * (from + 3));
            CHECK(n[6 + axis] == sign * (from - 4));
        }
        CHECK(std::fabs(n[0] * n[1] * n[2]) == 5 * 6 * 7);
    }
    CHECK(images.size() == 48);
    CHECK(numbers_of(groups.front()) == Numbers{5, 6, 7, 8, 9, 10, 1, 2, 3, 4});
}

TEST_CASE("a mirrored box is a box with its ends in order") {
    const std::string boxes = sweep_head + R"([[case]]
name = "b"
symmetric = true
boxes = [{ lo = [1, -2, 3], hi = [2, 5, 9] }]
rays = [{ origin = [0, 0, 0], direction = [1.5, 1, 4] }]
)";
    const CaseFile file = loaded_cases(boxes);
    CHECK(file.shapes() == std::vector{Shape::box});
    std::set<decltype(Primitive<double>::numbers)> images;
    for (const RayGroup& group : file.rays(0, binary32)) {
        REQUIRE(group.primitives.size() == 1);
        REQUIRE(group.primitives[0].shape == Shape::box);
        const Box<double> b = group.primitives[0].box();
        images.insert(group.primitives[0].numbers);
        const Vec<double> d(group.rays.dx[0], group.rays.dy[0], group.rays.dz[0]);
        int inside = 0;
        for (int i = 0; i < 3; ++i) {
            CHECK(b.lo[i] < b.hi[i]);
            inside += b.lo[i] <= d[i] && d[i] <= b.hi[i];  // the direction, as a point, goes with the box
        }
        CHECK(inside == 3);
        CHECK((b.hi.x - b.lo.x) * (b.hi.y - b.lo.y) * (b.hi.z - b.lo.z) == 1 * 7 * 6);
    }
    CHECK(images.size() == 48);
    const std::string mixed = replace_text(boxes, "rays =", "spheres = [{ centre = [7, 0, 0], radius = 1 }]\nrays =");
    const CaseFile several = loaded_cases(mixed);
    CHECK(several.shapes() == std::vector{Shape::sphere, Shape::box});
    CHECK(several.rays(0, binary32)[0].primitives.size() == 2);
    CHECK_FALSE(several.accepts(Shape::box));
    const auto ended = loaded_cases(replace_text(mixed, "direction =", "tmax = 4, direction ="));
    CHECK(ended.rays(0, binary32)[0].rays.tmax == std::vector{4.0});
}

TEST_CASE("the corners of a box keep the signed zeros of the file in either order") {
    const auto corners = [](const std::string& lo, const std::string& hi, bool symmetric) {
        const CaseFile file =
            loaded_cases(sweep_head + "[[case]]\nname = \"b\"\n" + std::string(symmetric ? "symmetric = true\n" : "") +
                         "boxes = [{ lo = [" + lo + ", 1, 2], hi = [" + hi +
                         ", 1, 2] }]\nrays = [{ origin = [0, 0, 0], direction = [1, 1, 4] }]\n");
        std::set<std::pair<bool, bool>> signs;  // of lo and of hi, in the axis that holds the zeros
        for (const RayGroup& group : file.rays(0, binary32)) {
            const Box<double> b = group.primitives[0].box();
            int zeros = 0;
            for (int i = 0; i < 3; ++i) {
                if (b.lo[i] != 0) continue;
                ++zeros;
                signs.insert({std::signbit(b.lo[i]), std::signbit(b.hi[i])});
            }
            CHECK(zeros == 1);
        }
        return signs;
    };
    using Signs = std::set<std::pair<bool, bool>>;
    for (const std::string zero : {"0.0", "\"+0\"", "0"}) {
        for (const std::string minus : {"-0.0", "\"-0\""}) {
            CHECK(corners(minus, zero, false) == Signs{{true, false}});
            CHECK(corners(zero, minus, false) == Signs{{false, true}});
            CHECK(corners(minus, minus, false) == Signs{{true, true}});
            // A mirror takes lo = −0, hi = +0 to −(+0), −(−0): the same again.
            CHECK(corners(minus, zero, true) == Signs{{true, false}});
            CHECK(corners(zero, minus, true) == Signs{{false, true}});
            CHECK(corners(zero, zero, true) == Signs{{false, false}, {true, true}});
        }
    }
}

TEST_CASE("corners that rounding puts in the wrong order are exchanged") {
    const CaseFile file = loaded_cases(sweep_head + R"([[case]]
name = "b"
boxes = [{ lo = ["1 + ulp", 1, 2], hi = [1.0001, 1, 2] }]
rays = [{ origin = [0, 0, 0], direction = [1, 1, 4] }]
)");
    const Box<double> narrow = file.rays(0, find_format("bf16")->parameters)[0].primitives[0].box();
    CHECK(narrow.lo.x == 1);
    CHECK(narrow.hi.x == 1 + 0x1p-7);
    CHECK(file.unrounded_rays(0, find_format("bf16")->parameters)[0].primitives[0].box().hi.x == 1.0001);
}

TEST_CASE("the rays of a case have ranges for every shape") {
    const auto file = loaded_cases(sweep_head + R"([[case]]
name = "a"
open_ends = "tmin"
spheres = [{ centre = [0, 0, 0], radius = 1 }]
rays = [{ origin = [0, 0, 0], direction = [1, 0, 0], tmin = 0.5, tmax = "3 - ulp" },
        { origin = [0, 0, 0], direction = [1, 0, 0] }]
)");
    const auto rays = file.rays(0, binary32)[0].rays;
    CHECK(rays.tmin == std::vector<double>{0.5, 0});
    CHECK(rays.tmax == std::vector<double>{3 - 0x1p-22, HUGE_VAL});
    CHECK((rays.open_ends.tmin && !rays.open_ends.tmax));
    CHECK(has(broken("title", "open_ends = \"tmin\"\ntitle"), "open_ends"));
}

TEST_CASE("an empty range is refused in a case as in a scene") {
    const auto error = [](const std::string& ends, const std::string& open = "none") {
        return case_error(sweep_head + "[[case]]\nname = \"a\"\nopen_ends = \"" + open +
                          "\"\nspheres = [{ centre = [0, 0, 0], radius = 1 }]\n"
                          "rays = [{ origin = [0, 0, 0], direction = [1, 0, 0], " +
                          ends + " }]\n");
    };
    const std::string none_at = "c.toml:8:71: case[0].rays[0].tmax leaves no t between tmin and tmax";
    CHECK(error("tmin = 5, tmax = 4").starts_with(none_at));
    CHECK(error("tmin = 4, tmax = 4", "both").starts_with(none_at));
    CHECK(error("tmin = 4, tmax = 4", "tmin").starts_with(none_at));
    CHECK(error("tmin = 4, tmax = 4", "tmax").starts_with(none_at));
    CHECK(error("tmin = 3, tmax = \"3 - ulp\"").starts_with(none_at));
    CHECK(has(error("tmax = -1"), "tmax leaves no t"));
    CHECK(has(error("tmax = 0", "tmax"), "tmax leaves no t"));
    CHECK(has(error("tmax = \"nan\""), "tmax is not a t"));
    for (const std::string tmin : {"-1", "\"inf\"", "\"nan\""})
        CHECK(has(error("tmin = " + tmin), "c.toml:8:61: case[0].rays[0].tmin is not a finite t of 0 or more"));
    for (const std::string some :
         {"tmin = 4, tmax = 4", "tmin = 0, tmax = 0", "tmax = \"inf\"", "tmin = 4", "tmin = 4, tmax = 4.000000000001"})
        CHECK(error(some) == "no error");
    CHECK(error("tmin = 4, tmax = 4.000000000001", "both") == "no error");  // there are doubles between
}

TEST_CASE("a wrong file of cases is refused with its line") {
    CHECK(broken("title", "title") == "no error");
    CHECK(broken("lostbits-sweep/1", "lostbits-scene/1").starts_with("c.toml:1:10: "));
    CHECK(broken("name = \"two\"", "name = \"one\"") ==
          "c.toml:9:8: case[1].name is \"one\", which is also the name of another case; give each its own name");
    CHECK(broken("radius = 4", "radius = \"nan\"") ==
          "c.toml:6:43: is nan, which is allowed in rays only; write a finite number");
    CHECK(broken("centre = [1, 2, 3]", "centre = [1, inf, 3]") ==
          "c.toml:6:27: is inf, which is allowed in rays only; write a finite number");
    CHECK(
        broken("spheres = [{ centre = [1, 2, 3], radius = 4 }]\n", "").starts_with("c.toml:4:1: a case needs spheres"));
    CHECK(broken("rays = [{ origin = [5, 6, 7], direction = [8, 9, 10] }]\n", "")
              .starts_with("c.toml:4:1: a case needs rays"));
    for (const std::string list : {"spheres", "rays"})
        CHECK(broken(list + " = [", 'x' + list + " = [")
                  .ends_with("unknown key case[0].x" + list + "; did you mean \"" + list + "\"?"));
    CHECK(case_error(good_cases.substr(0, good_cases.find("[[case]]"))) == "c.toml:1:1: has no [[case]]");
    CHECK(has(case_error(good_cases + "[[axis]]\n"), "unknown key axis"));
}

TEST_CASE("the tables of a sweep file determine its kind") {
    const Scratch folder;
    CHECK(read_sweep_kind(folder.write("a.toml", "[[axis]]\n")) == SweepKind::axes);
    CHECK(read_sweep_kind(folder.write("e.toml", "[axis]\n")) == SweepKind::every_float);
    CHECK(read_sweep_kind(folder.write("n.toml", "[axis]\nsteps = 3\n")) == SweepKind::axes);
    CHECK(read_sweep_kind(folder.write("c.toml", "[[case]]\n")) == SweepKind::cases);
    CHECK(read_sweep_kind(folder.write("s.toml", "[search]\n")) == SweepKind::search);
}

TEST_CASE("a misspelt table of a sweep file is reported as misspelt, for every kind of sweep") {
    const Scratch folder;
    const auto error = [&folder](const std::string& text) {
        const fs::path file = folder.write("s.toml", text);
        return error_in(folder, [&] { static_cast<void>(read_sweep_kind(file)); });
    };
    CHECK(error(sweep_head + "[edge_serch]\n") == "s.toml:4:2: unknown key edge_serch; did you mean \"edge_search\"?");
    CHECK(error(sweep_head + "[serch]\n") == "s.toml:4:2: unknown key serch; did you mean \"search\"?");
    CHECK(error(sweep_head + "[[axes]]\n") == "s.toml:4:3: unknown key axes; did you mean \"axis\"?");
    CHECK(error(sweep_head + "[sphere_rys]\n[[axis]]\n") ==
          "s.toml:4:2: unknown key sphere_rys; did you mean \"sphere_rays\"?");
    CHECK(error(sweep_head + "[[axis]]\n[spher]\n") == "s.toml:5:2: unknown key spher; did you mean \"sphere\"?");
    CHECK(error("schema = \"lostbits-scene/1\"\n[rays]\n").starts_with("s.toml:1:10: schema is"));
    CHECK(read_sweep_kind(folder.write("s.toml", sweep_head + "[unheard_of]\n")) ==
          SweepKind::axes);  // told by its reader
}

}  // namespace test_case_file
