// Every file that names a ray names it by a command, and this command gives the numbers of the row again.
#include <cmath>
#include <cstdlib>
#include <tuple>

#include "catch.hpp"
#include "program.hpp"
#include "run_explain.hpp"

namespace test_paste {

using namespace lostbits::test;

namespace {

using Json = nlohmann::json;
using Table = std::vector<std::map<std::string, std::string>>;

struct CheckResult {
    int worst = 0, faults = 0;
};

/// Pastes the worst ray and the first wrong decision of every `every`th row.
CheckResult paste_rows(const Table& table, const Scratch& folder, std::size_t every = 1) {
    CheckResult checked;
    for (std::size_t i = 0; i < table.size(); i += every) {
        const std::string name = table[i].at("form") + " in " + table[i].at("format");
        CAPTURE(i, name);
        CHECK(table[i].at("worst_explain").empty() == table[i].at("worst_t_hex").empty());
        CHECK(table[i].at("fault_explain").empty() == table[i].at("fault_outcome").empty());
        if (const std::string command = table[i].at("worst_explain"); !command.empty()) {
            const Json j = run_explain(command, folder.path());
            CAPTURE(command);
            CHECK(j["form"] == table[i].at("form"));
            CHECK(j["format"] == table[i].at("format"));
            CHECK(j["outcome"] == "agree_hit");
            CHECK(hex_in(j["t"]) == table[i].at("worst_t_hex"));
            CHECK(hex_in(j["truth"]) == table[i].at("worst_truth_hex"));
            CHECK(number_in(j["ulp_error"]) == number_in(table[i].at("worst_ulp_error")));
            CHECK(std::fabs(number_in(j["ulp_error"])) == number_in(table[i].at("ulp_error_max")));
            CHECK(number_in(j["t"]["decimal"]) == number_in(table[i].at("worst_t")));
            CHECK(number_in(j["truth"]["decimal"]) == number_in(table[i].at("worst_truth")));
            ++checked.worst;
        }
        if (const std::string command = table[i].at("fault_explain"); !command.empty()) {
            const Json j = run_explain(command, folder.path());
            CAPTURE(command);
            CHECK(j["outcome"] == table[i].at("fault_outcome"));
            CHECK(hex_in(j["truth"]) == table[i].at("fault_truth_hex"));
            if (j["outcome"] == "false_hit" || j["outcome"] == "wrong_primitive")
                CHECK(hex_in(j["t"]) == table[i].at("fault_t_hex"));
            else CHECK(table[i].at("fault_t_hex").empty());
            ++checked.faults;
        }
    }
    return checked;
}

const std::string head = "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n";

}  // namespace

TEST_CASE("paste: the worst ray of each row of summary.csv and any row of a pixel CSV of a map") {
    const Scratch folder;
    // A file of the user: a space in its name, variants, and numbers that each format rounds itself.
    const std::string own =
        spoil_scene("shared", "own") +
        "[[variant]]\nname = \"a\"\nset = { \"sphere[0].radius\" = \"1.1\" }\n[[variant]]\nname = \"b\"\nset = {}\n";
    folder.write("my scene.toml", own);
    const std::string rows =
        " -i sphere.schoolbook -i sphere.press -i sphere.double_inside -i box.signs -i box.max_mult -i "
        "sdf.sphere_trace -f f32 -f f64 -f bf16 --size 40x30 --pixels csv -o out ";
    must("map near-benign world-offset-own box-octree sdf-sphere rtg-fig-7-3-4100-oblique './my scene.toml'" + rows,
         folder.path());
    must(
        "map camera-inside --set camera.fov_deg=50 --metric lost_bits -i sphere.unit_half_b -f "
        "f32 --size 9x7 -o set",
        folder.path());
    CheckResult all = paste_rows(read_csv(folder / "set/camera-inside/summary.csv"), folder);
    CHECK(all.faults == 1);
    for (const std::string scene : {"near-benign", "world-offset-own", "box-octree", "sdf-sphere",
                                    "rtg-fig-7-3-4100-oblique", "my scene.a", "my scene.b"}) {
        const auto table = read_csv(folder / "out" / scene / "summary.csv");
        const CheckResult some = paste_rows(table, folder);
        CAPTURE(scene);
        CHECK(some.worst > 0);
        all.worst += some.worst;
        all.faults += some.faults;
        // A row of the pixel table is explained by the same command with its own pixel.
        const std::string stem = table[0].at("form") + "." + table[0].at("format");
        const auto pixels = read_csv(folder / "out" / scene / (stem + ".csv"));
        const std::string words = table[0].at("worst_explain");
        const auto begin = words.find("--pixel ") + 8, end = words.find(' ', begin);
        for (std::size_t i = 11; i < pixels.size(); i += 397) {
            std::string other = words;
            other.replace(begin, end - begin, pixels[i].at("x") + "," + pixels[i].at("y"));
            const Json j = run_explain(other, folder.path());
            CAPTURE(other);
            CHECK(j["outcome"] == pixels[i].at("outcome"));
            CHECK(hex_in(j["truth"]) == pixels[i].at("truth_hex"));
            if (j["hit"] == true) CHECK(hex_in(j["t"]) == pixels[i].at("t_hex"));
            CHECK(j["ulp_error"].is_null() == pixels[i].at("ulp_error").empty());
            if (!j["ulp_error"].is_null()) CHECK(number_in(j["ulp_error"]) == number_in(pixels[i].at("ulp_error")));
        }
    }
    CHECK(all.worst > 35);
    CHECK(all.faults > 5);
}

TEST_CASE("paste: the worst ray of each sweep step, with the primitive of its view and the constants of its march") {
    const Scratch folder;
    folder.write("one.toml", make_sweep_file("[sphere_rays]\nviews = 3\nrays = 16\n" +
                                             make_axis({"distance", "\"distance\"", "100", "1e6"})));
    folder.write("many.toml",
                 make_sweep_file("convention = \"closed\"\n[box_rays]\naim = \"edge\"\nadjoining = true\nviews = 2\n"
                                 "rays = 16\n" +
                                 make_axis({"distance", "\"distance\"", "2", "1000"})));
    folder.write("march.toml",
                 make_sweep_file("[march]\nhit_eps = 0.01\nmax_steps = 40\n[sphere_rays]\nviews = 2\nrays = 8\n" +
                                 make_axis({"distance", "\"distance\", \"march.max_dist\"", "4", "4000"})));
    folder.write("scene.toml", make_sweep_file("scene = \"near-benign\"\n" +
                                               make_axis({"radius", "\"sphere[0].radius\"", "0.25", "1"})));
    CheckResult all;
    for (const auto& [name, forms] :
         std::vector<std::pair<std::string, std::string>>{{"one", "-i sphere.schoolbook -i sphere.press"},
                                                          {"many", "-i box.signs -i box.baseline"},
                                                          {"march", "-i sdf.sphere_trace -i sdf.over_relaxed"},
                                                          {"scene", "-i sphere.unified"}}) {
        must("sweep " + name + ".toml " + forms + " -f f32 -f f64 -f bf16 -o out", folder.path());
        const CheckResult some = paste_rows(read_csv(folder / "out" / name / "samples.csv"), folder);
        CAPTURE(name);
        CHECK(some.worst > 5);
        all.faults += some.faults;
    }
    CHECK(all.faults > 5);
}

TEST_CASE("paste: the nearest ray of each outcome of an edge search") {
    const Scratch folder;
    must(
        "sweep mesh-edges --worst -i triangle.undivided -i triangle.baldwin_weber -f f32 -f p16 "
        "--set rays=8192 -o out",
        folder.path());
    const auto table = read_csv(folder / "out/mesh-edges/worst.csv");
    int pasted = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const std::string command = table[i].at("explain");
        CHECK(command.empty() == (table[i].at("found") == "false"));
        if (command.empty()) continue;
        INFO(command);
        const auto j = run_explain(command, folder.path());
        CHECK(j.at("in_mesh") == table[i].at("outcome"));
        ++pasted;
    }
    CHECK(pasted >= 6);
}

