// `lostbits judge`: files of rays from the outside, as a user has them.

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "catch.hpp"
#include "program.hpp"

namespace test_judge {

using namespace lostbits::test;

namespace {

const fs::path dumps = fs::path(LOSTBITS_DATA_DIR) / "dumps";
const std::string far_csv = "'" + (dumps / "far-sphere.csv").string() + "' --answer-format f32 --sphere 0,0,0,1";
const std::string far_raw =
    "'" + (dumps / "far-sphere.f32").string() + "' --columns ox:f32,oy,oz,dx,dy,dz,t,hit:u8 --sphere 0,0,0,1";
const std::string head = "ox,oy,oz,dx,dy,dz,hit,t\n";

}  // namespace

TEST_CASE("judge: the program in docs/judge.md writes the file that it judges") {
    const Scratch scratch;
    const std::string page = contents(fs::path(LOSTBITS_DATA_DIR).parent_path() / "docs" / "judge.md");
    const auto begin = page.find("```c\n") + 5;
    const std::string source = scratch.write("dump.c", page.substr(begin, page.find("```", begin) - begin));
    const std::string folder = scratch.path().string();
    REQUIRE(std::system(("cc -O1 -ffp-contract=off -o '" + folder + "/dump' '" + source + "' -lm && '" + folder +
                         "/dump' > '" + folder + "/made.csv'")
                            .c_str()) == 0);
    CHECK(contents(scratch / "made.csv") == contents(dumps / "far-sphere.csv"));
}

TEST_CASE("judge: a file gives the same numbers as text, as raw numbers and from a pipe") {
    const Scratch scratch;
    must("judge " + far_csv + into(scratch, "a"));
    must("judge " + far_raw + into(scratch, "b"));
    must("judge /dev/stdin --container csv --answer-format f32 --sphere 0,0,0,1" + into(scratch, "c"), ".",
         "cat '" + (dumps / "far-sphere.csv").string() + "' |");
    const auto a = read_csv(scratch / "a/far-sphere/summary.csv");
    const auto b = read_csv(scratch / "b/far-sphere/summary.csv");
    auto c = read_csv(scratch / "c/stdin/summary.csv");
    REQUIRE(a.size() == 1);
    CHECK(a == b);
    c.front()["form"] = "file.far-sphere";
    CHECK(a == c);
    CHECK(a.front().at("false_hit") == "177");
    CHECK(a.front().at("worst_explain").empty());  // a file has no formula to explain
}

TEST_CASE("judge: rays at a mesh of thousands of triangles use the tree, and every ray is judged") {
    const Scratch scratch;
    scratch.write("ball.toml",
                  "schema = \"lostbits-scene/1\"\ntitle = \"A ball\"\nsource = \"-\"\n"
                  "inputs = \"shared\"\nsize = [8, 8]\n"
                  "[camera]\nkind = \"orthographic\"\neye = [0, 0, 9]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\n"
                  "width = 2\n[[mesh]]\nmake = \"icosphere\"\nlevels = 5\n");
    // A vertex of every level, which six triangles own; the squares of the last direction underflow.
    scratch.write("rays.csv",
                  "ox,oy,oz,dx,dy,dz,hit,t\n0,0,9,0,0,-1,1,8\n3,0,9,0,0,-1,0,\n"
                  "0,0,9,0,0,1,1,3\n0,0,9,0,0,-1e-200,1,8e200\n");
    must("judge rays.csv --scene ball.toml -i triangle.filtered" + into(scratch), scratch.path());
    const auto rows = read_csv(scratch / "out/rays/summary.csv");
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].at("agree_hit") == "2");
    CHECK(rows[0].at("agree_miss") == "1");
    CHECK(rows[0].at("false_hit") == "1");
    CHECK(rows[1].at("agree_miss") == "2");
    CHECK(rows[1].at("false_miss") == "0");
}

