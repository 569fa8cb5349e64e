// Criteria of claims: verdicts follow from them and are counted by source. Also claims about a choice for a scene, in
// the profile `timing`, which fails nothing.
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "catch.hpp"
#include "program.hpp"

namespace test_criterion {

using namespace lostbits::test;

namespace {

const std::string given = "scene = \"camera-inside\"\n" + form_keys("sphere.unit_half_b");
const std::string holds = "\"holds\"", refuted = "\"refuted\"",
                  qualified = "\"qualified\"\ncondition = \"where the eye is outside\"";

/// The measured value is 1: no ray from inside is hit.
std::string expect(const std::string& in, const std::string& criterion) {
    return metric_keys("false_miss_fraction", in) + (criterion.empty() ? "" : "criterion = " + criterion + "\n");
}

ClaimText claim(const std::string& id, const std::string& verdict, const std::string& in, const std::string& criterion,
                const std::string& source = "-") {
    return {id, given, expect(in, criterion), "", verdict, source};
}

}  // namespace

TEST_CASE("a verdict follows from its criterion for every number that its interval admits") {
    const Scratch scratch;
    scratch.write(
        "right.toml",
        make_claim_file({claim("a", holds, "[1, 1]", "\"= 1\""), claim("b", holds, "[0.5, 1]", "\"> 0.4\""),
                         claim("c", holds, "[0.5, 1]", "\">= 0.5\""), claim("d", holds, "[1, 1]", "[0.9, 1]"),
                         claim("e", holds, "[1, 1]", "\"<=0x1p0\""), claim("f", refuted, "[1, 1]", "\"< 1\""),
                         claim("g", refuted, "[0.5, 1]", "\"= 0\""), claim("h", refuted, "[0.5, 1]", "[0, 0.4]"),
                         claim("i", refuted, "[0.5, 1]", "\"> 1\""), claim("j", qualified, "[1, 1]", "\"= 0\""),
                         claim("k", qualified, "[1, 1]", "\"= 1\""), claim("l", holds, "[1, 1]", "")}));
    must("check right.toml", scratch.path());
    const auto row = [](const std::string& verdict, const std::string& in, const std::string& criterion,
                        const std::string& says) {
        return RefusedClaim{given, expect(in, criterion), says, "", verdict};
    };
    const std::string does_not_follow = ": the verdict \"";
    check_refused_claims(
        scratch,
        {row(holds, "[1, 1]", "\"= 0\"",
             "c.toml:14:13: claim[0].expect.criterion is = 0, which is false of the numbers in [1, 1]: the verdict "
             "\"holds\" does not follow"),
         row(holds, "[0.5, 1]", "\"> 0.5\"", "is > 0.5, which is true of some and false of others"),
         row(refuted, "[1, 1]", "\"= 1\"", "which is true of the numbers in [1, 1]: the verdict \"refuted\""),
         row(refuted, "[0.5, 1]", "\">= 1\"", does_not_follow + "refuted\""),
         row(qualified, "[0.5, 1]", "\"= 1\"", does_not_follow + "qualified\""),
         row("\"qualified\"", "[1, 1]", "\"= 1\"", "c.toml:6:11: claim[0].verdict is qualified; say when"),
         row("\"holds\"\ncondition = \"never\"", "[1, 1]", "", "c.toml:7:13: claim[0].condition needs"),
         row(holds, "[1, 1]", "\"1\"", "c.toml:14:13: claim[0].expect.criterion is \"1\"; write"),
         row(holds, "[1, 1]", "\">\"", "write what the sentence says"),
         row(holds, "[1, 1]", "\"!= 0\"", "write what the sentence says"),
         row(holds, "[1, 1]", "\"= one\"", "in which one is not a number"),
         row(holds, "[1, 1]", "1", "a string is expected here"), row(holds, "[1, 1]", "[1, 0]", "must be [low, high]"),
         row("\"maybe\"", "[1, 1]", "", "claim[0].verdict is \"maybe\"")});
}

TEST_CASE("a quotation has at most twelve words, and a source") {
    const Scratch scratch;
    const auto claims = [&](const std::string& source, const std::string& quotation) {
        return scratch.write(
            "c.toml",
            make_claim_file({claim("q", holds + "\nquotation = \"" + quotation + "\"", "[1, 1]", "", source)}));
    };
    const std::string twelve = "one two three four five six seven eight nine ten eleven twelve";
    must("check '" + claims("Fell", twelve) + "' --export-csv q.csv --report report", scratch.path());
    CHECK(read_csv(scratch / "q.csv").at(0).at("quotation") == twelve);
    const std::string page = contents(scratch / "report/README.md");
    CHECK(has(page, "stand below 1 of the sentences"));
    CHECK(has(page, " <br> \"" + twelve + "\""));
    for (const auto& [source, quotation, says] :
         {std::tuple{"Fell", twelve + " more", "c.toml:7:13: claim[0].quotation has 13 words; quote at most 12"},
          std::tuple{"Fell", std::string(), "claim[0].quotation is empty"},
          std::tuple{"-", std::string("ours"), "claim[0].quotation needs a source"}}) {
        const auto r = run("check '" + claims(source, quotation) + "'");
        INFO(r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err, says));
    }
}

