// Which ray `lostbits explain` is asked about, and what it is given.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include "catch.hpp"
#include "program.hpp"
#include "setting_of.hpp"

namespace test_explain_ray {

using namespace lostbits::test;

namespace {

using Json = nlohmann::json;

/// What the command says, in place of its table.
Json explained(const std::string& arguments, const Scratch& folder) {
    const auto r = must("explain " + arguments + " --json -q", folder.path());
    return Json::parse(r.out);
}

std::string hex(const Json& j) { return j["hex"].get<std::string>(); }

}  // namespace

TEST_CASE("a ray is taken as given: what a format cannot hold is input error, and --as rounds first") {
    const Scratch folder;
    const std::string ray = "--sphere 0,0,5,1 --ray 0.1,0,0,0,0,1 -i sphere.schoolbook ";
    // Of the decimal's binary64 number, whatever form it is then asked of: t* = 5 - sqrt(1 - 0.1²), by hand in 40
    // digits for 0x1.999999999999ap-4 and for 0x1.99999ap-4, each rounded to binary64.
    const Json f64 = explained(ray + "-f f64", folder), f32 = explained(ray + "-f f32", folder);
    CHECK(hex(f64["inputs"]["o.x"]) == "0x1.999999999999ap-4");
    CHECK(hex(f32["inputs"]["o.x"]) == "0x1.99999ap-4");
    CHECK(f64["inputs_rounded"] == false);
    CHECK(f32["inputs_rounded"] == true);
    CHECK(hex(f64["truth"]) == "0x1.005220366c8ebp+2");
    CHECK(f32["truth"] == f64["truth"]);
    const Json as = explained(ray + "-f f32 --as f32", folder), wide = explained(ray + "-f f64 --as f32", folder);
    CHECK(as["inputs_rounded"] == false);
    CHECK(wide["inputs_rounded"] == false);
    CHECK(hex(as["truth"]) == "0x1.0052203695b95p+2");
    CHECK(as["truth"] == wide["truth"]);
    // Of a scene with numbers of its own the ray is ideal, and every format rounds it once from the decimal.
    std::string own = lostbits::test::good_scene;
    own.replace(own.find("shared"), 6, "own");
    static_cast<void>(folder.write("own.toml", own));
    const std::string ideal = "own.toml --ray 0.1,0,-5,0,0,1 -i sphere.schoolbook ";
    const Json in_own = explained(ideal + "-f f64", folder);
    CHECK(in_own["inputs_rounded"] == true);
    CHECK(hex(in_own["inputs"]["o.x"]) == "0x1.999999999999ap-4");
    CHECK(explained(ideal + "-f f64 --as f64", folder)["inputs_rounded"] == false);
    const auto text = run("explain own.toml --ray 0.1,0,-5,0,0,1 -i sphere.schoolbook", folder.path());
    CHECK(has(text.out, "f32 cannot hold all of these numbers and gets them rounded"));
}

TEST_CASE("a ray with solids of its own ends where it is told to, and is judged by the convention it is told") {
    const Scratch folder;
    const std::string face = "--box 0,0,5,1,1,6 --ray 1,0.5,0,0,0,1 -i box.inclusive ";
    CHECK(hex(explained(face + "--convention closed", folder)["truth"]) == "0x1.4p+2");
    CHECK(explained(face + "--convention open", folder)["truth"].is_null());
    CHECK(explained(face + "--convention open", folder)["outcome"] == "false_hit");
    CHECK(explained(face + "--convention closed --tmax 4", folder)["outcome"] == "agree_miss");
    CHECK(explained(face + "--convention closed --tmax 5", folder)["outcome"] == "agree_hit");
    CHECK(explained(face + "--convention closed --tmax 5 --open-ends tmax", folder)["outcome"] == "agree_miss");
    const std::string ball = "--sphere 0,0,5,1 --ray 0,0,0,0,0,1 -i sphere.schoolbook ";
    CHECK(hex(explained(ball + "--tmin 4 --tmax 4", folder)["truth"]) == "0x1p+2");
    const auto far = explained(ball + "--tmin 4 --open-ends tmin", folder);
    CHECK(hex(far["truth"]) == "0x1.8p+2");
    CHECK(far["outcome"] == "agree_hit");
    CHECK(explained(ball + "--tmin 4.5 --tmax 5.5", folder)["outcome"] == "agree_miss");
}

TEST_CASE("explain refuses words that name no ray, and says what to write") {
    const std::string with = " -i sphere.press";
    for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
             {"--ray 0,0,0,0,0,1" + with, "name a scene, a file of cases with --case, or solids"},
             {"near-benign --sphere 0,0,5,1 --ray 0,0,0,0,0,1" + with, "a scene has its own solids"},
             {"--sphere 0,0,5,1" + with, "name the ray too"},
             {"--sphere 0,0,5 --ray 0,0,0,0,0,1" + with, "is not a sphere"},
             {"--sphere 0,0,5,-1 --ray 0,0,0,0,0,1" + with, "radius is not greater than 0"},
             {"--box 0,0,5,1,1,4 --ray 0,0,0,0,0,1 -i box.signs", "hi is below lo in a component"},
             {"--box 0,0,5,1,1,6 --ray 0,0,0,0,0,1" + with, "try -i 'box.*' -i 'sdf.*'"},
             {"near-benign --ray 0,0,0,0,0,1 --tmin 5" + with, "--set rays.tmin"},
             {"--sphere 0,0,5,1 --ray 0,0,0,0,0,1 --set camera.x=1" + with, "only march.KEY can be set"},
             {"--sphere 0,0,5,1 --ray 0,0,0,0,0,1 --as f31" + with, "unknown format"},
             {"--sphere 0,0,5,1 --ray 0,0,0,0,0,1e39 --as f32" + with, "the largest number of f32 is 3.40"},
             {"near-benign --pixel 1,1 --as f32" + with, "--as needs --ray"},
             {"extremes/contact --case 'eye at the centr'" + with, "did you mean"},
             {"extremes/contact --case 'eye at the centr:0'" + with, "did you mean \"eye at the centre\""},
             {"extremes/contact --case 'eye at the centre:99'" + with, "counted from 0"},
             {"sphere-distance --case x" + with, "has no [[case]] tables"},
             {"extremes/contact --case x --ray 0,0,0,0,0,1" + with, "a case has its rays"},
             {"box-boundary --case x" + with, "try -i 'box.*'"}}) {
        const auto r = run("explain " + arguments);
        INFO(arguments << "\n" << r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err, says));
        CHECK(r.out.empty());
    }
}

