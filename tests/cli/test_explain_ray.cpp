// Tests of the rays and inputs that `lostbits explain` accepts.
#include <algorithm>
#include <cmath>
#include <map>

#include "catch.hpp"
#include "program.hpp"
#include "run_explain.hpp"
#include "scene_and_pixel.hpp"

namespace test_explain_ray {

using namespace lostbits::test;

namespace {

using Json = nlohmann::json;

/// Runs `lostbits explain` with these arguments, and returns what it writes as JSON.
Json explain_as_json(const std::string& arguments, const fs::path& folder = ".") {
    return run_explain("lostbits explain " + arguments, folder);
}

}  // namespace

TEST_CASE("explain: a ray is taken as given, with input error where the format cannot hold it, and --as rounds first") {
    const Scratch folder;
    const std::string ray = "--sphere 0,0,5,1 --ray 0.1,0,0,0,0,1 -i sphere.schoolbook ";
    // The truth is that of the decimal's binary64 number, in whatever format the form computes: t* = 5 - sqrt(1 -
    // 0.1²), by hand in 40 digits for 0x1.999999999999ap-4 and for 0x1.99999ap-4, each rounded to binary64.
    const Json f64 = explain_as_json(ray + "-f f64", folder.path()),
               f32 = explain_as_json(ray + "-f f32", folder.path());
    CHECK(hex_in(f64["inputs"]["o.x"]) == "0x1.999999999999ap-4");
    CHECK(hex_in(f32["inputs"]["o.x"]) == "0x1.99999ap-4");
    CHECK(f64["inputs_rounded"] == false);
    CHECK(f32["inputs_rounded"] == true);
    CHECK(hex_in(f64["truth"]) == "0x1.005220366c8ebp+2");
    CHECK(f32["truth"] == f64["truth"]);
    const Json as = explain_as_json(ray + "-f f32 --as f32", folder.path()),
               wide = explain_as_json(ray + "-f f64 --as f32", folder.path());
    CHECK(as["inputs_rounded"] == false);
    CHECK(wide["inputs_rounded"] == false);
    CHECK(hex_in(as["truth"]) == "0x1.0052203695b95p+2");
    CHECK(as["truth"] == wide["truth"]);
    // A scene with numbers of its own has an ideal ray, which every format rounds once from the decimal.
    folder.write("own.toml", spoil_scene("shared", "own"));
    const std::string ideal = "own.toml --ray 0.1,0,-5,0,0,1 -i sphere.schoolbook ";
    const Json in_own = explain_as_json(ideal + "-f f64", folder.path());
    CHECK(in_own["inputs_rounded"] == true);
    CHECK(hex_in(in_own["inputs"]["o.x"]) == "0x1.999999999999ap-4");
    CHECK(explain_as_json(ideal + "-f f64 --as f64", folder.path())["inputs_rounded"] == false);
    const auto text = run("explain own.toml --ray 0.1,0,-5,0,0,1 -i sphere.schoolbook", folder.path());
    CHECK(has(text.out, "f32 cannot represent all of these numbers and gets them rounded"));
}

TEST_CASE("explain: a ray with its own primitives keeps its end and is judged by the given convention") {
    const Scratch folder;
    const std::string face = "--box 0,0,5,1,1,6 --ray 1,0.5,0,0,0,1 -i box.inclusive ";
    CHECK(hex_in(explain_as_json(face + "--convention closed", folder.path())["truth"]) == "0x1.4p+2");
    CHECK(explain_as_json(face + "--convention open", folder.path())["truth"].is_null());
    CHECK(explain_as_json(face + "--convention open", folder.path())["outcome"] == "false_hit");
    CHECK(explain_as_json(face + "--convention closed --tmax 4", folder.path())["outcome"] == "agree_miss");
    CHECK(explain_as_json(face + "--convention closed --tmax 5", folder.path())["outcome"] == "agree_hit");
    CHECK(explain_as_json(face + "--convention closed --tmax 5 --open-ends tmax", folder.path())["outcome"] ==
          "agree_miss");
    const std::string ball = "--sphere 0,0,5,1 --ray 0,0,0,0,0,1 -i sphere.schoolbook ";
    CHECK(hex_in(explain_as_json(ball + "--tmin 4 --tmax 4", folder.path())["truth"]) == "0x1p+2");
    const auto far = explain_as_json(ball + "--tmin 4 --open-ends tmin", folder.path());
    CHECK(hex_in(far["truth"]) == "0x1.8p+2");
    CHECK(far["outcome"] == "agree_hit");
    CHECK(explain_as_json(ball + "--tmin 4.5 --tmax 5.5", folder.path())["outcome"] == "agree_miss");
}

TEST_CASE("explain: normalising a direction is reported") {
    const std::string ray = "explain sdf-sphere --ray 0,0,4,0,0,-2 ";
    const auto march = run(ray + "-i sdf.sphere_trace");
    CHECK(has(march.out,
              "The direction (0, 0, -2) is normalised and rounded: the form takes unit directions, and its t is a "
              "distance."));
    CHECK(explain_as_json(ray.substr(8) + "-i sdf.sphere_trace")["given_direction"] == nlohmann::json({0, 0, -2}));
    CHECK_FALSE(has(run("explain sdf-sphere --ray 0,0,4,0,0,-1 -i sdf.sphere_trace").out, "is normalised"));
    CHECK_FALSE(has(run("explain near-benign --ray 0,0,0,0,0,-2 -i sphere.schoolbook").out, "is normalised"));
}

TEST_CASE("explain: one ray is evaluated alone, however many spheres there are") {
    // The whole row of the picture in p2, where every sphere is a candidate, took minutes.
    const auto r = must("explain sphereflake-near --pixel 100,100 -i sphere.unified -f p2 --json");
    CHECK(nlohmann::json::parse(r.out)["primitives"] == 66431);
}

TEST_CASE("explain --worst takes the ray of the tables: a wrong decision, or else the largest error") {
    const Scratch folder;
    const std::string with = " -i sphere.schoolbook -f f32";
    const auto first = [&folder](const std::string& file) { return read_csv(folder.path() / file).front(); };
    // In a scene it is the first wrong decision, or else the largest error.
    for (const auto& [scene, column] :
         {std::pair{"rtg-fig-7-3-4100-oblique --size 64x48", "fault"}, {"near-benign --size 64x48", "worst"}}) {
        must(std::string("map ") + scene + with + " -o map", folder.path());
        const std::string id(scene, std::string_view(scene).find(' '));
        const auto row = first("map/" + id + "/summary.csv");
        CAPTURE(id);
        CHECK(row.at("fault_explain").empty() == (std::string(column) == "worst"));
        const std::string named = row.at(std::string(column) + "_explain");
        const auto worst = must("explain " + (scene + (" --worst" + with)), folder.path());
        const auto there = run(named.substr(named.find(' ') + 1), folder.path());
        const auto end = worst.out.find('\n');
        const auto pixel = named.find("--pixel ") + 8;
        CHECK(worst.out.starts_with("Pixel " + named.substr(pixel, named.find(' ', pixel) - pixel) + ", the worst"));
        CHECK(worst.out.substr(end + 1) == there.out);
        CHECK(has(worst.out.substr(0, end), "the worst of 3072 for this form: "));
    }
    // The worst ray of a sweep is the worst of all its steps, and that of cases the worst of all cases.
    for (const std::string sweep : {"sphere-tilt --set views=16", "extremes/contact"}) {
        CAPTURE(sweep);
        const bool cases = sweep.starts_with("extremes");
        const std::string id = cases ? "contact" : "sphere-tilt", file = cases ? "/cases.csv" : "/samples.csv";
        must("sweep " + sweep + with + " --seeds 0 -o sweep", folder.path());
        std::string largest;
        double most = -1;
        bool wrong = false;
        for (const auto& row : read_csv(folder / ("sweep/" + id + file))) {
            if (!wrong && !row.at("fault_explain").empty()) {
                wrong = true;
                largest = row.at("fault_explain");
            }
            if (wrong || row.at("worst_ulp_error").empty()) continue;
            const double size = std::fabs(number_in(row.at("worst_ulp_error")));
            if (size <= most) continue;
            most = size;
            largest = row.at("worst_explain");
        }
        REQUIRE_FALSE(largest.empty());
        const auto worst = run("explain " + sweep + " --worst" + with, folder.path());
        CAPTURE(largest, worst.err);
        REQUIRE(worst.code == 0);
        const auto there = run(largest.substr(largest.find(' ') + 1), folder.path());
        // The output begins with a line that names the ray, as for a named case.
        const auto after_a_line = [](const std::string& text) { return text.substr(text.find('\n') + 1); };
        CHECK(after_a_line(worst.out) == (cases ? after_a_line(there.out) : there.out));
    }
}

TEST_CASE("explain --ranges takes the ranges of one step of a sweep") {
    const Scratch folder;
    const std::string with = " --set rays=64 --pieces 16 -i sphere.unified -f f32";
    const auto r = must("explain sphere-distance --ranges --at-step 4 --set views=1" + with, folder.path());
    CHECK(has(r.out, "over the ranges of the rays of sphere-distance at 4"));
    CHECK(has(r.out, "the ranges of the 64 rays of the step"));
    const auto far = run("explain sphere-distance --ranges --at-step 4096 --set views=1 --json" + with, folder.path());
    CHECK(has(far.out, "\"sweep\": \"sphere-distance at 4096\""));
    // A scene has the same name; it has no steps.
    const std::string thin = "explain triangle-thin --ranges -i triangle.woop --size 4x4 --pieces 1";
    CHECK(has(run(thin + " --at-step 0.5", folder.path()).out, "of triangle-thin at 0.5, in 1 piece:"));
    CHECK(has(run(thin, folder.path()).out, "of triangle-thin, in 1 piece:"));
}

TEST_CASE("explain --worst of a sweep reports the ray, its step and the number of rays") {
    const Scratch folder;
    const std::string changes = " --set views=16 --set rays=4 --steps 7", with = " -i sphere.schoolbook -f f32";
    const auto worst = must("explain sphere-distance --worst" + changes + with, folder.path());
    must("sweep sphere-distance" + changes + with + " --seeds 0 -o sweep", folder.path());
    // The same by hand: the most frequent wrong decision over all steps, and the first ray of that.
    std::map<std::string, int> wrong;
    const auto rows = read_csv(folder / "sweep/sphere-distance/samples.csv");
    for (const auto& row : rows)
        for (const char* kind : {"false_hit", "false_miss"}) wrong[kind] += std::stoi(row.at(kind));
    REQUIRE(wrong["false_miss"] > wrong["false_hit"]);
    const auto first =
        std::ranges::find_if(rows, [](const auto& row) { return row.at("fault_outcome") == "false_miss"; });
    REQUIRE(first != rows.end());
    CHECK(has(worst.out, " of the 64 of the step distance_radii " + first->at("distance_radii") +
                             ", the worst of 448 in 7 steps for this form: a false miss, the first of " +
                             std::to_string(wrong["false_miss"]) + ".\n"));
    const auto there = run(first->at("fault_explain").substr(9), folder.path());
    CHECK(worst.out.substr(worst.out.find('\n') + 1) == there.out);
    // This is not the first ray of its view in the distribution: there is one ray per view, and the index is that of
    // the view.
    const auto single = run("explain sphere-distance --worst --set views=64 --steps 7" + with, folder.path());
    CHECK(single.out.starts_with("Ray "));
    CHECK_FALSE(single.out.starts_with("Ray 0 "));
}

TEST_CASE("a claim about all wrong decisions names the first one, as explain --worst does") {
    const Scratch scratch;
    const std::string form = form_keys("sphere.press"), none = metric_keys("wrong_fraction", "[0, 0]");
    scratch.write("c.toml", make_claim_file({{"scene", "scene = \"grazing\"\n" + form, none},
                                             {"sweep", "sweep = \"sphere-distance\"\nat = 4096\n" + form, none}}));
    const auto r = run("check c.toml --junit j.xml", scratch.path());
    REQUIRE(r.code == 1);
    const auto worst = run("explain grazing --worst -i sphere.press -f f32").out;
    REQUIRE(worst.starts_with("Pixel "));
    const std::string pixel = "--pixel " + worst.substr(6, worst.find(", the worst") - 6) + " ";
    CHECK(has(worst.substr(0, worst.find('\n')), ": a false "));
    CHECK(has(r.out, "explain grazing " + pixel));
    CHECK(has(contents(scratch / "j.xml"), "explain grazing " + pixel));
    // The ray of the step is decided wrongly.
    const auto command = r.out.rfind("explain it: lostbits ");
    REQUIRE(command != std::string::npos);
    const std::string words = r.out.substr(command + 21, r.out.find('\n', command) - command - 21);
    CHECK(has(run(words).out, "false miss"));
}

TEST_CASE("explain: a form that decides exactly shows what ran, with the exact step as one call") {
    for (const std::string options : exact_step_rays) {
        INFO(options);
        const auto j = explain_as_json(options + " -f f32");
        CHECK(j["outcome"] == "agree_hit");
        CHECK(j["lost_bits"] == 0);
        CHECK(j["culprit"] == nullptr);
        CHECK(j["attribution"]["exact_hit"] == true);
        std::size_t calls = 0;
        for (const auto& operation : j["operations"]) {
            if (operation["operation"] != "call") continue;
            ++calls;
            CHECK(operation["expression"] == "exactly(ray, primitive)");
            CHECK(operation["operands"].size() + (has(options, "box") ? 0 : 1) == j["inputs"].size());
        }
        CHECK(calls > 0);
        CHECK(has(run("explain " + options + " -f f32 --c").out, "a call, which sums without rounding"));
        const auto core = run("explain " + options + " -f f32 --fpcore");
        CHECK(core.code == (has(options, "box") ? 0 : 2));  // its t is not computed by an exact step
        if (core.code == 2) CHECK(has(core.err, "by a call that sums without rounding"));
    }
    CHECK(has(run(std::string("explain ") + exact_step_rays[0] + " -f f32").out, "t = 0"));
}

}  // namespace test_explain_ray
