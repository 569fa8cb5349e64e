// The committed reports are what the program makes now.
#include <filesystem>

#include "catch.hpp"
#include "program.hpp"

using namespace lostbits::test;

TEST_CASE("the report of the claims is made again and is the same") {
    const Scratch scratch;
    const std::string made = (scratch.path() / "reports").string();
    std::filesystem::create_directories(made);
    std::filesystem::copy(LOSTBITS_REPORTS_DIR "/screenshots", made + "/screenshots",
                          std::filesystem::copy_options::recursive);  // whose names the document has
    const auto check = run("check --seeds 3 --report '" + made + "'");
    INFO(check.out);
    REQUIRE(check.code == 0);
    CHECK(contents(made + "/README.md") == contents(LOSTBITS_REPORTS_DIR "/README.md"));
    // By content: numbers of the table, pixels of the pictures.
    const auto table = run("diff '" + made + "/claims.csv' '" LOSTBITS_REPORTS_DIR "/claims.csv'");
    INFO(table.out);
    CHECK(table.code == 0);
    const auto pictures = run("diff '" + made + "/pictures' '" LOSTBITS_REPORTS_DIR "/pictures'");
    INFO(pictures.out);
    CHECK(pictures.code == 0);
}
