// Solids under matrices from the command line: which spaces there are, what is measured through them, and what is said
// of mistakes.
#include <string>

#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "intersect/space/space.hpp"
#include "program.hpp"

namespace test_cli_spaces {

using namespace lostbits;
using namespace lostbits::test;

TEST_CASE("twelve kilometres out a map tells what each space loses, and which step loses it") {
    const Scratch folder;
    const std::string out = (folder / "out").string();
    must(
        "map instance-far.sphere -i 'sphere.unified@*' -f f32 --size 24x24 --metric worst_step --metric "
        "step:origin --metric step:form -o '" +
        out + "'");
    const auto rows = read_csv(folder / "out/instance-far.sphere/summary.csv");
    REQUIRE(rows.size() == intersect::space::spaces().size());
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

TEST_CASE("a form without a space is asked through the plain one, and a scene of several shapes by sets") {
    const Scratch folder;
    const std::string out = (folder / "out").string();
    must("map instance-far.box -i box.signs -f f32 --size 8x8 -o '" + out + "/one'");
    CHECK(read_csv(folder / "out/one/instance-far.box/summary.csv")[0].at("form") == "box.signs@plain");
    const auto crowd = must(
        "map instance-crowd -i sphere.unified@relative -i box.signs@pbrt -i capsule.half_b -i "
        "cone.moment@embree -f f32 --size 12x12 -o '" +
        out + "/many'");
    CHECK(read_csv(folder / "out/many/instance-crowd/summary.csv")[0].at("form") ==
          "sphere.unified@relative+box.signs@pbrt+capsule.half_b@plain+cone.moment@embree");
}

TEST_CASE("explain goes through the space, and a matrix can be given with the numbers of a solid") {
    const auto pixel = must("explain instance-far.sphere --pixel 96,96 -i sphere.unified -f f32 --json");
    const auto x = nlohmann::ordered_json::parse(pixel.out);
    CHECK(x["form"] == "sphere.unified@plain");
    std::string solid, ray, matrix;
    for (const auto& [name, number] : x["inputs"].items()) {
        if (name == "limit") continue;
        std::string& to = name[0] == 'M' ? matrix : name[1] == '.' ? ray : solid;
        to += (to.empty() ? "" : ",") + number["hex"].get<std::string>();
    }
    const auto own =
        must("explain --sphere=" + solid + "@" + matrix + " --ray=" + ray + " -i sphere.unified -f f32 --json");
    const auto y = nlohmann::ordered_json::parse(own.out);
    CHECK(x["t"] == y["t"]);
    CHECK(x["truth"] == y["truth"]);
    CHECK(has(run("explain instance-far.sphere --pixel 96,96 -i sphere.unified -f f32").out, "@relative"));
}

TEST_CASE("what is wrong with a matrix or a space is said, and nothing is written") {
    const Scratch folder;
    check_refused(folder, "map instance-far.sphere --size 4x4 -f f32 -o out",
                  {{"-i sphere.unified@plan", "unknown space; did you mean \"plain\"?"},
                   {"-i sphere.unified@", "stands beside the @"},
                   {"--set 'sphere[0].transform.scale=[1,0,1]'", "flattens the solid"},
                   {"--set 'sphere[0].transform.matrix=[1,2,3,0,2,4,6,0,0,0,1,0]'", "is singular: it flattens"},
                   {"--set 'sphere[0].transform.scale=[1,1,\"1e-60\"]'", "is singular in binary32"},
                   {"--set 'sphere[0].transform.rotat=1'", "did you mean \"rotate\"?"},
                   {"--set 'sphere[0].transform.stored=\"back\"'", "forward"},
                   {"-i sphere.unified --metric step:orign", "did you mean \"origin\"?"},
                   {"-i sphere.unified --metric 'step:x*'", "no step matches this pattern", 4},
                   {"-i sdf.sphere_trace@plain", "marches"},
                   {"-i 'sdf.*@plain'", "every form that matches marches", 4},
                   {"-i 'sdf.*'", "no selected form handles", 4}});
    check_refused(folder, "explain --ray=0,0,9,0,0,-1",
                  {{"--sphere=0,0,0,1@1,2,3 -i sphere.unified", "is not a matrix"},
                   {"--sphere=0,0,0,1@1,0,0,0,0,1,0,0,0,0,0,0 -i sphere.unified", "singular"},
                   {"--sphere=0,0,0,1 -i sphere.unified@plain", "no solid under a matrix"}});
    check_refused(folder, "map -f f32 -o out",
                  {{"instance-crowd -i 'sphere.unified+box.signs@plain+capsule.half_b@plain+cone.moment@plain'",
                    "after each form, or after none"},
                   {"rtg-fig-7-3-4100-oblique -i sphere.unified --metric worst_step", "stands under a matrix"}});
}

TEST_CASE("a glob of steps is every step, and a glob of forms through a space leaves out those that march") {
    const Scratch folder;
    const std::string out = (folder / "out").string();
    must("map instance-far.sphere -i '*@relative' -f f32 --size 6x6 --metric 'step:*' -o '" + out + "'");
    const auto rows = read_csv(folder / "out/instance-far.sphere/summary.csv");
    CHECK(rows.size() > 5);
    for (const auto& row : rows) {
        CHECK(has(row.at("form"), "sphere."));
        for (const std::string_view step : intersect::space::step_names)
            CHECK(row.count("step_" + std::string(step) + "_p50") == 1);
    }
}

TEST_CASE("far out the bound of a point is safe in the world, and not where it is taken in the space of the solid") {
    const Scratch folder;
    const std::string out = (folder / "out").string();
    must(
        "offsets instance-far -i sphere.unified@pbrt -i box.signs@pbrt -i triangle.undivided@pbrt "
        "-f f32 --size 24x24 --strategy offset.none,offset.bound,offset.bound_object -o '" +
        out + "'");
    int bounds = 0;
    for (const char* variant : {"sphere", "box", "triangle"}) {
        const auto file = std::string("out/instance-far.") + variant + "/summary.csv";
        for (const auto& row : read_csv(folder.path() / file)) {
            if (row.at("side") != "outside" || row.at("point") != "projected") continue;
            CAPTURE(variant, row.at("strategy"), row.at("points"));
            CHECK(number_in(row.at("points")) > 50);
            const bool bound = row.at("strategy") == "offset.bound";
            const double hits = number_in(row.at("self_hit_fraction"));
            CHECK((bound ? hits == 0 : hits > 0.01));
            bounds += bound;
        }
    }
    CHECK(bounds == 3);
}

TEST_CASE("the same solid under a matrix or directly: each way round, and what differs is the ways own") {
    const Scratch folder;
    const std::string out = (folder / "out").string();
    must(
        "consistency instance-far.triangle -i triangle.undivided@plain -i triangle.undivided@relative -f f32 "
        "--size 32x32 --check placed -o '" +
        out + "'");
    must("consistency near-benign -i sphere.unified -f f32 -f f64 --size 32x32 -o '" + out + "'");
    const auto placed = read_csv(folder / "out/instance-far.triangle/summary.csv");
    REQUIRE(placed.size() == 2);
    CHECK(number_in(placed[0].at("excess_p50")) > 32);
    CHECK(number_in(placed[1].at("excess_p50")) < number_in(placed[0].at("excess_p50")) / 16);
    int rows = 0;
    for (const auto& row : read_csv(folder / "out/near-benign/summary.csv")) {
        if (row.at("check") != "placed") continue;
        ++rows;
        CHECK(row.at("rays") == "1024");
        CHECK(number_in(row.at("excess_p50")) < 64);
        CHECK(number_in(row.at("unresolved")) == 0);
    }
    CHECK(rows == 2);
}

TEST_CASE("a file of rays has a matrix for each ray, and is judged as the scene that they are of") {
    const Scratch folder;
    const std::string out = (folder / "out").string();
    const std::string scene = "instance-far.sphere --size 7x7 -i sphere.unified@pbrt -f f32";
    must("map " + scene + " -o '" + out + "'");
    std::string names, matrix, solid, with_matrices, without;
    for (int i = 0; i < 49; ++i) {
        const auto pixel = " --pixel " + std::to_string(i % 7) + "," + std::to_string(i / 7);
        const auto explained = must("explain " + scene + pixel + " --json");
        std::string ray;
        names = matrix = solid = "";
        const auto inputs = nlohmann::ordered_json::parse(explained.out)["inputs"];
        for (const auto& [name, number] : inputs.items()) {
            if (name == "limit") continue;
            const auto hex = number["hex"].get<std::string>();
            if (name[0] == 'M') names += "," + name, matrix += "," + hex;
            else if (name[1] == '.') ray += (ray.empty() ? "" : ",") + hex;
            else solid += (solid.empty() ? "" : ",") + hex;
        }
        with_matrices += ray + matrix + "\n";
        without += ray + "\n";
    }
    const std::string head = "ox,oy,oz,dx,dy,dz";
    const std::string file = folder.write("rays.csv", head + names + "\n" + with_matrices);
    must("judge '" + file + "' --format f32 --sphere=" + solid +
         " -i sphere.unified@pbrt -i sphere.unified --rows -o '" + out + "'");
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
    must("sweep '" + worst + "' -i sphere.unified@pbrt -f f32 -o '" + out + "/w'");
    double most = 0;
    for (const auto& row : read_csv(folder / "out/w/worst/cases.csv"))
        most = std::max(most, number_in(row.at("lost_bits_max")));
    CHECK(most == number_in(rows[0].at("lost_bits_max")));
    // Given once, with the solid: the same again.
    must("judge '" + folder.write("once.csv", head + "\n" + without) + "' --format f32 --sphere=" + solid + "@" +
         matrix.substr(1) + " -i sphere.unified@pbrt -o '" + out + "'");
    CHECK(read_csv(folder / "out/once/summary.csv")[0].at("lost_bits_p99") == rows[0].at("lost_bits_p99"));
    // A singular one is refused with its line.
    const std::string ray = "0,0,-5,0,0,1";
    const std::string flat = folder.write(
        "flat.csv", head + names + "\n" + ray + ",1,0,0,0,0,1,0,0,0,0,1,0\n" + ray + ",1,2,3,0,2,4,6,0,0,0,1,0\n");
    const auto refused = run("judge '" + flat + "' --sphere 0,0,0,1 -i sphere.unified -o '" + out + "/f'");
    CHECK(refused.code == 2);
    CHECK(has(refused.err, "flat.csv:3:"));
    CHECK(has(refused.err, "singular"));
    const std::string part = folder.write("part.csv", head + ",M00,M01\n" + ray + ",1,0\n");
    CHECK(has(run("judge '" + part + "' --sphere 0,0,0,1 -i sphere.unified -o '" + out + "/f'").err,
              "a matrix has no m02"));
    CHECK(has(run("judge '" + file + "' --sphere 0,0,0,1 --sphere 0,0,3,1 -i sphere.unified -o '" + out + "/f'").err,
              "one solid is to be given"));
}

TEST_CASE("trade has the price of a space on a scene, and says why it has none at a solid under no matrix") {
    const Scratch folder;
    const std::string out = " -o '" + (folder / "out").string() + "'";
    must("trade --scene instance-far.sphere --size 8x8 -i 'sphere.unified@*' -f f32 --quick" + out);
    const auto rows = read_csv(folder / "out/instance-far.sphere/pareto.csv");
    CHECK(rows.size() == intersect::space::spaces().size());
    CHECK(has(run("trade --shape sphere -i sphere.unified@plain -f f32 --quick" + out).err, "under no matrix"));
}

TEST_CASE("a mesh under a matrix has its outcomes") {
    const Scratch folder;
    const std::string out = (folder / "out").string();
    must("map instance-mesh -i triangle.undivided@plain -i triangle.undivided@relative -f f32 --size 64x64 -o '" + out +
         "'");
    const auto rows = read_csv(folder / "out/instance-mesh/summary.csv");
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].count("crack") == 1);
    CHECK(number_in(rows[0].at("lost_bits_p50")) > 8);
    CHECK(number_in(rows[1].at("lost_bits_p50")) < 3);
}

}  // namespace test_cli_spaces