TEST_CASE("a number that leaves its interval reports whether the verdict still holds") {
    const Scratch scratch;
    const std::string text = make_claim_file(
        {claim("stands", holds, "[0.8, 0.9]", "\"> 0.5\""), claim("falls", holds, "[0.1, 0.2]", "\"< 0.5\""),
         claim("still", refuted, "[0.8, 0.9]", "\"= 0\""), claim("describes", holds, "[0.8, 0.9]", "")});
    const auto r = run("check '" + scratch.write("c.toml", text) + "'");
    CHECK(r.code == 1);
    CHECK(has(r.out, "FAILED: holds, but the number has changed: stands"));
    CHECK(has(r.out,
              "in [0.8, 0.9], measured 1; the statement says > 0.5: the number has changed, but the verdict stands"));
    CHECK(has(r.out, "FAILED: expected to hold, but does not: falls"));
    CHECK(has(r.out, "in [0.1, 0.2], measured 1; the statement says < 0.5: the verdict no longer follows"));
    CHECK(has(r.out, "FAILED: refuted, but the number has changed: still"));
    CHECK(has(r.out, "the statement says = 0: the number has changed, but the verdict stands"));
    CHECK(has(r.out, "FAILED: expected to hold, but does not: describes"));
}

TEST_CASE("claims quoted from a source are counted apart from our own everywhere") {
    const Scratch scratch;
    const std::string file = scratch.write(
        "c.toml",
        make_claim_file(
            {claim("a", holds, "[1, 1]", "\"= 1\"", "A book"), claim("b", refuted, "[1, 1]", "\"= 0\"", "A book"),
             claim("c", qualified, "[1, 1]", "\"= 0\"", "A book"), claim("d", holds, "[1, 1]", ""),
             claim("e", holds, "[1, 1]", "\"> 0\""), claim("f", refuted, "[0.8, 0.9]", "\"= 0\"", "A book")}));
    const auto at = [&](const char* name) { return (scratch.path() / name).string(); };
    const auto r = run("check '" + file + "' --junit '" + at("j.xml") + "' --export-csv '" + at("c.csv") +
                       "' --export-json '" + at("c.json") + "' --report '" + at("report") + "'");
    CHECK(r.code == 1);
    const std::string counts = "from a source: 1 holds, 1 is qualified, 1 is refuted; our own: 2 hold";
    CHECK(has(r.out, "5 verdicts confirmed, 1 failed\n" + counts + "\n"));
    const std::string xml = contents(at("j.xml"));
    CHECK(has(xml, "<property name=\"from a source\" value=\"1 holds, 1 is qualified, 1 is refuted\""));
    CHECK(has(xml, "<property name=\"our own\" value=\"2 hold\""));
    const auto rows = read_csv(at("c.csv"));
    REQUIRE(rows.size() == 6);
    const auto array = nlohmann::json::parse(contents(at("c.json")));
    for (std::size_t i = 0; i < rows.size(); ++i) {
        CHECK(rows[i].at("sourced") == (i < 3 || i == 5 ? "1" : "0"));
        CHECK(array[i]["sourced"] == (i < 3 || i == 5));
        // A cell that a spreadsheet would compute begins with an apostrophe.
        const std::string cell = rows[i].at("criterion");
        CHECK(array[i]["criterion"] == cell.substr(cell.starts_with("'") ? 1 : 0));
        CHECK(array[i]["condition"] == rows[i].at("condition"));
    }
    CHECK(rows[0].at("criterion") == "'= 1");
    CHECK(rows[3].at("criterion").empty());
    CHECK(rows[2].at("verdict") == "qualified");
    CHECK(rows[2].at("condition") == "where the eye is outside");
    CHECK(rows[0].at("condition").empty());
    const std::string document = contents(at("report") + "/README.md");
    CHECK(has(document,
              "6 claims, each a sentence or a part of one, of which 1 failed or could not be measured: " + counts));
    CHECK(has(document, "The verdicts on 4 follow from what the statement says about the number"));
    CHECK(has(document, "| qualified: where the eye is outside | A sentence |"));
    CHECK(has(document, "false_miss_fraction = 1; says = 0 |"));
    CHECK(has(run("check '" + file + "' --filter d -v").out, "ok       d (holds): 1"));
    CHECK(has(run("check '" + file + "' --filter c -v").out, "ok       c (qualified, where the eye is outside): 1"));
}