TEST_CASE("a direction that is normalised is said to be") {
    const std::string ray = "explain sdf-sphere --ray 0,0,4,0,0,-2 ";
    const auto march = run(ray + "-i sdf.sphere_trace");
    CHECK(has(march.out,
              "The direction (0, 0, -2) is normalised and rounded: the form takes unit directions, and its t is a "
              "distance."));
    CHECK(nlohmann::json::parse(run(ray + "-i sdf.sphere_trace --json").out)["given_direction"] ==
          nlohmann::json({0, 0, -2}));
    CHECK_FALSE(has(run("explain sdf-sphere --ray 0,0,4,0,0,-1 -i sdf.sphere_trace").out, "is normalised"));
    CHECK_FALSE(has(run("explain near-benign --ray 0,0,0,0,0,-2 -i sphere.schoolbook").out, "is normalised"));
}

TEST_CASE("a ray is asked alone, however many spheres there are") {
    // Its row of the picture in p2, where every sphere is a candidate, took minutes.
    const auto r = must("explain sphereflake-near --pixel 100,100 -i sphere.unified -f p2 --json");
    CHECK(nlohmann::json::parse(r.out)["solids"] == 66431);
}

TEST_CASE("explain --worst takes the ray that the tables name: a wrong decision, or else the largest error") {
    const Scratch folder;
    const std::string with = " -i sphere.schoolbook -f f32";
    const auto first = [&folder](const std::string& file) {
        return lostbits::test::read_csv(folder.path() / file).front();
    };
    // Of a scene: where a decision is wrong the first that is so, and elsewhere the largest error.
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
    // Of a sweep, over all its steps; of cases, over all of them.
    for (const std::string sweep : {"sphere-tilt --set views=16", "extremes/contact"}) {
        CAPTURE(sweep);
        const bool cases = sweep.starts_with("extremes");
        const std::string id = cases ? "contact" : "sphere-tilt", file = cases ? "/cases.csv" : "/samples.csv";
        must("sweep " + sweep + with + " --seeds 0 -o sweep", folder.path());
        std::string largest;
        double most = -1;
        bool wrong = false;
        for (const auto& row : lostbits::test::read_csv(folder.path() / ("sweep/" + id + file))) {
            if (!wrong && !row.at("fault_explain").empty()) {
                wrong = true;
                largest = row.at("fault_explain");
            }
            if (wrong || row.at("worst_ulp_error").empty()) continue;
            const double size = std::fabs(lostbits::test::number_in(row.at("worst_ulp_error")));
            if (size <= most) continue;
            most = size;
            largest = row.at("worst_explain");
        }
        REQUIRE_FALSE(largest.empty());
        if (!cases) continue;
        const auto worst = run("explain " + sweep + " --worst" + with, folder.path());
        CAPTURE(largest, worst.err);
        REQUIRE(worst.code == 0);
        const auto there = run(largest.substr(largest.find(' ') + 1), folder.path());
        // Each begins with a line on which case it is.
        CHECK(worst.out.substr(worst.out.find('\n')) == there.out.substr(there.out.find('\n')));
    }

    for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
             {"near-benign --worst --pixel 1,1" + with, "name one ray"},
             {"extremes/contact --worst --case x" + with, "--worst needs a scene or a sweep"},
             {"--sphere 0,0,5,1 --ray 0,0,0,0,0,1 --worst" + with, "--worst needs a scene or a sweep"},
             {"worst/near --worst" + with, "run `lostbits sweep` on it"},
             {"near-benihn --worst" + with, "near-benign"},
             {"box-distance --worst" + with, "try -i 'box.*'"},
             {"near-benign --size 1x1 --set camera.look_at[2]=100 --worst" + with,
              "it decides every ray correctly, and none of them hits anything"},
             // What would change nothing, or cannot, is refused; of a sweep as `lostbits sweep` refuses it.
             {"sphere-distance --worst --variant foo" + with, "--variant foo: is for a scene"},
             {"sphere-distance --worst --pixel 1,1" + with, "--pixel 1,1: names one ray"},
             {"sphere-distance --worst --size 9x9" + with, "--size is of a scene's picture"},
             {"sphere-distance --worst --set nonsense=64" + with, "unknown key"},
             {"sphere-distance --worst --steps x" + with, "--steps x: is not a number of steps"},
             {"extremes/contact --worst --set views=2" + with, "--set views=2: extremes/contact names each"},
             {"extremes/contact --worst --steps 3" + with, "has no steps but its cases"},
             {"near-benign --worst --steps 3" + with, "--steps 3: is of a sweep"}}) {
        const auto r = run("explain " + arguments, folder.path());
        INFO(arguments << "\n" << r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err, says));
        CHECK(r.out.empty());
    }
}

