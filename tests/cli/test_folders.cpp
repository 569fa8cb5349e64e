// A run owns its folder of results. Results of an earlier run are removed, other people's files stay, and every file
// that can hold it names the command that made it.
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

/// Returns the files that the manifest of a folder names, and the manifest itself, in order.
std::vector<std::string> list_files_of_manifest(const fs::path& folder) {
    std::vector<std::string> names = Json::parse(contents(folder / "manifest.json")).at("files");
    names.emplace_back("manifest.json");
    std::ranges::sort(names);
    return names;
}

std::string make_ray_table() {
    std::string text = "ox,oy,oz,dx,dy,dz,hit,t\n";
    for (int i = 0; i < 16; ++i) text += "0,0,-5,0,0,1,1,4\n";
    return text;
}

}  // namespace

namespace {

struct SmallRun {
    std::string words, more;    ///< as their list says them; `more` adds files
    std::string folder, table;  ///< of the results; the table that `-o -` writes, none where it has times
    bool has_sheet = true;      ///< its pictures are contact sheets, but with --pictures all
};
const SmallRun small_runs[] = {
    {"map mine.toml -i sphere.press -f f32",
     "-i sphere.unified -f f64 --metric culprit,lost_bits --pixels csv --exr --pictures all", "mine", "summary.csv"},
    {"render raycast-course.small -i sphere.press --size 8x6", "-i sphere.unified --pictures all",
     "raycast-course.small", "summary.csv"},
    {"offsets near-benign --strategy offset.none --size 8x6",
     "--strategy offset.bound --pixels csv --along world --pictures all", "near-benign", "summary.csv"},
    {"consistency near-benign -i sphere.press --check packs --size 8x6",
     "-i sphere.unified --check segment --pixels csv --pictures all", "near-benign", "summary.csv"},
    {"judge rays.csv --sphere 0,0,0,1 --size 4x4", "-i sphere.press --metric lost_bits,ulp_error --rows --pictures all",
     "rays", "summary.csv"},
    {"sweep sphere-tilt -i sphere.press -f f32 --seeds 0 --steps 4", "-i sphere.unified -f f64", "sphere-tilt",
     "samples.csv", false},
    {"sweep sphere-height -i sphere.press -f f32 --steps 3,2 --set views=8", "-i sphere.unified -f f64 --pictures all",
     "sphere-height", "samples.csv"},
    {"sweep extremes/contact -i sphere.press -f f32", "-i sphere.unified -f f64", "contact", "cases.csv", false},
    {"trade -i sphere.press -f f32 --repetitions 1 --quick", "-i sphere.unified -f f64", "sphere", "", false}};

/// Counts the pictures among the files of a folder that are not contact sheets.
std::size_t count_single_pictures(const std::vector<std::string>& files) {
    return static_cast<std::size_t>(std::ranges::count_if(
        files, [](const std::string& name) { return name.ends_with(".png") && !name.starts_with("contact"); }));
}

}  // namespace

TEST_CASE("a second run replaces all results of the first, and -o - writes its table to standard output only") {
    const Scratch scratch, temporary;
    scratch.write("mine.toml", good_scene);
    scratch.write("rays.csv", make_ray_table());
    for (const SmallRun& row : small_runs) {
        INFO(row.words);
        const fs::path folder = scratch / "out" / row.folder;
        must(row.words + " " + row.more + " -o out", scratch.path());
        const auto before = files_below(folder);
        CHECK(before == list_files_of_manifest(folder));
        std::ofstream(folder / "notes.txt") << "mine";
        must(row.words + " -o out", scratch.path());
        auto after = files_below(folder);
        CHECK(std::erase(after, "notes.txt") == 1);
        CHECK(after == list_files_of_manifest(folder));
        CHECK(after.size() <= before.size());
        CHECK((!row.has_sheet || (count_single_pictures(after) == 0 && count_single_pictures(before) > 0)));
        // As into a new folder.
        fs::remove_all(scratch / "out");
        must(row.words + " -o out", scratch.path());
        CHECK(files_below(folder) == after);
        CHECK(Json::parse(contents(folder / "manifest.json")).at("command") == "lostbits " + row.words);
        if (!row.table.empty()) {
            const auto r =
                must(row.words + " -o -", scratch.path(), "export TMPDIR='" + temporary.path().string() + "';");
            CHECK(r.out == contents(folder / row.table));
            CHECK_FALSE(has(r.err, temporary.path().string()));
            CHECK(temporary.files().empty());
            CHECK_FALSE(fs::exists(scratch / "-"));
        }
        fs::remove_all(scratch / "out");
    }
}

TEST_CASE("a list of results cannot name files outside its folder") {
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

TEST_CASE("two runs cannot write to one folder at the same time") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const fs::path folder = scratch / "out/mine";
    fs::create_directories(folder);
    const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    REQUIRE(::flock(fd, LOCK_EX) == 0);
    const auto r = run("map mine.toml -i sphere.press -f f32 -o out", scratch.path());
    CHECK(r.code == 2);
    CHECK(has(r.err, "another run is writing to this folder"));
    ::close(fd);
    must("map mine.toml -i sphere.press -f f32 -o out", scratch.path());
}

TEST_CASE("every result file that can hold it has the command, the settings and the version") {
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

TEST_CASE("an HTML page names its command") {
    const Scratch scratch;
    must("report near-benign --size 8x8 -i sphere.press -f f32 --no-claims -o page", scratch.path());
    std::string version = run("--version").out;
    version.pop_back();
    CHECK(has(contents(scratch / "page/index.html"), version));
    const auto page = Json::parse(contents(scratch / "page/manifest.json"));
    CHECK(page.at("command") == "lostbits report near-benign -i sphere.press -f f32 --size 8x8 --no-claims");
    CHECK(page.at("files") == Json::array({"index.html"}));
}

TEST_CASE("a folder shared by a report and checked claims keeps both, and its list names the command of each file") {
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
    const auto r = run("report near-benign --size 700x700 -j 1 -o page/inner" + end_after(1.5, "TERM"), scratch.path(),
                       "set -m; ");
    CHECK(r.code == 130);
    CHECK(scratch.files().empty());
    CHECK_FALSE(fs::exists(scratch / "page"));
}

}  // namespace test_folders