TEST_CASE("a 99th percentile of random rays has order-statistic bounds, and that of a picture has none") {
    const Scratch scratch;
    const std::string form = form_keys("sphere.unified"), sweep = "sweep = \"sphere-distance\"\nat = 4096\n" + form;
    const std::string in = "[0, 24]", p99 = metric_keys("lost_bits_p99", in);
    const std::string file =
        scratch.write("c.toml", make_claim_file({{"p99", sweep, p99},
                                                 {"low", sweep, metric_keys("lost_bits_p99_low", in)},
                                                 {"high", sweep, metric_keys("lost_bits_p99_high", in)},
                                                 {"median", sweep, metric_keys("lost_bits_p50", in)},
                                                 {"picture", "scene = \"near-benign\"\n" + form, p99}}));
    const auto at = [&](const char* name) { return (scratch.path() / name).string(); };
    must("check '" + file + "' --export-json '" + at("c.json") + "'");
    const auto array = nlohmann::json::parse(contents(at("c.json")));
    const auto measured = [&](int i) { return array[i]["measured"].get<double>(); };
    CHECK(array[0]["p99_bounds"] == nlohmann::json{measured(1), measured(2)});
    CHECK(measured(1) < measured(0));
    CHECK(measured(0) < measured(2));
    CHECK(array[3]["p99_bounds"].is_null());
    CHECK(array[4]["p99_bounds"].is_null());
    must("check '" + file + "' --filter p99 --report '" + at("report") + "'");
    CHECK(has(contents(at("report") + "/README.md"), " (95 %: "));
}

namespace {

const std::string far_away = "1095.9, 2191.7, -3287.2]\n";
const std::string scene =
    scene_text("[[sphere]]\nradius = 1\ncentre = [" + far_away, "size = [24, 24]\n",
               "kind = \"orthographic\"\nwidth = 2.5\neye = [0.1, 0.2, 0.3]\nlook_at = [" + far_away);

const std::string head = "profile = \"timing\"\n", choice = "choose = \"far.toml\"\n",
                  unified = choice + form_keys("sphere.unified"), schoolbook = choice + form_keys("sphere.schoolbook"),
                  double_inside = choice + form_keys("sphere.double_inside") + "bits = 24\nformats = [\"f32\"]\n";

}  // namespace

