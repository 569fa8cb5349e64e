// Transformed primitives and forms behind boxes from the command line: the transform methods, measurements with them,
// and messages on wrong input.
#include <string>

#include <map>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "intersect/bounding_box/box_methods.hpp"
#include "intersect/transform/transform_method.hpp"
#include "program.hpp"

namespace test_cli_spaces {

using namespace lostbits;
using namespace lostbits::test;

TEST_CASE("12 km from the origin a map shows what each transform method loses and at which step") {
    const Scratch folder;
    must(
        "map instance-far.sphere -i 'sphere.unified@*' -f f32 --size 24x24 --metric worst_step --metric "
        "step:origin --metric step:form" +
        into(folder));
    const auto rows = read_csv(folder / "out/instance-far.sphere/summary.csv");
    REQUIRE(rows.size() == intersect::transform::transform_methods().size());
    for (const auto& row : rows) {
        CAPTURE(row.at("form"));
        const bool difference_first = has("@rigid @relative @adjugate @unreal @in_double @two_words",
                                          row.at("form").substr(row.at("form").find('@')));
        const double lost = number_in(row.at("lost_bits_p50"));
        CHECK((difference_first ? lost < 2 : lost > 8));
        CHECK(row.at("false_hit") == "0");
        const double origin = number_in(row.at("step_origin_p50"));
        CHECK((difference_first ? origin < 2 : origin > 100));
        CHECK(number_in(row.at("step_form_max")) < 100);
    }
}

TEST_CASE("a form without a transform method uses the plain one, and a scene of several shapes uses sets") {
    const Scratch folder;
    must("map instance-far.box -i box.signs -f f32 --size 8x8" + into(folder, "out/one"));
    CHECK(read_csv(folder / "out/one/instance-far.box/summary.csv")[0].at("form") == "box.signs@plain");
    const auto crowd = must(
        "map instance-crowd -i sphere.unified@relative -i box.signs@pbrt -i capsule.half_b -i "
        "cone.moment@embree -f f32 --size 12x12" +
        into(folder, "out/many"));
    CHECK(read_csv(folder / "out/many/instance-crowd/summary.csv")[0].at("form") ==
          "sphere.unified@relative+box.signs@pbrt+capsule.half_b@plain+cone.moment@embree");
}

TEST_CASE("explain follows the transform, and a matrix can be given with the numbers of a primitive") {
    const auto pixel = must("explain instance-far.sphere --pixel 96,96 -i sphere.unified -f f32 --json");
    const auto x = nlohmann::ordered_json::parse(pixel.out);
    CHECK(x["form"] == "sphere.unified@plain");
    std::string primitive, ray, matrix;
    for (const auto& [name, number] : x["inputs"].items()) {
        if (name == "ray.tmax") continue;
        std::string& to = name[0] == 'M' ? matrix : name[1] == '.' ? ray : primitive;
        to += (to.empty() ? "" : ",") + number["hex"].get<std::string>();
    }
    const auto own =
        must("explain --sphere=" + primitive + "@" + matrix + " --ray=" + ray + " -i sphere.unified -f f32 --json");
    const auto y = nlohmann::ordered_json::parse(own.out);
    CHECK(x["t"] == y["t"]);
    CHECK(x["truth"] == y["truth"]);
    CHECK(has(run("explain instance-far.sphere --pixel 96,96 -i sphere.unified -f f32").out, "@relative"));
}

TEST_CASE("a glob of steps covers every step, and a glob of forms with a transform method leaves out marches") {
    const Scratch folder;
    must("map instance-far.sphere -i '*@relative' -f f32 --size 6x6 --metric 'step:*'" + into(folder));
    const auto rows = read_csv(folder / "out/instance-far.sphere/summary.csv");
    CHECK(rows.size() > 5);
    for (const auto& row : rows) {
        CHECK(has(row.at("form"), "sphere."));
        for (const std::string_view step : intersect::transform::step_names)
            CHECK(row.count("step_" + std::string(step) + "_p50") == 1);
    }
}

TEST_CASE("a file of rays with a matrix per ray is judged as the scene it comes from") {
    const Scratch folder;
    const std::string scene = "instance-far.sphere --size 7x7 -i sphere.unified@pbrt -f f32";
    must("map " + scene + into(folder));
    std::string names, matrix, primitive, with_matrices, without;
    for (int i = 0; i < 49; ++i) {
        const auto pixel = " --pixel " + std::to_string(i % 7) + "," + std::to_string(i / 7);
        const auto explained = must("explain " + scene + pixel + " --json");
        std::string ray;
        names = matrix = primitive = "";
        const auto inputs = nlohmann::ordered_json::parse(explained.out)["inputs"];
        for (const auto& [name, number] : inputs.items()) {
            if (name == "ray.tmax") continue;
            const auto hex = number["hex"].get<std::string>();
            if (name[0] == 'M') names += "," + name, matrix += "," + hex;
            else if (name[1] == '.') ray += (ray.empty() ? "" : ",") + hex;
            else primitive += (primitive.empty() ? "" : ",") + hex;
        }
        with_matrices += ray + matrix + "\n";
        without += ray + "\n";
    }
    const std::string head = "ox,oy,oz,dx,dy,dz";
    const std::string file = folder.write("rays.csv", head + names + "\n" + with_matrices);
    must("judge '" + file + "' --answer-format f32 --sphere=" + primitive +
         " -i sphere.unified@pbrt -i sphere.unified --rows" + into(folder));
    const auto rows = read_csv(folder / "out/rays/summary.csv");
    const auto map = read_csv(folder / "out/instance-far.sphere/summary.csv");
    REQUIRE(rows.size() == 2);
    CHECK(number_in(rows[0].at("agree_hit")) > 5);
    for (const char* column : {"agree_hit", "agree_miss", "false_hit", "false_miss", "lost_bits_p50", "lost_bits_max"})
        CHECK(rows[0].at(column) == map[0].at(column));
    CHECK(rows[1].at("form") == "sphere.unified@plain");
    // Its worst rays are cases, with their matrices.
    const auto worst = (folder / "out/rays/worst.toml").string();
    CHECK(has(test::contents(worst), "matrix = ["));
    must("sweep '" + worst + "' -i sphere.unified@pbrt -f f32" + into(folder, "out/w"));
    double most = 0;
    for (const auto& row : read_csv(folder / "out/w/worst/cases.csv"))
        most = std::max(most, number_in(row.at("lost_bits_max")));
    CHECK(most == number_in(rows[0].at("lost_bits_max")));
    // Given once, with the primitive: the same again.
    must("judge '" + folder.write("once.csv", head + "\n" + without) + "' --answer-format f32 --sphere=" + primitive +
         "@" + matrix.substr(1) + " -i sphere.unified@pbrt" + into(folder));
    CHECK(read_csv(folder / "out/once/summary.csv")[0].at("lost_bits_p99") == rows[0].at("lost_bits_p99"));
    // A singular one is refused with its line.
    const std::string ray = "0,0,-5,0,0,1";
    const std::string flat = folder.write(
        "flat.csv", head + names + "\n" + ray + ",1,0,0,0,0,1,0,0,0,0,1,0\n" + ray + ",1,2,3,0,2,4,6,0,0,0,1,0\n");
    const auto refused = run("judge '" + flat + "' --sphere 0,0,0,1 -i sphere.unified" + into(folder, "out/f"));
    CHECK(refused.code == 2);
    CHECK(has(refused.err, "flat.csv:3:"));
    CHECK(has(refused.err, "singular"));
    const std::string part = folder.write("part.csv", head + ",M00,M01\n" + ray + ",1,0\n");
    CHECK(has(run("judge '" + part + "' --sphere 0,0,0,1 -i sphere.unified" + into(folder, "out/f")).err,
              "a matrix has no m02"));
    CHECK(
        has(run("judge '" + file + "' --sphere 0,0,0,1 --sphere 0,0,3,1 -i sphere.unified" + into(folder, "out/f")).err,
            "give one primitive for all rays"));
}

TEST_CASE("trade reports the cost of a transform, and why there is none for a primitive without a matrix") {
    const Scratch folder;
    const std::string out = into(folder);
    must("trade instance-far.sphere --size 8x8 -i 'sphere.unified@*' -f f32 --quick" + out);
    const auto rows = read_csv(folder / "out/instance-far.sphere/pareto.csv");
    CHECK(rows.size() == intersect::transform::transform_methods().size());
    CHECK(has(run("trade --shape sphere -i sphere.unified@plain -f f32 --quick" + out).err, "has no transform"));
}

TEST_CASE("a map of a form behind boxes shows the level that loses a hit") {
    const Scratch folder;
    must(
        "map behind-boxes.sphere -i 'sphere.filtered^box.pbrt_padded~*' -f f32 --size 24x24 --metric lost_to "
        "--metric padding" +
        into(folder));
    std::map<std::string, double> culled;
    for (const auto& row : read_csv(folder / "out/behind-boxes.sphere/summary.csv")) {
        culled[row.at("form")] = number_in(row.at("false_miss"));
        CHECK((number_in(row.at("lost_to_box")) > 0) == (row.at("false_miss") != "0"));
        CHECK(number_in(row.at("lost_to_form")) == 0);
    }
    REQUIRE(culled.size() == intersect::bounding_box::box_methods().size());
    CHECK(culled.at("sphere.filtered^box.pbrt_padded") == 0);
    CHECK(culled.at("sphere.filtered^box.pbrt_padded~next") == 0);
    CHECK(culled.at("sphere.filtered^box.pbrt_padded~nearest") > 10);
}

TEST_CASE("two levels of boxes are named from inside to outside, and can be explained") {
    const Scratch folder;
    const std::string name = "box.filtered^box.signs@relative^box.embree_padded~pbrt";
    must("map behind-boxes.instance -i '" + name + "' -f f32 --size 12x12 --metric lost_to" + into(folder));
    const auto rows = read_csv(folder / "out/behind-boxes.instance/summary.csv");
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].at("form") == name);
    const auto explained = must("explain behind-boxes.instance --pixel 3,6 --size 12x12 -i '" + name + "'");
    CHECK(has(explained.out, name));
    // With a transform, a form behind a box without a transform method uses the default one, with its box in the space
    // of the primitive.
    must("map behind-boxes.instance -i 'box.filtered^box.signs' -f f32 --size 8x8" + into(folder, "out/one"));
    CHECK(read_csv(folder / "out/one/behind-boxes.instance/summary.csv")[0].at("form") ==
          "box.filtered^box.signs@plain");
}

TEST_CASE("steps and offsets of a form behind a world-space box are those of its transform") {
    const Scratch folder;
    const std::string form = "box.signs@plain";
    const auto step = [&](const std::string& name, const std::string& where) {
        must("map behind-boxes.instance -i '" + name + "' -f f32 --size 8x8 --metric worst_step" +
             into(folder, "out" + where));
        return read_csv(folder / ("out" + where) / "behind-boxes.instance/summary.csv")[0].at("worst_step_inverse");
    };
    CHECK(step(form, "/a") == step(form + "^box.embree_robust", "/b"));
    must("offsets behind-boxes.instance -i '" + form + "^box.signs~nearest' -f f32 --size 8x8" + into(folder, "out/c"));
}

}  // namespace test_cli_spaces
