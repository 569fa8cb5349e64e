// `lostbits mend` and `lostbits choose --mend` from the outside.
#include <utility>

#include "catch.hpp"
#include "counts.hpp"
#include "program.hpp"

namespace test_mend {

using namespace lostbits::test;

namespace {

const std::string far_rays =
    "'" LOSTBITS_DATA_DIR "/dumps/far-sphere.csv' --answer-format f32 --sphere 0,0,0,1 -i sphere.schoolbook --bits 16";

}  // namespace

TEST_CASE("mend reads files of rays, and says how many bits the form keeps on all of them", "[mend]") {
    const Scratch scratch;
    const auto r = must("mend " + far_rays + " -o out --emit far.hpp", scratch.path());
    CHECK(has(r.out, "far-sphere: 16 correct bits of every hit, no wrong decision"));
    CHECK(has(r.out, "185 of 1536 rays decided wrongly"));
    CHECK(has(r.out, "On all 1536 rays of the file: "));
    CHECK_FALSE(has(r.out, "other pixels"));
    CHECK(has(contents(scratch / "far.hpp"), "on every ray kept of far-sphere"));
    const auto rows = read_csv(scratch / "out" / "far-sphere" / "mend.csv");
    REQUIRE(rows.size() > 10);
    CHECK(rows.front().at("wrong") == "185");
    CHECK(rows.front().at("apart_wrong") == "185");
    int rewritten = 0;
    for (const auto& row : rows) {
        if (row.at("kind") != "wider" && row.at("kind") != "rewritten") continue;
        INFO(row.at("kind"));
        CHECK(row.at("meets") == "1");
        CHECK(row.at("apart_wrong") == "0");
        ++rewritten;
    }
    CHECK(rewritten > 1);
}

TEST_CASE("the page of a mended form has its sentences, its changed lines and the CSV's numbers", "[mend]") {
    const Scratch scratch;
    const auto r = must("mend box-slabs --size 10x10 -i box.baseline --bits 20 -o out", scratch.path());
    const auto folder = scratch / "out" / "box-slabs";
    CHECK(has(r.out, "out/box-slabs/index.html\n"));
    const std::string page = contents(folder / "index.html");
    const auto at = page.find("<section id=\"mend\">");
    REQUIRE(at != std::string::npos);
    const std::string part = page.substr(at, page.find("</section>", at) - at);
    const auto rows = read_csv(folder / "mend.csv");
    REQUIRE(rows.size() > 3);
    std::vector<std::string> expected;
    bool catalogue = false;
    for (const auto& row : rows) {
        if (row.at("kind") == "catalogue") {
            // The most accurate form comes first; if it is the form itself, it is already listed.
            if (std::exchange(catalogue, true) || row.at("form") == "box.baseline") continue;
        } else {
            expected.insert(expected.end(), {row.at("operations"), row.at("wider_operations")});
        }
        for (const char* column : {"kept_bits", "wrong", "apart_kept_bits", "apart_wrong"})
            if (!row.at(column).empty()) expected.push_back(row.at(column));
    }
    std::vector<std::string> shown;
    const std::string value = "<data value=\"";
    for (auto next = part.find(value); next != std::string::npos; next = part.find(value, next + 1))
        shown.push_back(part.substr(next + value.size(), part.find('"', next + value.size()) - next - value.size()));
    CHECK(expected.size() > 12);
    CHECK(shown == expected);
    CHECK(has(part, "<li>t1, t2 in double: "));
    CHECK(has(part, " no wrong decision instead of " + rows.front().at("wrong") + "<"));
    CHECK(has(part, "<del>    - const T t1_2 = named(&quot;t1&quot;, "));
    CHECK(has(part, "<ins>    + const W t1_2 = named(&quot;t1&quot;, "));
    CHECK_FALSE(has(part, "named(\""));
    CHECK(has(part, "distance: holds up to "));
    CHECK(has(part, "other pixels, which the search did not use"));
    CHECK(has(part, "<figure class=\"chart plotted\""));
    CHECK_FALSE(has(part, "ns a ray"));
    CHECK(has(page, "lostbits mend box-slabs "));
    if (!is_long()) return;  // compiling takes half a minute
    const std::string scene = "rtg-fig-7-3-4100-oblique";
    must("mend " + scene + " --size 48x48 -i sphere.half_b --bits 16 --price -o priced", scratch.path());
    const std::string timed_page = contents(scratch / "priced" / scene / "index.html");
    CHECK(has(timed_page, "Another run measures other times"));
    CHECK(has(timed_page, " ns a ray</li>"));
    int timed = 0;
    for (const auto& row : read_csv(scratch / "priced" / scene / "mend.csv")) {
        if (row.at("time_ns").empty() || (row.at("kind") == "catalogue" && row.at("front") == "0")) continue;
        INFO(row.at("form"));
        CHECK(has(timed_page, "<data value=\"" + row.at("time_ns") + "\">"));
        CHECK(has(timed_page, "<data value=\"" + row.at("single_time_ns") + "\">"));
        ++timed;
    }
    CHECK(timed > 2);
}

TEST_CASE("a mended form is written as a function of GLSL with the names of the source", "[mend]") {
    const Scratch scratch;
    const std::string words = "mend rtg-fig-7-3-4100-oblique --size 24x21 -i sphere.half_b --bits 16";
    must(words + " --emit halved.glsl", scratch.path());
    const std::string text = contents(scratch / "halved.glsl");
    CHECK(has(text, "bool halved(vec3 o, vec3 d, vec3 centre, float radius, out float first) {"));
    CHECK(has(text, "// lostbits: direction=any touching=hit at_origin=hit inside=usual roots=first"));
    CHECK(has(text, "precise float o_minus_centre_x = o.x - centre.x;"));
    CHECK(has(text, "Made by lostbits mend rtg-fig-7-3-4100-oblique -i sphere.half_b"));
}

TEST_CASE("a file name that is a keyword of the language is changed", "[mend]") {
    const Scratch scratch;
    const std::string words = "mend rtg-fig-7-3-4100-oblique --size 24x21 -i sphere.half_b --bits 16 --emit ";
    for (const auto& [file, name] :
         std::initializer_list<std::pair<std::string, std::string>>{{"NULL.hpp", "struct NULL_ {"},
                                                                    {"sphere.hpp", "struct Sphere_ {"},
                                                                    {"far_one.hpp", "struct FarOne {"},
                                                                    {"main.glsl", "bool main_("},
                                                                    {"gl_x.glsl", "bool form_gl_x("},
                                                                    {"float.glsl", "bool float_("},
                                                                    {"a__b.glsl", "bool a_b("}}) {
        must(words + file, scratch.path());
        INFO(file);
        CHECK(has(contents(scratch / file), name));
    }
}

TEST_CASE("with a transform a mended form is a function that takes the matrix, and its cost is measured", "[mend]") {
    const Scratch scratch;
    const std::string words = "mend instance-far.sphere --size 24x24 -i sphere.unified@plain --bits 18 ";
    const auto r = must(words + "--emit placed.hpp -o out" + (is_long() ? " --price" : ""), scratch.path());
    const std::string text = contents(scratch / "placed.hpp");
    CHECK(has(text, "const Sphere<T>& sphere, const std::array<T, 12>& matrix) {"));
    CHECK(has(text, "// The matrix maps from the primitive to the world, row by row.\n"));
    CHECK(has(text, "M03"));
    CHECK_FALSE(has(text, "sphere.M"));
    if (!is_long()) return;  // compiling takes half a minute
    CHECK(has(r.out, "Compiled, compared with their tapes to the bit on all rays"));
    int mended = 0, beside = 0;
    for (const auto& row : read_csv(scratch / "out" / "instance-far.sphere" / "mend.csv")) {
        INFO(row.at("kind") << " " << row.at("form"));
        if (row.at("kind") == "all_wider") continue;
        CHECK_FALSE(row.at("time_ns").empty());
        CHECK(number_in(row.at("single_time_ns")) > 0);
        (row.at("kind") == "catalogue" ? beside : mended) += 1;
    }
    CHECK(mended > 1);
    CHECK(beside > 10);
}

TEST_CASE("choose offers the mended form, compiled and timed with the others, or says why not", "[mend]") {
    const Scratch scratch;
    const std::string scene = "rtg-fig-7-3-4100-oblique", rest = " -f f32 --bits 16 --at max --mend -o out",
                      none = "choose " + scene + " --size 24x21 --quick -i sphere.half_b" + rest;
    const auto failed = run(none + " --compiler no-such-compiler", scratch.path());
    CHECK(failed.code == 3);
    CHECK(has(failed.err, "no-such-compiler"));
    CHECK_FALSE(fs::exists(scratch / "out" / scene / "choose.csv"));
    if (!is_long()) return;  // compiling takes half a minute
    const auto r =
        must("choose " + scene + " --size 48x48 --quick -i sphere.half_b,sphere.hearn_baker" + rest, scratch.path());
    CHECK(has(r.out, "mended.sphere_half_b_1 is sphere.half_b, "));
    CHECK(has(r.out, "On rays that the search did not use: "));
    int mended = 0;
    for (const auto& row : read_csv(scratch / "out" / scene / "choose.csv")) {
        const std::string form = row.at("form");
        INFO(form);
        CHECK(row.at("mended").empty() == !form.starts_with("mended."));
        if (row.at("mended").empty()) continue;
        ++mended;
        CHECK(row.at("meets") == "1");
        CHECK_FALSE(row.at("time_ns").empty());
        const auto file = scratch / "out" / scene / (form.substr(form.find('.') + 1) + ".hpp");
        CHECK(has(contents(file), "// sphere.half_b, "));
    }
    CHECK(mended > 1);
}

}  // namespace test_mend
