// `lostbits choose` from the outside, for a scene and for files of rays. No time is compared.
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

TEST_CASE("choose reports what meets a requirement and lists every form by cost") {
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

TEST_CASE("choose accepts a length as a requirement") {
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
    CHECK(has(none.out, "Nothing meets the requirement. The nearest is"));
    CHECK(has(none.out, "What limits it"));
    const auto both = choose(scene + " --tolerance 1 --bits 40" + forms, scratch);
    CHECK(both.code == 0);
    CHECK(has(both.out, "40 correct bits of 99 of 100 hits and at most 1 off"));
}

TEST_CASE("choose reports and draws what each pixel requires, in emulated formats too") {
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

TEST_CASE("choose exits with 1 where nothing meets the requirement, and says why") {
    const Scratch scratch;
    const auto bits = choose("near-benign --bits 30 -f f32", scratch);
    CHECK(bits.code == 1);
    CHECK(has(bits.out, "Nothing meets the requirement"));
    CHECK(has(bits.out, "f32 has 24 bits"));
    const auto decisions = choose("rtg-fig-7-3-4100-oblique --bits 1 -i sphere.schoolbook -f f32", scratch);
    CHECK(decisions.code == 1);
    CHECK(has(decisions.out, "its decisions"));
}

TEST_CASE("choose reports that nothing is hit and does not blame the inputs") {
    const Scratch scratch;
    const auto away = choose("near-benign --set 'camera.look_at=[0,0,100]' --bits 12 -i sphere.unified", scratch);
    CHECK(away.code == 1);
    CHECK(has(away.out, "None of the rays truly hits anything"));
    CHECK_FALSE(has(away.out, "the inputs"));
    CHECK(read_csv(scratch / "near-benign" / "inputs.csv").empty());
}

TEST_CASE("a requirement is printed as it was typed") {
    const Scratch scratch;
    const auto r = choose("near-benign --bits 4 --at p99.99999 --wrong 0.5 -i sphere.unified -f f32", scratch);
    CHECK(has(r.out, "4 correct bits of 99.99999 of 100 hits, at most 50% of the rays decided wrongly\n"));
    CHECK(choose("spheres-on-floor --bits 4 -i sphere.press -i box.signs", scratch).code == 0);  // a set
}

namespace {

const std::string far_rays = "'" LOSTBITS_DATA_DIR
                             "/dumps/far-sphere.csv' --answer-format f32 --sphere 0,0,0,1 --quick -i sphere.unified "
                             "-i sphere.schoolbook";

const std::string head = "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius\n";

}  // namespace

TEST_CASE("choose takes a file of rays and reports the accuracy of its answers") {
    const Scratch scratch;
    const auto r = must("choose " + far_rays + " --bits 16" + into(scratch, ""));
    CHECK(has(r.out, "the rays start"));  // docs/choose.md has its other lines
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
        " --answer-format f32 --sphere 0,0,0,1 --quick -i sphere.unified --bits 16" + into(scratch, "");
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

TEST_CASE("choose blames the inputs where rays of a file are more exact than the format") {
    const Scratch scratch;
    std::string text = head;
    for (int i = 0; i < 20; ++i) text += "0,0,999990.5,0,0,1,0,0,1000000.03,1\n";
    scratch.write("near.csv", text);
    const auto r = run("choose near.csv --bits 16 -f f32 -i sphere.unified --quick -o .", scratch.path());
    CHECK(r.code == 1);
    CHECK(has(r.out,
              "What limits it: the inputs. Even exact arithmetic on them, rounded to binary32, keeps only 8.0 bits."));
    CHECK(has(r.out, "lost by rounding the centres. With these in binary64 (at least 32 bits are needed)"));
    const auto rows = read_csv(scratch / "near" / "inputs.csv");
    REQUIRE(rows.size() == 16);
    CHECK(rows.front().at("place") == "binary32");
    CHECK(rows.back().at("place") == "binary64");
    CHECK(std::stod(rows.front().at("exact_kept_bits")) < 9);
    CHECK(std::stod(rows.back().at("f64_kept_bits")) > 30);
}

}  // namespace test_choose
