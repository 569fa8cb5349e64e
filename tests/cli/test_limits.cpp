// Input that declares more than it contains, is expensive to read, or leads out of its folder; and machines with little
// memory.
#include <algorithm>
#include <numeric>
#include <random>
#include <tuple>

#include "catch.hpp"
#include "program.hpp"

namespace test_limits {

using namespace lostbits::test;

namespace {

void put(std::string& bytes, std::uint64_t number, int size) {
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(number >> (8 * i) & 0xFF);
}

void put_attribute(std::string& bytes, const std::string& name, const std::string& type, const std::string& value) {
    bytes += name + '\0' + type + '\0';
    put(bytes, value.size(), 4);
    bytes += value;
}

/// The head of an OpenEXR file of so many pixels a side and 19 float channels, compressed as ZIP, and an empty table of
/// where its parts begin.
std::string exr_head(std::uint64_t side) {
    std::string channels, window, bytes("\x76\x2f\x31\x01\x02\x00\x00\x00", 8);
    for (char c = 'a'; c < 'a' + 19; ++c) {
        channels += std::string(1, c) + '\0';
        for (const std::uint64_t number : {2, 0, 1, 1}) put(channels, number, 4);  // float, sampled everywhere
    }
    channels += '\0';
    for (const std::uint64_t number : {std::uint64_t{0}, std::uint64_t{0}, side - 1, side - 1}) put(window, number, 4);
    put_attribute(bytes, "channels", "chlist", channels);
    put_attribute(bytes, "compression", "compression", "\x03");
    put_attribute(bytes, "dataWindow", "box2i", window);
    put_attribute(bytes, "displayWindow", "box2i", window);
    put_attribute(bytes, "lineOrder", "lineOrder", std::string(1, '\0'));
    put_attribute(bytes, "pixelAspectRatio", "float", std::string("\x00\x00\x80\x3f", 4));
    put_attribute(bytes, "screenWindowCenter", "v2f", std::string(8, '\0'));
    put_attribute(bytes, "screenWindowWidth", "float", std::string("\x00\x00\x80\x3f", 4));
    bytes += '\0';
    for (std::uint64_t part = 0; part < (side + 15) / 16; ++part) put(bytes, bytes.size() + 8, 8);
    return bytes + std::string(20000, '\0');
}

/// Seconds of work after which a run is ended: far above the time it needs, far below the time it needed before.
std::string at_most(int seconds) { return "ulimit -t " + std::to_string(seconds) + ";"; }

}  // namespace

TEST_CASE("a picture that declares more than its file can hold is refused before memory is taken") {
    draw_pictures();
    const Scratch scratch;
    scratch.write("a.exr", exr_head(16384));
    scratch.write("b.exr", exr_head(16384) + "x");
    const auto r = run("diff a.exr b.exr", scratch.path(), under_sanitizer ? "" : "ulimit -v 4000000;");
    CHECK(r.code == 2);
    CHECK(has(r.err, "a.exr: claims 16384x16384 pixels of 76 bytes, 20 GB, which no file of"));
    CHECK(has(r.err, "give one that is complete"));
}

TEST_CASE("numbers of any size are compared quickly") {
    const Scratch scratch;
    std::string huge = "x\n", tiny = "x\n", hex = "x\n", other = "x\n";
    for (int i = 0; i < 4000; ++i)
        huge += "1e9999\n", tiny += "1e-9999\n", hex += "0x1p-1100\n", other += "0x1p-1101\n";
    scratch.write("huge.csv", huge);
    scratch.write("tiny.csv", tiny);
    scratch.write("hex.csv", hex);
    scratch.write("other.csv", other);
    for (const char* words : {"huge.csv tiny.csv", "hex.csv other.csv", "huge.csv tiny.csv --allow x=0.5,1e-3"}) {
        const auto r = run("diff " + std::string(words), scratch.path(), at_most(5));
        INFO(words << r.err);
        CHECK(r.code == 1);
        CHECK(has(r.out, "4000 differences, in 4000 of 4000 rows"));
    }
}

TEST_CASE("diff handles any number of moved columns") {
    const Scratch scratch;
    std::vector<int> order(60000);
    std::iota(order.begin(), order.end(), 0);
    const auto table = [&] {
        std::string names, cells;
        for (const int i : order) {
            names += (names.empty() ? "c" : ",c") + std::to_string(i);
            cells += (cells.empty() ? "" : ",") + std::to_string(i);
        }
        return names + "\n" + cells + "\n";
    };
    scratch.write("a.csv", table());
    std::ranges::shuffle(order, std::mt19937(1));
    scratch.write("b.csv", table());
    const auto r = run("diff a.csv b.csv", scratch.path(), at_most(5));
    CHECK(r.code == 1);
    CHECK(has(r.out, "moved from place"));
}

TEST_CASE("no file name leads out of the folder of results") {
    const Scratch scratch;
    fs::create_directories(scratch / "in/of-a-map");
    scratch.write("in/of-a-map/...toml", good_scene);
    scratch.write("in/...toml", small_sweep);
    scratch.write("in/...csv", "ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,1\n");
    scratch.write("in/a\nb.toml", small_sweep);
    const auto before = scratch.files();
    for (const std::string words :
         {"map of-a-map/...toml", "sweep ./...toml -i sphere.press -f f32", "judge ./...csv --sphere 0,0,0,1",
          "sweep 'a\nb.toml'", "choose ./...csv --sphere 0,0,0,1 --bits 3"}) {
        const auto r = run(words + " -o out", scratch / "in");
        INFO(words << "\n" << r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err, "rename it"));
        CHECK(scratch.files() == before);
    }
}

