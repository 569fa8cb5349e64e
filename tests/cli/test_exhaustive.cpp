// `lostbits sweep` over every float of an axis, from the outside.
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "every_float.hpp"
#include "output/file/read_csv.hpp"
#include "output/shard/state_file.hpp"
#include "program.hpp"

namespace test_exhaustive {

using namespace lostbits::test;
using lostbits::output::file::CsvTable;

namespace {

const std::string small = every_float_to("0x1.6bp10");

std::string replaced(const std::string& what, const std::string& by) {
    std::string text = small;
    return text.replace(text.find(what), what.size(), by);
}

CsvTable table(const Scratch& folder, const std::string& name) {
    return lostbits::output::file::read_csv(folder.path() / name);
}
std::string cell(const CsvTable& table, const std::string& column, std::size_t row) {
    INFO(column);
    REQUIRE(table.find(column) != nullptr);
    return std::string(table.find(column)->cells.at(row));
}

double number(const std::string& text) { return std::strtod(text.c_str(), nullptr); }

/// What a command of a table's column says.
nlohmann::json explained(const std::string& command) {
    REQUIRE(command.starts_with("lostbits explain "));
    const auto r = must(command.substr(9) + " --json -q");
    return nlohmann::json::parse(r.out);
}

}  // namespace

TEST_CASE("every float between two: exact onsets, the worst of each binade, and a sentence that says it") {
    const Scratch scratch;
    const std::string file = scratch.write("s.toml", small);
    const auto r = must("sweep '" + file + "' -v -i sphere.schoolbook -i sphere.hearn_baker" + into(scratch, ""));
    const std::string sentence =
        "all 65537 floats between 0x1.69p+10 (1444) and 0x1.6bp+10 (1452) were tried: sphere.schoolbook on the ray "
        "beside "
        "decides rightly for every float up to 0x1.6a09eap+10 (1448.1549), and first fails at 0x1.6a09ecp+10 "
        "(1448.155): "
        "a false hit; it decides wrongly for ";
    CHECK(has(r.out, sentence));
    CHECK(has(r.out, "sphere.hearn_baker on the ray beside decides rightly for every one of them\n"));
    CHECK(has(r.out, "  131074 truths: "));
    const auto statements = table(scratch, "s/statements.csv");
    REQUIRE(statements.rows() == 4);
    CHECK(cell(statements, "statement", 0).starts_with(sentence));
    CHECK(cell(statements, "right_up_to_hex", 0) == "0x1.6a09eap+10");
    CHECK(cell(statements, "first_wrong_bits", 0) == "0x44b504f6");
    const auto fault = explained(cell(statements, "fault_explain", 0));
    CHECK(fault["outcome"] == "false_hit");
    // The neighbour is right.
    std::string before = cell(statements, "fault_explain", 0);
    before.replace(before.find("0x1.6a09ecp+10"), 14, "0x1.6a09eap+10");
    CHECK(explained(before)["outcome"] == "agree_miss");

    const auto binades = table(scratch, "s/binades.csv");
    REQUIRE(binades.rows() == 4);
    CHECK(cell(binades, "binade", 1) == "+2^10");
    const auto worst = explained(cell(binades, "worst_explain", 1));
    CHECK(number(cell(binades, "worst_ulp_error", 1)) == worst["ulp_error"].get<double>());
    CHECK(cell(binades, "worst_t_hex", 1) == worst["t"]["hex"]);
    CHECK(cell(binades, "worst_truth_hex", 1) == worst["truth"]["hex"]);
    CHECK(number(cell(binades, "ulp_error_at_most", 1)) >= std::fabs(worst["ulp_error"].get<double>()));

    const auto onsets = table(scratch, "s/onsets.csv");
    REQUIRE(onsets.rows() == 4 * 7);
    std::size_t found = 0;
    for (std::size_t i = 0; i < onsets.rows(); ++i) {
        if (cell(onsets, "found", i) != "1" || cell(onsets, "last_good_hex", i).empty()) continue;
        ++found;
        const auto good = static_cast<float>(number(cell(onsets, "last_good_hex", i)));
        CHECK(std::nextafter(good, HUGE_VALF) == static_cast<float>(number(cell(onsets, "first_bad_hex", i))));
        const auto there = explained(cell(onsets, "explain", i));
        if (cell(onsets, "event", i) != "lost_bits") CHECK(there["outcome"] == cell(onsets, "event", i));
        else CHECK(there["lost_bits"].get<double>() >= number(cell(onsets, "threshold", i)));
    }
    CHECK(found >= 1);
    CHECK(fs::exists(scratch.path() / "s/datapackage.json"));
    CHECK_FALSE(fs::exists(scratch.path() / "s/unfinished.state"));
}

TEST_CASE("a convention of the file is said, and holds for what explains a float") {
    const Scratch scratch;
    std::string touch = replaced("\"0x1.69p10\"\nto = \"0x1.6bp10\"", "1\nto = \"0x1.00001p0\"");
    touch.replace(touch.find("0.75, 0.75, 0"), 13, "0, 1, 0");  // it touches the sphere
    const std::string file = scratch.write("s.toml", "convention = \"open\"\n" + touch);
    const auto r = must("sweep '" + file + "' -i sphere.schoolbook" + into(scratch, ""));
    CHECK(has(r.out,
              "sphere.schoolbook, judged by the open solid, on the ray beside fails at the first of them already"));
    const auto statements = table(scratch, "s/statements.csv");
    CHECK(explained(cell(statements, "fault_explain", 0))["outcome"] == "false_hit");
}

TEST_CASE("a sweep over every float that is stopped goes on with --resume and leaves the same files") {
    const Scratch scratch;
    // Long enough to be stopped in the middle: 50 million floats.
    const std::string file = scratch.write("s.toml", replaced("\"0x1.6bp10\"", "\"0x1.6bp16\""));
    const std::string rows = "sweep '" + file + "' -i sphere.schoolbook -o ";
    const auto out = [&](const char* name) { return "'" + (scratch.path() / name).string() + "'"; };
    must("-q -j 2 " + rows + out("whole"));
    const auto state = scratch.path() / "parts/s/unfinished.state";
    int stops = 0;
    for (std::string more; stops < 20; more = " --resume") {
        const auto r = run(
            "-j 1 " + rows + out("parts") + more + " & child=$!; sleep 0.6; kill -TERM $child; wait $child; exit $?",
            ".", "set -m; ");
        if (!fs::exists(state)) break;
        ++stops;
        CHECK(has(r.err, "with --resume goes on from there"));
        const auto joined = run("merge '" + state.string() + "' -o " + out("joined"));
        CHECK(joined.code == 2);
        CHECK(has(joined.err, " floats of s were tried: a part is that of a run that was stopped"));
        CHECK_FALSE(fs::exists(scratch.path() / "parts/s/binades.csv"));
    }
    if (fs::exists(state)) must("-q " + rows + out("parts") + " --resume");
    CHECK(stops > 0);  // none: the machine is faster than the test foresees
    for (const char* name : {"binades.csv", "onsets.csv", "statements.csv", "lost_bits_max.png", "wrong.png"}) {
        const std::string whole = contents(scratch.path() / "whole/s" / name);
        CHECK_FALSE(whole.empty());
        const bool same = whole == contents(scratch.path() / "parts/s" / name);
        CHECK(same);
    }
    CHECK_FALSE(fs::exists(state));
}

TEST_CASE("a resume with another file, other forms, another version or a damaged state is refused") {
    const Scratch scratch;
    static_cast<void>(scratch.write("s.toml", small));
    const std::string sweep = "sweep s.toml -i sphere.press", resume = sweep + " --resume -o .";
    const auto none = run(resume, scratch.path());
    CHECK(none.code == 2);
    CHECK(has(none.err, "unfinished.state: there is no such file"));
    CHECK(scratch.files() == std::vector<std::string>{"s.toml"});
    const auto other_kind = run("sweep sphere-distance -i sphere.press --resume -o .", scratch.path());
    CHECK(other_kind.code == 2);
    CHECK(has(other_kind.err, "--resume: sphere-distance is not a sweep over every float"));
    // A state as a stopped run writes it, though all is tried: that of the only shard.
    const auto state_of = [&](const std::string& form) {
        must("-q sweep s.toml -i " + form + " --shard 1/1 -o parts", scratch.path());
        return contents(scratch.path() / "parts/shard-1-of-1/shard.state");
    };
    const std::string good = state_of("sphere.press");
    const auto write = [&](const std::string& state) {
        fs::remove_all(scratch.path() / "s");
        fs::create_directories(scratch.path() / "s");
        static_cast<void>(scratch.write("s/unfinished.state", state));
        static_cast<void>(scratch.write("s/manifest.json", R"({"schema": "lostbits-manifest/1", "program": "lostbits",
            "command": "lostbits sweep s.toml", "files": ["unfinished.state"]})"));
    };
    const auto refused = [&](const std::string& state, const std::string& what) {
        write(state);
        const auto r = run(resume, scratch.path());
        CHECK(r.code == 2);
        CHECK(has(r.err, what));
        CHECK_FALSE(fs::exists(scratch.path() / "s/binades.csv"));
    };
    /// The good one with other bytes in a place, and its own hash at the end.
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
    refused("lostbits-unfinished/3\nversion 0.1.0\n", "is damaged, or of another version");
    refused(state_of("sphere.unified"), "belongs to `lostbits sweep s.toml -i sphere.unified`");
    static_cast<void>(scratch.write("s.toml", small + "# changed\n"));
    refused(good, "belongs to a run that read other files");
    static_cast<void>(scratch.write("s.toml", small));
    write(good);
    must("-q " + resume, scratch.path());
    CHECK(table(scratch, "s/statements.csv").rows() == 2);
    // Of several sweeps those that have no state begin anew.
    static_cast<void>(scratch.write("t.toml", small));
    const std::string both = "-q sweep t.toml s.toml -i sphere.press --resume -o .";
    CHECK(has(run(both, scratch.path()).err, "t/unfinished.state: there is no such file"));
    write(good);
    must(both, scratch.path());
    CHECK(table(scratch, "s/statements.csv").rows() == 2);
    CHECK(table(scratch, "t/statements.csv").rows() == 2);
    // Without --resume it begins anew, and says that a state is there.
    write(good);
    const auto anew = must(sweep + " -o .", scratch.path());
    CHECK(has(anew.err, "this one begins anew (--resume goes on)"));
    CHECK_FALSE(fs::exists(scratch.path() / "s/unfinished.state"));
}

TEST_CASE("an axis of every float is of one format, and bad input leaves nothing behind") {
    const Scratch scratch;
    const std::string file = scratch.write("s.toml", small), out = into(scratch);
    const auto refused = [&](const std::string& arguments, const std::string& says) {
        const auto r = run("sweep " + arguments + out);
        CHECK(r.code == 2);
        CHECK(has(r.err, says));
        CHECK_FALSE(fs::exists(scratch.path() / "out"));
    };
    refused("'" + file + "' -f f64", "-f f64: s tries every number of one format, and that is f32; leave out -f");
    refused("'" + file + "' -f f32 -f bf16", "-f bf16: s tries");
    refused("'" + file + "' --metric condition", "--metric condition: s tries every float");
    refused("'" + file + "' --worst", "[search]");
    refused("'" + file + "' --seeds 2", "--seeds 2: s tries every float and draws nothing at random");
    refused("'" + file + "' --against sphere.unified", "--against sphere.unified: s tries every float");
    const std::string bad = scratch.write("bad.toml", replaced("\"0x1.69p10\"", "1444.1"));
    refused("'" + bad + "'", "bad.toml:10:8: axis.from is not a number of binary32");
    const std::string empty = scratch.write(
        "empty.toml", replaced("\"0x1.69p10\"\nto = \"0x1.6bp10\"", "\"0x1.690001p10\"\nto = \"0x1.6900011p10\""));
    refused("'" + empty + "'", "have no number of binary32 between them");
    const auto boxes = run("sweep '" + file + "' -i 'box.*'" + out);
    CHECK(boxes.code == 4);
    CHECK(has(boxes.err, "no selected form handles s"));
}

TEST_CASE("a claim may rest on every float of a range, and its verdict says how many") {
    const Scratch scratch;
    const auto claim = [](const std::string& id, const std::string& given, const std::string& expect) {
        return "[[claim]]\nid = \"" + id +
               "\"\nstatement = \"-\"\nsource = \"-\"\nverdict = \"holds\"\n[claim.given]\nsweep = "
               "\"s.toml\"\nform = \"sphere.schoolbook\"\nformat = \"f32\"\n" +
               given + "\n[claim.expect]\n" + expect + "\n";
    };
    static_cast<void>(scratch.write("s.toml", small));
    const std::string head = "schema = \"lostbits-claims/1\"\n", all = "exhaustive = true\nray = \"beside\"";
    const std::string onset = "onset = \"false_hit\"\nin = [\"0x1.6a09ecp10\", \"0x1.6a09ecp10\"]";
    const std::string range = "\nfrom = \"0x1.6ap10\"\nto = \"0x1.6a09eap10\"";
    static_cast<void>(scratch.write(
        "c.toml", head + claim("first", all, onset) + claim("before", all + range, "metric = \"wrong\"\nin = [0, 0]")));
    const auto r = must("-v check c.toml --export-csv c.csv --export-json c.json", scratch.path());
    CHECK(has(r.out, "ok       first (holds, all 65537 floats): 1448.155029296875\n"));
    CHECK(has(r.out, "ok       before (holds, all 1270 floats): 0\n"));
    const auto csv = table(scratch, "c.csv");
    CHECK(cell(csv, "floats", 0) == "65537");
    CHECK(explained(cell(csv, "witness_explain", 0))["outcome"] == "false_hit");
    CHECK(nlohmann::json::parse(contents(scratch.path() / "c.json"))[1]["floats"] == 1270);
    const auto broken = [&](const std::string& given, const std::string& expect, const std::string& says) {
        static_cast<void>(scratch.write("b.toml", head + claim("b", given, expect)));
        const auto b = run("check b.toml", scratch.path());
        CHECK(b.code == 2);
        CHECK(has(b.err, says));
    };
    broken("ray = \"beside\"", onset, "goes with `exhaustive = true`");
    broken("at = 3", "metric = \"wrong\"\nin = [0, 0]", "write `exhaustive = true` in claim.given");
    broken("exhaustive = true", onset, "names no ray");
    broken("exhaustive = true\nray = \"besides\"", onset, "did you mean \"beside\"");
    broken(all, "metric = \"lost_bits_p50\"\nin = [0, 1]", "which a sweep over every float does not measure");
    broken(all, "onset = \"lost_bits\"\nthreshold = 5\nin = [0, 1]", "no onset of \"lost_bits\" at that threshold");
    broken(all + "\nfrom = 1\nto = 2", onset, "lies outside the axis distance");
    broken(all + "\nfrom = 1444", onset, "one of from and to");
    static_cast<void>(scratch.write("b.toml", head + claim("b", all, "onset = \"false_miss\"\nin = [0, 1]")));
    const auto never = run("check b.toml", scratch.path());
    CHECK(never.code == 1);
    CHECK(has(never.out, "it does not happen at any of the floats"));
}

}  // namespace test_exhaustive
