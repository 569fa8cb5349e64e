// The committed reports are what the program makes now.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "catch.hpp"
#include "counts.hpp"
#include "program.hpp"

namespace test_reports {

using namespace lostbits::test;

namespace {

/// The document without what several draws say: how far they are apart, and the option that made them.
std::string of_one_draw(const std::string& document) {
    static const std::regex spread(
        R"re( \((in each of|[-+.e0-9]+ to [-+.e0-9]+ over) [0-9]+ draws\)| --seeds [0-9]+)re");
    return std::regex_replace(document, spread, "");
}

/// A subject of each kind, small ones: numbers, a scene, a march, sweeps, cases, a search, every float, two questions,
/// respawned rays, a picture.
constexpr std::string_view kinds[] = {"arithmetic",           "box-one",
                                      "sdf-by-hand.miss",     "sphere-impact",
                                      "hard/padding",         "padding, searched",
                                      "exhaustive-impact",    "box-far, consistency",
                                      "offset-tiny, offsets", "raycast-acne.ulp1, rendered"};

/// The sections of the document, each from its heading on.
std::set<std::string> sections(const std::string& document) {
    std::set<std::string> all;
    for (auto at = document.find("\n## "); at != std::string::npos;) {
        const auto next = document.find("\n## ", at + 1);
        std::string section = document.substr(at + 1, next == std::string::npos ? next : next - at - 1);
        section.erase(section.find_last_not_of('\n') + 1);
        all.insert(section);
        at = next;
    }
    return all;
}

/// ` --filter ID` of each claim in the sections of `kinds`.
std::string one_of_each_kind() {
    static const std::regex id(R"re(\| `([^`\n]+)` \|(\n|$))re");
    std::string filters;
    for (const std::string& section : sections(contents(LOSTBITS_REPORTS_DIR "/README.md"))) {
        if (std::ranges::find(kinds, section.substr(3, section.find('\n') - 3)) == std::end(kinds)) continue;
        for (std::sregex_iterator m(section.begin(), section.end(), id), end; m != end; ++m)
            filters += " --filter '" + (*m)[1].str() + "'";
    }
    return filters;
}

}  // namespace

TEST_CASE("every claim measures as stated, in the long tests on three further draws too, and the table is the same") {
    if (under_sanitizer) {  // which looks for faults: a further draw runs the code of the first
        const auto once = run("check");
        INFO(once.out << once.err);
        REQUIRE(once.code == 0);
        return;
    }
    const Scratch scratch;
    const std::string json = (scratch.path() / "claims.json").string(), csv = (scratch.path() / "claims.csv").string();
    const std::string seeds = is_long() ? "check --seeds 3" : "check";
    const auto check = run(seeds + " --export-csv '" + csv + "' --export-json '" + json + "'");
    INFO(check.out);
    REQUIRE(check.code == 0);
    int drawn = 0;
    for (const auto& claim : nlohmann::json::parse(contents(json))) {
        INFO(claim["id"]);
        // Whatever is random has an interval that comes from many draws.
        const bool random = claim["samples"] > 0;
        CHECK(claim["further_draws"].size() == (random && is_long() ? 3 : 0));
        CHECK((random ? claim["interval_draws"] >= 32 : claim["interval_draws"] == 0));
        drawn += random;
    }
    CHECK(drawn > 50);
    // By content: sentences, sources, numbers, worst rays.
    const auto table =
        run("diff '" + csv + "' '" LOSTBITS_REPORTS_DIR "/claims.csv'" + (is_long() ? "" : " --ignore 'draw*'"));
    INFO(table.out);
    CHECK(table.code == 0);
}

// Its pictures measure their subjects once more: in the short tests there is one subject of each kind.
TEST_CASE("the report is the committed one, in the long tests all of it, else a section of each kind of subject") {
    if (under_sanitizer) {
        SUCCEED("a sanitizer looks for faults, and other tests write reports");
        return;
    }
    draw_pictures();
    const Scratch scratch;
    const std::string made = (scratch.path() / "reports").string();
    std::filesystem::create_directories(made);
    std::filesystem::copy(LOSTBITS_REPORTS_DIR "/screenshots", made + "/screenshots",
                          std::filesystem::copy_options::recursive);  // whose names the document has
    const auto check = run((is_long() ? "check --seeds 3" : "check" + one_of_each_kind()) + " --report '" + made + "'");
    INFO(check.out);
    REQUIRE(check.code == 0);
    const std::string document = contents(made + "/README.md"), committed = contents(LOSTBITS_REPORTS_DIR "/README.md");
    if (is_long()) CHECK(document == committed);
    const std::set<std::string> there = sections(of_one_draw(committed)), here = sections(of_one_draw(document));
    CHECK(here.size() == (is_long() ? there.size() : std::size(kinds)));
    for (const std::string& section : here) {
        INFO(section);
        CHECK(there.contains(section));
    }
    for (const auto& picture : std::filesystem::directory_iterator(made + "/pictures")) {
        const std::string name = picture.path().filename().string();
        const auto same =
            run("diff --strict '" + picture.path().string() + "' '" LOSTBITS_REPORTS_DIR "/pictures/" + name + "'");
        INFO(name << ": " << same.out << same.err);
        CHECK(same.code == 0);
    }
    if (!is_long()) return;
    const auto pictures = run("diff --strict '" + made + "/pictures' '" LOSTBITS_REPORTS_DIR "/pictures'");
    INFO(pictures.out);
    CHECK(pictures.code == 0);
}

}  // namespace test_reports
