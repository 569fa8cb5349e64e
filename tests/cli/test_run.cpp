// ./run: what it builds, in which order it works, and what it says last. Packages, compiler and program are stand-ins
// that write down how they were called.
#include <cstdlib>

#include "catch.hpp"
#include "program.hpp"

namespace test_run {

using namespace lostbits::test;

namespace {

/// A folder with the script, two scenes and a scene with light.
class Tree {
public:
    Tree() {
        for (const char* folder : {"bin", "build", "data/scenes", "node_modules/uplot", "tests"})
            std::filesystem::create_directories(at(folder));
        std::filesystem::copy_file(LOSTBITS_DATA_DIR "/../run", at("run"));
        for (const char* scene : {"one", "rtg-fig-7-3-4100-oblique", "raycast-acne"})
            static_cast<void>(scratch_.write(std::string("data/scenes/") + scene + ".toml", ""));
        stand_in("bin/cmake", "");
        stand_in("bin/npm", "");
        stand_in("bin/apt-get", "");
        stand_in("bin/dpkg-query", "echo install ok installed");
        stand_in("build/lostbits", "echo made by the program");
        stand_in("tests/instrumented_tbb", "");
    }

    struct Said {
        int code;
        std::string out, calls;
    };
    [[nodiscard]] Said run(const std::string& word) const {
        const std::string command = "cd '" + scratch_.path().string() + "' && PATH=\"$PWD/bin:$PATH\" bash run " +
                                    word + " >out.txt 2>err.txt </dev/null";
        const int code = std::system(command.c_str());
        return {code, contents(at("out.txt")), contents(at("calls.txt"))};
    }
    [[nodiscard]] std::filesystem::path at(const std::string& name) const { return scratch_.path() / name; }
    void stand_in(const std::string& name, const std::string& answer) const {
        const std::string program = std::filesystem::path(name).filename();
        std::filesystem::permissions(scratch_.write(name, "#!/bin/sh\necho \"" + program + " $*\" >>'" +
                                                              at("calls.txt").string() + "'\n" + answer + "\n"),
                                     std::filesystem::perms::owner_all);
    }

private:
    Scratch scratch_;
};

/// A ctest that writes down tests which ended so.
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

}  // namespace

TEST_CASE("./run builds the program alone, maps one scene first and all of them small, and ends with their folder") {
    const Tree tree;
    const auto said = tree.run("");
    INFO(said.calls);
    REQUIRE(said.code == 0);
    CHECK(has(said.calls, "-DLOSTBITS_BUILD_TESTS=OFF -DLOSTBITS_BUILD_BENCH=OFF -DLOSTBITS_BUILD_PLUGINS=OFF"));
    // What the page needs is a hundred packages, and what tests need is another hundred.
    for (const char* no : {"npm ", "check", "render", "report", "raycast"}) CHECK_FALSE(has(said.calls, no));
    for (const char* no : {"catch2", "libbenchmark-dev", "nodejs"}) CHECK_FALSE(has(said.calls, no));
    const auto build = said.calls.find("cmake --build"), first = said.calls.find("lostbits map data/scenes/rtg-"),
               small = said.calls.find("lostbits map -q data/scenes/one.toml data/scenes/rtg-");
    REQUIRE(small != std::string::npos);
    CHECK(build < first);
    CHECK(first < small);
    CHECK(has(said.calls.substr(small), "--size 64x48"));
    CHECK(said.out.starts_with("made by the program\n"));  // the path of the first picture
    CHECK(said.out.ends_with(tree.at("out/small").string() + "\n"));
}

TEST_CASE("./run all makes everything and ends with the page, another word is refused") {
    const Tree tree;
    const auto said = tree.run("all");
    INFO(said.calls);
    REQUIRE(said.code == 0);
    for (const char* part : {"lostbits map data/scenes/one.toml", "lostbits render data/scenes/raycast-acne.toml",
                             "lostbits check", "lostbits report"})
        CHECK(has(said.calls, part));
    CHECK(said.out.ends_with(tree.at("out/report/index.html").string() + "\n"));
    CHECK(tree.run("al").code != 0);
    CHECK(has(contents(tree.at("err.txt")), "usage: ./run [all | test [--long | --sanitize] | fuzz [SECONDS]]"));
}

TEST_CASE("./run test says how many tests passed, and with --sanitize of both sanitizers' builds") {
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
    // One without its program failed, once; one that lacks a package failed where that could be installed.
    tree.stand_in("bin/ctest", ctest_says("run missing skip") + "; exit 8");
    CHECK(tree.run("test").out.ends_with("\n1 passed, 2 failed\n"));
    CHECK(has(contents(tree.at("err.txt")), "\ntest 3\n"));
    tree.stand_in("bin/ctest", "exit 8");
    CHECK(tree.run("test").out.ends_with("0 passed, 1 failed\n"));
}

TEST_CASE("./run test --long compiles each source by itself as well, and counts an error as a failure") {
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
