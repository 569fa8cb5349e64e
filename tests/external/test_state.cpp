// A library that changes how the processor computes (rounding mode, subnormal numbers) changes its own answers and
// nothing else.
#include <array>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"
#include "counts.hpp"

namespace test_state {

using namespace lostbits::test;

namespace {

const std::string library = std::string(LOSTBITS_LIBRARIES) + "/changes_state.so";

/// Spheres whose squares are subnormal numbers of doubles, and rays that hit half of them.
const std::string tiny =
    scene_text("[[sphere]]\ncentre = [0, 0, 0]\nradius = \"0x1p-70\"\n", "inputs = \"shared\"\nsize = [24, 16]\n",
               "kind = \"orthographic\"\neye = [0, 0, \"0x1p-68\"]\nwidth = \"0x1.4p-69\"\n");

/// The same for a radius that is a subnormal number: the sphere vanishes if such numbers become zeros.
std::string subnormal_sphere() {
    return replace_text(replace_text(replace_text(tiny, "0x1p-70", "0x1p-140"), "0x1p-68", "0x1p-138"), "0x1.4p-69",
                        "0x1.4p-139");
}

/// Every float of a range of subnormal numbers.
const std::string subnormals = R"(schema = "lostbits-sweep/1"
title = "Subnormal radii"
source = "-"
[axis]
name = "radius"
unit = "m"
spacing = "every_float"
set = "sphere.radius"
from = "0x1p-149"
to = "0x1p-136"
[[ray]]
name = "ahead"
origin = [0, 0, 1]
direction = [0, 0, -1]
[sphere]
centre = [0, 0, 0]
radius = 1
)";

const std::string rays = "ox,oy,oz,dx,dy,dz,hit,t\n0.25,0,-1234.5,0,0,1,1,1233.53175\n0x1p-140,0,-5,0,0,1.5,1,2.7\n";

constexpr std::size_t commands = 3;

/// All rows of the files of one command except those of the library, without the commands that name it.
std::vector<std::string> rows_left(std::size_t command, const std::string& more, const std::string& before) {
    const Scratch folder;
    static_cast<void>(folder.write("tiny.toml", subnormal_sphere()));
    static_cast<void>(folder.write("subnormals.toml", subnormals));
    static_cast<void>(folder.write("rays.csv", rays));
    const std::string more_forms = more.empty() ? "" : ",example.*",
                      forms = " -i 'sphere.double_inside,sphere.half_b" + more_forms + "'";
    const std::array<std::string, commands> all{
        "map tiny.toml" + forms + " -f f32,f64 --metric lost_bits,residual -o out",
        "judge rays.csv --answer-format f32 --sphere 0,0,0,1" + forms + " -f f32 -o out",
        "sweep subnormals.toml -i sphere.half_b,sphere.double_inside -f f32 -o out"};
    must("-q " + all[command] + more, folder.path(), before);
    std::vector<std::string> left;
    for (const std::string& file : folder.files()) {
        if (!file.ends_with("summary.csv") && !file.ends_with("floats.csv") && !file.ends_with("binades.csv")) continue;
        for (auto& row : read_csv(folder.path() / file)) {
            if (row["form"].starts_with("example.")) continue;
            std::string text = file;
            for (const auto& [column, cell] : row)
                if (!column.ends_with("_explain")) text += "," + cell;
            left.push_back(text);
        }
    }
    return left;
}

std::string environment(const std::string& when, const std::string& what) {
    return "export WHEN=" + when + " CHANGES=" + what + ";";
}

}  // namespace

