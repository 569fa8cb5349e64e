// Claims from the outside: which claims agree, which do not, and the files for other programs.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"

namespace test_check {

using namespace lostbits::test;

namespace {

const std::string inside = "scene = \"camera-inside\"\n" + form_keys("sphere.unit_half_b");
const std::string all_missed = metric_keys("false_miss_fraction", "[1, 1]");
const std::string none_missed = metric_keys("false_miss_fraction", "[0, 0.5]");

}  // namespace

TEST_CASE("check: a claim about random rays must hold for every draw, and --seeds shows the spread") {
    const Scratch scratch;
    const std::string given = "sweep = \"sphere-distance\"\nat = 4096\n" + form_keys("sphere.schoolbook");
    const auto text = [&](const std::string& in) {
        return make_claim_file(
            {{"median", given, metric_keys("lost_bits_p50", in) + "draws = 2\n"}, {"scene", inside, all_missed}});
    };
    scratch.write("wide.toml", text("[0, 24]"));
    const auto all = must("check wide.toml --seeds 3 --export-json c.json --export-csv c.csv", scratch.path());
    const auto array = nlohmann::json::parse(contents(scratch / "c.json"));
    std::vector<double> draws{array[0]["measured"].get<double>()};
    for (const auto& x : array[0]["further_draws"]) draws.push_back(x.get<double>());
    REQUIRE(draws.size() == 4);
    CHECK(array[0]["samples"] == 1024);
    CHECK(array[0]["interval_draws"] == 2);
    CHECK(array[1]["samples"] == 0);  // a camera draws nothing
    CHECK(array[1]["further_draws"].empty());
    const auto [low, high] = std::ranges::minmax(draws);
    REQUIRE(low < high);
    const auto rows = read_csv(scratch / "c.csv");
    CHECK(rows[0].at("draws") == "4");
    CHECK(std::stod(rows[0].at("draw_low")) == low);
    CHECK(std::stod(rows[0].at("draw_high")) == high);
    CHECK((rows[1].at("draws").empty() && rows[1].at("draw_low").empty()));
    CHECK(has(all.out, "claims about random rays"));

    // The draw of the file alone would agree.
    const double own = draws.front();
    scratch.write("narrow.toml", text(fmt::format("[{0}, {0}]", own)));
    must("check narrow.toml", scratch.path());
    const auto failed = run("check narrow.toml --seeds 3", scratch.path());
    CHECK(failed.code == 1);
    CHECK(has(failed.out, fmt::format("measured {}, and {} to {} over 4 draws", own, low, high)));
    CHECK(has(run("check wide.toml --seeds 3 --measure", scratch.path()).out,
              fmt::format("median = {}; 4 draws: {} to {}", own, low, high)));
    check_refused_claims(scratch,
                         {{inside, all_missed + "draws = 32\n", "`draws` belongs to claims about random rays"}});
}

TEST_CASE("check: a claim that fails is named with the worst input and the command") {
    const Scratch scratch;
    // The last claim has no hit that form and truth agree on. A claim that cannot be measured is an error, never a
    // pass.
    scratch.write("c.toml", make_claim_file({{"right", inside, all_missed},
                                             {"wrong", inside, none_missed},
                                             {"empty", inside, metric_keys("lost_bits_p50", "[0, 24]")}}));
    const auto r = run("check c.toml --junit j.xml --export-json c.json --annotations github", scratch.path());
    CHECK(r.code == 1);
    CHECK(has(r.out, "FAILED: expected to hold, but does not: wrong (A sentence)"));
    CHECK(has(r.out, "measured 1"));
    CHECK(has(r.out, "lostbits map camera-inside -i sphere.unit_half_b -f f32"));
    CHECK(has(r.out, "::error file="));
    CHECK(has(r.out, "\nbroken: could not be measured: empty"));
    CHECK_FALSE(has(r.out, "right"));
    const std::string xml = contents(scratch / "j.xml");
    CHECK(has(xml, "tests=\"3\" failures=\"1\" errors=\"1\""));
    CHECK(has(xml, "<failure message="));
    CHECK(has(xml, "<error message="));
    const auto array = nlohmann::json::parse(contents(scratch / "c.json"));
    CHECK(array[0]["state"] == "agrees");
    CHECK(array[1]["state"] == "disagrees");
    CHECK(array[1]["measured"] == 1);
}

TEST_CASE("check: claims have a severity, a filter and a measure, and say what this machine lacks") {
    const Scratch scratch;
    scratch.write("c.toml", make_claim_file({{"soft", inside, none_missed, "severity = \"warn\"\n"},
                                             {"hard", inside, all_missed}}));
    const auto check = [&](const std::string& words) { return run("check c.toml" + words, scratch.path()); };
    CHECK(check("").code == 0);
    CHECK(check(" --strict").code == 1);
    CHECK(check(" --strict --filter 'h*'").code == 0);
    CHECK(check(" --filter nothing").code == 4);
    CHECK(check(" --measure").out == "soft = 1\nhard = 1\n");
    scratch.write("c.toml", make_claim_file({{"isa", inside + "requires = [\"isa-128\"]\n", all_missed}}));
    CHECK(check(" --junit j.xml").code == 0);
    CHECK(has(contents(scratch / "j.xml"), "skipped=\""));
    check_refused_claims(scratch, {{inside + "requires = [\"isa-127\"]\n", all_missed, "isa-127"}});
}

TEST_CASE("check: claims can be about a sweep, a step, an onset, a case, a cell of a plane and a row of a table") {
    const std::string form = form_keys("sphere.schoolbook"), f64 = form_keys("sphere.schoolbook", "f64"),
                      distance = "sweep = \"sphere-distance\"\n" + f64,
                      table = "table = \"arithmetic\"\nformat = \"f32\"\nat = 16777216\nrow = ";
    const ScratchFile file(
        "c.toml",
        make_claim_file(
            {// 2^26.5 = 94906265.6
             {"onset", distance, "onset = \"lost_bits\"\nstatistic = \"p50\"\nthreshold = 26.5\nin = [9.2e7, 9.8e7]\n"},
             {"place", distance + "at = 4096\n", metric_keys("lost_bits_p50", "[10, 14]")},
             {"case", "sweep = \"extremes/contact\"\ncase = \"one ulp outside the tangent\"\n" + form,
              metric_keys("false_hit_fraction", "[1, 1]")},
             {"plane", "sweep = \"sphere-height\"\nat = [1e6, 1]\n" + form, metric_keys("lost_bits_p50", "[15, 20]")},
             // 1 + 2^-24 is a tie and rounds to even; 1 - 2^-24 is a float.
             {"sum", table + "\"sum_power_of_two\"\n", metric_keys("fraction", "[1, 1]")},
             {"difference", table + "\"difference_power_of_two\"\n", metric_keys("fraction", "[0, 0]")}}));
    must("check '" + file.path().string() + "'");
}

TEST_CASE("check: claims can be about culprits, cancellation and contributions") {
    const Scratch scratch;
    const std::string form = form_keys("sphere.schoolbook"), given = "scene = \"rtg-fig-7-3-4100-oblique\"\n" + form,
                      fd = "operation = \"dot(o - centre, d)\"\n";
    const auto share = [](const std::string& operation, const std::string& in = "[0, 1]") {
        return metric_keys("culprit_fraction", in) + operation;
    };
    scratch.write(
        "c.toml",
        make_claim_file(
            {{"fd", given, share(fd, "[0.45, 0.5]")},
             {"c", given, share("operation = \"c\"\n", "[0.5, 0.53]")},
             {"both", given, share("operation = [\"c\", \"dot(o - centre, d)\", \"c\"]\n", "[0.995, 0.9999]")},
             {"median", given, metric_keys("contribution_c_p50", "[1900, 2000]")},
             {"all", given, metric_keys("cancellation_p50", "[24, 24]")},
             {"disc", given, metric_keys("cancellation_disc_max", "[24, 24]")},
             {"none", given, metric_keys("cancellation_c_max", "[0, 0]")},
             {"sweep", "sweep = \"sphere-distance\"\nat = 4100\n" + form, share("operation = \"c\"\n", "[0.5, 0.7]")},
             {"case", "sweep = \"extremes/contact\"\ncase = \"*\"\n" + form,
              metric_keys("cancellation_max", "[0, 24]")}}));
    must("check c.toml --export-json c.json", scratch.path());
    const auto array = nlohmann::json::parse(contents(scratch / "c.json"));
    CHECK(array[0]["quantity"] == "culprit_fraction of dot(o - centre, d)");
    const std::string map = "lostbits map rtg-fig-7-3-4100-oblique -i sphere.schoolbook -f f32 --metric ";
    CHECK(array[0]["reproduce"] == map + "culprit -o out");
    CHECK(array[5]["reproduce"] == map + "cancellation:disc -o out");
    CHECK(array[2]["measured"].get<double>() ==
          Approx(array[0]["measured"].get<double>() + array[1]["measured"].get<double>()));
    check_refused_claims(
        scratch,
        {{given, share("operation = \"disk\"\n"),
          "c.toml:14:13: sphere.schoolbook has no operation \"disk\"; did you mean \"disc\"?"},
         {given, share("operation = \"dot(o - centre, e)\"\n"), "did you mean \"dot(o - centre, d)\"?"},
         {given, share("operation = \"|f|\"\n"), "sphere.schoolbook has no operation"},  // sphere.factored_c has
         {given, share(""), "c.toml:12:10: claim[0].expect.metric needs an operation"},
         {given, share("operation = []\n"), "c.toml:14:13"},
         {given, metric_keys("lost_bits_p50") + "operation = \"c\"\n",
          "c.toml:14:1: claim[0].expect.operation needs metric"},
         {given, metric_keys("contribution:c_p50"),
          "c.toml:12:10: unknown metric \"contribution:c_p50\" of sphere.schoolbook; did you mean "
          "\"contribution_c_p50\"?"},
         {given, metric_keys("contribution_disk_p50"), "did you mean \"contribution_disc_p50\"?"},
         {given, metric_keys("cancelation_p50"), "did you mean \"cancellation_p50\"?"},
         {given, metric_keys("culprit_fracton"), "did you mean \"culprit_fraction\"?"}});
}

TEST_CASE("check: times are measured on request and never fail a check") {
    const Scratch scratch;
    const std::string head = "profile = \"timing\"\n",
                      scalar = "timing = \"one_ray_many_boxes\"\nkernel = \"scalar\"\ndata = \"l1\"\n" +
                               form_keys("box.signs"),
                      over = scalar + "over = { kernel = \"128\" }\n", all = metric_keys("speed_ratio", "[1e-3, 1e3]");
    scratch.write("t.toml", make_claim_file({{"t.never", over, metric_keys("speed_ratio", "[1e6, 1e7]")},
                                             {"t.always", over, all},
                                             {"t.skipped", over + "requires = [\"isa-512\", \"isa-256\"]\n", all}},
                                            head));
    const auto r = must("check t.toml --profile timing", scratch.path());
    CHECK(r.out.starts_with("differs  holds"));
    CHECK(has(r.out, "as found holds"));
    check_refused_claims(scratch,
                         {{scalar, all, "over"},
                          {over, all, "severity", "severity = \"warn\"\n"},
                          {scalar + "over = { kernel = \"127\" }\n", all, "kernels are scalar"},
                          {scalar + "over = { form = \"box.sign\" }\n", all, "box.sign"},
                          {scalar + "all_processors = true\n", all, "speedup_per_processor"},
                          {inside, all, "timing"}},
                         head, " --profile timing");
    check_refused_claims(scratch, {{scalar, all, "profile = \"timing\""}});
    check_refused_claims(scratch, {{inside, all, "timing"}}, "profile = \"times\"\n");
}

TEST_CASE("check: bad claims are refused with their line") {
    const Scratch scratch;
    const auto given = [](const std::string& subject, const std::string& form = "sphere.press",
                          const std::string& format = "f32") { return subject + "\n" + form_keys(form, format); };
    const std::string scene = "scene = \"camera-inside\"";
    check_refused_claims(
        scratch,
        {{given(""), all_missed, "scene"},
         {given("scene = \"camera-insid\""), all_missed, "camera-inside"},
         {given(scene, "sphere.pres"), all_missed, "or --function); did you mean \"sphere.press\"?\n"},
         {given(scene, "mylib.mine"), all_missed,
          "load a form of your own with --plugin, --pipe, --shader or --function"},
         {inside + "size = [64, 48]\n", all_missed, "claim[0].given.size is the scene's own"},
         {given(scene, "sphere.press", "f33"), all_missed, "f32"},
         {inside, metric_keys("false_mis_fraction"), "false_miss_fraction"},
         {inside, metric_keys("false_miss_fraction", "[1, 0]"), "low"},
         {inside, "metric = \"false_miss_fraction\"\n", "in"},
         {inside, "onset = \"lost_bits\"\nin = [0, 1]\n", "sweep"},
         {given("sweep = \"extremes/contact\"\ncase = \"eye at the center\""), all_missed, "eye at the centre"},
         {given("sweep = \"sphere-height\"\nat = 1"), all_missed, "2 axes"},
         {"table = \"arithmetic\"\nrow = \"summ\"\nformat = \"f32\"\nat = 1\n", metric_keys("fraction"), "sum"},
         {inside, all_missed, "severity", "sverity = \"warn\"\n"}});
}

TEST_CASE("check: the command of a claim computes what the claim is about") {
    const Scratch scratch;
    must(
        "check -q --filter 'sdf3.miss.0.x' --filter shader.unit-half-b-direction --filter "
        "rtg7.fig3.schoolbook-f32-4100-axis-false-hits --export-json claims.json",
        scratch.path());
    std::map<std::string, std::string> command;
    for (const auto& claim : nlohmann::json::parse(contents(scratch / "claims.json"))) {
        command[claim.at("id")] = claim.at("reproduce");
        must(command[claim.at("id")].substr(std::string("lostbits ").size()), scratch.path());
    }
    // A step of a march is not in any map; a metric that is measured only on request is requested.
    CHECK(has(command.at("sdf3.miss.0.x"), " explain "));
    CHECK(has(command.at("shader.unit-half-b-direction"), " --metric model_error "));
    CHECK_FALSE(has(command.at("rtg7.fig3.schoolbook-f32-4100-axis-false-hits"), "--metric"));
    CHECK(has(contents(scratch / "out/near-benign/summary.csv"), "model_error_max"));
}

TEST_CASE("check: a claim can be about one ray of a scene, and user files and variants are named by path") {
    const Scratch scratch;
    const std::string scene =
        "schema = \"lostbits-scene/1\"\ntitle = \"mine\"\nsize = [8, 8]\n[camera]\nkind = \"orthographic\"\n"
        "eye = [0, 0, 4100]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\nwidth = 4\n[[sphere]]\ncentre = [0, 0, 0]\n"
        "radius = 1\n";
    scratch.write("mine.toml", scene);
    scratch.write("two.toml", scene +
                                  "[[variant]]\nname = \"far\"\nset = { \"sphere[0].radius\" = 1 }\n"
                                  "[[variant]]\nname = \"wide\"\nset = { \"sphere[0].radius\" = 4 }\n");
    must("map mine.toml -i sphere.schoolbook -f f32 --pixels csv" + into(scratch), scratch.path());
    std::vector<ClaimText> claims;
    std::size_t hits = 0;
    for (const auto& pixel : read_csv(scratch / "out/mine/sphere.schoolbook.f32.csv")) {
        const std::string at = "pixel = [" + pixel.at("x") + ", " + pixel.at("y") + "]\n",
                          id = pixel.at("x") + "-" + pixel.at("y"), &outcome = pixel.at("outcome");
        const std::string given = "scene = \"mine.toml\"\n" + at + form_keys("sphere.schoolbook");
        claims.push_back({id, given, metric_keys(outcome, "[1, 1]")});
        if (outcome != "agree_hit") continue;
        ++hits;
        const std::string lost = pixel.at("lost_bits");
        claims.push_back({id + "-bits", given, metric_keys("lost_bits_max", "[" + lost + ", " + lost + "]")});
    }
    CHECK(hits > 3);
    CHECK(claims.size() == 64 + hits);
    claims.push_back(
        {"wide", "scene = \"two.toml.wide\"\n" + form_keys("sphere.unified"), metric_keys("agree_hit", "[64, 64]")});
    scratch.write("claims.toml", make_claim_file(claims));
    must("check claims.toml", scratch.path());
    // Beside the claims, from anywhere.
    must("check '" + (scratch / "claims.toml").string() + "'", "/");
    const std::string one = "scene = \"mine.toml\"\npixel = ";
    check_refused_claims(
        scratch,
        {{one + "[8, 0]\n" + form_keys("sphere.unified"), metric_keys("agree_hit"), "columns 0 to 7"},
         {one + "[0, -1]\n" + form_keys("sphere.unified"), metric_keys("agree_hit"), "pixel[1]"},
         {one + "[0, 0]\nstep = 1\n" + form_keys("sphere.unified"), metric_keys("agree_hit"), "together with step"},
         {"sweep = \"sphere-distance\"\nat = 4\npixel = [0, 0]\n" + form_keys("sphere.unified"),
          metric_keys("agree_hit"), "needs a scene"}});
}

}  // namespace test_check
