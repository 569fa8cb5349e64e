// Libraries that end the program, copy it or change its state. Wherever they run, no failure is reported as success,
// the library to blame is named, and no process is left.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"
#include "cli/started_program.hpp"

namespace test_manners {

using namespace lostbits::test;
namespace fs = std::filesystem;

namespace {

const std::string library = std::string(LOSTBITS_LIBRARIES) + "/ill_mannered.so";

/// A claim about the library's form, which holds or does not.
std::string claims(const Scratch& folder, bool holds) {
    return folder.write("claims.toml",
                        make_claim_file({{"a", "scene = \"near-benign\"\n" + form_keys("ill.right"),
                                          metric_keys("false_miss_fraction", holds ? "[0.0, 0.01]" : "[0.5, 0.6]")}}));
}

/// The processes that have this text in their environment, in order of their start.
std::vector<int> marked(const std::string& mark) {
    std::vector<int> found;
    std::error_code gone;
    for (const auto& entry : fs::directory_iterator("/proc", gone)) {
        const int process = std::atoi(entry.path().filename().c_str());
        if (process > 0 && process != getpid() && has(contents(entry.path() / "environ"), mark))
            found.push_back(process);
    }
    std::ranges::sort(found);
    return found;
}

struct RunResult {
    Outcome outcome;
    bool has_results = false;  ///< all of them, where they belong
};

/// Waits until no such process is left, since a signal does not wait for the end that it causes. A process that stays
/// is ended with this test, and the watching program names it.
void wait_for_all_ends(const std::string& mark) {
    while (!marked(mark).empty()) usleep(50'000);
}

/// A command with the library, ill-mannered in one way; no process may be left, and no half-written file.
RunResult run_with(const std::string& manner, const std::string& words, const std::string& before = "",
                   bool claim_holds = true) {
    const Scratch folder;
    const std::string mark = "ILL_RUN=" + folder.path().string();
    const bool checks = words.starts_with("check"), tries = words.starts_with("plugin");
    const std::string command = tries    ? words
                                : checks ? words + " " + claims(folder, claim_holds) + " --junit out.xml"
                                         : words + " near-benign --size 16x16 -i ill.right -f f32 -o out";
    RunResult ran;
    ran.outcome = run(command + " --time-limit 3 --plugin " + library, folder.path(),
                      before + " export ILL_MANNER='" + manner + "' " + mark + ";");
    INFO(manner << " | " << before << words << " | " << ran.outcome.code << " | " << ran.outcome.err);
    wait_for_all_ends(mark);
    for (const std::string& file : folder.files()) CHECK_FALSE(has(file, ".partial-"));
    ran.has_results = tries ? has(ran.outcome.out, "ill.right in binary32, a sphere: keeps its contract")
                            : fs::exists(folder.path() / (checks ? "out.xml" : "out/near-benign/summary.csv")) &&
                                  !fs::exists(folder.path() / "out/near-benign/UNFINISHED.txt");
    return ran;
}

/// Each action alone, in the program and in child processes.
struct RunMode {
    const char *words, *before;
    bool isolated;
};
const std::vector<RunMode> ways{{"map", "", false},
                                {"map", "export CI=1;", true},
                                {"map --isolate", "", true},
                                {"check", "", true},
                                {"check --in-process", "", false},
                                {"check --in-process", "export CI=true;", false},
                                {"plugin check", "", false},
                                {"plugin check", "export CI=true;", true}};

/// Each of these manners, in every way to load the library.
template <class See>
void in_every_way(const std::vector<std::string>& manners, const See& see) {
    for (const std::string& manner : manners) {
        for (const RunMode& way : ways) {
            const RunResult ran = run_with(manner, way.words, way.before);
            INFO(manner << " | " << way.before << way.words << " | " << ran.outcome.err);
            see(manner, way, ran);
        }
    }
}

}  // namespace

TEST_CASE("manners: a library that ends the program makes it exit with 3 and the library's name", "[external]") {
    in_every_way(
        {"load _exit", "load quick_exit", "load exit", "load crash in a thread", "call _exit", "call quick_exit",
         "call exit", "call crash in a thread", "load throw in a thread", "call throw in a thread"},
        [](const std::string&, const RunMode&, const RunResult& ran) {
            CHECK(ran.outcome.code == 3);
            CHECK(has(ran.outcome.err, "ill_mannered.so"));
            CHECK_FALSE(ran.has_results);
            CHECK_FALSE(has(ran.outcome.out, "confirmed"));
        });
}

TEST_CASE("manners: environment variables set by a library do not change where data is found", "[external]") {
    in_every_way({"load setenv", "call setenv"}, [](const std::string&, const RunMode&, const RunResult& ran) {
        CHECK(ran.outcome.code == 0);
        CHECK(ran.has_results);
    });
}

TEST_CASE("manners: events after the results change neither them nor the exit status", "[external]") {
    in_every_way({"load crash at exit", "call crash at exit"},
                 [](const std::string&, const RunMode& way, const RunResult& ran) {
                     CHECK(ran.outcome.code == (way.isolated ? 0 : 3));
                     CHECK(ran.has_results);
                     if (!way.isolated) CHECK(has(ran.outcome.err, "ill_mannered.so: crashed while the program ended"));
                 });
    for (const char* words : {"check", "check --in-process"}) {
        INFO("unload throw | " << words);
        CHECK(run_with("unload throw", words).outcome.code == (std::string(words) == "check" ? 0 : 3));
    }
    for (const std::string manner : {"load _exit at exit", "call _exit at exit", "unload _exit", "unload quick_exit"}) {
        for (const char* words : {"check", "check --in-process"}) {
            INFO(manner << " | " << words);
            CHECK(run_with(manner, words, "", true).outcome.code == 0);
            CHECK(run_with(manner, words, "", false).outcome.code == 1);
        }
    }
}

TEST_CASE("manners: a forked copy of the program that returns does not continue the run", "[external]") {
    in_every_way({"load fork", "call fork", "load fork and exit", "call fork and exit", "load fork and stay",
                  "call fork and stay", "load fork and setsid", "call fork and setsid"},
                 [](const std::string& manner, const RunMode&, const RunResult& ran) {
                     CHECK(ran.outcome.code == 0);
                     CHECK(ran.has_results);
                     if (manner.ends_with("fork")) CHECK(has(ran.outcome.err, "ill_mannered.so"));
                 });
}

TEST_CASE("manners: results go where -o says even if a library changes the folder", "[external]") {
    in_every_way({"load chdir", "call chdir", "load umask", ""},
                 [](const std::string&, const RunMode&, const RunResult& ran) {
                     CHECK(ran.outcome.code == 0);
                     CHECK(ran.has_results);
                     CHECK(ran.outcome.err.empty());
                 });
}

TEST_CASE("manners: standard output closed by a library is an error, and does not end up in a file", "[external]") {
    in_every_way({"load close"}, [](const std::string&, const RunMode& way, const RunResult& ran) {
        if (std::string(way.words) == "plugin check") return;
        CHECK(ran.outcome.code == (way.isolated ? 0 : 3));
        if (!way.isolated) CHECK(has(ran.outcome.err, "standard output: cannot write"));
    });
}

TEST_CASE("manners: a library that closes the program's own file descriptors makes it exit with 3 and a name",
          "[external]") {
    in_every_way({"load close all", "call close all", "load close files", "call close files"},
                 [](const std::string& manner, const RunMode& way, const RunResult& ran) {
                     // Behind a pipe, a library has no descriptor of the program except the pipe.
                     if (way.isolated && manner.ends_with("files")) return;
                     CHECK(ran.outcome.code == 3);
                     CHECK(has(ran.outcome.err, "ill_mannered.so"));
                     if (manner.ends_with("files")) CHECK(has(ran.outcome.err, "file descriptors of the program"));
                     CHECK_FALSE(ran.has_results);
                 });
}

TEST_CASE("manners: a program stopped by a library does not wait for ever", "[external]") {
    for (const std::string manner : {"load stop", "call stop"}) {
        for (const RunMode& way : {ways[0], ways[2]}) {
            const RunResult ran = run_with(manner, way.words, way.before);
            INFO(manner << " | " << way.words << " | " << ran.outcome.err);
            CHECK(ran.outcome.code == 3);
            CHECK(has(ran.outcome.err, "ill_mannered.so"));
            CHECK(has(ran.outcome.err, way.isolated ? "within the time limit" : "stopped the program"));
            CHECK_FALSE(ran.has_results);
        }
    }
}

TEST_CASE("manners: limits lowered by a library affect that library only", "[external]") {
    in_every_way({"load lower limits", "call lower limits"},
                 [](const std::string&, const RunMode&, const RunResult& ran) {
                     CHECK(ran.outcome.code == 0);
                     CHECK(ran.has_results);
                     CHECK(ran.outcome.err.empty());
                 });
}

TEST_CASE("manners: a library of formulas is loaded into the program, and the output says so", "[external]") {
    const Scratch folder;
    const std::string command = "list forms --plugin " + std::string(LOSTBITS_LIBRARIES) + "/only_march.so",
                      said = "only_march.so: has formulas, so it runs in this process";
    const Outcome by_default = must(command, folder.path(), "export CI=1;");
    CHECK(has(by_default.err, said));
    for (const char* more : {"", " --in-process"}) {
        const Outcome other = must(command + more, folder.path(), *more == '\0' ? "" : "export CI=1;");
        CHECK(other.err.empty());
    }
    CHECK_FALSE(has(run(command + " -q", folder.path(), "export CI=1;").err, said));
    CHECK(run("list forms --in-process", folder.path()).code == 2);
    CHECK(run(command + " --in-process --isolate", folder.path()).code == 2);
}

TEST_CASE("manners: signals reach the working process once each, and it ends with its parent", "[external]") {
    for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
        for (const bool to_both : {false, true}) {
            const Scratch folder;
            const std::string mark = "ILL_RUN=" + folder.path().string();
            setenv("ILL_MANNER", "call stay", 1);
            setenv("ILL_RUN", folder.path().c_str(), 1);
            StartedProgram run({"map", "near-benign", "--size", "16x16", "-i", "ill.right", "-f", "f32", "-o", "out",
                                "--plugin", library, "--time-limit", "60"},
                               folder.path());
            REQUIRE(run.wait_until([&mark] { return marked(mark).size() == 2; }));
            const std::vector<int> both = marked(mark);
            for (const int process : both) {
                if (to_both || process == both.front()) kill(process, signal);
            }
            const int code = run.wait();
            INFO(signal << " to " << (to_both ? "both: " : "the first: ") << contents(folder.path() / "err.txt"));
            CHECK(code == (signal == SIGKILL ? 128 + SIGKILL : 130));
            if (signal != SIGKILL) CHECK(has(contents(folder.path() / "err.txt"), "interrupted"));
            wait_for_all_ends(mark);
            unsetenv("ILL_MANNER");
            unsetenv("ILL_RUN");
        }
    }
}

TEST_CASE("manners: plugin serve fails if it cannot send its answers", "[external]") {
    const Scratch folder;
    const Outcome full = run("plugin serve " + library + " </dev/zero >/dev/full", folder.path());
    INFO(full.err);
    CHECK(full.code == 3);
    CHECK(has(full.err, "cannot write"));
    // A process that has closed both ends has ended, and needs no answers.
    must("plugin serve " + library + " </dev/null >/dev/full", folder.path());
}

}  // namespace test_manners
