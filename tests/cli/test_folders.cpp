// A run owns its folder of results: what an earlier run left there goes, what is somebody's own stays, and every file
// that can hold it says what made it.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"

namespace test_folders {

using namespace lostbits::test;
using Json = nlohmann::json;

namespace {

/// What the list names, and itself.
std::vector<std::string> listed_in(const fs::path& folder) {
    std::vector<std::string> names = Json::parse(contents(folder / "manifest.json")).at("files");
    names.emplace_back("manifest.json");
    std::ranges::sort(names);
    return names;
}

std::string rays() {
    std::string text = "ox,oy,oz,dx,dy,dz,hit,t\n";
    for (int i = 0; i < 16; ++i) text += "0,0,-5,0,0,1,1,4\n";
    return text;
}

}  // namespace

TEST_CASE("a second run into a folder leaves nothing of the first") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    scratch.write("rays.csv", rays());
    struct Pair {
        std::string first, second, folder;
    };
    const Pair pairs[] = {
        {"map mine.toml -i sphere.press,sphere.unified -f f32,f64 --metric culprit,lost_bits --pixels csv --exr -o out",
         "map mine.toml -i sphere.press -f f32 -o out", "mine"},
        {"render raycast-course.small --size 8x6 -i sphere.press,sphere.unified -o out",
         "render raycast-course.small --size 8x6 -i sphere.press -o out", "raycast-course.small"},
        {"offsets near-benign --size 8x6 --strategy offset.none,offset.bound --pixels csv --along world -o out",
         "offsets near-benign --size 8x6 --strategy offset.none -o out", "near-benign"},
        {"consistency near-benign --size 8x6 -i sphere.press,sphere.unified --pixels csv -o out",
         "consistency near-benign --size 8x6 -i sphere.press --check packs -o out", "near-benign"},
        {"judge rays.csv --sphere 0,0,0,1 -i sphere.press --size 4x4 --metric lost_bits,ulp_error --rows -o out",
         "judge rays.csv --sphere 0,0,0,1 -o out", "rays"},
        {"sweep sphere-tilt --steps 4 -i sphere.press,sphere.unified -f f32,f64 --seeds 0 -o out",
         "sweep sphere-tilt --steps 4 -i sphere.press -f f32 --seeds 0 -o out", "sphere-tilt"},
        {"sweep extremes/contact -i sphere.press,sphere.unified -f f32,f64 -o out",
         "sweep extremes/contact -i sphere.press -f f32 -o out", "contact"},
        {"trade --quick --repetitions 1 -i sphere.press,sphere.unified -o out",
         "trade --quick --repetitions 1 -i sphere.press -f f32 -o out", "sphere"}};
    for (const Pair& pair : pairs) {
        INFO(pair.second);
        const fs::path folder = scratch / "out" / pair.folder;
        must(pair.first, scratch.path());
        CHECK(files_below(folder) == listed_in(folder));
        const std::size_t before = files_below(folder).size();
        std::ofstream(folder / "notes.txt") << "mine";
        must(pair.second, scratch.path());
        auto after = files_below(folder);
        CHECK(std::erase(after, "notes.txt") == 1);
        CHECK(after == listed_in(folder));
        CHECK(after.size() <= before);
        // As into a new folder.
        fs::rename(scratch / "out", scratch / "old");
        must(pair.second, scratch.path());
        CHECK(files_below(folder) == after);
        fs::remove_all(scratch / "old");
    }
}

TEST_CASE("results that no list names are refused, and stay with --force") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const std::string words = "map mine.toml -i sphere.press -f f32 -o out";
    const fs::path folder = scratch / "out/mine";
    fs::create_directories(folder);
    std::ofstream(folder / "older.png") << "x";
    const auto r = run(words, scratch.path());
    CHECK(r.code == 2);
    CHECK(has(r.err, "holds results that are not in its manifest.json: older.png"));
    CHECK(has(r.err, "--force"));
    CHECK(files_below(folder) == std::vector<std::string>{"older.png"});
    must(words + " --force", scratch.path());
    CHECK(contents(folder / "older.png") == "x");
    CHECK(fs::exists(folder / "summary.csv"));
}