TEST_CASE("paste: cases in numbers of the format, with symmetries, ranges, conventions and invalid rays") {
    const Scratch folder;
    folder.write("my cases.toml", head + R"(conventions = ["open", "closed", "own"]
[[case]]
name = "the reader's: 3"
symmetric = true
boxes = [{ lo = [-1, -2, "-3 - ulp"], hi = ["1 + ulp", 2, 3] }]
rays = [{ origin = [0, 0, -9], direction = [0, 0.3, 1] },
        { origin = [0.7, 0.5, -8], direction = [0.1, 0, 1], tmax = 9 },
        { origin = [1, 2, -9], direction = [0, 0, 1] }, { origin = [0, 0, -9], direction = [0, 0, 1], tmax = 2 }]
)");
    must("sweep './my cases.toml' extremes/contact extremes/not-numbers box-boundary " LOSTBITS_DATA_DIR
         "/hard/near.toml -i sphere.schoolbook -i sphere.unified -i box.signs -i box.baseline -f f32 "
         "-f f64 -f bf16 -o out",
         folder.path());
    const std::vector<std::tuple<std::string, std::size_t, int>> files{
        {"my cases", 1, 12}, {"contact", 3, 3}, {"not-numbers", 2, 3}, {"box-boundary", 29, 10}, {"near", 17, 10}};
    CheckResult all;
    for (const auto& [name, every, least] : files) {
        const auto table = read_csv(folder / "out" / name / "cases.csv");
        const CheckResult some = paste_rows(table, folder, every);
        CAPTURE(name);
        CHECK(some.worst + some.faults >= least);
        all.worst += some.worst;
        all.faults += some.faults;
        for (std::size_t i = 0; i < table.size(); ++i) {
            const std::string verdict = table[i].at("verdict"), fault = table[i].at("fault_outcome");
            CHECK(fault ==
                  (verdict == "right" || verdict == "within_inputs" || verdict == "wrong_value" ? "" : verdict));
        }
    }
    CHECK(all.worst > 30);
    CHECK(all.faults > 15);
    // Without an index it is the ray that the table names: a wrong decision before a wrong value.
    const auto boxes = read_csv(folder / "out/my cases/cases.csv");
    for (const std::size_t i : {std::size_t{0}, boxes.size() - 1}) {
        std::string command = boxes[i].at("fault_explain");
        if (command.empty()) command = boxes[i].at("worst_explain");
        const auto colon = command.rfind(':', command.rfind("' "));
        std::string without = command;
        without.erase(colon, command.find('\'', colon) - colon);
        CAPTURE(command, without);
        CHECK(run_explain(without, folder.path()) == run_explain(command, folder.path()));
    }
}