TEST_CASE("state: a library that changes the processor state at any time changes no other row", "[external]") {
    std::array<std::vector<std::string>, commands> right;
    for (std::size_t command = 0; command < commands; ++command) right[command] = rows_left(command, "", "");
    REQUIRE(right[0].size() + right[1].size() + right[2].size() == 8);
    // The short tests run one way and one command for each pair. With four of each, every way and every command occurs
    // at least once with each `when` and each `what`.
    const std::string ways[] = {" -j 1", " -j 4", " --isolate -j 1", " --isolate -j 4"};
    const auto hold = [&right](std::size_t turn, const std::string& more, const std::string& before) {
        for (std::size_t command = 0; command < commands; ++command) {
            if (!is_long() && command != turn % commands) continue;
            INFO(before << more << " command " << command);
            CHECK(rows_left(command, more, before) == right[command]);
        }
    };
    std::size_t turn = 0;
    for (const std::string when : {"load", "list", "call", "thread"}) {
        for (const std::string what : {"rounding", "flush", "denormals", "x87"}) {
            for (std::size_t w = 0; w < 4; ++w)
                if (is_long() || w == (turn / 4 + turn) % 4)
                    hold(turn / 4 + turn, " --plugin " + library + ways[w], environment(when, what));
            ++turn;
        }
    }
    // With LD_PRELOAD, the loader runs it before the program begins.
    for (const std::string what : {"rounding", "flush", "denormals", "x87"})
        for (const std::string when : {"load", "yield"})
            hold(turn++, "", environment(when, what) + "export LD_PRELOAD=" + library + ";");
}

TEST_CASE("state: a library that flushes subnormal numbers is measured so by every command", "[external]") {
    const Scratch folder;
    static_cast<void>(folder.write("tiny.toml", tiny));
    const auto answers = [&](const std::string& when, const std::string& more) {
        must("-q map tiny.toml -i 'example.*' -f f32 -o out --plugin " + library + more, folder.path(),
             environment(when, "flush"));
        return contents(folder.path() / "out/tiny/example.schoolbook.f32.csv").empty()
                   ? read_csv(folder.path() / "out/tiny/summary.csv").front().at("false_miss") +
                         read_csv(folder.path() / "out/tiny/summary.csv").front().at("false_hit")
                   : "";
    };
    const std::string usual = answers("never", "");
    for (const std::string when : {"load", "list", "call"}) {
        const std::string flushed = answers(when, " -j 1");
        INFO(when);
        CHECK(flushed != usual);
        for (const std::string more : {" -j 2", " -j 4", " --isolate -j 1", " --isolate -j 4"})
            CHECK(answers(when, more) == flushed);
    }
}

TEST_CASE("state: a library that changes the processor state is reported once", "[external]") {
    const Scratch folder;
    const auto run_when = [&](const std::string& when, const std::string& command) {
        return run(command, folder.path(), environment(when, "flush"));
    };
    const std::string map = "map near-benign --size 64x48 -i 'example.*' -f f32,f64 -j 4 -o out --plugin " + library;
    for (const std::string option : {"", " --isolate"}) {
        const auto loaded = run_when("load", map + option);
        INFO(option << loaded.err);
        CHECK(loaded.code == 0);
        CHECK(count_in(loaded.err, "changes how the processor computes (flush_to_zero) when it is loaded") == 1);
        const auto called = run_when("call", map + option);
        INFO(called.err);
        CHECK(called.code == 0);
        CHECK(count_in(called.err, "changes how the processor computes during a call") >= 1);
        CHECK(count_in(called.err, "changes how the processor computes during a call") <= 2);  // a form in two formats
        CHECK_FALSE(has(run_when("never", map + option).err, "how the processor computes"));
        CHECK_FALSE(has(run_when("load", "-q " + map + option).err, "how the processor computes"));
    }
    for (const std::string option : {"", " --isolate"}) {
        const auto loaded = run_when("load", "plugin check " + library + option);
        CHECK(has(loaded.out, "state        loading its library leaves the processor with flush_to_zero"));
        const auto called = run_when("call", "plugin check " + library + option);
        INFO(called.out);
        CHECK(called.code == 1);
        CHECK(has(called.out, "BROKEN state"));
        CHECK(run_when("never", "plugin check " + library + option).code == 0);
    }
}

}  // namespace test_state
