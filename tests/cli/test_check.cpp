// Claims from the outside: what agrees, what does not, and what a machine reads of it.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"

namespace test_check {

using namespace lostbits::test;

namespace {

const std::string head = "schema = \"lostbits-claims/1\"\n";

std::string claim(const std::string& id, const std::string& given, const std::string& expect,
                  const std::string& more = "") {
    return "[[claim]]\nid = \"" + id + "\"\nstatement = \"A sentence\"\nsource = \"-\"\nverdict = \"holds\"\n" + more +
           "[claim.given]\n" + given + "[claim.expect]\n" + expect;
}

const std::string inside = "scene = \"camera-inside\"\nform = \"sphere.unit_half_b\"\nformat = \"f32\"\n";
const std::string all_missed = "metric = \"false_miss_fraction\"\nin = [1, 1]\n";
const std::string none_missed = "metric = \"false_miss_fraction\"\nin = [0, 0.5]\n";

}  // namespace

TEST_CASE("a claim about random rays must hold of every draw, and check --seeds shows the spread") {
    const Scratch scratch;
    const std::string given =
        "sweep = \"sphere-distance\"\nat = 4096\nform = \"sphere.schoolbook\"\nformat = \"f32\"\n";
    const auto text = [&](const std::string& in) {
        return head + claim("median", given, "metric = \"lost_bits_p50\"\nin = " + in + "\ndraws = 2\n") +
               claim("scene", inside, all_missed);
    };
    const std::string json = (scratch.path() / "c.json").string(), csv = (scratch.path() / "c.csv").string();
    const std::string wide = scratch.write("wide.toml", text("[0, 24]"));
    const auto all = run("check '" + wide + "' --seeds 3 --export-json '" + json + "' --export-csv '" + csv + "'");
    INFO(all.out << all.err);
    REQUIRE(all.code == 0);
    const auto array = nlohmann::json::parse(contents(json));
    std::vector<double> draws{array[0]["measured"].get<double>()};
    for (const auto& x : array[0]["further_draws"]) draws.push_back(x.get<double>());
    REQUIRE(draws.size() == 4);
    CHECK(array[0]["samples"] == 1024);
    CHECK(array[0]["interval_draws"] == 2);
    CHECK(array[1]["samples"] == 0);  // a camera draws nothing
    CHECK(array[1]["further_draws"].empty());
    const auto [low, high] = std::ranges::minmax(draws);
    REQUIRE(low < high);
    const auto rows = read_csv(csv);
    CHECK(rows[0].at("draws") == "4");
    CHECK(std::stod(rows[0].at("draw_low")) == low);
    CHECK(std::stod(rows[0].at("draw_high")) == high);
    CHECK((rows[1].at("draws").empty() && rows[1].at("draw_low").empty()));
    CHECK(all.out.find("claims about random rays") != std::string::npos);

    // The file's own draw alone would agree.
    const double own = draws.front();
    const std::string narrow = scratch.write("narrow.toml", text(fmt::format("[{0}, {0}]", own)));
    CHECK(run("check '" + narrow + "'").code == 0);
    const auto failed = run("check '" + narrow + "' --seeds 3");
    INFO(failed.out);
    CHECK(failed.code == 1);
    CHECK(failed.out.find(fmt::format("measured {}, and {} to {} over 4 draws", own, low, high)) != std::string::npos);
    const auto measured = run("check '" + wide + "' --seeds 3 --measure");
    CHECK(measured.out.find(fmt::format("median = {}; 4 draws: {} to {}", own, low, high)) != std::string::npos);
    CHECK(run("check --seeds -1").code == 2);
    const auto both = run("check '" + wide + "' --measure --export-csv '" + csv + "'");
    CHECK(both.code == 2);
    CHECK(both.err.find("it judges nothing; leave one of them out") != std::string::npos);
    const std::string still = scratch.write("still.toml", head + claim("scene", inside, all_missed + "draws = 32\n"));
    const auto nothing = run("check '" + still + "'");
    CHECK(nothing.code == 2);
    CHECK(nothing.err.find("`draws` belongs to claims about random rays") != std::string::npos);
}

TEST_CASE("a claim that does not measure as stated fails, by name, with the worst input and the command") {
    const Scratch scratch;
    const std::string file =
        scratch.write("c.toml", head + claim("right", inside, all_missed) + claim("wrong", inside, none_missed));
    const std::string junit = (scratch.path() / "j.xml").string(), json = (scratch.path() / "c.json").string();
    const auto r =
        run("check '" + file + "' --junit '" + junit + "' --export-json '" + json + "' --annotations github");
    CHECK(r.code == 1);
    CHECK(r.out.find("FAILED: expected to hold, does not: wrong (A sentence)") != std::string::npos);
    CHECK(r.out.find("measured 1") != std::string::npos);
    CHECK(r.out.find("lostbits map camera-inside -i sphere.unit_half_b -f f32") != std::string::npos);
    CHECK(r.out.find("::error file=") != std::string::npos);
    CHECK(r.out.find("right") == std::string::npos);
    const std::string xml = contents(junit);
    CHECK(xml.find("tests=\"2\" failures=\"1\" errors=\"0\"") != std::string::npos);
    CHECK(xml.find("<failure message=") != std::string::npos);
    const auto array = nlohmann::json::parse(contents(json));
    CHECK(array[0]["state"] == "agrees");
    CHECK(array[1]["state"] == "disagrees");
    CHECK(array[1]["measured"] == 1);
}

TEST_CASE("what cannot be measured is an error, never a pass") {
    const Scratch scratch;
    // No hit is agreed on, so there is no error to take a quantile of.
    const std::string file =
        scratch.write("c.toml", head + claim("empty", inside, "metric = \"lost_bits_p50\"\nin = [0, 24]\n"));
    const auto r = run("check '" + file + "' --junit '" + (scratch.path() / "j.xml").string() + "'");
    CHECK(r.code == 1);
    CHECK(r.out.find("broken") == 0);
    CHECK(contents(scratch.path() / "j.xml").find("<error message=") != std::string::npos);
}

TEST_CASE("severity, filter and measure") {
    const Scratch scratch;
    const std::string file =
        scratch.write("c.toml", head + claim("soft", inside, none_missed, "severity = \"warn\"\n") +
                                    claim("hard", inside, all_missed));
    CHECK(run("check '" + file + "'").code == 0);
    CHECK(run("check '" + file + "' --strict").code == 1);
    CHECK(run("check '" + file + "' --strict --filter 'h*'").code == 0);
    CHECK(run("check '" + file + "' --filter nothing").code == 4);
    CHECK(run("check '" + file + "' --measure").out == "soft = 1\nhard = 1\n");
}

TEST_CASE("a claim along a sweep, at a place and by its onset") {
    const Scratch scratch;
    const std::string given = "sweep = \"sphere-distance\"\nform = \"sphere.schoolbook\"\nformat = \"f64\"\n";
    // 2^26.5 = 94906265.6
    const std::string file = scratch.write(
        "c.toml", head +
                      claim("onset", given,
                            "onset = \"lost_bits\"\nstatistic = \"p50\"\nthreshold = 26.5\nin = [9.2e7, 9.8e7]\n") +
                      claim("place", given + "at = 4096\n", "metric = \"lost_bits_p50\"\nin = [10, 14]\n"));
    const auto r = run("check '" + file + "'");
    INFO(r.out);
    CHECK(r.code == 0);
}

TEST_CASE("a claim about a case, a place of a plane and a row of a table") {
    const Scratch scratch;
    const std::string form = "form = \"sphere.schoolbook\"\nformat = \"f32\"\n";
    const std::string file = scratch.write(
        "c.toml",
        head +
            claim("case", "sweep = \"extremes/contact\"\ncase = \"one ulp outside the tangent\"\n" + form,
                  "metric = \"false_hit_fraction\"\nin = [1, 1]\n") +
            claim("plane", "sweep = \"sphere-height\"\nat = [1e6, 1]\n" + form,
                  "metric = \"lost_bits_p50\"\nin = [15, 20]\n") +
            // 1 + 2^-24 is a tie and goes to even, 1 - 2^-24 is a float.
            claim("sum", "table = \"arithmetic\"\nrow = \"sum_power_of_two\"\nformat = \"f32\"\nat = 16777216\n",
                  "metric = \"fraction\"\nin = [1, 1]\n") +
            claim("difference",
                  "table = \"arithmetic\"\nrow = \"difference_power_of_two\"\nformat = \"f32\"\nat = 16777216\n",
                  "metric = \"fraction\"\nin = [0, 0]\n"));
    const auto r = run("check '" + file + "'");
    INFO(r.out << r.err);
    CHECK(r.code == 0);
}

TEST_CASE("claims about culprits, cancellation and contributions") {
    const Scratch scratch;
    const std::string given = "scene = \"rtg-fig-7-3-4100-oblique\"\nform = \"sphere.schoolbook\"\nformat = \"f32\"\n",
                      share = "metric = \"culprit_fraction\"\n";
    const std::string fd = "\"dot(o - centre, d)\"", in = "in = [0, 1]\n";
    const std::string file = scratch.write(
        "c.toml",
        head + claim("fd", given, share + "operation = " + fd + "\nin = [0.45, 0.5]\n") +
            claim("c", given, share + "operation = \"c\"\nin = [0.5, 0.53]\n") +
            claim("both", given, share + "operation = [\"c\", " + fd + ", \"c\"]\nin = [0.995, 0.9999]\n") +
            claim("median", given, "metric = \"contribution_c_p50\"\nin = [1900, 2000]\n") +
            claim("all", given, "metric = \"cancellation_p50\"\nin = [24, 24]\n") +
            claim("disc", given, "metric = \"cancellation_disc_max\"\nin = [24, 24]\n") +
            claim("none", given, "metric = \"cancellation_c_max\"\nin = [0, 0]\n") +
            claim("sweep", "sweep = \"sphere-distance\"\nat = 4100\nform = \"sphere.schoolbook\"\nformat = \"f32\"\n",
                  share + "operation = \"c\"\nin = [0.5, 0.7]\n") +
            claim("case",
                  "sweep = \"extremes/contact\"\ncase = \"*\"\nform = \"sphere.schoolbook\"\nformat = \"f32\"\n",
                  "metric = \"cancellation_max\"\nin = [0, 24]\n"));
    const std::string json = (scratch.path() / "c.json").string();
    const auto r = run("check '" + file + "' --export-json '" + json + "'");
    INFO(r.out << r.err);
    CHECK(r.code == 0);
    const auto array = nlohmann::json::parse(contents(json));
    CHECK(array[0]["quantity"] == "culprit_fraction of dot(o - centre, d)");
    CHECK(array[0]["reproduce"] ==
          "lostbits map rtg-fig-7-3-4100-oblique -i sphere.schoolbook -f f32 --metric culprit -o out");
    CHECK(array[5]["reproduce"] ==
          "lostbits map rtg-fig-7-3-4100-oblique -i sphere.schoolbook -f f32 --metric \"cancellation:disc\" -o out");
    CHECK(array[2]["measured"].get<double>() ==
          Approx(array[0]["measured"].get<double>() + array[1]["measured"].get<double>()));

    const std::string before =
        head +
        "[[claim]]\nid = \"a\"\nstatement = \"A sentence\"\nsource = \"-\"\nverdict = \"holds\"\n[claim.given]\n" +
        given + "[claim.expect]\n";
    const std::pair<std::string, std::string> bad[] = {
        {share + "operation = \"disk\"\n" + in,
         "c.toml:13:13: sphere.schoolbook has no operation \"disk\"; did you mean \"disc\"?"},
        {share + "operation = \"dot(o - centre, e)\"\n" + in, "did you mean \"dot(o - centre, d)\"?"},
        {share + "operation = \"|f|\"\n" + in, "sphere.schoolbook has no operation"},  // sphere.factored_c has
        {share + in, "c.toml:12:10: claim[0].expect.metric needs an operation"},
        {share + "operation = []\n" + in, "c.toml:13:13"},
        {"metric = \"lost_bits_p50\"\noperation = \"c\"\n" + in,
         "c.toml:13:1: claim[0].expect.operation goes with metric"},
        {"metric = \"contribution:c_p50\"\n" + in,
         "c.toml:12:10: unknown metric \"contribution:c_p50\" of sphere.schoolbook; did you mean "
         "\"contribution_c_p50\"?"},
        {"metric = \"contribution_disk_p50\"\n" + in, "did you mean \"contribution_disc_p50\"?"},
        {"metric = \"cancelation_p50\"\n" + in, "did you mean \"cancellation_p50\"?"},
        {"metric = \"culprit_fracton\"\n" + in, "did you mean \"culprit_fraction\"?"},
    };
    for (const auto& [text, says] : bad) {
        const auto refused = run("check '" + scratch.write("c.toml", before + text) + "'");
        INFO(text << refused.err);
        CHECK(refused.code == 2);
        CHECK(refused.err.find(says) != std::string::npos);
    }
}

TEST_CASE("what this machine lacks is skipped, what nobody knows is refused") {
    const Scratch scratch;
    const std::string junit = (scratch.path() / "j.xml").string();
    const std::string here =
        scratch.write("c.toml", head + claim("isa", inside + "requires = [\"isa-128\"]\n", all_missed));
    const auto r = run("check '" + here + "' --junit '" + junit + "'");
    CHECK(r.code == 0);
    CHECK(contents(junit).find("skipped=\"") != std::string::npos);
    CHECK(run("check '" +
              scratch.write("d.toml", head + claim("isa", inside + "requires = [\"isa-127\"]\n", all_missed)) + "'")
              .code == 2);
}

TEST_CASE("times are measured when asked for, and fail nothing") {
    const Scratch scratch;
    const std::string timing_head = head + "profile = \"timing\"\n";
    const std::string scalar =
        "timing = \"one_ray_many_boxes\"\nform = \"box.signs\"\nkernel = \"scalar\"\nformat = \"f32\"\ndata = \"l1\"\n";
    const std::string impossible = "metric = \"speed_ratio\"\nin = [1e6, 1e7]\n",
                      all = "metric = \"speed_ratio\"\nin = [1e-3, 1e3]\n";
    const std::string file = scratch.write(
        "t.toml",
        timing_head + claim("t.never", scalar + "over = { kernel = \"128\" }\n", impossible) +
            claim("t.always", scalar + "over = { kernel = \"128\" }\n", all) +
            claim("t.skipped", scalar + "over = { kernel = \"128\" }\nrequires = [\"isa-512\", \"isa-256\"]\n", all));
    const auto r = run("check '" + file + "' --profile timing");
    INFO(r.out << r.err);
    CHECK(r.code == 0);
    CHECK(r.out.find("differs  holds") == 0);
    CHECK(r.out.find("as found holds") != std::string::npos);
    CHECK(run("check '" + file + "'").code == 4);
    CHECK(run("check '" + file + "'").err.find("--profile timing") != std::string::npos);
    CHECK(run("check --filter 'speed.*'").code == 4);
    for (const std::string gate : {"--strict", "--junit j.xml", "--report r", "--export-csv c.csv"})
        CHECK(run("check '" + file + "' --profile timing " + gate, scratch.path()).code == 2);
    CHECK(scratch.files() == std::vector<std::string>{"t.toml"});
    const std::pair<std::string, std::string> bad[] = {
        {head + claim("a", scalar, all), "profile = \"timing\""},
        {timing_head + claim("a", scalar, all), "over"},
        {timing_head + claim("a", scalar + "over = { kernel = \"128\" }\n", all, "severity = \"warn\"\n"), "severity"},
        {timing_head + claim("a", scalar + "over = { kernel = \"127\" }\n", all), "kernels are scalar"},
        {timing_head + claim("a", scalar + "over = { form = \"box.sign\" }\n", all), "box.sign"},
        {timing_head + claim("a", scalar + "all_processors = true\n", all), "speedup_per_processor"},
        {timing_head + claim("a", inside, all), "timing"},
        {head + "profile = \"times\"\n" + claim("a", inside, all), "timing"},
    };
    for (const auto& [text, says] : bad) {
        INFO(text);
        const auto refused = run("check '" + scratch.write("b.toml", text) + "' --profile timing");
        INFO(refused.err);
        CHECK(refused.code == 2);
        CHECK(refused.err.find(says) != std::string::npos);
    }
}

TEST_CASE("bad claims are refused with their place") {
    const Scratch scratch;
    struct Case {
        std::string text;
        const char* says;
    };
    const Case cases[] = {
        {head + claim("a", inside, all_missed) + claim("a", inside, all_missed), "twice"},
        {head + claim("a", "form = \"sphere.press\"\nformat = \"f32\"\n", all_missed), "scene"},
        {head + claim("a", "scene = \"camera-insid\"\nform = \"sphere.press\"\nformat = \"f32\"\n", all_missed),
         "camera-inside"},
        {head + claim("a", "scene = \"camera-inside\"\nform = \"sphere.pres\"\nformat = \"f32\"\n", all_missed),
         "sphere.press"},
        {head + claim("a", "scene = \"camera-inside\"\nform = \"mylib.mine\"\nformat = \"f32\"\n", all_missed),
         "a form of your own comes by --plugin, --pipe or --shader"},
        {head + claim("a", inside + "size = [64, 48]\n", all_missed), "claim[0].given.size is the scene's own"},
        {head + claim("a", "scene = \"camera-inside\"\nform = \"sphere.press\"\nformat = \"f33\"\n", all_missed),
         "f32"},
        {head + claim("a", inside, "metric = \"false_mis_fraction\"\nin = [0, 1]\n"), "false_miss_fraction"},
        {head + claim("a", inside, "metric = \"false_miss_fraction\"\nin = [1, 0]\n"), "low"},
        {head + claim("a", inside, "metric = \"false_miss_fraction\"\n"), "in"},
        {head + claim("a", inside, "onset = \"lost_bits\"\nin = [0, 1]\n"), "sweep"},
        {head + claim("a",
                      "sweep = \"extremes/contact\"\nform = \"sphere.press\"\nformat = \"f32\"\ncase = \"eye at the "
                      "center\"\n",
                      all_missed),
         "eye at the centre"},
        {head +
             claim("a", "sweep = \"sphere-height\"\nform = \"sphere.press\"\nformat = \"f32\"\nat = 1\n", all_missed),
         "2 axes"},
        {head + claim("a", "table = \"arithmetic\"\nrow = \"summ\"\nformat = \"f32\"\nat = 1\n",
                      "metric = \"fraction\"\nin = [0, 1]\n"),
         "sum"},
        {head + claim("a", inside, all_missed, "sverity = \"warn\"\n"), "severity"},
    };
    for (const Case& c : cases) {
        INFO(c.text);
        const auto r = run("check '" + scratch.write("c.toml", c.text) + "'");
        INFO(r.err);
        CHECK(r.code == 2);
        CHECK(r.err.find("c.toml:") != std::string::npos);
        CHECK(r.err.find(c.says) != std::string::npos);
    }
    CHECK(run("check missing.toml").code == 2);
    CHECK(run("check --junit /proc/no/j.xml").code == 3);
}

TEST_CASE("the command of a claim writes what the claim is about") {
    const Scratch scratch;
    const auto file = scratch.path() / "claims.json";
    REQUIRE(run("check -q --filter 'sdf3.miss.0.x' --filter shader.unit-half-b-direction --filter "
                "rtg7.fig3.schoolbook-f32-4100-axis-false-hits --export-json '" +
                file.string() + "'")
                .code == 0);
    std::map<std::string, std::string> command;
    for (const auto& claim : nlohmann::json::parse(contents(file))) command[claim.at("id")] = claim.at("reproduce");
    // A step of a march is in no map; a metric that is not measured unasked is asked for.
    CHECK(command.at("sdf3.miss.0.x").find(" explain ") != std::string::npos);
    CHECK(command.at("shader.unit-half-b-direction").find(" --metric model_error ") != std::string::npos);
    CHECK(command.at("rtg7.fig3.schoolbook-f32-4100-axis-false-hits").find("--metric") == std::string::npos);
    for (const auto& [id, text] : command) {
        INFO(text);
        std::string arguments = text.substr(text.find(' ') + 1);
        if (const auto out = arguments.find("-o out"); out != std::string::npos)
            arguments.replace(out, 6, "-o '" + (scratch.path() / "out").string() + "'");
        CHECK(run(arguments).code == 0);
    }
    CHECK(contents(scratch.path() / "out/near-benign/summary.csv").find("model_error_max") != std::string::npos);
}

}  // namespace test_check