TEST_CASE("explain --ranges takes the ranges of a sweep from one step") {
    const Scratch folder;
    const std::string with = " --set rays=64 --boxes 16 -i sphere.unified -f f32";
    const auto r = must("explain sphere-distance --ranges --at 4 --set views=1" + with, folder.path());
    CHECK(has(r.out, "over the ranges of the rays of sphere-distance at 4"));
    CHECK(has(r.out, "the ranges of the 64 rays of the step"));
    const auto far = run("explain sphere-distance --ranges --at 4096 --set views=1 --json" + with, folder.path());
    CHECK(has(far.out, "\"sweep\": \"sphere-distance at 4096\""));
    // A scene has the same name; it has no steps.
    const std::string thin = "explain triangle-thin --ranges -i triangle.woop --size 4x4 --boxes 1";
    CHECK(has(run(thin + " --at 0.5", folder.path()).out, "of triangle-thin at 0.5, in 1 box:"));
    CHECK(has(run(thin, folder.path()).out, "of triangle-thin, in 1 box:"));
    for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
             {"sphere-distance --ranges", "name one step of it by --at distance_radii"},
             {"sphere-distance --ranges --at 1,2", "write --at distance_radii"},
             {"near-benign --ranges --at 4", "--at 4: is a step of a sweep"},
             {"worst/near --ranges --at 4", "has no axes"},
             {"sphere-distance --at 4", "--at requires --ranges"},
             {"near-benign --range d.x=0..1", "--range requires --ranges"},
             {"near-benign --boxes 64", "--boxes requires --ranges"},
             {"near-benign --ranges --boxes 0", "--boxes 0: is not a number from 1 to 1048576"}}) {
        const auto refused = run("explain " + arguments + " -i sphere.unified", folder.path());
        INFO(arguments << "\n" << refused.err);
        CHECK(refused.code == 2);
        CHECK(has(refused.err, says));
        CHECK(refused.out.empty());
    }
}