TEST_CASE("paste: the rays in worst.csv of a search, and the cases of its hard.toml") {
    const Scratch folder;
    for (const auto& [name, primitive] : std::vector<std::pair<std::string, std::string>>{
             {"s", "centre = [-1, 1]\nradius = [0.5, 2]\n"}, {"b", "lo = [-2, -1]\nhi = [1, 2]\n"}})
        folder.write(name + ".toml", head + "[search]\norigin = [-8, 8]\ndirection = [-1, 1]\n" + primitive +
                                         "starts = 2\ngenerations = 6\n");
    must("sweep s.toml --worst -i sphere.schoolbook -i sphere.press -f f32 -f f64 -f bf16 -o out", folder.path());
    must("sweep b.toml --worst -i box.divide -i box.inclusive -f f32 -f f64 -f bf16 -o out", folder.path());
    for (const std::string name : {"s", "b"}) {
        const auto table = read_csv(folder / "out" / name / "worst.csv");
        REQUIRE(table.size() == 6);
        for (std::size_t i = 0; i < table.size(); ++i) {
            const Json j = run_explain(table[i].at("explain"), folder.path());
            CAPTURE(table[i].at("explain"));
            CHECK(j["outcome"] == table[i].at("outcome"));
            CHECK(hex_in(j["truth"]) == table[i].at("truth_hex"));
            if (j["hit"] == true) CHECK(hex_in(j["t"]) == table[i].at("t_hex"));
            if (!j["lost_bits"].is_null()) CHECK(number_in(j["lost_bits"]) == number_in(table[i].at("lost_bits")));
        }
        must("sweep out/" + name + "/hard.toml -i sphere.press -i box.divide -f f64 -o out", folder.path());
        CHECK(paste_rows(read_csv(folder / "out/hard/cases.csv"), folder).worst > 2);
    }
}

TEST_CASE("paste: the witness of a claim in the message, CSV, JSON and JUnit XML") {
    const Scratch folder;
    const std::string ulps = metric_keys("ulp_error_max", "[-2, -1]"), unified = form_keys("sphere.unified"),
                      press = form_keys("sphere.press", "bf16"), all = "case = \"*\"\n";
    folder.write(
        "c.toml",
        make_claim_file({{"scene", "scene = \"near-benign\"\n" + form_keys("sphere.schoolbook", "f64"), ulps},
                         {"own", "scene = \"world-offset-own\"\n" + press, ulps},
                         {"wrong", "scene = \"camera-inside\"\n" + form_keys("sphere.unit_half_b"),
                          metric_keys("false_miss", "[-2, -1]")},
                         {"sweep", "sweep = \"sphere-distance\"\nat = 30\n" + press, ulps},
                         {"march", "sweep = \"sdf-distance\"\nat = 300\n" + form_keys("sdf.sphere_trace"), ulps},
                         {"none", "sweep = \"not-numbers\"\n" + all + unified, metric_keys("not_a_number", "[-2, -1]")},
                         {"case", "sweep = \"scale\"\n" + all + form_keys("sphere.unified", "f64"), ulps}}));
    const auto r = run("check c.toml --export-csv c.csv --export-json c.json --junit j.xml", folder.path());
    REQUIRE(r.code == 1);
    const auto table = read_csv(folder / "c.csv");
    const Json array = Json::parse(contents(folder / "c.json"));
    const std::string xml = contents(folder / "j.xml");
    REQUIRE(table.size() == 7);
    for (std::size_t i = 0; i < table.size(); ++i) {
        const std::string command = table[i].at("witness_explain");
        CAPTURE(command);
        CHECK(array[i]["witness_explain"] == command);
        CHECK(has(r.out, "explain it: " + command + "\n"));
        CHECK(has(xml, "\n" + command + "\n"));
        const Json j = run_explain(command, folder.path());
        const std::string metric = table[i].at("quantity");
        if (metric.find("ulp_error") == std::string::npos) CHECK(j["outcome"] == metric);
        else CHECK(std::fabs(number_in(j["ulp_error"])) == number_in(table[i].at("measured")));
    }
}

}  // namespace test_paste
