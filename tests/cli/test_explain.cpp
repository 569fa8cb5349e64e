// lostbits explain: the table, and the programs that it writes, which are run and compared to the bit.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>

#include "catch.hpp"
#include "fpcore.hpp"
#include "intersect/table.hpp"
#include "program.hpp"

using namespace lostbits;
using test::run;
using test::Scratch;

namespace {

const std::string far = "explain rtg-fig-7-3-4100-oblique --pixel 128,40 ";

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Scenes, each with a pixel that forms of its shape hit.
const std::vector<std::pair<Shape, std::string>> settings{{Shape::sphere, "rtg-fig-7-3-100-oblique --pixel 128,100"}, {Shape::box, "box-one --pixel 128,100"}, {Shape::sdf, "sdf-sphere --pixel 100,100"}};

const std::string& setting_of(Shape shape) {
    return std::ranges::find(settings, shape, &std::pair<Shape, std::string>::first)->second;
}

}  // namespace

TEST_CASE("the schoolbook form at 4100: c rounds, and the discriminant cancels it away") {
    const auto r = run(far + "-i sphere.schoolbook -f f32");
    REQUIRE(r.code == 0);
    CHECK(has(r.out, "disc = b·b − 4·a·c cancels 24 of 24 bits"));
    CHECK(has(r.out, "The culprit is c = (o − centre)·(o − centre) − radius·radius"));
    CHECK(has(r.out, "First order alone would say infinity"));
    CHECK(has(r.out, "beyond it are the formula's own"));
    CHECK(has(r.out, "sphere.unified"));
    CHECK(has(r.out, "radius   = 0x1p+0"));
}

TEST_CASE("the unified form beside a huge sphere: what is left is c, and the problem is to blame") {
    const auto r = run("explain rtg-fig-7-4.r1e6 --pixel 100,200 -i sphere.unified -f f32");
    REQUIRE(r.code == 0);
    CHECK(has(r.out, "c = (o − centre)·(o − centre) − radius·radius cancels 18 of 24 bits"));
    CHECK(has(r.out, "within it the problem is hard"));
}

TEST_CASE("JSON holds every operation, and contributions that sum to the error") {
    for (const char* form : {"sphere.schoolbook", "sphere.pbrt_interval"}) {
        const auto j = nlohmann::json::parse(run(far + "-i " + form + " --json").out);
        double sum = 0;
        int culprits = 0;
        for (const auto& o : j["operations"]) {
            if (o.contains("contribution") && o["live"] == true) sum += o["contribution"].get<double>();
            culprits += o["name"] == j["culprit"];
        }
        const double error = j["attribution"]["error"];
        CHECK(std::fabs(sum - error) <= 1e-9 * std::fabs(error));
        CHECK(culprits == 1);
        CHECK(j["inputs"]["radius"]["hex"] == "0x1p+0");
    }
}

TEST_CASE("C programs compile alone and compute the recorded bits") {
    const Scratch scratch;
    int compiled = 0;
    for (const Intersector& form : intersectors()) {
        for (const char* format : {"f32", "f64", "bf16"}) {
            const std::string name(form.info->name);
            if (form.info->formats == Formats::binary32_only && format != std::string("f32")) continue;
            const auto r = run("explain " + setting_of(form.shape) + " -i " + name + " -f " + format + " --c");
            INFO(name << " in " << format << ": " << r.err);
            if (r.code == 2) {  // neighbours and fused operations of a narrow format
                CHECK(std::string(format) == "bf16");
                CHECK(has(r.err, "try -f f32 or f64"));
                continue;
            }
            REQUIRE(r.code == 0);
            const std::string source = scratch.write("ray.c", r.out), program = (scratch.path() / "ray").string();
            REQUIRE(std::system(("cc -std=c99 -O2 -o '" + program + "' '" + source + "' -lm").c_str()) == 0);
            CHECK(std::system(("'" + program + "' > '" + (scratch.path() / "said").string() + "'").c_str()) == 0);
            CHECK(has(test::contents(scratch.path() / "said"), "computed  "));
            ++compiled;
        }
    }
    CHECK(compiled > 85);
}

