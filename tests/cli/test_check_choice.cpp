// Claims about what is chosen for a scene: of the profile `timing`, which fails nothing.
#include <sstream>
#include <tuple>

#include "catch.hpp"
#include "program.hpp"

namespace test_check_choice {

using namespace lostbits::test;

namespace {

const std::string scene = R"(schema = "lostbits-scene/1"
title = "A sphere 4100 away"
source = "-"
size = [24, 24]
[camera]
kind = "orthographic"
width = 2.5
eye = [0.1, 0.2, 0.3]
look_at = [1095.9, 2191.7, -3287.2]
up = [0, 1, 0]
[[sphere]]
centre = [1095.9, 2191.7, -3287.2]
radius = 1
)";

const std::string head = "profile = \"timing\"\n", choice = "choose = \"far.toml\"\n",
                  unified = choice + tested("sphere.unified"), schoolbook = choice + tested("sphere.schoolbook"),
                  double_inside = choice + tested("sphere.double_inside") + "bits = 24\nformats = [\"f32\"]\n";

}  // namespace

TEST_CASE("a claim may rest on who meets a wish, and on times over times") {
    const Scratch scratch;
    scratch.write("far.toml", scene);
    const std::vector<std::tuple<std::string, std::string, double>> rows{
        {unified + "bits = 18\n", "meets", 1},
        {unified + "bits = 23\n", "meets", 0},
        {schoolbook + "bits = 1\n", "meets", 0},  // it decides rays wrongly
        {schoolbook + "bits = 1\nwrong = 1\n", "meets", 1},
        {unified + "bits = 53\nformats = [\"f32\"]\n", "others_that_meet", 0},
        // sphere.double_inside alone is right to half an ulp. The claim's own form does not count.
        {unified + "bits = 24\nformats = [\"f32\"]\n", "others_that_meet", 1},
        {double_inside, "others_that_meet", 0},
        {double_inside, "chosen", 1},
        {unified + "bits = 24\n", "chosen", 0},
        {unified + "over = { format = \"f64\" }\n", "time_ratio", 1},
        {unified + "over = {}\n", "time_ratio", 1}};  // the same over itself: about 1
    std::vector<ClaimText> claims;
    for (const auto& [given, metric, right] : rows)
        claims.push_back({"c" + std::to_string(claims.size()), given, metric_in(metric, "[-1, 1000]")});
    scratch.write("c.toml", claims_of(claims, head));
    std::istringstream said(must("check c.toml --profile timing --measure", scratch.path()).out);
    for (const auto& [given, metric, right] : rows) {
        INFO(given << metric);
        std::string id, equals;
        double measured = -1;
        said >> id >> equals >> measured;
        if (metric == "time_ratio") CHECK(measured > 0.01);
        else CHECK(measured == right);
    }
}

TEST_CASE("a claim about a choice fails nothing, and wrong words are refused with their place") {
    const Scratch scratch;
    scratch.write("far.toml", scene);
    scratch.write("d.toml", claims_of({{"d", unified + "bits = 23\n", metric_in("meets", "[1, 1]")}}, head));
    CHECK(has(must("check d.toml --profile timing", scratch.path()).out, "differs"));
    const std::string eighteen = unified + "bits = 18\n", meets = metric_in("meets"), ratio = metric_in("time_ratio"),
                      chosen = metric_in("chosen");
    check_refused_claims(scratch,
                         {{unified, meets, "needs a wish"},
                          {unified + "bits = 54\n", meets, "0 to 53"},
                          {eighteen + "wrong = 2\n", meets, "share"},
                          {eighteen + "at = \"p100\"\n", meets, "p99.9"},
                          {eighteen + "at = \"p99\"\nover = { format = \"f64\" }\n", ratio, "one of the two"},
                          {eighteen, ratio, "others_that_meet"},
                          {eighteen, metric_in("meet"), "unknown metric"},
                          {unified + "over = { format = \"f64\" }\n", chosen, "time_ratio"},
                          {unified + "over = { form = \"sphere.unifed\" }\n", ratio, "sphere.unified"},
                          {unified + "over = { forms = \"sphere.press\" }\n", ratio, "forms"},
                          {unified + "over = { format = \"fp16\" }\n", ratio, "emulated"},
                          {eighteen + "formats = [\"f31\"]\n", chosen, "f31"},
                          {eighteen + "formats = [\"bf16\"]\n", chosen, "emulated"},
                          {eighteen + "bit = 3\n", meets, "bits"},
                          {choice + tested("box.signs") + "bits = 18\n", meets, "other solids"}},
                         head, " --profile timing");
    check_refused_claims(scratch, {{eighteen, meets, "profile = \"timing\""}}, "profile = \"results\"\n");
}

}  // namespace test_check_choice
