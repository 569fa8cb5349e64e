// The documents are correct: the commands of README.md and docs/ run and print the output shown, links lead somewhere,
// and the README stays short.
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <regex>
#include <set>
#include <span>
#include <string_view>

#include "blocks.hpp"
#include "catch.hpp"
#include "counts.hpp"
#include "program.hpp"
#include "slow_commands.hpp"

namespace test_docs {

using namespace lostbits::test;

namespace {

const fs::path root = fs::path(LOSTBITS_REPORTS_DIR).parent_path();

std::vector<std::string> pages() {
    std::vector<std::string> all{"README.md"};
    for (const auto& entry : fs::directory_iterator(root / "docs"))
        if (entry.is_regular_file()) all.push_back("docs/" + entry.path().filename().string());
    std::ranges::sort(all);
    return all;
}

std::vector<Block> blocks_of(const std::string& page) { return find_blocks(contents(root / page)); }

/// A line `$ build/lostbits …` of a console block.
struct Command {
    std::string where, arguments;
    std::vector<std::string> shown;  ///< the output that the page shows, `...` for any lines; none: it shows nothing
    int code = 0;                    ///< the exit status that the page promises: `# exit N` at the end of the line
    bool compiles = false;           ///< a call of the compiler, which makes a library from a page's own source
};

constexpr std::string_view prompt = "$ ", program = "build/lostbits ", compiler = "c++ ";

/// Commands on the pages that this test does not run.
struct OtherPage {
    std::string_view start, why;
};
constexpr std::array others{
    OtherPage{"./run", "builds everything"},
    OtherPage{"cmake ", "builds everything; tests/package installs"},
    OtherPage{"ctest ", "runs this test"},
    OtherPage{"cc ray.c ", "test_explain.cpp compiles the C program of every form"},
    OtherPage{"build/bench/", "measures time, and is not always built"},
    OtherPage{"node tests/browser/screenshots.js ", "needs a browser; tests/browser has one where there is one"},
};

std::vector<Command> commands_of(const std::string& page) {
    std::vector<Command> commands;
    for (const Block& block : blocks_of(page)) {
        if (block.language != "console") continue;
        bool ours = false;
        for (std::size_t i = 0; i < block.lines.size(); ++i) {
            const std::string& line = block.lines[i];
            const std::string where = page + ":" + std::to_string(block.first + i);
            if (!line.starts_with(prompt)) {
                INFO(where << ": output without a command of ours: " << line);
                REQUIRE(ours);
                commands.back().shown.push_back(line);
                continue;
            }
            const std::string typed = line.substr(prompt.size());
            if (typed.starts_with(compiler)) {
                commands.push_back({where, typed, {}, 0, true});
                continue;
            }
            ours = typed.starts_with(program);
            if (!ours) {
                INFO(where << ": neither run nor listed: " << typed);
                CHECK(std::ranges::any_of(others, [&](const OtherPage& o) { return typed.starts_with(o.start); }));
                continue;
            }
            std::smatch exit;
            const bool promised = std::regex_search(typed, exit, std::regex(R"(# exit (\d+))"));
            commands.push_back({where, typed.substr(program.size()), {}, promised ? std::stoi(exit[1]) : 0});
        }
    }
    return commands;
}

/// `check --filter 'GLOB'` with the first claim that the glob selects: test_reports.cpp measures them all. A glob that
/// selects no claim is unchanged, and ends with 4.
std::string of_one_claim(const std::string& text) {
    static const std::regex glob(R"(check --filter '([^']*\*[^']*)')");
    std::smatch found;
    if (!std::regex_match(text, found, glob)) return text;
    for (const auto& claim : read_csv(LOSTBITS_REPORTS_DIR "/claims.csv")) {
        const std::string& id = claim.at("id");
        if (::fnmatch(found[1].str().c_str(), id.c_str(), 0) == 0) return "check --filter '" + id + "'";
    }
    return text;
}

/// A page that shows counts shows the counts of the whole picture.
bool shows_counts(const Command& command) {
    return std::ranges::any_of(command.shown, [](const std::string& line) { return line.ends_with(" rays"); });
}

/// The command without its comment, with the options that make it fast.
std::string affordable(const Command& command, std::set<std::string_view>& used) {
    std::string text = command.arguments;
    if (const auto comment = text.find(" #"); comment != std::string::npos) text.erase(comment);
    text.erase(text.find_last_not_of(' ') + 1);
    const std::string padded = text + "  ";  // so that a start can say where the command ends
    for (const CheaperTest& c : cheaper) {
        const std::string_view option = c.adds.substr(0, c.adds.find(' ', 1));
        if (!padded.starts_with(c.start) || text.find(option) != std::string::npos || shows_counts(command)) continue;
        used.insert(c.start);
        text += c.adds;
    }
    return of_one_claim(text);
}

/// Lines whose values are times: the cheapest form differs from one run to the next on a busy machine.
constexpr std::array timed{std::string_view("The cheapest is ")};

/// The lines that a page shows, with `...` in place of times.
std::vector<std::string> without_times(std::vector<std::string> shown) {
    for (std::string& line : shown)
        if (std::ranges::any_of(timed, [&](std::string_view start) { return line.starts_with(start); })) line = "...";
    return shown;
}

/// Lines against lines; `...` stands for any number of them.
bool shows(std::span<const std::string> shown, std::span<const std::string> printed) {
    if (shown.empty()) return printed.empty();
    if (shown[0] == "...") {
        for (std::size_t skipped = 0; skipped <= printed.size(); ++skipped) {
            if (shows(shown.subspan(1), printed.subspan(skipped))) return true;
        }
        return false;
    }
    return !printed.empty() && shown[0] == printed[0] && shows(shown.subspan(1), printed.subspan(1));
}

/// The files that a page asks the reader to save: "Save this as `NAME`", and the block that follows.
void save_files(const Scratch& scratch, const std::string& page) {
    static const std::regex save_words(R"([Ss]ave\s+(this\s+file|this|it)\s+as\s+`([^`]+)`)");
    const auto lines = split_lines(contents(root / page));
    std::size_t begin = 0;
    for (const Block& block : blocks_of(page)) {
        std::string text, name;
        for (std::size_t i = begin; i < block.first - 1; ++i) text += lines[i] + "\n";
        for (std::sregex_iterator m(text.begin(), text.end(), save_words), end; m != end; ++m) name = (*m)[2];
        if (!name.empty()) scratch.write(name, block.text());
        begin = block.first + block.lines.size();
    }
}

/// Saves those files and those of the tutorial, and links the data of the project, its functions under test and what a
/// library of forms is compiled with.
void lay_out(const Scratch& scratch, const std::string& page) {
    fs::create_directory_symlink(LOSTBITS_DATA_DIR, scratch / "data");
    fs::create_directories(scratch.path() / "tests/external");
    for (const char* folder : {"plugins", "examples", "tests/external/functions"})
        fs::create_directory_symlink(root / folder, scratch.path() / folder);
    fs::create_directory_symlink(fs::path(LOSTBITS_PROGRAM).parent_path(), scratch / "build");
    for (const std::string& from : {std::string("docs/first-hour.md"), page}) save_files(scratch, from);
}

bool is(const SlowCommand& slow, const Command& command) {
    const std::string page = command.where.substr(0, command.where.find(':')) + " ";
    return command.arguments.starts_with(slow.start) || (page + command.arguments).starts_with(slow.start);
}

bool is_slow(const Command& command) {
    return std::ranges::any_of(slow_commands,
                               [&](const SlowCommand& slow_command) { return is(slow_command, command); });
}

/// Checks a command that is not run: each of its options belongs to the command or to the program.
void check_options(const Command& command) {
    static const std::regex option(R"(\s(--[a-z-]+))");
    const std::string& text = command.arguments;
    const std::string help = must(text.substr(0, text.find(' ')) + " --help").out + must("--help").out;
    for (std::sregex_iterator m(text.begin(), text.end(), option), end; m != end; ++m) CHECK(has(help, (*m)[1]));
}

/// Runs the commands of a page in their order, in one folder.
void hold(const std::string& page) {
    const auto commands = commands_of(page);
    if (commands.empty()) return;
    // `diff` must read pictures again.
    if (std::ranges::any_of(commands, [](const Command& c) { return c.arguments.starts_with("diff "); }))
        draw_pictures();
    else unsetenv("LOSTBITS_IMAGE_MODULE");
    const Scratch scratch;
    lay_out(scratch, page);
    std::set<std::string_view> used;
    for (const Command& command : commands) {
        if (!is_long() && is_slow(command)) {
            if (!command.compiles) check_options(command);
            continue;
        }
        if (command.compiles) {
            INFO(command.where << ": " << command.arguments);
            CHECK(std::system(("cd '" + scratch.path().string() + "' && " + command.arguments).c_str()) == 0);
            continue;
        }
        const std::string arguments = affordable(command, used);
        const auto r = run(arguments, scratch.path());
        INFO(command.where << ": lostbits " << arguments << "\n" << r.out << r.err);
        CHECK(r.code == command.code);
        if (!command.shown.empty()) CHECK(shows(without_times(command.shown), split_lines(r.out)));
    }
}

/// Takes every fourth page, so that the four tests run side by side.
void hold_quarter(std::size_t quarter) {
    const auto all = pages();
    for (std::size_t i = quarter; i < all.size(); i += 4) hold(all[i]);
}

std::size_t columns(const std::string& line) {
    return static_cast<std::size_t>(
        std::ranges::count_if(line, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

}  // namespace

TEST_CASE("docs: the commands print what the documents show: first quarter of the pages") { hold_quarter(0); }
TEST_CASE("docs: the commands print what the documents show: second quarter of the pages") { hold_quarter(1); }
TEST_CASE("docs: the commands print what the documents show: third quarter of the pages") { hold_quarter(2); }
TEST_CASE("docs: the commands print what the documents show: last quarter of the pages") { hold_quarter(3); }

TEST_CASE("docs: the comparison with the documents can fail") {
    const std::vector<std::string> printed{"one", "two", "three", "four"};
    const auto says = [&](std::vector<std::string> shown) { return shows(shown, printed); };
    CHECK(says({"one", "two", "three", "four"}));
    CHECK(says({"one", "...", "four"}));
    CHECK(says({"...", "two", "...", "four", "..."}));
    CHECK_FALSE(says({"one", "two", "three"}));
    CHECK_FALSE(says({"one", "...", "two"}));
    CHECK_FALSE(says({"...", "three", "two", "..."}));
    CHECK_FALSE(says({"...", "Two", "..."}));
    std::set<std::string_view> used;
    CHECK(affordable({"", "map x -o out   # all", {}}, used) == "map x -o out --size 32x32");
    CHECK(affordable({"", "map x --size 8x8", {}}, used) == "map x --size 8x8");
    CHECK(affordable({"", "map x -o out", {"x: 65536 rays", "..."}}, used) == "map x -o out");
    CHECK(affordable({"", "check --filter 'a'", {}}, used) == "check --filter 'a'");
    CHECK(affordable({"", "check --filter 'none*'", {}}, used) == "check --filter 'none*'");
    CHECK(affordable({"", "check --filter 'box.*-harm'", {}}, used).find('*') == std::string::npos);
}

TEST_CASE("docs: documents have commands and output, and every way of shortening them is needed") {
    std::set<std::string_view> used, found;
    std::size_t commands = 0, shown = 0;
    for (const std::string& page : pages()) {
        for (const Command& command : commands_of(page)) {
            (void)affordable(command, used);
            for (const SlowCommand& slow_command : slow_commands)
                if (is(slow_command, command)) found.insert(slow_command.start);
            ++commands;
            shown += command.shown.size();
        }
    }
    CHECK(commands > 50);
    CHECK(shown > 5);
    CHECK(found.size() == slow_commands.size());
    for (const CheaperTest& c : cheaper) {
        INFO(c.start);
        CHECK(used.contains(c.start));
    }
}

TEST_CASE("docs: every command and option that a sentence names exists") {
    // `lostbits WORD …` between backquotes.
    static const std::regex named(R"(`lostbits ([a-z]+)([^`]*)`)"), option(R"((^|\s)(--[a-z-]+))");
    std::map<std::string, std::string> help;
    for (const std::string& page : pages()) {
        const std::string text = contents(root / page);
        for (auto m = std::sregex_iterator(text.begin(), text.end(), named); m != std::sregex_iterator(); ++m) {
            const std::string word = (*m)[1], rest = (*m)[2];
            INFO(page << ": " << m->str());
            if (!help.contains(word)) {
                const auto r = must(word + " --help");
                help[word] = r.out;
            }
            for (auto o = std::sregex_iterator(rest.begin(), rest.end(), option); o != std::sregex_iterator(); ++o)
                CHECK(has(help[word], (*o)[2]));
        }
    }
    CHECK(help.size() > 5);
}

TEST_CASE("docs: the README has at most 150 lines, and lines fit 120 columns") {
    CHECK(split_lines(contents(root / "README.md")).size() <= 150);
    for (const std::string& page : pages()) {
        bool block = false;
        const auto lines = split_lines(contents(root / page));
        for (std::size_t i = 0; i < lines.size(); ++i) {
            if (lines[i].starts_with("```")) block = !block;
            // Rows of tables, links, commands and output cannot be wrapped.
            if (block || lines[i].starts_with("|") || lines[i].find("](") != std::string::npos) continue;
            INFO(page << ":" << i + 1);
            CHECK(columns(lines[i]) <= 120);
        }
    }
}

TEST_CASE("docs: every link leads somewhere, and the index lists every page") {
    static const std::regex link(R"(\]\(([^)\s#]+)(#[^)\s]*)?\))");
    std::size_t links = 0;
    for (const std::string& page : pages()) {
        const std::string text = contents(root / page);
        for (auto m = std::sregex_iterator(text.begin(), text.end(), link); m != std::sregex_iterator(); ++m) {
            const std::string target = (*m)[1];
            if (target.find("://") != std::string::npos) continue;
            INFO(page << ": " << target);
            CHECK(fs::exists((root / page).parent_path() / target));
            ++links;
        }
    }
    CHECK(links > 40);
    const std::string index = contents(root / "docs/README.md");
    for (const std::string& page : pages()) {
        if (page == "README.md" || page == "docs/README.md") continue;
        INFO(page);
        CHECK(has(index, "](" + page.substr(5) + ")"));
    }
}

TEST_CASE("docs: sources are cited by title, not by our numbers for them") {
    static const std::regex number(R"([Ss]eed[- ]0\d\d|\b0\d\d_[0-9a-f]{16})");
    auto all = pages();
    all.push_back("data/README.md");
    for (const std::string& page : all) {
        std::smatch m;
        const std::string text = contents(root / page);
        INFO(page << ": " << (std::regex_search(text, m, number) ? m.str() : ""));
        CHECK_FALSE(std::regex_search(text, number));
    }
}

}  // namespace test_docs