TEST_CASE("explain --worst of a sweep says which ray of which step it is, and of how many") {
    const Scratch folder;
    const std::string changes = " --set views=16 --set rays=4 --steps 7", with = " -i sphere.schoolbook -f f32";
    const auto worst = must("explain sphere-distance --worst" + changes + with, folder.path());
    must("sweep sphere-distance" + changes + with + " --seeds 0 -o sweep", folder.path());
    // The same by hand: the most frequent wrong decision over all steps, and the first ray of that.
    std::map<std::string, int> wrong;
    const auto rows = lostbits::test::read_csv(folder.path() / "sweep/sphere-distance/samples.csv");
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
    // Not the first ray of its view, as far as a family goes: one ray a view, and the place is that of the view.
    const auto single = run("explain sphere-distance --worst --set views=64 --steps 7" + with, folder.path());
    CHECK(single.out.starts_with("Ray "));
    CHECK_FALSE(single.out.starts_with("Ray 0 "));
}

TEST_CASE("a claim about all wrong decisions names the first of them, as explain --worst does") {
    const Scratch scratch;
    const auto claim = [](const std::string& id, const std::string& subject) {
        return "[[claim]]\nid = \"" + id +
               "\"\nstatement = \"-\"\nsource = \"-\"\nverdict = \"holds\"\n[claim.given]\n" + subject +
               "form = \"sphere.press\"\nformat = \"f32\"\n[claim.expect]\nmetric = \"wrong_fraction\"\n" +
               "in = [0, 0]\n";
    };
    const std::string file =
        scratch.write("c.toml", "schema = \"lostbits-claims/1\"\n" + claim("scene", "scene = \"grazing\"\n") +
                                    claim("sweep", "sweep = \"sphere-distance\"\nat = 4096\n"));
    const std::string junit = (scratch.path() / "j.xml").string();
    const auto r = run("check '" + file + "' --junit '" + junit + "'");
    REQUIRE(r.code == 1);
    const auto worst = run("explain grazing --worst -i sphere.press -f f32").out;
    REQUIRE(worst.starts_with("Pixel "));
    const std::string pixel = "--pixel " + worst.substr(6, worst.find(", the worst") - 6) + " ";
    CHECK(has(worst.substr(0, worst.find('\n')), ": a false "));
    CHECK(has(r.out, "explain grazing " + pixel));
    CHECK(has(lostbits::test::contents(junit), "explain grazing " + pixel));
    // Of the step: its ray is decided wrongly.
    const auto command = r.out.rfind("explain it: lostbits ");
    REQUIRE(command != std::string::npos);
    const std::string words = r.out.substr(command + 21, r.out.find('\n', command) - command - 21);
    CHECK(has(run(words).out, "false miss"));
}

TEST_CASE("a form that settles a ray exactly is explained by what ran, and its exact step is a call") {
    for (const std::string asked : settled_exactly) {
        INFO(asked);
        const auto j = Json::parse(run("explain " + asked + " -f f32 --json -q").out);
        CHECK(j["outcome"] == "agree_hit");
        CHECK(j["lost_bits"] == 0);
        CHECK(j["culprit"] == nullptr);
        CHECK(j["attribution"]["exact_hit"] == true);
        std::size_t calls = 0;
        for (const auto& operation : j["operations"]) {
            if (operation["operation"] != "call") continue;
            ++calls;
            CHECK(operation["expression"] == "exactly(ray, solid)");
            CHECK(operation["operands"].size() + (has(asked, "box") ? 0 : 1) == j["inputs"].size());
        }
        CHECK(calls > 0);
        CHECK(has(run("explain " + asked + " -f f32 --c").out, "a call, which sums without rounding"));
        const auto core = run("explain " + asked + " -f f32 --fpcore");
        CHECK(core.code == (has(asked, "box") ? 0 : 2));  // whose t no exact step computes
        if (core.code == 2) CHECK(has(core.err, "by a call that sums without rounding"));
    }
    CHECK(has(run(std::string("explain ") + settled_exactly[0] + " -f f32").out, "t = 0"));
}

}  // namespace test_explain_ray
