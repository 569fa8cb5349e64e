// `lostbits choose` from the outside. Times are not asserted.
#include <algorithm>

#include "catch.hpp"
#include "program.hpp"

namespace test_choose {

using namespace lostbits::test;

namespace {

Outcome choose(const std::string& words, const Scratch& scratch) {
    return run("choose " + words + " --quick --size 32x32" + into(scratch, ""));
}

}  // namespace

TEST_CASE("choose says what meets a wish, and writes every form by price") {
    const Scratch scratch;
    const auto r = choose("rtg-fig-7-3-4100-oblique --bits 40 -i sphere.schoolbook -i sphere.unified", scratch);
    REQUIRE(r.code == 0);
    CHECK(has(r.out, "The cheapest is sphere.unified in f64"));
    CHECK(has(r.out, "It holds"));
    const auto folder = scratch / "rtg-fig-7-3-4100-oblique";
    const auto rows = read_csv(folder / "choose.csv");
    REQUIRE(rows.size() == 4);
    double before = 0;
    for (const auto& row : rows) {
        const double time = std::stod(row.at("time_ns"));
        CHECK(time >= before);
        before = time;
        const bool chosen = row.at("form") == "sphere.unified" && row.at("format") == "f64";
        CHECK(row.at("chosen") == (chosen ? "1" : "0"));
    }
    CHECK(read_csv(folder / "room.csv").size() == 3);  // parallel rays have no view to widen
    CHECK(fs::exists(folder / "front.png"));
}

TEST_CASE("choose takes a length for a wish") {
    const Scratch scratch;
    const std::string scene = "rtg-fig-7-3-4100-oblique", forms = " -i sphere.unified,sphere.schoolbook -f f32,f64";
    const auto r = choose(scene + " --tolerance 0.5mm --unit m --at max" + forms, scratch);
    REQUIRE(r.code == 0);
    CHECK(has(r.out, "every hit at most 0.0005 off, no wrong decision"));
    CHECK(has(r.out, " off, no wrong decision in 1024 rays"));
    for (const auto& row : read_csv(scratch.path() / scene / "choose.csv")) {
        const bool near = !row.at("distance_error").empty() && std::stod(row.at("distance_error")) <= 0.0005;
        CHECK(row.at("meets") == (near && row.at("wrong") == "0" ? "1" : "0"));
    }
    const auto none = choose(scene + " --tolerance 0" + forms, scratch);
    CHECK(none.code == 1);
    CHECK(has(none.out, "Nothing meets the wish. Nearest is"));
    CHECK(has(none.out, "What limits it"));
    const auto both = choose(scene + " --tolerance 1 --bits 40" + forms, scratch);
    CHECK(both.code == 0);
    CHECK(has(both.out, "40 correct bits of 99 of 100 hits and at most 1 off"));
}

TEST_CASE("choose says what each pixel requires, in emulated formats too, and draws it") {
    const Scratch scratch;
    const auto r = choose("near-benign --bits 30 -i sphere.unified -f f32,f64,p40", scratch);
    REQUIRE(r.code == 0);
    CHECK(has(r.out, "Pixel by pixel"));
    const auto folder = scratch / "near-benign";
    CHECK(fs::exists(folder / "requirement.png"));
    const auto rows = read_csv(folder / "requirement.csv");
    REQUIRE(rows.size() == 6);  // two rows with a time, three formats, and nothing
    int required = 0, of_formats = 0;
    for (const auto& row : rows) {
        const bool timed = !row.at("time_ns").empty();
        CHECK(timed == (row.at("form") == "sphere.unified"));
        (row.at("form") == "any" ? of_formats : required) += std::stoi(row.at("required"));
    }
    CHECK(required == 32 * 32);
    CHECK(of_formats == 32 * 32);
    const auto p40 = std::ranges::find_if(rows, [](const auto& row) { return row.at("format") == "p40"; });
    REQUIRE(p40 != rows.end());
    CHECK(std::stoi(p40->at("required")) > 100);  // the hits, which f32 cannot keep 30 bits of
    CHECK(read_csv(folder / "choose.csv").size() == 2);
}

TEST_CASE("choose ends with 1 where nothing meets the wish, and says what is in the way") {
    const Scratch scratch;
    const auto bits = choose("near-benign --bits 30 -f f32", scratch);
    CHECK(bits.code == 1);
    CHECK(has(bits.out, "Nothing meets the wish"));
    CHECK(has(bits.out, "f32 has 24 bits"));
    const auto decisions = choose("rtg-fig-7-3-4100-oblique --bits 1 -i sphere.schoolbook -f f32", scratch);
    CHECK(decisions.code == 1);
    CHECK(has(decisions.out, "its decisions"));
}

TEST_CASE("choose says so where nothing is hit, and does not blame the inputs") {
    const Scratch scratch;
    const auto away = choose("near-benign --set 'camera.look_at=[0,0,100]' --bits 12 -i sphere.unified", scratch);
    CHECK(away.code == 1);
    CHECK(has(away.out, "None of the rays truly hits anything"));
    CHECK_FALSE(has(away.out, "the inputs"));
    CHECK(read_csv(scratch / "near-benign" / "inputs.csv").empty());
}

TEST_CASE("a wish is said as it was typed") {
    const Scratch scratch;
    const auto r = choose("near-benign --bits 4 --at p99.99999 --wrong 0.5 -i sphere.unified -f f32", scratch);
    CHECK(has(r.out, "4 correct bits of 99.99999 of 100 hits, at most 50% of the rays decided wrongly\n"));
}

TEST_CASE("choose refuses what is no wish") {
    check_refused(Scratch(), "choose -o out",
                  {{"near-benign --bits nan", "--bits nan: is not a number from 0 to 53"},
                   {"near-benign --bits 60", "--bits 60: is not a number from 0 to 53"},
                   {"near-benign --bits 1 --wrong nan", "is not a number from 0 to 1"},
                   {"near-benign --bits 16 --at p", "--at p"},
                   {"near-benign --bits 16 --at p100", "--at p100"},
                   {"near-benign", "no wish is given; add --bits 16"},
                   {"near-benign --bits 8 -f fp16", "emulated"},
                   {"near-benign --bits 8 -i 'box.*'", "sphere.*", 4},
                   {"rtg-fig-7-4 --bits 8", "variants"}});
}

}  // namespace test_choose
