// ./run: the targets that it builds, the order of its work, and its last lines. Packages, compiler and program are
// stand-ins that record their calls.
#include <sys/wait.h>

#include <cstdlib>
#include <sstream>

#include "catch.hpp"
#include "counts.hpp"
#include "program.hpp"

namespace test_run {

using namespace lostbits::test;

namespace {

/// A folder with the script, two scenes and a scene with light.
class Tree {
public:
    Tree() {
        for (const char* folder : {"bin", "build", "data/scenes", "tests"}) fs::create_directories(at(folder));
        fs::copy_file(LOSTBITS_DATA_DIR "/../run", at("run"));
        for (const char* scene : {"one", "rtg-fig-7-3-4100-oblique", "raycast-acne"})
            scratch_.write(std::string("data/scenes/") + scene + ".toml", "");
        stand_in("bin/cmake", "");
        stand_in("bin/npm", "");
        stand_in("bin/apt-get", "");
        stand_in("bin/sudo", "exec \"$@\"");
        stand_in("bin/dpkg-query", "shift 3; for name; do echo \"$name install ok installed\"; done");
        stand_in("build/lostbits", "echo made by the program");
        stand_in("tests/instrumented_tbb", "");
    }

    struct Output {
        int code;
        std::string out, err, calls;
    };
    [[nodiscard]] Output run(const std::string& word) const { return said_by("bash run " + word); }
    [[nodiscard]] Output said_by(const std::string& words) const {
        const std::string command = "cd '" + scratch_.path().string() + "' && TMPDIR=$PWD PATH=\"$PWD/bin:$PATH\" " +
                                    words + " >out.txt 2>err.txt </dev/null";
        const int code = std::system(command.c_str());
        for (const auto& entry : fs::directory_iterator(scratch_.path()))  // its own temporary folder is gone
            CHECK_FALSE(has(entry.path().filename().string(), "lostbits-run"));
        return {WEXITSTATUS(code), contents(at("out.txt")), contents(at("err.txt")), contents(at("calls.txt"))};
    }
    void write(const std::string& name, const std::string& text) const { scratch_.write(name, text); }
    [[nodiscard]] fs::path at(const std::string& name) const { return scratch_.path() / name; }
    void stand_in(const std::string& name, const std::string& answer) const {
        const std::string program = fs::path(name).filename();
        fs::permissions(scratch_.write(name, "#!/bin/sh\necho \"" + program + " $*\" >>'" + at("calls.txt").string() +
                                                 "'\n" + answer + "\n"),
                        fs::perms::owner_all);
    }

private:
    Scratch scratch_;
};

/// A ctest that reports these tests with these results.
std::string ctest_says(const std::string& ends) {
    return R"(echo some words; while [ $# -gt 1 ]; do [ "$1" = --output-junit ] && junit=$2; shift; done
n=0; for end in )" +
           ends + R"(; do
    n=$((n + 1)); tab=$(printf '\t')
    case $end in
        missing) status=notrun more="<skipped message=\"Unable to find executable\"/>" ;;
        skip) status=notrun more="<skipped message=\"SKIP_REGULAR_EXPRESSION_MATCHED\"/>" ;;
        *) status=$end more="<failure message=\"status=\"/>" ;;
    esac
    printf '%s\n' "$tab<testcase name=\"test $n\" classname=\"x\" time=\"0\" status=\"$status\">" "$tab$tab$more"
done >>"$junit")";
}

/// Builds a file for ninja: `steps` steps that succeed, and then one that prints said.txt and ends with `code`.
std::string ninja_file(int steps, int code) {
    std::string file = "rule step\n  command = true\nrule last\n  command = cat said.txt; exit " +
                       std::to_string(code) + "\nbuild last: last ||",
                rest;
    for (int i = 0; i < steps; ++i) {
        file += " s" + std::to_string(i);
        rest += "build s" + std::to_string(i) + ": step\n";
    }
    return file + "\n" + rest;
}