TEST_CASE("a list can name nothing outside its folder") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const std::string words = "map mine.toml -i sphere.press -f f32 -o out";
    must(words, scratch.path());
    const fs::path folder = scratch / "out/mine";
    fs::create_directories(scratch / "elsewhere");
    std::ofstream(scratch / "elsewhere/kept.csv") << "x";
    std::ofstream(scratch / "kept.csv") << "x";
    fs::create_directory_symlink(scratch / "elsewhere", folder / "link");
    auto list = Json::parse(contents(folder / "manifest.json"));
    for (const char* name : {"../../kept.csv", "link/kept.csv", "/etc/hostname", ""}) list["files"].push_back(name);
    std::ofstream(folder / "manifest.json") << list.dump();
    must(words, scratch.path());
    CHECK(fs::exists(scratch / "kept.csv"));
    CHECK(fs::exists(scratch / "elsewhere/kept.csv"));
    std::ofstream(folder / "manifest.json") << "not a list";
    CHECK(run(words, scratch.path()).code == 2);
}

TEST_CASE("what a killed run left goes, what a living one writes stays") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const std::string words = "map mine.toml -i sphere.press -f f32 -o out";
    const auto killed =
        run("map mine.toml -i sphere.press -f f32 --size 3000x3000 -o out & child=$!; while [ -z "
            "\"$(ls -A out/mine "
            "2>/dev/null)\" ]; do sleep "
            "0.05; done; sleep 0.3; kill -KILL $child; wait $child; exit $?",
            scratch.path());
    REQUIRE(killed.code == 128 + 9);
    const fs::path folder = scratch / "out/mine";
    const auto left = files_below(folder);
    REQUIRE(std::ranges::any_of(left, [](const std::string& name) { return has(name, ".partial-"); }));
    // A living run holds a lock on what it writes.
    const fs::path living = folder / ".other.csv.partial-1";
    const int fd = ::open(living.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    REQUIRE(fd >= 0);
    REQUIRE(::flock(fd, LOCK_EX) == 0);
    must(words, scratch.path());
    auto now = files_below(folder);
    CHECK(std::erase(now, ".other.csv.partial-1") == 1);
    CHECK(now == listed_in(folder));
    ::close(fd);
    must(words, scratch.path());
    CHECK(files_below(folder) == listed_in(folder));
}

TEST_CASE("two runs do not write into one folder at a time") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const fs::path folder = scratch / "out/mine";
    fs::create_directories(folder);
    const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    REQUIRE(::flock(fd, LOCK_EX) == 0);
    const auto r = run("map mine.toml -i sphere.press -f f32 -o out", scratch.path());
    CHECK(r.code == 2);
    CHECK(has(r.err, "another run is writing there"));
    ::close(fd);
    must("map mine.toml -i sphere.press -f f32 -o out", scratch.path());
}

TEST_CASE("a run that is stopped before it has results leaves those that were there") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    must("map mine.toml -i sphere.press -f f32,f64 -o out", scratch.path());
    const auto before = files_below(scratch / "out/mine");
    const auto r = run(
        "map mine.toml -i sphere.press -f f32 --size 3000x3000 --metric culprit -j 1 -o out & child=$!; sleep 1; kill "
        "-TERM $child; "
        "wait $child; exit $?",
        scratch.path());
    CHECK(r.code == 130);
    CHECK(files_below(scratch / "out/mine") == before);
}