TEST_CASE("judge: rays are grouped by a column of the file") {
    const Scratch scratch;
    const auto r = must("judge " + far_csv + " -i sphere.unified --by y --tolerance 0.05 --bits 14" + into(scratch));
    CHECK(has(r.out, "    y 31 "));
    CHECK(has(r.out, "too few      beyond"));
    const auto rows = read_csv(scratch / "out/far-sphere/summary.csv");
    REQUIRE(rows.size() == 2 * 33);
    for (const std::size_t form : {std::size_t{0}, std::size_t{33}}) {
        CHECK(rows[form].at("y").empty());
        for (const char* name : {"rays", "agree_hit", "false_hit", "false_miss", "tolerance_beyond", "tolerance_within",
                                 "enough_bits_too_few"}) {
            double sum = 0;
            for (std::size_t y = 0; y < 32; ++y) sum += std::stod(rows[form + 1 + y].at(name));
            INFO(name);
            CHECK(sum == std::stod(rows[form].at(name)));
        }
        for (std::size_t y = 0; y < 32; ++y) CHECK(rows[form + 1 + y].at("y") == std::to_string(y));  // 9 before 10
    }
    // The float's error in t counts as a length: t is about 1, and directions are 2000 long.
    CHECK(std::stod(rows[0].at("tolerance_beyond")) > 800);
    CHECK(std::stod(rows[33].at("tolerance_beyond")) == 0);
    CHECK(std::stod(rows[0].at("distance_error_max")) > std::stod(rows[33].at("distance_error_max")) * 100);
}

TEST_CASE("judge: a length has the declared unit, and a group is a column of the file") {
    const Scratch scratch;
    const auto beyond = [&](const std::string& words, const std::string& folder) {
        must("judge " + far_csv + " " + words + into(scratch, folder));
        return read_csv(scratch.path() / folder / "far-sphere/summary.csv").front().at("tolerance_beyond");
    };
    const std::string in_units = beyond("--tolerance 0.02", "a");
    CHECK(in_units == beyond("--tolerance 20mm --unit m", "b"));
    CHECK(in_units == beyond("--tolerance 2cm --unit m", "c"));
    CHECK(in_units != beyond("--tolerance 2cm --unit cm", "d"));
    const auto many = scratch.write("many.csv", [] {
        std::string rays = "ox,oy,oz,dx,dy,dz,t,id\n";
        for (int i = 0; i < 5000; ++i) rays += "0,0,-5,0,0,1,4," + std::to_string(i) + "\n";
        return rays;
    }());
    const auto r = run("judge '" + many + "' --sphere 0,0,0,1 --by id" + into(scratch));
    CHECK(r.code == 2);
    CHECK(has(r.err, "id has more than 4096 values"));
}

TEST_CASE("judge: rows of rays keep the columns of the file") {
    const Scratch scratch;
    must("judge " + far_csv + " --rows" + into(scratch));
    const auto rows = read_csv(scratch / "out/far-sphere/file.far-sphere.f32.csv");
    REQUIRE(rows.size() == 1536);
    CHECK(rows[100].at("x") == "4");
    CHECK(rows[100].at("y") == "2");
    CHECK(rows[100].at("ray") == "100");
    std::size_t false_hits = 0;
    for (const auto& row : rows) {
        false_hits += row.at("outcome") == "false_hit";
        if (row.at("outcome") == "agree_hit") {
            CHECK(std::stof(row.at("t")) == std::stof(row.at("answer")));
            CHECK_FALSE(row.at("truth_hex").empty());
        }
    }
    CHECK(false_hits == 177);
}

TEST_CASE("judge: the worst rays of a file become cases that its formula gets as wrong") {
    const Scratch scratch;
    must("judge " + far_csv + " --worst-rays 3" + into(scratch));
    const std::string cases = (scratch / "out/far-sphere/worst.toml").string();
    must("sweep '" + cases + "' -i sphere.schoolbook -f f32" + into(scratch, "again"));
    const auto rows = read_csv(scratch / "again/worst/cases.csv");
    CHECK(rows.size() == 9);  // three errors, three false misses, three false hits
    must("judge " + far_csv + " --worst-rays 0" + into(scratch));
    CHECK_FALSE(fs::exists(cases));
    std::size_t false_hits = 0;
    for (const auto& row : rows) {
        CHECK(row.at("verdict") != "right");
        false_hits += row.at("verdict") == "false_hit";
    }
    CHECK(false_hits == 3);
}