std::size_t lines_with(const std::string& text, const std::string& part) {
    std::istringstream in(text);
    std::size_t count = 0;
    for (std::string line; std::getline(in, line);) count += has(line, part);
    return count;
}

}  // namespace

TEST_CASE("./run builds the program only, maps one scene first, then all at small size, and prints their folder") {
    const Tree tree;
    const auto said = tree.run("");
    INFO(said.calls);
    REQUIRE(said.code == 0);
    CHECK(has(said.calls, "-DLOSTBITS_BUILD_TESTS=OFF -DLOSTBITS_BUILD_BENCH=OFF -DLOSTBITS_BUILD_PLUGINS=OFF"));
    // Node is a hundred packages, and the tests need another hundred.
    for (const char* no : {"check", "render", "report", "raycast", "npm"}) CHECK_FALSE(has(said.calls, no));
    for (const char* no : {"catch2", "libbenchmark-dev", "nodejs"}) CHECK_FALSE(has(said.calls, no));
    const auto build = said.calls.find("cmake --build"), first = said.calls.find("lostbits map data/scenes/rtg-"),
               small = said.calls.find("lostbits map -q data/scenes/one.toml data/scenes/rtg-");
    REQUIRE(small != std::string::npos);
    CHECK(build < first);
    CHECK(first < small);
    CHECK(has(said.calls.substr(small), "--size 64x48"));
    CHECK(said.out.starts_with("made by the program\n"));  // the path of the first picture
    CHECK(said.out.ends_with(tree.at("out/small").string() + "\n"));

    // The suggested next command can be pasted.
    std::istringstream err(said.err);
    const std::string program = "  build/lostbits ";
    const Scratch folder;
    std::size_t tried = 0;
    for (std::string line; std::getline(err, line);) {
        if (!line.starts_with(program)) continue;
        INFO(line);
        std::string words = line.substr(program.size());
        if (!is_long() && !has(words, "--pixel")) words += " --size 32x24";  // a small picture has the same files
        // Times of every form are minutes; test_report.cpp and test_reports.cpp ask about the claims of pages.
        if (!is_long() && words.starts_with("choose ")) words += " -i sphere.unified,sphere.schoolbook --quick";
        if (!is_long() && words.starts_with("report ")) words += " --no-claims";
        const auto r = lostbits::test::run(words, folder.path());
        CHECK(r.code == 0);
        ++tried;
    }
    CHECK(tried == 3);
}

TEST_CASE("./run shows the progress of the build and full errors, and exits as the build does") {
    const Tree tree;
    tree.stand_in("bin/cmake", "case $1 in --build) ninja || exit 7 ;; esac");
    const std::string words = "x.cpp: In function:\n\nx.cpp:1:2: error: no\n    1 | int  y\n";
    tree.write("said.txt", words);
    tree.write("build.ninja", ninja_file(99, 1));
    const auto bad = tree.run("");
    CHECK(bad.code == 7);
    CHECK(has(bad.err, "\n" + words));
    CHECK(has(bad.err, "FAILED: last"));
    CHECK_FALSE(has(bad.calls, "lostbits map"));
    CHECK(has(bad.err, "building: 50 %, 0:0"));
    CHECK(lines_with(bad.err, "building:") == 10);
    CHECK_FALSE(has(bad.err, "\r"));

    tree.write("build.ninja", ninja_file(99, 0));
    const std::string terminal = "TERM=xterm script -qec 'bash run' /dev/null";
    const auto seen = tree.said_by(terminal).out;
    INFO(seen);
    CHECK(has(seen, "\r\x1b[Kbuilding: 1 %\r\x1b[Kbuilding: 2 %\r"));
    CHECK(has(seen, "\r\x1b[Kbuilding: 99 %, 0:00 left\r\x1b[K"));
    CHECK(has(seen, "\r\x1b[Kx.cpp:1:2: error: no\r\n"));  // a warning, say
    CHECK_FALSE(has(seen, "left\r\n"));
    CHECK(has(seen, "made by the program"));
    // Nothing is left to build, and the output does not mention a build.
    tree.write("build.ninja", "build x: phony\n");
    CHECK_FALSE(has(tree.run("").err, "ninja"));
}

