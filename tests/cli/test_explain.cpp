// lostbits explain: the table, and the programs that it writes, which are run and compared to the bit.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <set>

#include "c_words.hpp"
#include "catch.hpp"
#include "counts.hpp"
#include "fpcore.hpp"
#include "intersect/table/table.hpp"
#include "program.hpp"
#include "scene_and_pixel.hpp"

namespace test_explain {

using namespace lostbits;
using namespace lostbits::test;

namespace {

const std::string far = "explain rtg-fig-7-3-4100-oblique --pixel 128,40 ";

}  // namespace

TEST_CASE("explain: operations with equal contributions are named with their sum") {
    const std::string oblique = "explain rtg-fig-7-3-4100-oblique -f f32 --pixel ";
    const auto cancel = nlohmann::json::parse(run(oblique + "60,60 -i sphere.schoolbook --json").out);
    CHECK(cancel["culprit"] == "c");
    REQUIRE(cancel["equals"].size() == 1);
    const auto contribution = [](const nlohmann::json& j, const std::string& name) {
        for (const auto& o : j["operations"]) {
            if (o["name"] == name) return o["contribution"].get<double>();
        }
        return 0.0;
    };
    CHECK(contribution(cancel, "c") == -contribution(cancel, cancel["equals"][0]));
    CHECK(
        has(cancel["sentence"],
            "; (o − centre)·(o − centre), from which it is computed, contributes the same with the opposite sign. The "
            "two undo each other: the error of 742 ulp comes from the other operations, the largest part, 2830 "
            "ulp, from a."));

    const auto add = nlohmann::json::parse(run(oblique + "100,100 -i sphere.pbrt_interval --json").out);
    REQUIRE(add["equals"].size() == 1);
    CHECK(contribution(add, add["largest"]) == contribution(add, add["equals"][0]));
    CHECK(
        has(add["largest_sentence"], ", from which it is computed, contributes the same: together 1 ulp; the other "));

    const auto many =
        nlohmann::json::parse(run("explain near-benign -f f64 --pixel 100,100 -i sphere.pbrt_interval --json").out);
    CHECK(many["equals"].size() == 5);
    CHECK(has(many["largest_sentence"],
              " and 2 more contribute the same, 3 of them with the opposite sign. They undo each "));
}

TEST_CASE("explain: the unified form beside a huge sphere loses c, and the problem is to blame") {
    const auto r = must("explain rtg-fig-7-4.r1e6 --pixel 100,200 -i sphere.unified -f f32");
    CHECK(has(r.out, "c = (o − centre)·(o − centre) − radius·radius cancels 18 of 24 bits"));
    // The inputs are numbers of f32: nothing is lost by rounding them, and in f64 the same numbers keep everything.
    CHECK_FALSE(has(r.out, "input rounding"));
    CHECK(has(r.out,
              "the problem is ill-conditioned in f32, and the formula loses no more. The inputs are exact: "
              "wider arithmetic on them helps."));
    const auto wide = run("explain rtg-fig-7-4.r1e6 --pixel 100,200 -i sphere.unified -f bf16");
    CHECK(has(wide.out, "input rounding alone explains this loss"));
}

TEST_CASE("explain: JSON holds every operation, and the contributions sum to the error") {
    for (const char* form : {"sphere.schoolbook", "sphere.pbrt_interval"}) {
        const auto j = nlohmann::json::parse(run(far + "-i " + form + " --json").out);
        double sum = 0;
        int culprits = 0;
        for (const auto& o : j["operations"]) {
            if (o.contains("contribution") && o["live"] == true) sum += o["contribution"].get<double>();
            culprits += o["name"] == j["largest"];
        }
        const double error = j["attribution"]["error"];
        CHECK(std::fabs(sum - error) <= 1e-9 * std::fabs(error));
        CHECK(culprits == 1);
        CHECK(j["inputs"]["radius"]["hex"] == "0x1p+0");
    }
}

namespace {

/// True if what a C program says of the computed and of the recorded t is the same, letter by letter.
bool says_the_same_twice(const std::string& said) {
    const auto line = [&](const std::string& word) {
        const auto at = said.find(word);
        return at == std::string::npos ? word : said.substr(at + word.size(), said.find('\n', at) - at - word.size());
    };
    return line("computed  ") == line("recorded  ");
}

}  // namespace

TEST_CASE("explain: C programs compile alone, compute the recorded bits and print the same text") {
    const Scratch scratch;
    int compiled = 0;
    std::map<std::string, std::map<std::string, int>> seen;  // words, by the format
    std::vector<std::pair<std::string, std::string>> questions;
    std::vector<const char*> formats{"f32", "p52"};  // with 52 bits, half of all results are ties
    if (test::is_long()) formats.insert(formats.end(), {"f64", "bf16"});
    for (const intersect::table::Intersector& form : intersect::table::intersectors()) {
        for (const char* format : formats) {
            if (form.info->formats == intersect::Formats::binary32_only && format != std::string("f32")) continue;
            questions.emplace_back(scene_and_pixel_of(form.shape) + " -i " + std::string(form.info->name), format);
        }
    }
    // Misses, whose t may be any NaN; the widest formats that round; an answer that is not a number.
    for (const char* more :
         {"near-benign --pixel 0,0 -i sphere.schoolbook", "near-benign --pixel 0,0 -i sphere.pythagoras",
          "box-one --pixel 0,0 -i box.signs", "sdf-sphere --pixel 0,0 -i sdf.sphere_trace"}) {
        for (const char* format : {"f32", "f64", "p26", "p52", "p53"}) questions.emplace_back(more, format);
    }
    for (const char* filtered : exact_step_rays)
        for (const char* format : {"f32", "f64", "p52"}) questions.emplace_back(filtered, format);
    std::multiset<std::string> refused;
    for (const auto& [what, format] : questions) {
        const auto r = run("explain " + what + " -f " + format + " --c");
        INFO(what << " in " << format << ": " << r.err);
        if (r.code == 2) {  // neighbours and fused operations of a format that is not C's
            CHECK(format != "f32");
            CHECK(format != "f64");
            CHECK(has(r.err, "try -f f32 or f64"));
            refused.insert(what.substr(what.find("-i ") + 3));
            continue;
        }
        REQUIRE(r.code == 0);
        if (!test::add_words(r.out, seen[format]) && !test::is_long()) continue;
        const std::string source = scratch.write("ray.c", r.out), program = (scratch / "ray").string();
        REQUIRE(std::system(("cc -std=c99 -O2 -o '" + program + "' '" + source + "' -lm").c_str()) == 0);
        CHECK(std::system(("'" + program + "' > '" + (scratch / "said").string() + "'").c_str()) == 0);
        const std::string said = test::contents(scratch / "said");
        INFO(said);
        CHECK(has(said, "computed  "));
        CHECK(says_the_same_twice(said));
        ++compiled;
    }
    CHECK(compiled > (test::is_long() ? 155 : 30));
    for (const char* filtered : {"sphere.filtered", "triangle.filtered"})
        refused.erase(filtered);        // where a ray used wider arithmetic and the program changes the format for it
    std::multiset<std::string> narrow;  // in p52, and in bf16
    for (std::size_t i = 0; i < formats.size() / 2; ++i)
        narrow.insert({"box.bvh_robust", "box.embree_fma", "ellipsoid.two_words", "plane.two_words",
                       "sphere.kahan_discriminant", "sphere.pbrt_interval", "triangle.pbrt", "triangle.woop_double",
                       "triangle.woop_once", "tube.pbrt_interval"});
    CHECK(refused == narrow);
    const std::string docs = test::contents(fs::path(LOSTBITS_DATA_DIR).parent_path() / "docs/explain.md");
    const auto from = docs.find("- forms that use a fused multiply-add:"), to = docs.find("- a filtered form", from);
    REQUIRE(to != std::string::npos);
    for (const intersect::table::Intersector& form : intersect::table::intersectors()) {
        const std::string name(form.info->name);
        INFO(name);
        CHECK(has(docs.substr(from, to - from), "`" + name + "`") == (narrow.count(name) > 0));
    }
}

TEST_CASE("explain: FPCore parses as s-expressions and evaluates to the recorded bits") {
    int evaluated = 0;
    for (const intersect::table::Intersector& form : intersect::table::intersectors()) {
        for (const std::string format : {"f32", "f64"}) {
            if (form.info->formats == intersect::Formats::binary32_only && format != "f32") continue;
            const auto place = &form - intersect::table::intersectors().data();
            if (!is_long() && (format == "f32" ? place % 2 != 0 : place % 4 != 1)) continue;
            const std::string where =
                "explain " + scene_and_pixel_of(form.shape) + " -i " + std::string(form.info->name) + " -f " + format;
            const auto r = must(where + " --fpcore");
            std::size_t at = 0;
            const auto core = test::read_expression(r.out, at);
            REQUIRE(core.list.at(0).atom == "FPCore");
            const auto j = nlohmann::json::parse(run(where + " --json").out);
            std::map<std::string, double> values;
            for (const auto& [key, value] : j["inputs"].items()) {
                std::string id = key;
                std::ranges::replace(id, '.', '_');
                values[id] = std::strtod(value["hex"].get<std::string>().c_str(), nullptr);
            }
            for (const auto& argument : core.list.at(1).list) CHECK(values.contains(argument.atom));
            test::FpCore evaluate(values, {.single = format == "f32"});
            const auto pre = std::ranges::find(core.list, ":pre", &test::SExpression::atom);
            REQUIRE(pre != core.list.end());
            for (std::size_t i = 1; i < (pre + 1)->list.size(); ++i) CHECK(evaluate((pre + 1)->list[i]) != 0);
            const double want = std::strtod(j["t"]["hex"].get<std::string>().c_str(), nullptr);
            const double got = evaluate(core.list.back());
            CHECK((got == want || (std::isnan(got) && std::isnan(want))));
            ++evaluated;
        }
    }
    CHECK(evaluated > 70);
}

TEST_CASE("explain: FPCore says how to get a neighbour and another precision") {
    const auto interval = run(far + "-i sphere.pbrt_interval --fpcore");
    CHECK(has(interval.out, "(! :round toPositive (+ s26 (* 1 (pow 2 -149))))"));
    const auto inside = run(far + "-i sphere.double_inside --fpcore");
    CHECK(has(inside.out, "(! :precision binary64 (cast radius))"));
    CHECK(has(inside.out, "(! :precision binary64 (* b b))"));
}

TEST_CASE("explain: a C program of many bits is refused where a constant is not a double") {
    const Scratch scratch;
    // radius·radius = 1e-300 < 2^-960
    const std::string text = replace_text(spoil_scene("radius = 1", "radius = \"1e-150\""), "shared", "own");
    const std::string scene = "explain '" + scratch.write("s.toml", text) + "' --pixel 12,8 -i sphere.press --c -f ";
    const auto r = run(scene + "p40");
    CHECK(r.code == 2);
    CHECK(has(r.err, "radius*radius is 1.0"));
    CHECK(has(r.err, "so close to the ends of double's range"));
    must(scene + "p20");
}

TEST_CASE("explain: an agreed miss has no culprit, whatever the form") {
    for (const char* what :
         {"near-benign --pixel 0,0 -i sphere.schoolbook", "box-one --pixel 0,0 -i box.inclusive",
          "sdf-sphere --pixel 0,0 -i sdf.sphere_trace", "sdf-sphere --pixel 0,0 -i sdf.accumulated"}) {
        const auto r = must(std::string("explain ") + what);
        CHECK(has(r.out, "Nothing is lost."));
        CHECK(has(r.out, "no operation is to blame"));
        CHECK_FALSE(has(r.out, "The culprit is"));
        CHECK_FALSE(has(r.out, "The contributions add up to"));
        CHECK_FALSE(has(r.out, "-nan"));
        CHECK_FALSE(has(r.out, "\n* s"));
        const auto j = nlohmann::json::parse(run(std::string("explain ") + what + " --json").out);
        CHECK(j["culprit"].is_null());
    }
}

TEST_CASE("explain: JSON writes null for missing values and words for numbers that are not finite") {
    const auto miss = nlohmann::json::parse(run("explain near-benign --pixel 0,0 -i sphere.schoolbook --json").out);
    for (const char* key :
         {"truth", "ulp_error", "lost_bits", "condition", "inherent_bits", "culprit", "given_direction"}) {
        INFO(key);
        CHECK(miss[key].is_null());
    }
    // The root of a negative discriminant: NaN is what the machine computed, and what it is without rounding.
    int words = 0;
    for (const auto& o : miss["operations"])
        words += o["operation"] == "sqrt" && o["computed"]["decimal"] == "nan" && o["exact"] == "nan";
    CHECK(words == 1);
    const auto hit = nlohmann::json::parse(run(far + "-i sphere.schoolbook --json").out);
    CHECK(hit["attribution"]["first_order"].is_string());  // an infinite derivative
    CHECK(hit["ulp_error"].is_number());
}

TEST_CASE("explain: a constant on the way to t has no operation on the tape") {
    // This value, 1 and more, was once taken for 1 in the search for the cancellation that a rounding passes through.
    const auto r = must("explain box-octree --size 24x18 --pixel 17,11 -i box.max_mult -f bf16 --json");
    const auto explanation = nlohmann::json::parse(r.out);
    CHECK(explanation["outcome"] == "wrong_primitive");  // the explained hit is one of another box
    CHECK(has(explanation["largest_sentence"], "accounts for"));
    CHECK(explanation["culprit"].is_null() == !has(explanation["sentence"], "The culprit is"));
}

TEST_CASE("explain: an overflow that changed a decision is blamed, not the roundings beside it") {
    const auto r = must(far + "-i sphere.schoolbook -f fp16");
    CHECK(has(r.out, "b·b is infinity. Everything after it follows from that."));
    CHECK(has(r.out, "Rounding changed the decision disc < 0: disc is not a number, without rounding -4.378"));
    CHECK_FALSE(has(r.out, "0 is 0"));
    CHECK_FALSE(has(r.out, "11.0 bits lost"));  // a form that loses all of them does not do better
    CHECK(has(run("explain world-offset-own --pixel 60,60 -i sphere.unified -f fp16").out,
              "The input o.x is infinity in fp16. Everything after it follows from that."));
}

}  // namespace test_explain