TEST_CASE("judge: rays without answers are answered by forms") {
    const Scratch scratch;
    const std::string file = scratch.write("rays.csv", "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius\n0,0,-5,0,0,2,0,0,0,1\n");
    must("judge '" + file + "' -i sphere.press -f f32 -f bf16 --metric culprit" + into(scratch));
    const auto rows = read_csv(scratch / "out/rays/summary.csv");
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].at("agree_hit") == "1");
    CHECK(has(rows[0].at("worst_explain"), "lostbits explain --sphere=0x0p+0,0x0p+0,0x0p+0,0x1p+0 --ray="));
}

TEST_CASE("judge: metrics of a formula are measured for forms and left out for the file's answers") {
    const Scratch scratch;
    const auto r = must("judge " + far_csv + " --metric culprit --metric model_error -i sphere.press" + into(scratch));
    CHECK(has(r.err, "file.far-sphere"));
    CHECK(has(r.err, "culprit"));
    const auto rows = read_csv(scratch / "out/far-sphere/summary.csv");
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].at("culprit").empty());
    CHECK_FALSE(rows[1].at("culprit").empty());
    CHECK(rows[0].at("model_error_max").empty());
    CHECK_FALSE(rows[1].at("model_error_max").empty());
}

TEST_CASE("judge: a file is compared with a form, and a wrong contract is reported") {
    const Scratch scratch;
    must("judge " + far_csv + " --against sphere.schoolbook" + into(scratch));
    const auto rows = read_csv(scratch / "out/far-sphere/summary.csv");
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].at("against_same_t") == "1309");  // the program of the page has the operations of that form
    CHECK(rows[0].at("against_other_t") == "0");
    std::string text = head;
    for (int i = 0; i < 100; ++i)
        text +=
            "0,0," + std::to_string(-5 - i) + ",0,0," + std::to_string(2 + i) + ",1," + std::to_string(4 + i) + "\n";
    const std::string file = scratch.write("rays.csv", text);
    const auto wrong = must("judge '" + file + "' --sphere 0,0,0,1" + into(scratch));
    CHECK(has(wrong.err, "--direction unit"));
    const auto right =
        run("judge '" + file + "' --sphere 0,0,0,1 --direction unit --answer-format f32" + into(scratch));
    CHECK(right.err.empty());
    CHECK(read_csv(scratch / "out/rays/summary.csv")[0].at("lost_bits_max") == "0");
}

TEST_CASE("judge: notes report rounded numbers, and answers that look like floats") {
    const Scratch scratch;
    std::string text = head;
    for (int i = 0; i < 20; ++i) text += "0,0,-5,0,0,1.00000000001,1,4\n";
    const std::string file = scratch.write("rays.csv", text);
    const auto r = must("judge '" + file + "' --sphere 0,0,0,1 --answer-format f32" + into(scratch));
    CHECK(has(r.err, "20 values are not representable in f32 and were rounded"));
    const auto wide = run("judge '" + file + "' --sphere 0,0,0,1" + into(scratch));
    CHECK(has(wide.err, "--answer-format f32"));
    CHECK(run("judge '" + file + "' --sphere 0,0,0,1 -q" + into(scratch)).err.empty());
}

