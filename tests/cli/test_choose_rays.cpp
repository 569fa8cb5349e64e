// `lostbits choose` for rays of files, from the outside. Times are not asserted.
#include <algorithm>

#include "catch.hpp"
#include "program.hpp"

namespace test_choose_rays {

using namespace lostbits::test;

namespace {

const std::string far_rays = "'" LOSTBITS_DATA_DIR
                             "/dumps/far-sphere.csv' --file-format f32 --sphere 0,0,0,1 --quick -i sphere.unified "
                             "-i sphere.schoolbook";

const std::string head = "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius\n";

}  // namespace

TEST_CASE("choose takes a file of rays, and says what its own answers are worth") {
    const Scratch scratch;
    const auto r = must("choose " + far_rays + " --bits 16" + into(scratch, ""));
    CHECK(has(r.out, "no wrong decision in 1536 rays"));
    CHECK(has(r.out, "The answers that were there, file.far-sphere in f32"));
    CHECK(has(r.out, "185 of 1536 rays decided wrongly"));
    CHECK(has(r.out, "they do not meet the wish"));
    CHECK(has(r.out, "the rays start"));
    CHECK_FALSE(has(r.out, "camera"));
    CHECK_FALSE(has(r.out, "next ray"));
    const auto rows = read_csv(scratch / "far-sphere" / "choose.csv");
    REQUIRE(rows.size() == 5);
    CHECK(rows.back().at("form") == "file.far-sphere");
    CHECK(rows.back().at("time_ns").empty());
    CHECK(rows.back().at("wrong") == "185");
    // The renderer that wrote the file has the operations of this form.
    const auto same = std::ranges::find_if(
        rows, [](const auto& row) { return row.at("form") == "sphere.schoolbook" && row.at("format") == "f32"; });
    REQUIRE(same != rows.end());
    CHECK(same->at("wrong") == "185");
    CHECK(same->at("kept_bits") == rows.back().at("kept_bits"));
    CHECK(read_csv(scratch / "far-sphere" / "room.csv").size() == 3);
    CHECK(fs::exists(scratch / "far-sphere" / "front.png"));
}

TEST_CASE("choose takes raw rays, a pipe and several files") {
    const Scratch scratch;
    const std::string rest =
        " --file-format f32 --sphere 0,0,0,1 --quick -i sphere.unified --bits 16" + into(scratch, "");
    const std::string raw = LOSTBITS_DATA_DIR "/dumps/far-sphere.f32";
    const auto by_columns = must("choose '" + raw + "' --columns ox:f32,oy,oz,dx,dy,dz,t,hit:u8" + rest);
    CHECK(has(by_columns.out, "in 1536 rays"));
    const std::string csv = LOSTBITS_DATA_DIR "/dumps/far-sphere.csv";
    const auto twice = must("choose '" + csv + "' '" + csv + "'" + rest);
    CHECK(has(twice.out, "in 3072 rays"));
    CHECK(has(twice.out, "370 of 3072 rays decided wrongly"));
    const auto piped = must("choose /dev/stdin --container csv" + rest, ".", "cat '" + csv + "' |");
    CHECK(has(piped.out, "in 1536 rays"));
}

TEST_CASE("where rays of a file are more exact than a format, its inputs stand in the way") {
    const Scratch scratch;
    std::string text = head;
    for (int i = 0; i < 20; ++i) text += "0,0,999990.5,0,0,1,0,0,1000000.03,1\n";
    scratch.write("near.csv", text);
    const auto r = run("choose near.csv --bits 16 -f f32 -i sphere.unified --quick -o .", scratch.path());
    CHECK(r.code == 1);
    CHECK(
        has(r.out, "What limits it: the inputs. Even exact arithmetic on them, rounded to binary32, keeps 8.1 bits."));
    CHECK(has(r.out, "the rounding of the centres: with these in binary64 (of 32 bits at least)"));
    const auto rows = read_csv(scratch / "near" / "inputs.csv");
    REQUIRE(rows.size() == 16);
    CHECK(rows.front().at("place") == "binary32");
    CHECK(rows.back().at("place") == "binary64");
    CHECK(std::stod(rows.front().at("exact_kept_bits")) < 9);
    CHECK(std::stod(rows.back().at("f64_kept_bits")) > 30);
}

TEST_CASE("choose refuses files that are none, and words for the other subject") {
    const Scratch scratch;
    const std::string ray = "0,0,0,0,0,1,0,0,5,1\n";
    const std::pair<const char*, std::string> files[] = {{"empty.csv", ""},
                                                         {"no-rays.csv", head},
                                                         {"nan.csv", head + ray + "nan,0,0,0,0,1,0,0,5,1\n"},
                                                         {"zero.csv", head + "0,0,0,0,0,0,0,0,5,1\n"},
                                                         {"columns.csv", "a,b,c\n1,2,3\n"},
                                                         {"solid.csv", "ox,oy,oz,dx,dy,dz\n0,0,0,0,0,1\n"},
                                                         {"a.csv", head + ray}};
    for (const auto& [name, text] : files) scratch.write(name, text);
    check_refused(scratch, "choose --bits 16 --quick -o out",
                  {{"empty.csv", "empty.csv"},
                   {"no-rays.csv", "has no rays"},
                   {"nan.csv", "nan.csv:3:1"},
                   {"zero.csv", "zero.csv:2"},
                   {"columns.csv", "columns.csv:1"},
                   {"solid.csv", "no column has a solid"},
                   {"none.csv", "none.csv"},
                   {"a.csv --size 4x4", "--size: is about a scene"},
                   {"a.csv near-benign", "near-benign"},
                   {"near-benign --sphere 0,0,0,1", "--sphere: is about files of rays"},
                   {"near-benign sphereflake-near", "a choice is for one scene"},
                   {"near-benign --file-format f32", "--file-format: is about files"},
                   {"a.csv --file-format f23", "unknown format"},
                   {"a.csv -i 'box.*'", "sphere.*", 4}});
}

}  // namespace test_choose_rays