TEST_CASE("FPCore reads as s-expressions and evaluates to the recorded bits") {
    int evaluated = 0;
    for (const Intersector& form : intersectors()) {
        const std::string name(form.info->name), where = "explain " + setting_of(form.shape) + " -i " + name;
        if (form.info->formats == Formats::binary32_only) continue;  // two precisions: for a real reader of FPCore
        const auto r = run(where + " -f f64 --fpcore");
        INFO(name << ": " << r.err);
        if (name == "sphere.pbrt_interval") {
            CHECK(r.code == 2);
            CHECK(has(r.err, "FPCore has no operation"));
            continue;
        }
        REQUIRE(r.code == 0);
        std::size_t at = 0;
        const auto core = test::read_expression(r.out, at);
        REQUIRE(core.list.at(0).atom == "FPCore");
        const auto j = nlohmann::json::parse(run(where + " -f f64 --json").out);
        std::map<std::string, double> values;
        for (const auto& [key, value] : j["inputs"].items()) {
            std::string id = key;
            std::ranges::replace(id, '.', '_');
            values[id] = std::strtod(value["hex"].get<std::string>().c_str(), nullptr);
        }
        for (const auto& argument : core.list.at(1).list) CHECK(values.contains(argument.atom));
        test::FpCore<double> evaluate(values);
        const auto pre = std::ranges::find(core.list, ":pre", &test::SExpression::atom);
        REQUIRE(pre != core.list.end());
        for (std::size_t i = 1; i < (pre + 1)->list.size(); ++i) CHECK(evaluate((pre + 1)->list[i]) != 0);
        const double want = std::strtod(j["t"]["hex"].get<std::string>().c_str(), nullptr);
        const double got = evaluate(core.list.back());
        CHECK((got == want || (std::isnan(got) && std::isnan(want))));
        ++evaluated;
    }
    CHECK(evaluated > 30);
}

TEST_CASE("LaTeX closes what it opens") {
    for (const Intersector& form : intersectors()) {
        const auto r = run("explain " + setting_of(form.shape) + " -i " + std::string(form.info->name) + " --latex");
        REQUIRE(r.code == 0);
        int depth = 0;
        for (const char c : r.out) {
            depth += (c == '{') - (c == '}');
            REQUIRE(depth >= 0);
        }
        CHECK(depth == 0);
        const auto count = [&](const std::string& what) {
            int n = 0;
            for (std::size_t at = r.out.find(what); at != std::string::npos; at = r.out.find(what, at + 1)) ++n;
            return n;
        };
        CHECK(count("\\begin{") == count("\\end{"));
        CHECK(count("\\left|") == count("\\right|"));
    }
}

TEST_CASE("explain refuses what it cannot read, and says why") {
    for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
             {"explain near-benign -i sphere.unified", "name one ray"},
             {"explain near-benign --pixel 1 -i sphere.unified", "not a pixel"},
             {"explain near-benign --pixel 9999,0 -i sphere.unified", "has columns"},
             {"explain near-benign --ray 0,0,0,0,0,0 -i sphere.unified", "no ray"},
             {"explain near-benign --pixel 1,1 -i box.signs", "has no solids"},
             {"explain near-benign --pixel 1,1 -i sphere.double_inside -f f64", "does not exist"},
             {"explain near-benign --pixel 1,1 -i sphere.unified --json --c", "at most 1"},
             {"explain near-benign --pixel 1,1 -i sphere.unified -f p40 --c", "C has no type of 40 bits"}}) {
        const auto r = run(arguments);
        INFO(arguments);
        CHECK(r.code == 2);
        CHECK(has(r.err, says));
        CHECK(r.out.empty());
    }
}

TEST_CASE("culprits, cancellation and contributions are maps like any other, the same bytes for any number of threads") {
    const Scratch scratch;
    const std::string what = "map rtg-fig-7-3-4100-oblique -i sphere.schoolbook -i sphere.unified -f f32 --size 48x32 --metric culprit --metric cancellation --metric contribution:c --pixels csv -q ";
    REQUIRE(run(what + "-j 1 -o one", scratch.path()).code == 0);
    REQUIRE(run(what + "-j 2 -o two", scratch.path()).code == 0);
    int files = 0;
    for (const std::string& file : scratch.files()) {
        if (!file.starts_with("one/")) continue;
        CHECK(test::contents(scratch.path() / file) == test::contents(scratch.path() / ("two/" + file.substr(4))));
        ++files;
    }
    CHECK(files > 10);
    const auto text = test::contents(scratch.path() / "one/rtg-fig-7-3-4100-oblique/sphere.schoolbook.f32.csv");
    CHECK(has(text, "dot(o - centre, d)"));
    CHECK(has(text, "c = dot(o - centre, o - centre) - radius*radius"));

    const auto unknown = run("map near-benign -i sphere.schoolbook --metric contribution:dist -o out", scratch.path());
    CHECK(unknown.code == 2);
    CHECK(has(unknown.err, "did you mean \"disc\""));
    const auto sweep = run("sweep sphere-distance --metric culprit -o out", scratch.path());
    CHECK(sweep.code == 2);
    CHECK(has(sweep.err, "lostbits map"));
    CHECK_FALSE(std::filesystem::exists(scratch.path() / "out"));
}

TEST_CASE("a constant on the way to t is no place on the tape") {
    // Its value, 1 and more, was taken for one when the cancellation that a rounding goes through was looked for.
    const auto r = run("explain box-octree --size 24x18 --pixel 17,11 -i box.max_mult -f bf16 --json");
    REQUIRE(r.code == 0);
    const auto told = nlohmann::json::parse(r.out);
    CHECK(told["outcome"] == "agree_hit");
    CHECK(has(told["sentence"], "arrives as"));
}