TEST_CASE("judge: suspicions are reported in terms of files") {
    const Scratch scratch;
    const auto judged = [&](const std::string& rows, const std::string& options) {
        const std::string file = scratch.write("rays.csv", "ox,oy,oz,dx,dy,dz,hit,t\n" + rows);
        const auto r = must("judge '" + file + "' --answer-format f32 " + options + into(scratch));
        for (const char* word : {"unit_direction", "flags", "inside=", "hand over", "whole_line", "roots"})
            CHECK_FALSE(has(r.err, word));
        return r.err;
    };
    const auto rows = [](const auto& z, const auto& t) {
        std::string text;
        for (int i = 0; i < 40; ++i) text += "0,0," + std::to_string(z(i)) + ",0,0,1,1," + std::to_string(t(i)) + "\n";
        return text;
    };
    const auto outside = [](int i) { return -5.0 - i; };
    const auto inside = [](int i) { return -0.5 + i / 64.0; };
    const std::string sphere = "--sphere 0,0,0,1";
    CHECK(has(judged(rows(outside, [](int i) { return 6.0 + i; }), sphere), "the exit in place of the entry"));
    CHECK(has(judged(rows(outside, [](int i) { return 1000 * (4.0 + i); }), sphere), "1000 times what is right"));
    CHECK(has(judged(rows(inside, [](int) { return 0.0; }), sphere), "say --inside zero"));
    CHECK(judged(rows(inside, [](int) { return 0.0; }), sphere + " --inside zero").empty());
    CHECK(has(judged(rows(inside, [](int i) { return 1.5 - i / 64.0; }), "--box=-1,-1,-1,1,1,1"), "say --inside exit"));
    CHECK(has(judged(rows(inside, [](int i) { return 0.5 + i / 64.0; }), sphere), "without its sign"));
    CHECK(has(judged(rows(outside, [](int i) { return i % 7 + 0.25; }), sphere),
              "rays.csv: all 40 rays that hit or should hit are wrong; 40 have a t"));
    std::string many = rows(outside, [](int i) { return i % 7 + 0.25; }), all;
    CHECK(has(judged(many, sphere), "file.rays f32: on all 40 rays of "));
    for (int i = 0; i < 125; ++i) all += many;
    const std::string sampled = judged(all + "0,5,-9,0,0,1,0,0\n", sphere);
    CHECK(has(sampled, "file.rays f32: on a sample of "));
    CHECK(has(sampled, "the first 4096 of its rays that hit or should hit: all 4096 rays"));
    CHECK(has(judged(rows([](int i) { return 5.0 + i; }, [](int i) { return -6.0 - i; }), sphere), "--miss negative"));
    std::string overflows;  // t* = 2^136 - 2^130, for which f32 has infinity alone
    for (int i = 0; i < 40; ++i) overflows += "0,0,0,0,0,0.0009765625,1,inf\n";
    CHECK(judged(overflows, "--sphere 0,0,0x1p126,0x1p120").empty());
    CHECK(has(judged(overflows, "--sphere 0,0,0x1p100,0x1p90"), "40 have a t that is not a finite number"));
}

TEST_CASE("judge: primitives of all kinds keep the numbers as written") {
    const Scratch scratch;
    // The sphere is met at 3, the box at 7: only the number of the former is right.
    const std::string file =
        scratch.write("rays.csv", "ox,oy,oz,dx,dy,dz,hit,t,object\n0,0,9,0,0,-1,1,3,0\n0,0,9,0,0,-1,1,3,1\n");
    const std::string box = " --box=-1,-1,-1,1,1,2", sphere = " --sphere=0,0,4,2";
    const auto outcomes = [&](const std::string& primitives) {
        must("judge '" + file + "' --answer-format f64 --rows" + primitives + into(scratch));
        std::vector<std::string> found;
        for (const auto& row : read_csv(scratch / "out/rays/file.rays.f64.csv")) found.push_back(row.at("outcome"));
        return found;
    };
    const std::vector<std::string> first{"agree_hit", "wrong_primitive"}, second{"wrong_primitive", "agree_hit"};
    CHECK(outcomes(sphere + box) == first);
    CHECK(outcomes(box + sphere) == second);
    const std::string camera =
        "schema = \"lostbits-scene/1\"\ntitle = \"two\"\nsize = [1, 1]\n[camera]\nkind = \"orthographic\"\n"
        "eye = [0, 0, 9]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\nwidth = 1\n";
    const std::string of_box = "[[box]]\nlo = [-1, -1, -1]\nhi = [1, 1, 2]\n",
                      of_sphere = "[[sphere]]\ncentre = [0, 0, 4]\nradius = 2\n";
    for (const bool box_first : {true, false}) {
        const std::string scene =
            scratch.write("two.toml", camera + (box_first ? of_box + of_sphere : of_sphere + of_box));
        CHECK(outcomes(" --scene '" + scene + "'") == (box_first ? second : first));
        must("map '" + scene + "' -i sphere.unified+box.signs -f f64 --pixels csv" + into(scratch));
        const auto pixels = read_csv(scratch / "out/two/sphere.unified+box.signs.f64.csv");
        CHECK(pixels.at(0).at("truth_object") == (box_first ? "1" : "0"));
    }
}

