// Solids under matrices from the command line: which spaces there are, what is measured through them, and what is said
// of mistakes.
#include <cmath>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "intersect/space/space.hpp"
#include "program.hpp"

namespace test_cli_spaces {

using namespace lostbits;
using test::has;
using test::number_in;
using test::read_csv;
using test::run;
using test::Scratch;

TEST_CASE("list spaces has every way with its source") {
    const auto listed = nlohmann::json::parse(run("list spaces --json").out);
    REQUIRE(listed.size() == intersect::space::spaces().size());
    for (std::size_t k = 0; k < listed.size(); ++k) {
        CHECK(listed[k]["name"] == std::string(intersect::space::spaces()[k].info->name));
        CHECK_FALSE(listed[k]["source"].get<std::string>().empty());
    }
}

TEST_CASE("twelve kilometres out a map tells what each space loses, and which step loses it") {
    const Scratch folder;
    const std::string out = (folder.path() / "out").string();
    const auto r =
        run("map instance-far.sphere -i 'sphere.unified@*' -f f32 --size 24x24 --metric step --metric "
            "step:origin --metric step:form -o '" +
            out + "'");
    REQUIRE(r.code == 0);
    const auto rows = read_csv(folder.path() / "out/instance-far.sphere/summary.csv");
    REQUIRE(rows.size() == intersect::space::spaces().size());
    for (const auto& row : rows) {
        CAPTURE(row.at("form"));
        const bool difference_first =
            has("@rigid @relative @adjugate @in_double @two_words", row.at("form").substr(row.at("form").find('@')));
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
    const std::string out = (folder.path() / "out").string();
    REQUIRE(run("map instance-far.box -i box.signs -f f32 --size 8x8 -o '" + out + "/one'").code == 0);
    CHECK(read_csv(folder.path() / "out/one/instance-far.box/summary.csv")[0].at("form") == "box.signs@plain");
    const auto crowd =
        run("map instance-crowd -i sphere.unified@relative -i box.signs@pbrt -i capsule.half_b -i "
            "cone.moment@embree -f f32 --size 12x12 -o '" +
            out + "/many'");
    REQUIRE(crowd.code == 0);
    CHECK(read_csv(folder.path() / "out/many/instance-crowd/summary.csv")[0].at("form") ==
          "sphere.unified@relative+box.signs@pbrt+capsule.half_b@plain+cone.moment@embree");
}

TEST_CASE("explain goes through the space, and a matrix can be given with the numbers of a solid") {
    const auto pixel = run("explain instance-far.sphere --pixel 96,96 -i sphere.unified -f f32 --json");
    REQUIRE(pixel.code == 0);
    const auto x = nlohmann::ordered_json::parse(pixel.out);
    CHECK(x["form"] == "sphere.unified@plain");
    std::string solid, ray, matrix;
    for (const auto& [name, number] : x["inputs"].items()) {
        if (name == "limit") continue;
        std::string& to = name[0] == 'M' ? matrix : name[1] == '.' ? ray : solid;
        to += (to.empty() ? "" : ",") + number["hex"].get<std::string>();
    }
    const auto own =
        run("explain --sphere=" + solid + "@" + matrix + " --ray=" + ray + " -i sphere.unified -f f32 --json");
    REQUIRE(own.code == 0);
    const auto y = nlohmann::ordered_json::parse(own.out);
    CHECK(x["t"] == y["t"]);
    CHECK(x["truth"] == y["truth"]);
    CHECK(has(run("explain instance-far.sphere --pixel 96,96 -i sphere.unified -f f32").out, "@relative"));
}

TEST_CASE("what is wrong with a matrix or a space is said, and nothing is written") {
    const Scratch folder;
    const std::string out = " -o '" + (folder.path() / "out").string() + "'";
    const std::pair<const char*, const char*> mistakes[] = {
        {"-i sphere.unified@plan", "unknown space; did you mean \"plain\"?"},
        {"-i sphere.unified@", "stands beside the @"},
        {"--set 'sphere[0].transform.scale=[1,0,1]'", "flattens the solid"},
        {"--set 'sphere[0].transform.matrix=[1,2,3,0,2,4,6,0,0,0,1,0]'", "is singular: it flattens"},
        {"--set 'sphere[0].transform.scale=[1,1,\"1e-60\"]'", "is singular in binary32"},
        {"--set 'sphere[0].transform.rotat=1'", "did you mean \"rotate\"?"},
        {"--set 'sphere[0].transform.stored=\"back\"'", "forward"},
        {"-i sphere.unified --metric step:orign", "did you mean \"origin\"?"},
        {"-i 'sdf.*'", "no selected form handles"},
    };
    for (const auto& [words, message] : mistakes) {
        const auto r = run(std::string("map instance-far.sphere --size 4x4 -f f32 ") + words + out);
        CAPTURE(words, r.err);
        CHECK((r.code == 2 || r.code == 4));
        CHECK(has(r.err, message));
    }
    CHECK_FALSE(std::filesystem::exists(folder.path() / "out"));
    for (const char* command : {"offsets instance-far.sphere", "consistency instance-far.sphere",
                                "render instance-far.sphere", "mend instance-far.sphere -i sphere.unified --bits 16"}) {
        const auto r = run(command + out);
        CAPTURE(command, r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err, "under matrices"));
    }
    CHECK(has(run("explain --sphere=0,0,0,1@1,2,3 --ray=0,0,9,0,0,-1 -i sphere.unified").err, "is not a matrix"));
    CHECK(has(run("explain --sphere=0,0,0,1@1,0,0,0,0,1,0,0,0,0,0,0 --ray=0,0,9,0,0,-1 -i sphere.unified").err,
              "singular"));
    CHECK(
        has(run("explain --sphere=0,0,0,1 --ray=0,0,9,0,0,-1 -i sphere.unified@plain").err, "no solid under a matrix"));
    CHECK(has(run("map instance-crowd -f f32 -i "
                  "'sphere.unified+box.signs@plain+capsule.half_b@plain+cone.moment@plain'" +
                  out)
                  .err,
              "after each form, or after none"));
    CHECK(has(run("map rtg-fig-7-3-4100-oblique -i sphere.unified --size 4x4 --metric step" + out).err,
              "stands under a matrix"));
}

TEST_CASE("a mesh under a matrix has its outcomes") {
    const Scratch folder;
    const std::string out = (folder.path() / "out").string();
    REQUIRE(
        run("map instance-mesh -i triangle.undivided@plain -i triangle.undivided@relative -f f32 --size 64x64 -o '" +
            out + "'")
            .code == 0);
    const auto rows = read_csv(folder.path() / "out/instance-mesh/summary.csv");
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].count("crack") == 1);
    CHECK(number_in(rows[0].at("lost_bits_p50")) > 8);
    CHECK(number_in(rows[1].at("lost_bits_p50")) < 3);
}

}  // namespace test_cli_spaces
