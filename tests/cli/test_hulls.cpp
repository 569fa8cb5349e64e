// Forms behind boxes from the command line: how boxes can be computed, what a map says of the level that loses a hit,
// and what is said of mistakes.
#include <map>
#include <string>

#include "catch.hpp"
#include "intersect/hull/hulls.hpp"
#include "program.hpp"

namespace test_cli_hulls {

using namespace lostbits;
using namespace lostbits::test;

TEST_CASE("a map behind boxes tells the level that loses a hit") {
    const Scratch folder;
    const std::string out = (folder / "out").string();
    must(
        "map behind-boxes.sphere -i 'sphere.filtered^box.pbrt_padded~*' -f f32 --size 24x24 --metric lost_to "
        "--metric padding -o '" +
        out + "'");
    std::map<std::string, double> culled;
    for (const auto& row : read_csv(folder / "out/behind-boxes.sphere/summary.csv")) {
        culled[row.at("form")] = number_in(row.at("false_miss"));
        CHECK((number_in(row.at("lost_to_box")) > 0) == (row.at("false_miss") != "0"));
        CHECK(number_in(row.at("lost_to_form")) == 0);
    }
    REQUIRE(culled.size() == intersect::hull::hulls().size());
    CHECK(culled.at("sphere.filtered^box.pbrt_padded") == 0);
    CHECK(culled.at("sphere.filtered^box.pbrt_padded~next") == 0);
    CHECK(culled.at("sphere.filtered^box.pbrt_padded~nearest") > 10);
}

TEST_CASE("two levels of boxes are named from the inside out, and explained") {
    const Scratch folder;
    const std::string name = "box.filtered^box.signs@relative^box.embree_padded~pbrt";
    const std::string out = (folder / "out").string();
    must("map behind-boxes.instance -i '" + name + "' -f f32 --size 12x12 --metric lost_to -o '" + out + "'");
    const auto rows = read_csv(folder / "out/behind-boxes.instance/summary.csv");
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].at("form") == name);
    const auto explained = must("explain behind-boxes.instance --pixel 3,6 --size 12x12 -i '" + name + "'");
    CHECK(has(explained.out, name));
    // Under a matrix a form behind a box alone is taken through the usual space, its box in the space of the solid.
    must("map behind-boxes.instance -i 'box.filtered^box.signs' -f f32 --size 8x8 -o '" + out + "/one'");
    CHECK(read_csv(folder / "out/one/behind-boxes.instance/summary.csv")[0].at("form") ==
          "box.filtered^box.signs@plain");
}

TEST_CASE("steps and offsets of a form behind a box in the world are those of its way into the space of the solid") {
    const Scratch folder;
    const std::string form = "box.signs@plain", out = (folder / "out").string();
    const auto step = [&](const std::string& name, const std::string& where) {
        must("map behind-boxes.instance -i '" + name + "' -f f32 --size 8x8 --metric worst_step -o '" + out + where +
             "'");
        return read_csv(folder / ("out" + where) / "behind-boxes.instance/summary.csv")[0].at("worst_step_inverse");
    };
    CHECK(step(form, "/a") == step(form + "^box.embree_robust", "/b"));
    must("offsets behind-boxes.instance -i '" + form + "^box.signs~nearest' -f f32 --size 8x8 -o '" + out + "/c'");
}

TEST_CASE("what cannot be behind a box is refused with what to write") {
    check_refused(Scratch(), "map behind-boxes.sphere -o out -f f32",
                  {{"-i 'sphere.unified^'", "FORM^BOX"},
                   {"-i '^box.signs'", "FORM^BOX"},
                   {"-i 'sphere.unified^sphere.unified'", "is not a form of a box"},
                   {"-i 'sphere.unified^box.sings'", "box.signs"},
                   {"-i 'sphere.unified^box.signs~nearst'", "nearest"},
                   {"-i sphere.unified --metric lost_to", "behind a box"}});
    check_refused(Scratch(), "map plane-floor -o out -i 'plane.*^box.signs'", {{"", "no box around a plane"}});
}

}  // namespace test_cli_hulls
