// reports/specimens/upstream holds the reports for authors of libraries. Every defect has its file. Where the library
// is installed, the program in the file prints the quoted output.
#include <cstdlib>
#include <regex>
#include <set>

#include "blocks.hpp"
#include "catch.hpp"
#include "counts.hpp"
#include "program.hpp"

namespace test_upstream {

using namespace lostbits::test;

namespace {

const fs::path specimens = fs::path(LOSTBITS_REPORTS_DIR) / "specimens";

std::vector<fs::path> letters() {
    std::vector<fs::path> all;
    for (const auto& entry : fs::directory_iterator(specimens / "upstream")) all.push_back(entry.path());
    std::ranges::sort(all);
    return all;
}

int in_folder(const Scratch& scratch, const std::string& command) {
    return std::system(("cd '" + scratch.path().string() + "' && " + command).c_str());
}

/// The folder that holds node_modules, as plugins/npm_intersectors.mjs finds it.
fs::path npm() {
    const char* told = std::getenv("LOSTBITS_NPM");
    return (told ? fs::path(told) : specimens / "../../plugins/npm") / "node_modules";
}

/// True if the library is installed: the files that the program includes or imports are found.
bool installed(const Scratch& scratch, const std::string& command, const std::string& program) {
    if (command.starts_with("g++")) {
        if (in_folder(scratch, std::regex_replace(command, std::regex("^g\\+\\+"), "g++ -E -o all.i") + " 2>why") == 0)
            return true;
        INFO(contents(scratch / "why"));
        CHECK(contents(scratch / "why").find("No such file") != std::string::npos);
        return false;
    }
    static const std::regex import(R"(from '((@[^/']+/)?[^/']+))");
    std::smatch package;
    REQUIRE(std::regex_search(program, package, import));
    return fs::exists(npm() / package[1].str());
}

/// Runs every second program, in the short tests every eighth. Only the text of our own programs is checked.
void hold(std::size_t half) {
    const auto all = letters();
    for (std::size_t i = half; i < all.size(); i += is_long() ? 2 : 8) {
        const auto blocks = find_blocks(contents(all[i]));
        INFO(all[i].filename().string());
        REQUIRE(blocks.size() == 4);
        const bool script = blocks[0].language == "js";
        const std::string command = blocks[0].lines.at(0).substr(3);
        const Scratch scratch;
        scratch.write(script ? "r.mjs" : "r.cpp", blocks[0].text());
        if (script && fs::exists(npm())) fs::create_directory_symlink(fs::canonical(npm()), scratch / "node_modules");
        const std::string build = command.substr(0, command.find(" && "));
        if (!installed(scratch, build, blocks[0].text())) {
            WARN(all[i].filename().string() << ": not run, its library is not installed");
            continue;
        }
        CHECK(in_folder(scratch, "( " + command + " ) >printed 2>why") == 0);
        INFO(contents(scratch / "why"));
        CHECK(contents(scratch / "printed") == blocks[1].text());
    }
}

}  // namespace

TEST_CASE("every defect of a library has a report file, and every report file belongs to a defect") {
    const std::string report = contents(specimens / "README.md");
    const auto from = report.find("\n## Defects\n");
    REQUIRE(from != std::string::npos);
    std::string defects = report.substr(from, report.find("\n## ", from + 1) - from);
    static const std::regex link(R"(\]\(upstream/([a-z0-9-]+\.md)\))");
    std::set<std::string> linked, found;
    std::size_t sections = 0;
    for (auto at = defects.find("\n### "); at != std::string::npos; ++sections) {
        const auto next = defects.find("\n### ", at + 1);
        const std::string section = defects.substr(at, next - at);
        INFO(split_lines(section).at(1));
        const std::size_t before = linked.size();
        for (auto m = std::sregex_iterator(section.begin(), section.end(), link); m != std::sregex_iterator(); ++m)
            linked.insert((*m)[1]);
        CHECK(linked.size() > before);
        at = next;
    }
    CHECK(sections >= 9);
    for (const fs::path& letter : letters()) found.insert(letter.filename().string());
    CHECK(linked == found);
}

TEST_CASE("a report file for authors has a place, a program under 30 lines, its output, a fix and its cost") {
    static const std::regex place(R"(\nWhere: [^\n]*[A-Za-z0-9]:\d+[^\n]* \d+[.\d]+)"),
        ours("lost ?bits|culprit|specimen");
    for (const fs::path& letter : letters()) {
        const std::string text = contents(letter);
        INFO(letter.filename().string());
        CHECK(text.starts_with("# "));
        CHECK(std::regex_search(text, place));
        CHECK_FALSE(std::regex_search(text, ours));
        const auto blocks = find_blocks(text);
        REQUIRE(blocks.size() == 4);
        CHECK((blocks[0].language == "cpp" || blocks[0].language == "js"));
        CHECK(blocks[0].lines.size() < 30);
        CHECK(blocks[0].lines.at(0).starts_with("// "));
        CHECK(blocks[1].language == "text");
        CHECK(blocks[2].language == "diff");
        CHECK(blocks[2].text().find("\n@@ ") != std::string::npos);
        CHECK(blocks[3].language == "text");
        CHECK(blocks[1].lines != blocks[3].lines);
        const auto cost = text.find("\n## Cost\n");
        REQUIRE(cost != std::string::npos);
        CHECK(text.find(" ns ", cost) != std::string::npos);
    }
}

TEST_CASE("the programs in report files print the quoted output: first half") { hold(0); }
TEST_CASE("the programs in report files print the quoted output: second half") { hold(1); }

}  // namespace test_upstream