TEST_CASE("a run that needs too many open files stops before the work, and nothing is written") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const auto few =
        run("map mine.toml -i 'sphere.*' -f p2..p53 --pictures all -o out", scratch.path(), "ulimit -n 128;");
    CHECK(few.code == 3);
    CHECK(has(few.err, "files at once, but this machine allows a process only 128 open files (`ulimit -n`)"));
    CHECK(has(few.err, "select fewer forms, formats or metrics"));
    CHECK(scratch.files() == std::vector<std::string>{"mine.toml"});
    if (under_sanitizer) return;
    const auto little = run("map mine.toml -i 'sphere.*' -f p2..p53 --metric '*' --pictures all -o out", scratch.path(),
                            "ulimit -v 2000000;");
    CHECK(little.code == 3);
    // The message is about memory if the machine allows so many open files.
    CHECK((has(little.err, " of memory, but only ") || has(little.err, "(`ulimit -n`)")));
    CHECK(scratch.files() == std::vector<std::string>{"mine.toml"});
}

TEST_CASE("a failure of the machine ends the run with 3 and leaves no half-written file") {
    const Scratch scratch;
    scratch.write("scene.toml", good_scene);
    const std::string map = "map scene.toml -i sphere.press -f f32 ", itself = (scratch / "scene.toml").string();
    // The limit on a file's size stands in for the full disk: 8 blocks of 1024 bytes in bash, 512 in others.
    for (const auto& [words, before, says] :
         {std::tuple<std::string, std::string, std::string>{"-o /proc/nowhere", "", "/proc/nowhere"},
          {"-o '" + itself + "'", "", itself},
          {"-o out", "LOSTBITS_IMAGE_MODULE=/nowhere.so", "/nowhere.so"},
          {"-o out --size 400x400", "ulimit -f 8;", "cannot write"}}) {
        const auto r = run(map + words, scratch.path(), before);
        CHECK(r.code == 3);
        CHECK(has(r.err, says));
        CHECK(scratch.files() == std::vector<std::string>{"scene.toml"});
    }
    CHECK(run("list metrics >&- 2>&-").code == 3);
    CHECK(has(run("list intersectors >/dev/full").err, "standard output"));
}

}  // namespace test_limits
