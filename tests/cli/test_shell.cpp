// Integration with the shell: completion, the manual page, and tables on standard output.
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>

#include "catch.hpp"
#include "program.hpp"

namespace test_shell {

using namespace lostbits::test;

namespace {

/// Through a shell of its own: what it printed, and how it ended.
Outcome shell(const std::string& program, const std::string& script, const Scratch& scratch) {
    const std::string file = scratch.write("script", script);
    const auto out = (scratch / "said").string();
    const int status = std::system((program + " '" + file + "' >'" + out + "' 2>&1 </dev/null").c_str());
    return {status == 0 ? 0 : 1, contents(out), ""};
}

bool there_is(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

/// Completions that bash offers for the last word, requested as readline does.
std::set<std::string> offered(const std::vector<std::string>& words, const Scratch& scratch) {
    std::string script = "export LOSTBITS_DATA='" LOSTBITS_DATA_DIR "'\ncd '" + scratch.path().string() +
                         "'\nsource <('" LOSTBITS_PROGRAM "' completion bash)\nCOMP_WORDS=('" LOSTBITS_PROGRAM "'";
    for (const std::string& word : words) script += " '" + word + "'";
    script += ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_lostbits\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n";
    const Outcome said = shell("bash", script, scratch);
    CHECK(said.code == 0);
    std::set<std::string> all;
    std::istringstream in(said.out);
    for (std::string line; std::getline(in, line);) all.insert(line);
    all.erase("");
    return all;
}

/// The long options that the help of a command names.
std::set<std::string> options_in_help(const std::string& command) {
    const std::string help = run(command + " --help").out;
    std::set<std::string> names;
    const std::regex option(R"(^ +(?:-[a-z],)?(--[a-z-]+))");
    std::istringstream in(help);
    for (std::string line; std::getline(in, line);) {
        std::smatch found;
        if (std::regex_search(line, found, option)) names.insert(found[1]);
    }
    return names;
}

using Words = std::set<std::string>;

}  // namespace

TEST_CASE("bash completes commands, options, names and values") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    CHECK(offered({"ma"}, scratch) == Words{"manual", "map"});
    CHECK(offered({"map", "--metr"}, scratch) == Words{"--metric"});
    CHECK(offered({"map", "-i", "sphere.unifi"}, scratch) == Words{"sphere.unified", "sphere.unified_unit"});
    CHECK(offered({"map", "-i", "sphere.press,sphere.unifi"}, scratch) ==
          Words{"sphere.press,sphere.unified", "sphere.press,sphere.unified_unit"});
    CHECK(offered({"map", "--pixels", ""}, scratch) == Words{"none", "csv"});
    CHECK(offered({"map", "--progress", "b"}, scratch) == Words{"bar"});
    CHECK(offered({"map", "near-b"}, scratch) == Words{"near-benign"});
    CHECK(offered({"map", "mi"}, scratch) == Words{"mine.toml"});
    CHECK(offered({"-q", "map", "-f", "bf"}, scratch) == Words{"bf16"});
    CHECK(offered({"sweep", "sphere-ti"}, scratch) == Words{"sphere-tilt"});
    CHECK(offered({"list", "sce"}, scratch) == Words{"scenes"});
    CHECK(offered({"plugin", "ch"}, scratch) == Words{"check"});
    CHECK(offered({"render", "--stage", "sha"}, scratch) == Words{"shadows"});
    CHECK(offered({"map", "--size", ""}, scratch).empty());
}

TEST_CASE("bash completes every option of every command") {
    const Scratch scratch;
    for (const std::string command : {"check", "consistency", "diff", "explain", "judge", "list", "map", "offsets",
                                      "render", "report", "sweep", "trade"}) {
        INFO(command);
        const auto offers = offered({command, "--"}, scratch);
        const auto named = options_in_help(command);
        REQUIRE(named.size() > 1);
        for (const std::string& option : named) {
            INFO(option);
            CHECK(offers.contains(option));
        }
    }
}

TEST_CASE("the completion scripts work in zsh and fish") {
    const Scratch scratch;
    for (const std::string name : {"bash", "zsh", "fish"}) {
        const auto r = must("completion " + name);
        CHECK(has(r.out, "intersector"));
        if (!there_is(name)) continue;  // its syntax is read where it is installed
        const std::string file = scratch.write("completion", r.out);
        const auto read = shell(name + " -n", r.out, scratch);
        INFO(name << read.out);
        CHECK(read.code == 0);
    }
    if (there_is("fish")) {
        const auto said = shell("fish",
                                "source ('" LOSTBITS_PROGRAM
                                "' completion fish | psub)\n"
                                "complete -C 'lostbits map --metr'\n",
                                scratch);
        CHECK(has(said.out, "--metric"));
    }
}

TEST_CASE("the manual page has every command and option, and man can read it") {
    const Scratch scratch;
    const auto page = must("manual");
    CHECK(page.out.starts_with(".TH LOSTBITS 1"));
    const std::string file = scratch.write("lostbits.1", page.out);
    if (!there_is("man")) return;
    const auto said = shell("bash", "MANWIDTH=100 man --warnings -l '" + file + "' | col -b\n", scratch);
    CHECK(said.code == 0);
    CHECK_FALSE(has(said.out, "warning"));
    for (const char* words :
         {"NAME", "SYNOPSIS", "EXIT STATUS", "ENVIRONMENT", "LOSTBITS_DATA", "lostbits sweep SWEEP... [OPTION]...",
          "lostbits plugin check [LIBRARY] [OPTION]...", "lostbits merge parts -o -",
          "lostbits explain [SCENE] -i NAME [OPTION]...", "lostbits completion bash|zsh|fish [OPTION]..."})
        CHECK(has(said.out, words));
    for (const std::string command : {"check", "map", "explain", "judge"}) {
        for (const std::string& option : options_in_help(command)) {
            INFO(option);
            CHECK(has(said.out, option));
        }
    }
}

TEST_CASE("choose, mend and check write their table to standard output with -o - and leave no file") {
    const Scratch scratch, temporary;
    scratch.write("mine.toml", good_scene);
    const std::string before = "export TMPDIR='" + temporary.path().string() + "';";
    run("map mine.toml -i sphere.press -f f32 -o - | true", scratch.path(), before);
    CHECK(temporary.files().empty());
    // Its times are those of the run, so two tables differ.
    const auto choice = must("choose mine.toml --bits 4 -i sphere.press -f f32 --quick -o -", scratch.path(), before);
    CHECK(choice.out.starts_with("form,format,isa,time_ns,"));
    CHECK(has(choice.out, "\nsphere.press,f32,"));
    const auto mended = must("mend mine.toml --size 8x8 -i sphere.half_b --bits 5 -o -", scratch.path(), before);
    CHECK(mended.out.starts_with("kind,"));
    CHECK(temporary.files().empty());
    CHECK(run("check --filter 'float.*' --export-json - 2>/dev/null").out.starts_with("["));
    must("-q check --filter 'float.*' --shard 1/1 --report parts", scratch.path());
    CHECK(must("merge parts -o -", scratch.path(), before).out.starts_with("id,"));
    const auto csv = must("check --filter 'float.*' --export-csv -");
    CHECK(csv.out.starts_with("id,"));
    CHECK(has(csv.err, "confirmed"));
    // A confirmed verdict may be that the sentence is wrong.
    CHECK(has(run("check --filter 'float.sum-2p24-f32,float.sum-2p25-f32'").out,
              "2 verdicts confirmed, 0 failed\nfrom a source: 1 holds, 1 is refuted\n"));
    CHECK(has(run("check --filter float.sum-2p24-f32").out,
              "1 verdict confirmed, 0 failed\nfrom a source: 1 is refuted\n"));
}

TEST_CASE("JUnit output has the time of each claim") {
    const auto r = must("check --filter 'float.*' --junit -");
    const std::regex time("<testcase [^>]*time=\"([0-9.]+)\"");
    double sum = 0;
    int cases = 0;
    for (auto at = std::sregex_iterator(r.out.begin(), r.out.end(), time); at != std::sregex_iterator(); ++at, ++cases)
        sum += std::stod((*at)[1]);
    std::smatch suite;
    REQUIRE(std::regex_search(r.out, suite, std::regex("<testsuite [^>]*time=\"([0-9.]+)\"")));
    CHECK(cases > 5);
    CHECK(sum > 0);
    CHECK(std::abs(std::stod(suite[1]) - sum) < 1e-4);
}

TEST_CASE("data/... of the documents is found from any folder, and a local file of that name comes first") {
    const Scratch elsewhere;
    const std::string judge = "judge data/dumps/far-sphere.csv --answer-format f32 --sphere 0,0,0,1 -o out";
    const auto found = must(judge, elsewhere.path());
    CHECK(has(found.out, "1536 rays of"));
    must("sweep 'data/sweeps/sdf-*.toml' -i sdf.secant_refined -f f32 --steps 2 -o swept", elsewhere.path());
    CHECK(std::distance(fs::directory_iterator(elsewhere / "swept"), fs::directory_iterator()) > 1);
    fs::create_directories(elsewhere / "data/dumps");
    elsewhere.write("data/dumps/far-sphere.csv", "ox,oy,oz,dx,dy,dz,t,hit\n0,0,-5,0,0,1,4,1\n");
    CHECK(has(run(judge + "2", elsewhere.path()).out, "1 ray of"));
    const auto none = run("judge data/dumps/none.csv --answer-format f32 --sphere 0,0,0,1 -o out3", elsewhere.path());
    CHECK(none.code == 2);
    CHECK(has(none.err, "data/dumps/none.csv"));
}

}  // namespace test_shell