TEST_CASE("every file that can hold it says the command, what was set, and the version") {
    draw_pictures();
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const fs::path folder = scratch / "out/mine";
    must("map mine.toml -i 'sphere.p*' -f f32 --set 'sphere[0].radius=0.5' --size 16x16 --exr -j 2 -q -o out",
         scratch.path());
    const std::string command =
        "lostbits map mine.toml -i 'sphere.p*' -f f32 --size 16x16 --set 'sphere[0].radius=0.5' --exr";
    std::string version = run("--version").out;
    version.pop_back();
    const auto list = Json::parse(contents(folder / "manifest.json"));
    CHECK(list.at("command") == command);
    CHECK(list.at("program") == version);
    const auto package = Json::parse(contents(folder / "datapackage.json")).at("lostbits");
    CHECK(package.at("command") == command);
    CHECK(package.at("program") == version);
    for (const std::string& name : files_below(folder)) {
        INFO(name);
        if (!name.ends_with(".png") && !name.ends_with(".exr")) continue;
        const std::string bytes = contents(folder / name);
        CHECK(has(bytes, version));
        CHECK(has(bytes, "--set 'sphere[0].radius=0.5'"));
        if (name.ends_with(".png")) CHECK(has(bytes, "lostbits:command" + std::string(1, '\0') + command));
    }
    // Typed again, the command makes the same bytes.
    const std::string picture = contents(folder / "contact.png");
    must(command.substr(std::string("lostbits ").size()) + " -o again", scratch.path());
    CHECK(contents(scratch / "again/mine/contact.png") == picture);
    CHECK(contents(scratch / "again/mine/manifest.json") == contents(folder / "manifest.json"));
}

TEST_CASE("a page and a judgement name their command as well") {
    const Scratch scratch;
    scratch.write("rays.csv", rays());
    must("judge rays.csv --sphere 0,0,0,1 -i sphere.press -f f32 -o out", scratch.path());
    const auto list = Json::parse(contents(scratch / "out/rays/manifest.json"));
    CHECK(list.at("command") == "lostbits judge rays.csv --sphere 0,0,0,1 -i sphere.press -f f32");
    must("report near-benign --size 8x8 -i sphere.press -f f32 --no-claims -o page", scratch.path());
    std::string version = run("--version").out;
    version.pop_back();
    CHECK(has(contents(scratch / "page/index.html"), version));
    const auto page = Json::parse(contents(scratch / "page/manifest.json"));
    CHECK(page.at("command") == "lostbits report near-benign -i sphere.press -f f32 --size 8x8 --no-claims");
    CHECK(page.at("files") == Json::array({"index.html"}));
}

TEST_CASE("a folder that a report and checked claims share keeps both, and its list says which made what") {
    const Scratch scratch;
    const fs::path folder = scratch / "page";
    const std::string check = "check --filter 'float.*' --report page",
                      report = "report near-benign --size 8x8 -i sphere.press -f f32 --no-claims -o page";
    must(check, scratch.path());
    const auto claims = files_below(folder);
    must(report, scratch.path());
    for (int again = 0; again < 2; ++again) {
        const auto list = Json::parse(contents(folder / "manifest.json"));
        CHECK(list.at("files") == Json::array({"index.html"}));
        REQUIRE(list.at("others").size() == 1);
        CHECK(has(list.at("others")[0].at("command").get<std::string>(), "lostbits check"));
        CHECK(list.at("others")[0].at("files").size() + 1 == claims.size());
        CHECK(files_below(folder).size() == claims.size() + 1);
        must(again == 0 ? report : check, scratch.path());
    }
    CHECK(fs::exists(folder / "index.html"));
    CHECK(files_below(folder).size() == claims.size() + 1);
}

TEST_CASE("an interrupted report leaves no folder") {
    const Scratch scratch;
    const auto r =
        run("report near-benign --size 700x700 -j 1 -o page/inner & child=$!; sleep 1.5; kill -TERM $child; "
            "wait $child; exit $?",
            scratch.path(), "set -m; ");
    CHECK(r.code == 130);
    CHECK(scratch.files().empty());
    CHECK_FALSE(fs::exists(scratch / "page"));
}

}  // namespace test_folders
