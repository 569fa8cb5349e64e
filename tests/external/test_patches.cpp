// Patches of users' files: `patch` applies them, and the patched function keeps what `mend` promised.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"
#include "intersect/source_text/source_tokens.hpp"
#include "measure/repair/text_change.hpp"

namespace test_patches {

using namespace lostbits::test;
using lostbits::intersect::source_text::SourceTokens;
using lostbits::intersect::source_text::TextSpan;
using lostbits::measure::repair::apply_changes;
using lostbits::measure::repair::TextChange;

namespace {

const std::string sources = LOSTBITS_SOURCE_DIR;

int shell(const Scratch& made, const std::string& command) {
    return std::system(("cd '" + made.path().string() + "' && " + command).c_str());
}

/// `23.4 bits, no wrong decision`: what `mend` promises of the change before this place of its text.
std::string find_promise(const std::string& said, std::size_t patch) {
    const std::string mark = "it keeps ";
    const std::size_t at = said.rfind(mark, patch);
    REQUIRE(at != std::string::npos);
    const std::string end = "no wrong decision";
    return said.substr(at + mark.size(), said.find(end, at) + end.size() - at - mark.size());
}

/// Mends a function of a copy of a file, applies each patch to a copy, and maps the patched function.
std::size_t check_patches(const std::string& file, const std::string& function, const std::string& request) {
    CAPTURE(file, function);
    const Scratch made;
    const std::string name = std::filesystem::path(file).filename().string();
    std::filesystem::copy_file(sources + "/" + file, made.path() / name);
    const std::string words = " -f f32 -i function." + function + " --function " + name + ":" + function;
    const std::string said = must("mend " + request + words, made.path()).out;
    std::size_t count = 0;
    const std::string head = "    --- " + name + "\n";
    for (std::size_t at = said.find(head); at != std::string::npos; at = said.find(head, at + 1)) {
        std::string diff;
        std::istringstream lines(said.substr(at));
        for (std::string line; std::getline(lines, line) && line.starts_with("    ");) diff += line + "\n";
        const std::string folder = "copy" + std::to_string(++count);
        std::filesystem::create_directory(made.path() / folder);
        std::filesystem::copy_file(sources + "/" + file, made.path() / folder / name);
        std::ofstream(made.path() / folder / "own.patch") << diff;
        CAPTURE(diff);
        REQUIRE(shell(made, "cd " + folder + " && patch -s -p0 < own.patch") == 0);
        CHECK(contents(made.path() / folder / name) != contents(made.path() / name));
        const std::string scene = request.substr(0, request.find(" --bits"));
        must("map " + scene + words + " -o out", made.path() / folder);
        const auto rows = read_csv(made.path() / folder / "out" / scene.substr(0, scene.find(' ')) / "summary.csv");
        REQUIRE(rows.size() == 1);
        CHECK(rows[0].at("false_hit") == "0");
        CHECK(rows[0].at("false_miss") == "0");
        const std::string own = must("mend " + request + words, made.path() / folder).out;
        CHECK(own.find(" keeps " + find_promise(said, at) + ".\n") != std::string::npos);
    }
    return count;
}

}  // namespace

TEST_CASE("patches: the patched function keeps what mend promised, in C, Rust and GLSL", "[external][mend]") {
    const std::string request = "rtg-fig-7-3-4100-oblique --size 16x16 --bits 16";
    CHECK(check_patches("examples/functions/sphere.c", "hit_sphere", request) >= 1);
    CHECK(check_patches("examples/shaders/sphere.glsl", "sphere", request) >= 1);
    // In a file that rustc 1.63 (Debian 12) compiles, the operations of the changed lines are not found.
    if (std::system("rustc --version 2>/dev/null | grep -v -q '^rustc 1[.]63[.]'") == 0)
        CHECK(check_patches("tests/external/functions/sphere.rs", "hit_sphere", request) >= 1);
}

TEST_CASE("patches: a file that is not source has the formula and one sentence", "[external][mend]") {
    const Scratch made;
    REQUIRE(std::system(("clang -O1 -S -emit-llvm -fno-discard-value-names -o " + made.path().string() + "/own.ll " +
                         sources + "/tests/external/functions/sphere.c")
                            .c_str()) == 0);
    const std::string words =
        "mend rtg-fig-7-3-4100-oblique --size 16x16 --bits 16 -i function.schoolbook --function "
        "own.ll:schoolbook";
    CHECK(must(words, made.path())
              .out.find("It is not a patch of own.ll: it is not a file of C, C++, Rust, GLSL or HLSL.") !=
          std::string::npos);
    const Outcome refused = run(words + " --emit own.patch", made.path());
    CHECK(refused.code == 2);
    CHECK(refused.err.find("cannot write a patch of own.ll") != std::string::npos);
}

TEST_CASE("patches: an expression begins and ends where its operator says", "[external]") {
    struct Case {
        const char *text, *around;
        std::size_t at;
    };
    for (const auto& [text, around, at] :
         {Case{"x = a + b * c;", "a + b * c", 6}, Case{"x = a + b * c;", "b * c", 10},
          Case{"return -b - sqrtf(d) / a;", "-b - sqrtf(d) / a", 10}, Case{"return -b - sqrtf(d) / a;", "-b", 7},
          Case{"return -b - sqrtf(d) / a;", "sqrtf(d)", 12}, Case{"if (b * b - c < 0.0f) f();", "b * b - c < 0.0f", 14},
          Case{"y = r->o[0] - s.c[0], z = 1;", "r->o[0] - s.c[0]", 12}, Case{"y = x < 0 ? a - b : c;", "a - b", 14},
          Case{"y = /* - */ a / std::sqrt(b); // - 1", "std::sqrt(b)", 16}, Case{"y = 1e-5f - x;", "1e-5f - x", 10},
          Case{"y = a - -b - c;", "a - -b - c", 11}, Case{"y = a - b - c;", "a - b", 6}}) {
        CAPTURE(text, at);
        const TextSpan span = SourceTokens(text).find_expression_at(at);
        CHECK(std::string(text).substr(span.begin, span.end - span.begin) == around);
    }
    const std::string two = "float a = f(1, 2), b = 3;\nif (a < b)\n    a = 4;\nelse if (b > 1) a = 5;";
    const SourceTokens tokens(two);
    const auto value = tokens.value_of("a", 0, 20);
    REQUIRE(value);
    CHECK(two.substr(value->begin, value->end - value->begin) == "f(1, 2)");
    CHECK_FALSE(tokens.value_of("a", 0, two.size()));  // three statements
    CHECK(tokens.statement_around(two.find("4;")).begin == two.find("if (a"));
    CHECK(tokens.statement_around(two.find("f(1")).begin == 0);
}

TEST_CASE("patches: patch makes the new text from the old one", "[external]") {
    std::mt19937 random(9);
    for (int round = 0; round < 60; ++round) {
        const Scratch made;
        std::string old;
        for (auto lines = random() % 30; lines > 0; --lines)
            old +=
                std::string(1, static_cast<char>('a' + random() % 3)) + (lines == 1 && random() % 2 == 0 ? "" : "\n");
        std::vector<TextChange> changes;
        for (std::size_t at = 0; at < old.size(); at += 1 + random() % 20)
            changes.push_back(
                {{at, at + random() % 2}, std::string(random() % 3, '+') + (random() % 2 == 0 ? "\n" : "")});
        const auto now = apply_changes(old, changes);
        if (!now || *now == old) continue;
        std::ofstream(made.path() / "own.c") << old;
        std::ofstream(made.path() / "own.patch") << lostbits::measure::repair::make_unified_diff("own.c", old, *now);
        CAPTURE(old, *now);
        REQUIRE(shell(made, "patch -s -p0 < own.patch") == 0);
        CHECK(contents(made.path() / "own.c") == *now);
    }
}

}  // namespace test_patches