TEST_CASE("a criterion may be about the forms that meet a requirement, and about ratios of times") {
    const Scratch scratch;
    scratch.write("far.toml", scene);
    const std::vector<std::tuple<std::string, std::string, double>> rows{
        {unified + "bits = 18\n", "meets", 1},
        {unified + "bits = 23\n", "meets", 0},
        {schoolbook + "bits = 1\n", "meets", 0},  // it decides rays wrongly
        {schoolbook + "bits = 1\nwrong = 1\n", "meets", 1},
        {unified + "bits = 53\nformats = [\"f32\"]\n", "others_that_meet", 0},
        // sphere.double_inside alone is right to half an ulp. The claim's own form does not count.
        {unified + "bits = 24\nformats = [\"f32\"]\n", "others_that_meet", 1},
        {double_inside, "others_that_meet", 0},
        {double_inside, "chosen", 1},
        {unified + "bits = 24\n", "chosen", 0},
        {unified + "over = { format = \"f64\" }\n", "time_ratio", 1},
        {unified + "over = {}\n", "time_ratio", 1}};  // the same over itself: about 1
    std::vector<ClaimText> claims;
    for (const auto& [given, metric, right] : rows)
        claims.push_back({"c" + std::to_string(claims.size()), given, metric_keys(metric, "[-1, 1000]")});
    scratch.write("c.toml", make_claim_file(claims, head));
    std::istringstream said(must("check c.toml --profile timing --measure", scratch.path()).out);
    for (const auto& [given, metric, right] : rows) {
        INFO(given << metric);
        std::string id, equals;
        double measured = -1;
        said >> id >> equals >> measured;
        if (metric == "time_ratio") CHECK(measured > 0.01);
        else CHECK(measured == right);
    }
}

TEST_CASE("a claim about a choice never fails a check, and wrong words are refused with their line") {
    const Scratch scratch;
    scratch.write("far.toml", scene);
    scratch.write("d.toml", make_claim_file({{"d", unified + "bits = 23\n", metric_keys("meets", "[1, 1]")}}, head));
    CHECK(has(must("check d.toml --profile timing", scratch.path()).out, "differs"));
    const std::string eighteen = unified + "bits = 18\n", meets = metric_keys("meets"),
                      ratio = metric_keys("time_ratio"), chosen = metric_keys("chosen");
    check_refused_claims(scratch,
                         {{unified, meets, "needs a requirement"},
                          {unified + "bits = 54\n", meets, "0 and 53"},
                          {eighteen + "wrong = 2\n", meets, "share"},
                          {eighteen + "at = \"p100\"\n", meets, "p99.9"},
                          {eighteen + "at = \"p99\"\nover = { format = \"f64\" }\n", ratio, "one of the two"},
                          {eighteen, ratio, "others_that_meet"},
                          {eighteen, metric_keys("meet"), "unknown metric"},
                          {unified + "over = { format = \"f64\" }\n", chosen, "time_ratio"},
                          {unified + "over = { form = \"sphere.unifed\" }\n", ratio, "sphere.unified"},
                          {unified + "over = { forms = \"sphere.press\" }\n", ratio, "forms"},
                          {unified + "over = { format = \"fp16\" }\n", ratio, "emulated"},
                          {eighteen + "formats = [\"f31\"]\n", chosen, "f31"},
                          {eighteen + "formats = [\"bf16\"]\n", chosen, "emulated"},
                          {eighteen + "bit = 3\n", meets, "bits"},
                          {choice + form_keys("box.signs") + "bits = 18\n", meets, "other primitives"}},
                         head, " --profile timing");
    check_refused_claims(scratch, {{eighteen, meets, "profile = \"timing\""}}, "profile = \"results\"\n");
}

}  // namespace test_criterion
