// Claims about what is chosen for a scene: of the profile `timing`, which fails nothing.
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

/// A file of one claim: what is given beside the scene, and what is expected.
std::string claims(const std::string& given, const std::string& expect, const std::string& profile = "timing") {
    return "schema = \"lostbits-claims/1\"\nprofile = \"" + profile +
           "\"\n[[claim]]\nid = \"c\"\nstatement = \"s\"\nsource = \"-\"\nverdict = \"holds\"\n[claim.given]\n"
           "choose = \"far.toml\"\n" +
           given + "[claim.expect]\n" + expect;
}

const std::string unified = "form = \"sphere.unified\"\nformat = \"f32\"\n",
                  schoolbook = "form = \"sphere.schoolbook\"\nformat = \"f32\"\n";

std::string metric(const std::string& name, const char* in) { return "metric = \"" + name + "\"\nin = " + in + "\n"; }

Outcome check(const Scratch& scratch, const std::string& text, const std::string& how = " --profile timing") {
    static_cast<void>(scratch.write("far.toml", scene));
    return run("check '" + scratch.write("c.toml", text) + "'" + how);
}

}  // namespace

TEST_CASE("a claim may rest on who meets a wish, and on times over times") {
    const Scratch scratch;
    const auto measured = [&](const std::string& given, const std::string& name) {
        const auto r = check(scratch, claims(given, metric(name, "[-1, 1000]")), " --profile timing --measure");
        REQUIRE(r.code == 0);
        REQUIRE(r.out.starts_with("c = "));
        return std::stod(r.out.substr(4));
    };
    CHECK(measured(unified + "bits = 18\n", "meets") == 1);
    CHECK(measured(unified + "bits = 23\n", "meets") == 0);
    CHECK(measured(schoolbook + "bits = 1\n", "meets") == 0);  // it decides rays wrongly
    CHECK(measured(schoolbook + "bits = 1\nwrong = 1\n", "meets") == 1);
    CHECK(measured(unified + "bits = 53\nformats = [\"f32\"]\n", "others_that_meet") == 0);
    // sphere.double_inside alone is right to half an ulp. The claim's own form does not count.
    const double others = measured(unified + "bits = 24\nformats = [\"f32\"]\n", "others_that_meet");
    CHECK(others == 1);
    CHECK(measured("form = \"sphere.double_inside\"\nformat = \"f32\"\nbits = 24\nformats = [\"f32\"]\n",
                   "others_that_meet") == 0);
    CHECK(measured("form = \"sphere.double_inside\"\nformat = \"f32\"\nbits = 24\nformats = [\"f32\"]\n", "chosen") ==
          1);
    CHECK(measured(unified + "bits = 24\n", "chosen") == 0);
    const double ratio = measured(unified + "over = { format = \"f64\" }\n", "time_ratio");
    CHECK(ratio > 0);
    CHECK(measured(unified + "over = {}\n", "time_ratio") > 0.2);  // the same over itself: about 1
}

TEST_CASE("a claim about a choice fails nothing, and wrong words are refused with their place") {
    const Scratch scratch;
    const auto differs = check(scratch, claims(unified + "bits = 23\n", metric("meets", "[1, 1]")));
    CHECK(differs.code == 0);
    CHECK(has(differs.out, "differs"));
    struct Case {
        std::string given, metric;
        const char* says;
    };
    const Case cases[] = {
        {unified, "meets", "needs a wish"},
        {unified + "bits = 54\n", "meets", "0 to 53"},
        {unified + "bits = 18\nwrong = 2\n", "meets", "share"},
        {unified + "bits = 18\nat = \"p100\"\n", "meets", "p99.9"},
        {unified + "bits = 18\nat = \"p99\"\nover = { format = \"f64\" }\n", "time_ratio", "one of the two"},
        {unified + "bits = 18\n", "time_ratio", "others_that_meet"},
        {unified + "bits = 18\n", "meet", "unknown metric"},
        {unified + "over = { format = \"f64\" }\n", "chosen", "time_ratio"},
        {unified + "over = { form = \"sphere.unifed\" }\n", "time_ratio", "sphere.unified"},
        {unified + "over = { forms = \"sphere.press\" }\n", "time_ratio", "forms"},
        {unified + "over = { format = \"fp16\" }\n", "time_ratio", "emulated"},
        {unified + "bits = 18\nformats = [\"f31\"]\n", "chosen", "f31"},
        {unified + "bits = 18\nformats = [\"bf16\"]\n", "chosen", "emulated"},
        {unified + "bits = 18\nbit = 3\n", "meets", "bits"},
        {"form = \"box.signs\"\nformat = \"f32\"\nbits = 18\n", "meets", "other solids"},
    };
    for (const Case& c : cases) {
        INFO(c.given << c.metric);
        const auto r = check(scratch, claims(c.given, metric(c.metric, "[0, 1]")));
        CHECK(r.code == 2);
        CHECK(has(r.err, "c.toml:"));
        CHECK(has(r.err, c.says));
    }
    const auto elsewhere = check(scratch, claims(unified + "bits = 18\n", metric("meets", "[0, 1]"), "results"), "");
    CHECK(elsewhere.code == 2);
    CHECK(has(elsewhere.err, "profile = \"timing\""));
}

}  // namespace test_check_choice
