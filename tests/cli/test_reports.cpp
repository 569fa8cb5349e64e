// The committed reports are what the program makes now.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"

namespace test_reports {

using namespace lostbits::test;

TEST_CASE("every claim measures as stated, on three further draws too, and the report of all is the same") {
    if (under_sanitizer) {  // which looks for faults: a further draw runs the code of the first
        const auto once = run("check");
        INFO(once.out << once.err);
        REQUIRE(once.code == 0);
        return;
    }
    const Scratch scratch;
    const std::string made = (scratch.path() / "reports").string();
    std::filesystem::create_directories(made);
    std::filesystem::copy(LOSTBITS_REPORTS_DIR "/screenshots", made + "/screenshots",
                          std::filesystem::copy_options::recursive);  // whose names the document has
    const std::string json = (scratch.path() / "claims.json").string();
    const auto check = run("check --seeds 3 --report '" + made + "' --export-json '" + json + "'");
    INFO(check.out);
    REQUIRE(check.code == 0);
    int drawn = 0;
    for (const auto& claim : nlohmann::json::parse(contents(json))) {
        INFO(claim["id"]);
        // Whatever is random is measured on all draws, and its interval comes from many more.
        const bool random = claim["samples"] > 0;
        CHECK(claim["further_draws"].size() == (random ? 3 : 0));
        CHECK((random ? claim["interval_draws"] >= 32 : claim["interval_draws"] == 0));
        drawn += random;
    }
    CHECK(drawn > 50);
    CHECK(contents(made + "/README.md") == contents(LOSTBITS_REPORTS_DIR "/README.md"));
    // By content: numbers of the table, pixels of the pictures.
    const auto table = run("diff '" + made + "/claims.csv' '" LOSTBITS_REPORTS_DIR "/claims.csv'");
    INFO(table.out);
    CHECK(table.code == 0);
    const auto pictures = run("diff --strict '" + made + "/pictures' '" LOSTBITS_REPORTS_DIR "/pictures'");
    INFO(pictures.out);
    CHECK(pictures.code == 0);
}

}  // namespace test_reports
