// Comparison of two forms.
#include <cmath>
#include <filesystem>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"
#include "external/libraries.hpp"
#include "measure/answer/against.hpp"
#include "measure/truth/missing.hpp"

namespace test_against {

using namespace lostbits::test;
using namespace lostbits;
using measure::answer::AgainstOutcome;
using measure::answer::Answers;

namespace {

const std::string odd = plugin("odd_plugin");

std::map<std::string, std::string> row_in(const Scratch& folder, const std::string& form) {
    return row_of(folder / "out/near-benign/summary.csv", form);
}

int count(std::map<std::string, std::string>& row, const std::string& name) {
    REQUIRE(row.contains("against_" + name));
    return std::stoi(row["against_" + name]);
}

}  // namespace

TEST_CASE("against: the outcome of each pair of answers is right", "[external]") {
    const double nan = measure::truth::missing, inf = HUGE_VAL;
    const Answers a{{1, 1, 0, 0, nan, nan, 2, inf}, {1, 1, 1, 0, 1, 1, 1, 1}, {}};
    const Answers b{{1, 1 + 0x1p-22, 0, 0, nan, 1, 0, inf}, {1, 1, 0, 0, 1, 1, 1, 1}, {}};
    std::vector<double> which(8), apart(8);
    measure::answer::compare_against(a, b, true, binary32, which, apart);
    const auto is = [&which](std::size_t i, AgainstOutcome what) { return which[i] == static_cast<double>(what); };
    CHECK((is(0, AgainstOutcome::same_t) && apart[0] == 0));
    CHECK((is(1, AgainstOutcome::other_t) && apart[1] == -2));
    CHECK((is(2, AgainstOutcome::alone_hits) && std::isnan(apart[2])));
    CHECK((is(3, AgainstOutcome::both_miss) && std::isnan(apart[3])));
    CHECK((is(4, AgainstOutcome::same_t) && apart[4] == 0));
    CHECK((is(5, AgainstOutcome::other_t) && std::isinf(apart[5])));
    CHECK((is(6, AgainstOutcome::other_t) && apart[6] == std::ldexp(1.0, 150)));
    CHECK((is(7, AgainstOutcome::same_t) && apart[7] == 0));
    measure::answer::compare_against(b, a, false, binary32, which, apart);
    CHECK((is(0, AgainstOutcome::incomparable_t) && std::isnan(apart[0])));
    CHECK(is(2, AgainstOutcome::other_alone_hits));
}

TEST_CASE("against: a form is compared with itself, a twin, another form and a predicate", "[external]") {
    const Scratch folder;
    const std::string map = "map near-benign --size 64x48 -f f32 --pictures all -o out ";
    must(map + "-i sphere.unified -i sphere.schoolbook -i odd.right --against sphere.unified" + odd, folder.path());
    auto self = row_in(folder, "sphere.unified"), rival = row_in(folder, "sphere.schoolbook");
    CHECK(count(self, "both_miss") + count(self, "same_t") == 64 * 48);
    CHECK(self["apart_max"] == "0");
    CHECK(count(rival, "other_t") > 100);
    // Both forms hit: their t are alike, differ, or cannot be compared.
    CHECK(count(rival, "both_hit") == count(rival, "same_t") + count(rival, "other_t"));
    CHECK(count(self, "both_hit") == count(self, "same_t"));
    CHECK(std::stod(rival["apart_max"]) > 2);
    CHECK(contents(folder.path() / "out/near-benign/sphere.schoolbook.f32.against.png").size() > 1000);
    const Outcome predicate = run(map + "-i odd.predicate --against sphere.unified" + odd, folder.path());
    CHECK(has(predicate.err, "only their decisions are compared"));
    CHECK_FALSE(std::filesystem::exists(folder.path() / "out/near-benign/odd.predicate.f32.apart.png"));
    CHECK(std::filesystem::exists(folder.path() / "out/near-benign/odd.predicate.f32.against.png"));
    auto said = row_in(folder, "odd.predicate");
    CHECK(count(said, "incomparable_t") > 100);
    CHECK(count(said, "both_hit") == count(said, "incomparable_t"));
    CHECK(count(said, "incomparable_t") + count(said, "both_miss") + count(said, "alone_hits") +
              count(said, "other_alone_hits") ==
          64 * 48);
}

TEST_CASE("against: a sweep counts differences too, and wrong words are refused", "[external]") {
    const Scratch folder;
    must("sweep sphere-distance -i sphere.schoolbook -f f32 --against sphere.unified -o out", folder.path());
    const auto steps = read_csv(folder.path() / "out/sphere-distance/samples.csv");
    CHECK(std::stoi(steps.front().at("against_other_alone_hits")) == 0);
    int most = 0;
    for (const auto& step : steps) most = std::max(most, std::stoi(step.at("against_other_alone_hits")));
    CHECK(most > 300);  // far away the schoolbook form misses what unified hits
    check_refused(Scratch(), "map near-benign --size 32x24 -o out",
                  {{"-i sphere.press --against box.signs", "no selected form can be compared with it"},
                   {"-f f64 -i sphere.press --against sphere.double_inside", "in f32"},
                   {"--against sphere.unifide", "did you mean"},
                   {"--metric apart", "--against FORM"}});
}

}  // namespace test_against