TEST_CASE("./run shows the progress of package installation and hides its noise") {
    const Tree tree;
    tree.stand_in("bin/dpkg-query", "exit 1");
    const std::string status = R"sh(case $* in *install*)
    echo "$DEBIAN_FRONTEND $DEBCONF_NOWARNINGS" >>calls.txt
    for i in 10 20 30 100; do echo "dlstatus:3:$i.5:Retrieving file 3 of 9 (2s remaining)"; done
    echo Selecting previously unselected package x
    for i in 40 50 60 100; do echo "pmstatus:x:$i.000:Unpacking x (amd64)"; done
    echo 'E: something real' >&2; exit )sh";
    tree.stand_in("bin/apt-get", status + "0 ;; esac");
    const auto said = tree.run("");
    CHECK(said.code == 0);
    CHECK(has(said.calls, "noninteractive yes\n"));
    CHECK(has(said.err, "downloading: 20 %, 0:0"));
    CHECK(has(said.err, "installing: 50 %, 0:0"));
    CHECK(has(said.err, "E: something real\n"));
    CHECK_FALSE(has(said.err + said.out, "Selecting"));
    CHECK_FALSE(has(said.err + said.out, "status:"));
    tree.stand_in("bin/apt-get", status + "100 ;; esac");
    const auto bad = tree.run("");
    CHECK(bad.code == 100);
    CHECK(lines_with(bad.calls, "cmake --build") == 1);  // of the run before
}

TEST_CASE("./run all makes everything and ends with the page, and an unknown word is refused") {
    const Tree tree;
    const auto said = tree.run("all");
    INFO(said.calls);
    REQUIRE(said.code == 0);
    for (const char* part : {"lostbits map data/scenes/one.toml", "lostbits render data/scenes/raycast-acne.toml",
                             "lostbits check", "lostbits report"})
        CHECK(has(said.calls, part));
    CHECK(said.out.ends_with(tree.at("out/report/index.html").string() + "\n"));
    CHECK(tree.run("al").code != 0);
    CHECK(has(contents(tree.at("err.txt")),
              "usage: ./run [all | test [--long | --sanitize] | package | fuzz [SECONDS]]"));
}

TEST_CASE("./run package puts both packages and their checksums into dist") {
    const Tree tree;
    tree.write("python/setup.py", "");
    tree.write("CMakeLists.txt", "");
    tree.write("dist/lostbits_0.0.9_amd64.deb", "old");
    tree.stand_in("bin/cpack", "mkdir -p \"$4\" && echo deb >\"$4/lostbits_0.1.0_amd64.deb\"");
    tree.stand_in(
        "bin/python3",
        "case \"$*\" in *--wheel*) test -f \"${7}/setup.py\" && echo wheel >\"$6/lostbits-0.1.0.whl\" ;; esac");
    const auto said = tree.run("package");
    INFO(said.calls << said.err);
    REQUIRE(said.code == 0);
    CHECK(has(said.calls, "-DLOSTBITS_PACK_WIDTHS=all"));
    CHECK(said.out.ends_with(tree.at("dist").string() + "\n"));
    CHECK(has(contents(tree.at("dist/SHA256SUMS")), "  lostbits-0.1.0.whl\n"));
    CHECK(has(contents(tree.at("dist/SHA256SUMS")), "  lostbits_0.1.0_amd64.deb\n"));
    CHECK_FALSE(fs::exists(tree.at("dist/lostbits_0.0.9_amd64.deb")));
    CHECK_FALSE(fs::exists(tree.at("python/lostbits.egg-info")));
    tree.stand_in("bin/cpack", "echo no such generator; exit 1");
    const auto failed = tree.run("package");
    CHECK(failed.code == 3);
    CHECK(has(failed.err, "no such generator"));
    CHECK(fs::exists(tree.at("dist/SHA256SUMS")));
}

