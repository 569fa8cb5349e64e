// The help of the commands, the old names of options, the folder without -o, and files of another kind.
#include <algorithm>
#include <cstdlib>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "catch.hpp"
#include "program.hpp"

namespace test_help {

using namespace lostbits::test;

namespace {

std::vector<std::string> split_lines(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

/// The command lines below `Examples:`.
std::vector<std::string> examples_of(const std::string& help) {
    std::vector<std::string> examples;
    bool below = false;
    for (const std::string& line : split_lines(help)) {
        if (line == "Examples:") below = true;
        else if (below && line.empty()) break;
        else if (below && line.starts_with("  lostbits ")) examples.push_back(line.substr(2));
    }
    return examples;
}

/// Files that the examples name: the project's data and examples, two equal maps, a shard, and a library.
void lay_out(const Scratch& scratch) {
    fs::create_directory_symlink(LOSTBITS_DATA_DIR, scratch / "data");
    fs::create_directory_symlink(fs::path(LOSTBITS_DATA_DIR).parent_path() / "examples", scratch / "examples");
    for (const char* folder : {"before", "after"})
        must("-q map near-benign -i sphere.press -f f32 --size 8x8 -o " + std::string(folder), scratch.path());
    must("-q map near-benign -i sphere.press -f f32 --size 8x8 --shard 1/1 -o parts", scratch.path());
    const std::string plugins = (fs::path(LOSTBITS_DATA_DIR).parent_path() / "plugins").string();
    const std::string compiler = "c++ -std=c++20 -O1 -shared -fPIC -I'" + plugins + "' '" + plugins;
    REQUIRE(std::system((compiler + "/schoolbook.cpp' -o '" + (scratch / "mine.so").string() + "'").c_str()) == 0);
}

/// Runs through a shell in which `lostbits` is the program.
int status_of(const std::string& line, const Scratch& scratch) {
    const std::string script = scratch.write("script", "lostbits() { '" LOSTBITS_PROGRAM "' \"$@\"; }\n" + line + "\n");
    const int status =
        std::system(("cd '" + scratch.path().string() + "' && bash '" + script + "' >said 2>&1 </dev/null").c_str());
    return WEXITSTATUS(status);
}

/// The rows of the table in CHANGELOG.md: a command with the old name of an option, and with the new one.
std::vector<std::pair<std::string, std::string>> renamed_in_changelog() {
    static const std::regex row(R"(\s*\| `([^`]*)` \| `([^`]*)` \|)");
    std::vector<std::pair<std::string, std::string>> rows;
    for (const std::string& line : split_lines(contents(fs::path(LOSTBITS_DATA_DIR).parent_path() / "CHANGELOG.md"))) {
        std::smatch part;
        if (std::regex_match(line, part, row)) rows.emplace_back(part[1], part[2]);
    }
    return rows;
}

constexpr const char* rays = "ox,oy,oz,dx,dy,dz,hit,t\n0,0,-5,0,0,1,1,4\n0,0.5,-5,0,0,1,1,4.5\n";

}  // namespace

TEST_CASE("the help of every command has two examples, its own options and one footer line") {
    for (const std::string& command : commands()) {
        INFO(command);
        const std::string help = must(command + " --help").out;
        CHECK(examples_of(help).size() == 2);
        CHECK(has(help, "\nOptions of every command:\n"));
        for (const char* option : {"--data", "--plugin", "--isa", "--threads", "--quiet"}) CHECK(has(help, option));
        for (const char* raw : {"TEXT", "ENUM", "INT", " in {", " in [", "Needs:", "Excludes:", "Exit status:"})
            CHECK_FALSE(has(help, raw));
        CHECK(split_lines(help).back().starts_with("`lostbits --help` explains"));
        for (const std::string& line : split_lines(help)) {
            INFO(line);
            const bool is_one_word = line.find_first_not_of(' ') == std::string::npos ||
                                     line.find(' ', line.find_first_not_of(' ')) == std::string::npos;
            CHECK((line.size() <= 120 || is_one_word || line.starts_with("  lostbits ")));
        }
    }
    CHECK(has(must("map --help").out, "--pixels none|csv"));
    CHECK(has(must("--help").out, "--progress auto|bar|none"));
    for (const char* section : {"Exit status:", "Environment:"}) CHECK(has(must("--help").out, section));
    for (const char* section : {"\nFiles of rays (docs/judge.md):\n", "\nPrimitives of all rays (may be repeated; "})
        CHECK(has(must("judge --help").out, section));
}

TEST_CASE("the examples in the help run") {
    const Scratch scratch;
    lay_out(scratch);
    std::set<std::string> seen;
    for (const std::string& command : commands()) {
        for (const std::string& example : examples_of(must(command + " --help").out)) {
            INFO(example);
            CHECK(seen.insert(example).second);
            const int status = status_of(example, scratch);
            INFO(contents(scratch / "said"));
            // No driver runs shaders on some machines.
            CHECK((status == 0 || (command == "devices" && status == 3)));
        }
    }
}

TEST_CASE("internal commands are not listed") {
    CHECK_FALSE(commands().contains("shader"));
    CHECK_FALSE(has(must("plugin --help").out, "serve"));
    CHECK_FALSE(has(must("manual").out, "plugin serve"));
    CHECK(has(must("shader --help").out, "serve"));
    for (const char* shell : {"bash", "zsh", "fish"})
        CHECK_FALSE(has(must("completion " + std::string(shell)).out, "probe"));
}

TEST_CASE("old names of options are accepted, with one line that gives the new name") {
    const Scratch scratch;
    scratch.write("a.csv", "x,y\n1,2\n");
    scratch.write("b.csv", "x,y\n1,2.5\n");
    scratch.write("rays.csv", rays);
    const std::string on_rays = "rays.csv --sphere 0,0,0,1 -o out";
    const std::string at_step = "sphere-distance --ranges --set views=1 --set rays=4 --pieces 1 -i sphere.unified";
    const std::vector<std::pair<std::string, std::pair<std::string, std::string>>> uses{
        {"diff a.csv b.csv", {"--tolerance y=1", "--allow y=1"}},
        {"diff a.csv a.csv", {"--pictures", "--compare-pictures"}},
        {"explain " + at_step, {"--at 4", "--at-step 4"}},
        {"explain near-benign --size 4x4 --ranges -i sphere.unified", {"--boxes 2", "--pieces 2"}},
        {"explain near-benign --size 4x4 --ranges --pieces 1 -i sphere.unified",
         {"--range d.x=0..0.1", "--input-range d.x=0..0.1"}},
        {"judge " + on_rays, {"--format f32", "--answer-format f32"}},
        {"judge " + on_rays, {"--file-format f32", "--answer-format f32"}},
        {"choose " + on_rays + " -i sphere.unified -f f32 --bits 1 --quick",
         {"--file-format f32", "--answer-format f32"}},
        {"mend " + on_rays + " -i sphere.unified --bits 1", {"--file-format f32", "--answer-format f32"}},
        {"judge " + on_rays, {"--worst=1", "--worst-rays=1"}},
        {"map near-benign --size 4x4 -i sphere.unified -f f32 -o out", {"--bits-needed 8", "--bits 8"}},
        {"map near-benign --size 4x4 -f f32 -o out", {"--intersector sphere.unified", "--form sphere.unified"}},
        {"trade --size 4x4 -i sphere.unified -f f32 --quick -o out", {"--scene near-benign", "near-benign"}},
        {"list", {"hulls", "boxes"}},
        {"list", {"makers", "generators"}},
        {"list", {"spaces", "transforms"}}};
    const auto rows = renamed_in_changelog();
    CHECK(rows.size() == uses.size());
    for (const auto& [line, names] : uses) {
        INFO(line << " " << names.first);
        const std::string command = line.substr(0, line.find(' '));
        const std::string before = names.first.substr(0, names.first.find_first_of(" =")),
                          now = names.second.substr(0, names.second.find_first_of(" ="));
        const auto lists = [&](const std::string& name) {
            return std::ranges::any_of(rows, [&](const auto& row) {
                return row.first.starts_with(name + " " + before) &&
                       (row.second.starts_with(name + " " + now) || now.front() != '-');
            });
        };
        CHECK((lists(command) || lists("COMMAND")));  // COMMAND: every command
        const auto old_run = must("-j 1 " + line + " " + names.first, scratch.path());
        const auto new_run = must("-j 1 " + line + " " + names.second, scratch.path());
        const bool is_option = before.front() == '-';
        const std::string advice =
            "lostbits: " + command + " " + before + (is_option ? ": the option " : ": the list ");
        CHECK(has(old_run.err, advice));
        CHECK(old_run.err.find(advice) == old_run.err.rfind(advice));
        CHECK(has(old_run.err,
                  !is_option || now.front() == '-' ? "has been renamed to " + now + "\n" : "write SCENE without it\n"));
        CHECK_FALSE(has(new_run.err, ": the option "));
        if (command != "trade" && command != "choose") CHECK(old_run.out == new_run.out);  // the others print times
        CHECK_FALSE(has(must("-q " + line + " " + names.first, scratch.path()).err, advice));
    }
    // Words that look like options but are not: a value, and words behind `--`.
    CHECK_FALSE(has(run("diff a.csv -- --pictures", scratch.path()).err, ": the option "));
    CHECK(has(run("-j 1 --progress none judge rays.csv --format=f23", scratch.path()).err,
              "--answer-format f23: unknown"));
}

TEST_CASE("without -o results go to a folder named after the command") {
    const Scratch scratch;
    scratch.write("rays.csv", rays);
    must("map near-benign --size 4x4 -i sphere.press -f f32", scratch.path());
    CHECK(fs::exists(scratch / "out/map/near-benign/summary.csv"));
    must("judge rays.csv --sphere 0,0,0,1", scratch.path());
    CHECK(fs::exists(scratch / "out/judge/rays/summary.csv"));
    must("report near-benign --no-claims --size 4x4 -i sphere.press -f f32", scratch.path());
    CHECK(fs::exists(scratch / "out/report/index.html"));
    for (const std::string& command : commands()) {
        const std::string help = must(command + " --help").out;
        if (has(help, "-o,--out FOLDER") && command != "mend") CHECK(has(help, "(default: out/" + command + ")"));
    }
}

TEST_CASE("a file of another kind is refused with its kind and the command that takes it") {
    const Scratch scratch;
    const fs::path data = LOSTBITS_DATA_DIR;
    const auto copy = [&](const char* from, const char* to) { fs::copy_file(data / from, scratch / to); };
    copy("scenes/near-benign.toml", "scene.toml");
    copy("sweeps/sphere-distance.toml", "sweep.toml");
    copy("sweeps/extremes/contact.toml", "cases.toml");
    copy("sweeps/worst/near.toml", "search.toml");
    copy("claims/arithmetic.toml", "claims.toml");
    copy("report.toml", "choices.toml");
    scratch.write("rays.csv", rays);
    scratch.write("old.toml", "title = \"x\"\n[[claim]]\nid = \"a.b\"\n");  // without a schema
    fs::create_symlink(LOSTBITS_PROGRAM, scratch / "program.so");
    const std::map<std::string, std::pair<std::string, std::string>> files{
        {"scene.toml", {"is a scene", "lostbits map"}},
        {"sweep.toml", {"is a sweep", "lostbits sweep"}},
        {"cases.toml", {"is a file of cases", "lostbits sweep"}},
        {"search.toml", {"is a search for the worst rays", "lostbits sweep search.toml --worst"}},
        {"claims.toml", {"is a file of claims", "lostbits check"}},
        {"old.toml", {"is a file of claims", "lostbits check"}},
        {"choices.toml", {"is the choice of a report", "lostbits report"}},
        {"rays.csv", {"is a file of rays", "lostbits judge"}},
        {"program.so", {"is a library or a program", "lostbits plugin check"}},
        {"near-benign", {"is a scene", "lostbits map"}},
        {"sphere-distance", {"is a sweep", "lostbits sweep"}},
        {"extremes/contact", {"is a file of cases", "lostbits sweep"}}};
    const std::string sweeps = "sweep.toml cases.toml search.toml sphere-distance extremes/contact ";
    const std::string scenes = "scene.toml near-benign ";
    /// A command line in which `@` is the file, and the files that the command reads.
    const std::map<std::string, std::string> commands_of{
        {"check @", "claims.toml old.toml "},
        {"choose @ --bits 8", scenes + "rays.csv "},
        {"consistency @", scenes},
        {"explain @ -i sphere.press --pixel 1,1", scenes},
        {"explain @ -i sphere.press --worst", scenes + "sweep.toml cases.toml sphere-distance extremes/contact "},
        {"explain @ -i sphere.press --ranges", scenes + "sweep.toml sphere-distance "},
        {"explain @ -i sphere.press --case x", "cases.toml extremes/contact "},
        {"judge @", "rays.csv "},
        {"judge rays.csv --scene @", scenes},
        {"map @", scenes},
        {"mend @ --bits 8 -i sphere.press", scenes + "rays.csv "},
        {"offsets @", scenes},
        {"plugin check @", "program.so "},
        {"render @", scenes},
        {"report @", scenes + sweeps},
        {"sweep @", sweeps},
        {"trade @", scenes}};
    for (const auto& [line, takes] : commands_of) {
        for (const auto& [file, kind] : files) {
            if (has(takes, file + " ")) continue;
            std::string typed = line;
            typed.replace(typed.find('@'), 1, file);
            INFO(typed);
            const auto r = run(typed, scratch.path());
            CHECK(r.code == 2);
            CHECK(r.out.empty());
            CHECK(has(r.err, file + ": " + kind.first));
            CHECK(has(r.err, "try `" + kind.second));
            for (const char* edit : {"schema", "valid TOML", "write "}) CHECK_FALSE(has(r.err, edit));
            CHECK(split_lines(r.err).size() == 1);
        }
    }
    CHECK_FALSE(fs::exists(scratch / "out"));
    // The message names the option that makes `explain` read the file.
    CHECK(
        has(run("explain cases.toml -i sphere.press", scratch.path()).err, "with --case or --worst; add one of them"));
    // A name of two kinds means the kind that the command reads; files of no known kind are left to the command.
    CHECK(has(run("map none.toml", scratch.path()).err, "no such file"));
    CHECK(has(run("map none", scratch.path()).err, "no scene \"none\""));
}

}  // namespace test_help
