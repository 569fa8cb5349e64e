// `lostbits sweep` over every float of an axis, from the outside.
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "every_float.hpp"
#include "output/shard/state_file.hpp"
#include "program.hpp"
#include "run_explain.hpp"

namespace test_exhaustive {

using namespace lostbits::test;

namespace {

const std::string small = every_float_to("0x1.6bp10");

std::string spoil(const std::string& what, const std::string& by) { return replace_text(small, what, by); }

}  // namespace

TEST_CASE("a sweep over every float between two bounds gives exact onsets and the worst of each binade") {
    const Scratch scratch;
    const std::string file = scratch.write("s.toml", small);
    const auto r = must("sweep '" + file + "' -v -i sphere.schoolbook -i sphere.hearn_baker" + into(scratch, ""));
    const std::string sentence =
        "all 65537 floats between 0x1.69p+10 (1444) and 0x1.6bp+10 (1452) were tried: sphere.schoolbook on the ray "
        "beside decides correctly for every float up to 0x1.6a09eap+10 (1448.1549), and first fails at 0x1.6a09ecp+10 "
        "(1448.155): a false hit; it is wrong for ";
    CHECK(has(r.out, sentence));
    CHECK(has(r.out, "sphere.hearn_baker on the ray beside decides correctly for every one of them\n"));
    CHECK(has(r.out, "  131074 truths: "));
    const auto statements = read_csv(scratch / "s/statements.csv");
    REQUIRE(statements.size() == 4);
    CHECK(statements[0].at("statement").starts_with(sentence));
    CHECK(statements[0].at("right_up_to_hex") == "0x1.6a09eap+10");
    CHECK(statements[0].at("first_wrong_bits") == "0x44b504f6");
    const auto fault = run_explain(statements[0].at("fault_explain"));
    CHECK(fault["outcome"] == "false_hit");
    // The neighbour is right.
    const auto before = replace_text(statements[0].at("fault_explain"), "0x1.6a09ecp+10", "0x1.6a09eap+10");
    CHECK(run_explain(before)["outcome"] == "agree_miss");

    const auto binades = read_csv(scratch / "s/binades.csv");
    REQUIRE(binades.size() == 4);
    CHECK(binades[1].at("binade") == "+2^10");
    const auto worst = run_explain(binades[1].at("worst_explain"));
    CHECK(number_in(binades[1].at("worst_ulp_error")) == worst["ulp_error"].get<double>());
    CHECK(binades[1].at("worst_t_hex") == worst["t"]["hex"]);
    CHECK(binades[1].at("worst_truth_hex") == worst["truth"]["hex"]);
    CHECK(number_in(binades[1].at("ulp_error_at_most")) >= std::fabs(worst["ulp_error"].get<double>()));

    const auto onsets = read_csv(scratch / "s/onsets.csv");
    REQUIRE(onsets.size() == 4 * 7);
    std::size_t found = 0;
    for (std::size_t i = 0; i < onsets.size(); ++i) {
        if (onsets[i].at("found") != "1" || onsets[i].at("last_good_hex").empty()) continue;
        ++found;
        const auto good = static_cast<float>(number_in(onsets[i].at("last_good_hex")));
        CHECK(std::nextafter(good, HUGE_VALF) == static_cast<float>(number_in(onsets[i].at("first_bad_hex"))));
        const auto there = run_explain(onsets[i].at("explain"));
        if (onsets[i].at("event") != "lost_bits") CHECK(there["outcome"] == onsets[i].at("event"));
        else CHECK(there["lost_bits"].get<double>() >= number_in(onsets[i].at("threshold")));
    }
    CHECK(found >= 1);
    CHECK(fs::exists(scratch / "s/datapackage.json"));
    CHECK_FALSE(fs::exists(scratch / "s/unfinished.state"));
}

TEST_CASE("the convention of a sweep file is reported, and applies when a float is explained") {
    const Scratch scratch;
    const std::string touch = replace_text(spoil("\"0x1.69p10\"\nto = \"0x1.6bp10\"", "1\nto = \"0x1.00001p0\""),
                                           "0.75, 0.75, 0", "0, 1, 0");  // it touches the sphere
    const std::string file = scratch.write("s.toml", "convention = \"open\"\n" + touch);
    const auto r = must("sweep '" + file + "' -i sphere.schoolbook" + into(scratch, ""));
    CHECK(has(r.out,
              "sphere.schoolbook, judged by the open primitive, on the ray beside already fails at the first of them"));
    const auto statements = read_csv(scratch / "s/statements.csv");
    CHECK(run_explain(statements[0].at("fault_explain"))["outcome"] == "false_hit");
}

TEST_CASE("a stopped sweep over every float resumes with --resume and leaves the same files") {
    const Scratch scratch;
    // Long enough to be stopped in the middle: 50 million floats.
    const std::string file = scratch.write("s.toml", spoil("\"0x1.6bp10\"", "\"0x1.6bp16\""));
    const std::string first = scratch.write("first.toml", small),
                      rows = "sweep '" + first + "' '" + file + "' -i sphere.schoolbook -o ";
    const auto out = [&](const char* name) { return "'" + (scratch.path() / name).string() + "'"; };
    must("-q -j 2 " + rows + out("whole"));
    const auto state = scratch / "parts/s/unfinished.state", ended = scratch / "parts/s/binades.csv",
               first_state = scratch / "parts/first/unfinished.state";
    int stops = 0;
    for (std::string more; stops < 20; more = " --resume") {
        const auto r = run("-j 1 " + rows + out("parts") + more + end_after(0.6, "TERM"), ".", "set -m; ");
        if (fs::exists(ended)) break;
        ++stops;
        CHECK(has(r.err, "with --resume to continue"));
        if (!fs::exists(state)) continue;  // stopped in the first sweep
        CHECK(has(contents(scratch / "parts/s/UNFINISHED.txt"), "Run that command again with --resume"));
        // The first sweep is finished, and its state tells this to the run that continues.
        CHECK(fs::exists(scratch / "parts/first/binades.csv"));
        CHECK(fs::exists(first_state));
        const auto joined = run("merge '" + state.string() + "' -o " + out("joined"));
        CHECK(joined.code == 2);
        CHECK(has(joined.err, " floats of s were tried: one of the shards was stopped"));
    }
    if (!fs::exists(ended)) must("-q " + rows + out("parts") + " --resume");
    CHECK(stops > 0);  // none: the machine is faster than the test expects
    for (const char* name : {"binades.csv", "onsets.csv", "statements.csv", "lost_bits_max.png", "wrong.png"}) {
        const std::string whole = contents(scratch / "whole/s" / name);
        CHECK_FALSE(whole.empty());
        const bool same = whole == contents(scratch / "parts/s" / name);
        CHECK(same);
    }
    CHECK_FALSE(fs::exists(state));
    CHECK_FALSE(fs::exists(first_state));
}

TEST_CASE("a sweep resumed with another file, form or version or a damaged state is refused") {
    const Scratch scratch;
    scratch.write("s.toml", small);
    const std::string sweep = "sweep s.toml -i sphere.press", resume = sweep + " --resume -o .";
    // A state as a stopped run writes it, but with all floats tried: the state of the only shard.
    const auto state_of = [&](const std::string& form) {
        must("-q sweep s.toml -i " + form + " --shard 1/1 -o parts", scratch.path());
        return contents(scratch / "parts/shard-1-of-1/shard.state");
    };
    const std::string good = state_of("sphere.press");
    const auto write = [&](const std::string& state) {
        fs::remove_all(scratch / "s");
        fs::create_directories(scratch / "s");
        scratch.write("s/unfinished.state", state);
        scratch.write("s/manifest.json", R"({"schema": "lostbits-manifest/1", "program": "lostbits",
            "command": "lostbits sweep s.toml", "files": ["unfinished.state"]})");
    };
    const auto refused = [&](const std::string& state, const std::string& what) {
        write(state);
        const auto r = run(resume, scratch.path());
        CHECK(r.code == 2);
        CHECK(has(r.err, what));
        CHECK_FALSE(fs::exists(scratch / "s/binades.csv"));
    };
    /// The valid state with other bytes in one place, and its own hash at the end.
    const auto forged = [&](std::size_t at, const std::string& by, std::size_t size) {
        std::string state = good.substr(0, good.size() - 8);
        state.replace(at, size, by);
        lostbits::output::shard::InputHash hash;
        hash.add(state);
        const std::uint64_t sum = hash.value();
        return state.append(reinterpret_cast<const char*>(&sum), sizeof sum);
    };
    const std::size_t program = good.find("program lostbits ") + 17, shard = good.find("shard 1/1") + 6,
                      tried = good.find("\n\n") + 2 + 8 + std::string("sweep s").size() + 8;
    const std::size_t version = good.find('\n', program) - program;
    refused(forged(program, "0.0.0", version),
            "was written by lostbits 0.0.0, and this is lostbits " + good.substr(program, version));
    refused(forged(shard, "1/2", 3), "belongs to shard 1/2, and this is 1/1");
    refused(forged(tried, std::string(8, '\0'), 8), "is damaged");
    refused(forged(good.size() - 12, "", 4), "is damaged");
    refused(good.substr(0, good.size() - 9), "is damaged");
    refused("lostbits-unfinished/3\nversion 0.1.0\n", "is damaged or from another version");
    refused(state_of("sphere.unified"), "belongs to `lostbits sweep s.toml -i sphere.unified`");
    scratch.write("s.toml", small + "# changed\n");
    refused(good, "belongs to a run that read other files");
    scratch.write("s.toml", small);
    write(good);
    must("-q " + resume, scratch.path());
    CHECK(read_csv(scratch / "s/statements.csv").size() == 2);
    // Sweeps without a saved state start again.
    scratch.write("t.toml", small);
    const std::string both = "-q sweep t.toml s.toml -i sphere.press --resume -o .";
    CHECK(has(run(both, scratch.path()).err, "t/unfinished.state: does not exist"));
    write(good);
    must(both, scratch.path());
    CHECK(read_csv(scratch / "s/statements.csv").size() == 2);
    CHECK(read_csv(scratch / "t/statements.csv").size() == 2);
    // Without --resume it begins again, and reports that a state exists.
    write(good);
    const auto anew = must(sweep + " -o .", scratch.path());
    CHECK(has(anew.err, "this run starts from the beginning (to continue that one, use --resume)"));
    CHECK_FALSE(fs::exists(scratch / "s/unfinished.state"));
}