TEST_CASE("./run test reports how many tests passed, and with --sanitize for both sanitizer builds") {
    const Tree tree;
    tree.stand_in("bin/ctest", ctest_says("run run run run run run run"));
    const auto plain = tree.run("test");
    INFO(plain.calls);
    CHECK(plain.code == 0);
    CHECK(plain.out.ends_with("\n7 passed, 0 failed\n"));
    CHECK_FALSE(has(plain.calls, "tsan"));

    const auto both = tree.run("test --sanitize");
    INFO(both.calls);
    CHECK(both.out.ends_with("\n14 passed, 0 failed\n"));
    for (const char* preset : {"asan-ubsan", "tsan"}) {
        CHECK(has(both.calls, std::string("cmake --build --preset ") + preset));
        CHECK(has(both.calls, std::string("ctest --preset ") + preset));
    }
    CHECK(both.calls.find("instrumented_tbb build-tsan/tbb") < both.calls.find("cmake --build --preset tsan"));
    tree.stand_in("tests/instrumented_tbb", "exit 100");
    CHECK(tree.run("test --sanitize").out.ends_with("\n7 passed, 1 failed\n"));

    tree.stand_in("bin/ctest", ctest_says("run run fail run run run run") + "; exit 8");
    const auto bad = tree.run("test");
    CHECK(bad.code != 0);
    CHECK(bad.out.ends_with("\n6 passed, 1 failed\n"));
    // One test without its program failed, once; another that lacks a package failed where that package could be
    // installed.
    tree.stand_in("bin/ctest", ctest_says("run missing skip") + "; exit 8");
    CHECK(tree.run("test").out.ends_with("\n1 passed, 2 failed\n"));
    CHECK(has(contents(tree.at("err.txt")), "\ntest 3\n"));
    // A test that leaves files in the temporary folder fails.
    tree.stand_in("bin/ctest", ctest_says("run run") + "; echo x >\"$TMPDIR/left-behind\"");
    const auto left = tree.run("test");
    CHECK(left.code != 0);
    CHECK(left.out.ends_with("\n2 passed, 1 failed\n"));
    CHECK(has(left.err, "left-behind\n"));
    tree.stand_in("bin/ctest", "exit 8");
    CHECK(tree.run("test").out.ends_with("0 passed, 1 failed\n"));
    // A run that is ended in the middle leaves nothing, as said_by checks, and does not look like a finished one.
    tree.stand_in("bin/ctest", "echo x >\"$TMPDIR/half\"; kill -TERM $PPID");
    const auto ended = tree.run("test");
    CHECK(ended.code != 0);
    CHECK_FALSE(has(ended.out, "passed"));
}

TEST_CASE("./run test --long also compiles each source by itself and counts an error as a failure") {
    const Tree tree;
    tree.stand_in("bin/ctest", ctest_says("run run"));
    const auto said = tree.run("test --long");
    INFO(said.calls);
    CHECK(said.code == 0);
    CHECK(has(said.calls, "cmake --preset dev -DLOSTBITS_BUILD_TESTS=OFF"));
    CHECK(has(said.calls, "cmake --build --preset dev"));
    CHECK(said.out.ends_with("\n2 passed, 0 failed\n"));
    CHECK_FALSE(has(said.calls, "ctest --preset dev"));
    tree.stand_in("bin/cmake", "case \"$*\" in *--build*dev*) exit 1;; esac");
    const auto bad = tree.run("test --long");
    CHECK(bad.code != 0);
    CHECK(bad.out.ends_with("\n2 passed, 1 failed\n"));
}

}  // namespace test_run
