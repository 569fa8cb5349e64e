// The committed reports are what the program makes now.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

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

}  // namespace

TEST_CASE("every claim measures as stated, in the long tests on three further draws too, and the report is the same") {
    if (under_sanitizer) {  // which looks for faults: a further draw runs the code of the first
        const auto once = run("check");
        INFO(once.out << once.err);
        REQUIRE(once.code == 0);
        return;
    }
    draw_pictures();
    const Scratch scratch;
    const std::string made = (scratch.path() / "reports").string();
    std::filesystem::create_directories(made);
    std::filesystem::copy(LOSTBITS_REPORTS_DIR "/screenshots", made + "/screenshots",
                          std::filesystem::copy_options::recursive);  // whose names the document has
    const std::string json = (scratch.path() / "claims.json").string();
    const std::string seeds = is_long() ? "check --seeds 3" : "check";
    const auto check = run(seeds + " --report '" + made + "' --export-json '" + json + "'");
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
    const std::string document = contents(made + "/README.md"), committed = contents(LOSTBITS_REPORTS_DIR "/README.md");
    if (is_long()) CHECK(document == committed);
    CHECK(of_one_draw(document) == of_one_draw(committed));
    // By content: numbers of the table, pixels of the pictures.
    const auto table = run("diff '" + made + "/claims.csv' '" LOSTBITS_REPORTS_DIR "/claims.csv'" +
                           (is_long() ? "" : " --ignore 'draw*'"));
    INFO(table.out);
    CHECK(table.code == 0);
    const auto pictures = run("diff --strict '" + made + "/pictures' '" LOSTBITS_REPORTS_DIR "/pictures'");
    INFO(pictures.out);
    CHECK(pictures.code == 0);
}

}  // namespace test_reports
