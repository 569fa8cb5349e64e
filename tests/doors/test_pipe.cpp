// Programs behind pipes.
#include <initializer_list>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"

namespace test_pipe {

using namespace lostbits::test;

namespace {

const std::string pipes = std::string(LOSTBITS_SOURCE_DIR) + "/examples/pipes/";

/// A command for the shell that says so much of itself and then does something.
std::string speaking(const std::string& header, const std::string& then) {
    return " --pipe \"printf 'lostbits-pipe/1\\n" + header + "\\n\\n'; " + then + "\"";
}

}  // namespace

TEST_CASE("pipe: Python and JavaScript have the answers of sphere.schoolbook in doubles", "[doors]") {
    const Scratch folder;
    for (const std::string scene : {"near-benign", "rtg-fig-7-3-4100-oblique"}) {
        must("map " + scene +
                 " --size 96x64 -i 'python.*' -i 'js.*' -i sphere.schoolbook -f f64 "
                 "--pixels csv -o out --pipe " +
                 pipes + "schoolbook.py --pipe 'node " + pipes + "schoolbook.mjs'",
             folder.path());
        const auto out = folder.path() / "out" / scene;
        const std::string ours = contents(out / "sphere.schoolbook.f64.csv");
        CHECK(ours.size() > 100'000);
        CHECK(ours == contents(out / "python.schoolbook.f64.csv"));
        CHECK(ours == contents(out / "js.schoolbook.f64.csv"));
    }
    must("plugin check --pipe " + pipes + "schoolbook.py", folder.path());
}

TEST_CASE("pipe: a command that does not answer as it should is named, and nothing is written", "[doors]") {
    struct Fault {
        std::string pipe, says;
        int code;
    };
    for (const Fault& fault : std::initializer_list<Fault>{
             {" --pipe 'echo hello'", "says \"hello\" first", 3},
             {" --pipe 'printf \"\\033[2Jboo\\n\"'", "says \"\\x1b[2Jboo\" first", 3},
             {" --pipe no-such-command-here", "the shell did not find the command", 3},
             {" --pipe true", "ended with status 0", 3},
             {" --pipe 'sleep 60'", "within the time limit", 3},
             {" --pipe 'yes | tr -d \"\\n\"'", "a first line without end", 3},
             {speaking("name=a.x", "cat >/dev/null"), "within the time limit", 3},
             {speaking("name=a.x", "head -c 20 >/dev/null; echo helloworld"), "answered \"hellowor\"", 3},
             {speaking("name=a.x", "head -c 20 >/dev/null; printf 'LBA1'"), "ended without a whole answer", 3},
             {speaking("name=a.x", "exit 3"), "status 3", 3},
             {speaking("name=a.x", "head -c 100 >/dev/null; kill -SEGV \\$\\$"), "signal 11", 3},
             {speaking("name=a.x\\nshape=cube", "cat"), "shape is \"cube\"; it is one of sphere, box, triangle", 2},
             {speaking("shape=box", "cat"), "a form begins with name=", 2},
             {speaking("name=a.x\\ncolour=red", "cat"), "unknown key \"colour\"", 2},
             {speaking("name=a.x\\nred", "cat"), "is not key=value", 2},
             {speaking("name=a.x\\nflags=fast", "cat"), "flags is \"fast\"; it is one of line, no_end, one_thread",
              2}}) {
        const Scratch folder;
        const Outcome o =
            run("map near-benign --size 32x24 -i 'a.*' -f f32 -o out --time-limit 1" + fault.pipe, folder.path());
        INFO(fault.pipe << ": " << o.err);
        CHECK(o.code == fault.code);
        CHECK(has(o.err, fault.says));
        CHECK_FALSE(has(o.err, "\033"));
        CHECK(folder.files().empty());
    }
}

TEST_CASE("pipe: plugin serve refuses what is no request", "[doors]") {
    const Scratch folder;
    const Outcome o = run(
        "plugin serve " + std::string(LOSTBITS_LIBRARIES) + "/schoolbook.so </etc/services >/dev/null", folder.path());
    CHECK(o.code == 2);
    CHECK(has(o.err, "no request of lostbits-pipe/1"));
}

}  // namespace test_pipe