TEST_CASE("a claim may rest on every float of a range, and its verdict gives the count") {
    const Scratch scratch;
    scratch.write("s.toml", small);
    const std::string given = "sweep = \"s.toml\"\n" + form_keys("sphere.schoolbook"),
                      all = given + "exhaustive = true\nray = \"beside\"\n",
                      onset = "onset = \"false_hit\"\nin = [\"0x1.6a09ecp10\", \"0x1.6a09ecp10\"]\n",
                      range = "from = \"0x1.6ap10\"\nto = \"0x1.6a09eap10\"\n", none = metric_keys("wrong", "[0, 0]");
    scratch.write("c.toml", make_claim_file({{"first", all, onset}, {"before", all + range, none}}));
    const auto r = must("-v check c.toml --export-csv c.csv --export-json c.json", scratch.path());
    CHECK(has(r.out, "ok       first (holds, all 65537 floats): 1448.155029296875\n"));
    CHECK(has(r.out, "ok       before (holds, all 1270 floats): 0\n"));
    const auto row = read_csv(scratch / "c.csv").front();
    CHECK(row.at("floats") == "65537");
    CHECK(run_explain(row.at("witness_explain"))["outcome"] == "false_hit");
    CHECK(nlohmann::json::parse(contents(scratch / "c.json"))[1]["floats"] == 1270);
    check_refused_claims(
        scratch,
        {{given + "ray = \"beside\"\n", onset, "needs `exhaustive = true`"},
         {given + "at = 3\n", none, "write `exhaustive = true` in claim.given"},
         {given + "exhaustive = true\n", onset, "names no ray"},
         {given + "exhaustive = true\nray = \"besides\"\n", onset, "did you mean \"beside\""},
         {all, metric_keys("lost_bits_p50"), "which a sweep over every float does not measure"},
         {all, "onset = \"lost_bits\"\nthreshold = 5\nin = [0, 1]\n", "no onset of \"lost_bits\" at that threshold"},
         {all + "from = 1\nto = 2\n", onset, "lies outside the axis distance"},
         {all + "from = 1444\n", onset, "one of from and to"}});
    scratch.write("b.toml", make_claim_file({{"b", all, "onset = \"false_miss\"\nin = [0, 1]\n"}}));
    const auto never = run("check b.toml", scratch.path());
    CHECK(never.code == 1);
    CHECK(has(never.out, "it does not happen at any of the floats"));
}

}  // namespace test_exhaustive