TEST_CASE("judge: a form has the same outcomes at a mesh in judge and map") {
    const Scratch scratch;
    scratch.write("quad.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
    const std::string scene = scratch.write(
        "quad.toml",
        "schema = \"lostbits-scene/1\"\ntitle = \"quad\"\nsize = [1, 1]\n[camera]\nkind = \"orthographic\"\n"
        "eye = [0, 0, 4]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\nwidth = 1\n[[mesh]]\nfile = \"quad.obj\"\n");
    const std::string file =
        scratch.write("rays.csv", "ox,oy,oz,dx,dy,dz,hit,t,object\n0,0,4,0,0,-1,1,4,0\n0,0,4,0,0,-1,1,4,1\n");
    const auto r = must("judge '" + file + "' --answer-format f32 --scene '" + scene + "' -i triangle.woop --rows" +
                        into(scratch));
    CHECK(has(r.out, "double hit"));
    must("map '" + scene + "' -i triangle.woop -f f32 --pixels csv" + into(scratch));
    const std::string mapped = read_csv(scratch / "out/quad/triangle.woop.f32.csv").at(0).at("outcome");
    CHECK(mapped == "double_hit");
    for (const auto& row : read_csv(scratch / "out/rays/triangle.woop.f32.csv")) CHECK(row.at("outcome") == mapped);
    // The file does not say which other triangles it hits; both triangles own the hit.
    for (const auto& row : read_csv(scratch / "out/rays/file.rays.f32.csv")) CHECK(row.at("outcome") == "agree_hit");
}

namespace {

/// A cube of side 2 around the origin. Faces 0 and 1 are its bottom, 2 and 3 its top, at z = 1.
const std::string cube =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\nf 1 3 2\nf 1 4 3\nf 5 6 7\n"
    "f 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";
const std::string of_cube =
    "schema = \"lostbits-scene/1\"\ntitle = \"cube\"\nsize = [1, 1]\n[camera]\nkind = \"orthographic\"\n"
    "eye = [0, 0, 4]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\nwidth = 1\n[[mesh]]\nfile = \"cube.obj\"\n";

std::vector<std::string> outcomes_in(const fs::path& file) {
    std::vector<std::string> outcomes;
    for (const auto& row : read_csv(file)) outcomes.push_back(row.at("outcome"));
    return outcomes;
}

}  // namespace

TEST_CASE("judge: a file of decisions without t is suspected for its decisions alone") {
    const Scratch scratch;
    const std::string head = "ox,oy,oz,dx,dy,dz,hit\n", first = "0.1,0.1,4,0,0,-1,", second = "0.1,0.2,4,0,0,-1,",
                      beside = "5,5,4,0,0,-1,0\n";
    scratch.write("right.csv", head + first + "1\n" + second + "1\n" + beside);
    scratch.write("wrong.csv", head + first + "0\n" + second + "0\n" + beside);
    CHECK_FALSE(has(must("judge right.csv --sphere 0,0,0,1 -o a", scratch.path()).err, "wrong on"));
    CHECK(has(must("judge wrong.csv --sphere 0,0,0,1 -o b", scratch.path()).err, "2 miss what they should hit"));
}

TEST_CASE("judge: a list of all hits is compared with all crossings") {
    const Scratch scratch;
    scratch.write("cube.obj", cube), scratch.write("cube.toml", of_cube);
    struct Case {
        std::string records;  ///< object and t
        std::string outcome;
    };
    // Down the z axis near (1/2, 1/4), where triangles 2 and 0 are met at 3 and 5, and at the middle of both diagonals.
    const std::vector<Case> in_faces{{"2,3;0,5", "agree"},          {"2,3", "crack"},
                                     {"", "missing_hit"},           {"0,5;2,3", "out_of_order"},
                                     {"2,3;2,3;0,5", "double_hit"}, {"3,3;0,5", "wrong_neighbour"},
                                     {"2,nan;0,5", "not_a_number"}, {"2,3.5;0,5", "agree"}};
    const std::vector<Case> on_edges{{"2,3;0,5", "agree"}, {"3,3;1,5", "agree"}, {"2,3;3,3;1,5", "double_hit"}};
    const std::vector<Case> past{{"2,3", "false_hit"}, {"", "agree"}};
    std::string file = "ox,oy,oz,dx,dy,dz,hit_index,object,t\n";
    std::vector<std::string> expected;
    const auto add = [&](const std::string& ray, const Case& one) {
        expected.push_back(one.outcome);
        int index = 0;
        for (std::size_t begin = 0; begin < one.records.size();) {
            const std::size_t end = std::min(one.records.find(';', begin), one.records.size());
            file += ray + "," + std::to_string(index++) + "," + one.records.substr(begin, end - begin) + "\n";
            begin = end + 1;
        }
        if (index == 0) file += ray + ",,,\n";
    };
    for (const Case& one : in_faces) add("0.5,0.25,4,0,0,-1", one);
    for (const Case& one : on_edges) add("0.5,0.5,4,0,0,-1", one);
    for (const Case& one : past) add("9,9,4,0,0,-1", one);
    scratch.write("hits.csv", file);
    const auto r = must("judge hits.csv --scene cube.toml --rows" + into(scratch), scratch.path());
    CHECK(outcomes_in(scratch / "out/hits/file.hits.f64.csv") == expected);
    CHECK(has(r.out, "first crack: record 2, --ray=0x1p-1,0x1p-2,0x1p+2,0x0p+0,0x0p+0,-0x1p+0"));
    const auto summary = read_csv(scratch / "out/hits/summary.csv").at(0);
    CHECK(summary.at("rays") == "13");
    CHECK(summary.at("crack") == "1");
    CHECK(summary.at("missing_hits") == "3");
    CHECK(std::stod(summary.at("ulp_error_max")) == std::ldexp(1.0, 50));  // half a unit, where an ulp is 2^-51
    CHECK(read_csv(scratch / "out/hits/faults.csv").size() == 7);
    // The same at any number of threads, and with records that are divided between pieces of the file.
    must("judge hits.csv --scene cube.toml --rows -j 1" + into(scratch, "one"), scratch.path());
    CHECK(contents(scratch / "one/hits/file.hits.f64.csv") == contents(scratch / "out/hits/file.hits.f64.csv"));
}

TEST_CASE("judge: the hits of a ray may be in two pieces of a file, and must belong together there too") {
    const Scratch scratch;
    scratch.write("cube.obj", cube), scratch.write("cube.toml", of_cube);
    std::string file = "ox,oy,oz,dx,dy,dz,hit_index,object,t\n9,9,4,0,0,-1,,,\n";
    for (int i = 0; i < 5000; ++i) file += "0.5,0.25,4,0,0,-1,0,2,3\n0.5,0.25,4,0,0,-1,1,0,5\n";
    scratch.write("hits.csv", file);
    must("judge hits.csv --scene cube.toml" + into(scratch), scratch.path());
    const auto summary = read_csv(scratch / "out/hits/summary.csv").at(0);
    CHECK(summary.at("agree") == "5001");
    CHECK(summary.at("listed") == "10000");
    // Record 4097 begins the second piece.
    std::string other = "ox,oy,oz,dx,dy,dz,hit_index,object,t\n";
    for (int i = 0; i < 4096; ++i) other += "0.5,0.25,4,0,0,-1,0,2,3\n";
    scratch.write("hits.csv", other + "0.5,0.5,4,0,0,-1,1,0,5\n");
    const auto r = run("judge hits.csv --scene cube.toml" + into(scratch), scratch.path());
    CHECK(r.code == 2);
    CHECK(has(r.err, "hits.csv:4098:18: hit_index is 1; the record before it is of another ray"));
}

TEST_CASE("judge: numbers of crossings, their parity, and points in a mesh") {
    const Scratch scratch;
    scratch.write("cube.obj", cube), scratch.write("cube.toml", of_cube);
    const std::string inner = "0.5,0.25,4,0,0,-1,", beside = "3,0.25,4,0,0,-1,";
    scratch.write("counts.csv", "ox,oy,oz,dx,dy,dz,crossings\n" + inner + "2\n" + inner + "1\n" + inner + "0\n" +
                                    inner + "4\n" + beside + "0\n" + beside + "1\n" + beside + "2\n");
    must("judge counts.csv --scene cube.toml --rows" + into(scratch), scratch.path());
    CHECK(outcomes_in(scratch / "out/counts/file.counts.f64.csv") ==
          std::vector<std::string>{"agree", "crack", "missing_hit", "false_hit", "agree", "false_hit", "false_hit"});
    // At the edge x = z = 1 the ray touches the cube: it enters and leaves it at one t, or passes by.
    scratch.write("parity.csv", "ox,oy,oz,dx,dy,dz,parity\n" + inner + "0\n" + inner +
                                    "1\n2,0.25,2,1,0,-1,true\n"
                                    "2,0.25,0,-1,0,1,false\n2,0.25,0,-1,0,1,1\n");
    must("judge parity.csv --scene cube.toml --rows" + into(scratch), scratch.path());
    CHECK(outcomes_in(scratch / "out/parity/file.parity.f64.csv") ==
          std::vector<std::string>{"agree", "crack", "false_hit", "agree", "crack"});
    scratch.write("points.csv", "px,py,pz,inside\n0,0,0,1\n0,0,0,0\n2,0,0,0\n2,0,0,true\n1,0,0,1\n1,1,1,0\n");
    const auto r = must("judge points.csv --scene cube.toml --rows" + into(scratch), scratch.path());
    CHECK(outcomes_in(scratch / "out/points/file.points.f64.csv") ==
          std::vector<std::string>{"agree", "false_outside", "agree", "false_inside", "on_surface", "on_surface"});
    CHECK(has(r.out, "first false inside: point 3, 0x1p+1,0x0p+0,0x0p+0"));
    scratch.write("cube.obj", cube + "f 1 2 7\n");
    const auto open = run("judge points.csv --scene cube.toml" + into(scratch), scratch.path());
    CHECK(open.code == 2);
    CHECK(has(open.err, "3 edges have an odd number of faces"));
}

TEST_CASE("judge: options of first hits, and scenes without a mesh, are refused for answers about a surface") {
    const Scratch scratch;
    scratch.write("points.csv", "px,py,pz,inside\n0,0,0,1\n");
    for (const auto& [words, why] :
         {std::pair("-i triangle.woop --scene mesh-grid-vertices", "says that its records are points"),
          {"--facing front --scene mesh-grid-vertices", "is about rays"},
          {"--sphere 0,0,0,1", "give --scene with a scene of [[mesh]] tables"},
          {"--scene near-benign", "give --scene with a scene of [[mesh]] tables"}}) {
        const auto r = run("judge points.csv " + std::string(words) + into(scratch), scratch.path());
        INFO(words << r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err, why));
    }
}

}  // namespace test_judge
