// Verdicts of claims on the page: the result, and what it rests on.
#include "catch.hpp"
#include "output/report/page.hpp"

namespace test_claims_table {

using namespace lostbits::output::report;
using lostbits::measure::check::ClaimResult;
using lostbits::scene::check::Claim;
using Evidence = Claim::Evidence;

namespace {

/// The row of a claim whose number lies in its interval.
std::string row_of(Evidence evidence, Claim::Verdict verdict, std::uint64_t floats = 0, std::uint64_t evaluations = 0) {
    Claim claim;
    claim.id = "a.claim";
    claim.statement = "It never fails";
    claim.subject = lostbits::scene::check::TableSubject{.name = "arithmetic"};
    claim.verdict = verdict;
    claim.evidence = evidence;
    if (evidence == Evidence::proof) claim.lemma = "e < 4u";
    ClaimResult result;
    result.state = ClaimResult::State::agrees;
    result.measured = 7;
    result.float_count = floats;
    result.evaluation_count = evaluations;
    return claims_table(
        {.command = {}, .maps = {}, .sweeps = {}, .trades = {}, .claims = {claim}, .results = {result}});
}

bool says(const std::string& row, const std::string& text) {
    return row.find("<small class=\"evidence\">" + text + "</small>") != std::string::npos;
}

}  // namespace

TEST_CASE("a claim on the page shows what its verdict rests on") {
    constexpr auto holds = Claim::Verdict::holds, refuted = Claim::Verdict::refuted;
    CHECK(says(row_of(Evidence::proof, holds), "holds: proved: e &lt; 4u"));
    CHECK(says(row_of(Evidence::proof, refuted), "refuted: refuted by proof: e &lt; 4u"));
    CHECK(says(row_of(Evidence::exhaustive, holds, 2048), "holds: all 2048 floats"));
    CHECK(says(row_of(Evidence::exhaustive, holds), "holds: every case that it speaks of was measured"));
    CHECK(
        says(row_of(Evidence::search, holds, 0, 300), "holds: no worse case found in 300 evaluations; the worst is 7"));
    CHECK(says(row_of(Evidence::search, refuted), "refuted: by the worst case that a search found"));
    CHECK(says(row_of(Evidence::sample, holds), "holds: for a measured sample"));
    CHECK(row_of(Evidence::none, holds).find("evidence") == std::string::npos);
}

TEST_CASE("a claim on the page quotes its source after it") {
    Claim claim;
    claim.subject = lostbits::scene::check::TableSubject{.name = "arithmetic"};
    claim.source = "Fell";
    claim.quotation = "a < b";
    ClaimResult result;
    result.state = ClaimResult::State::agrees;
    const std::string page =
        claims_table({.command = {}, .maps = {}, .sweeps = {}, .trades = {}, .claims = {claim}, .results = {result}});
    CHECK(page.find("Fell: <q>a &lt; b</q> &middot; ") != std::string::npos);
}

TEST_CASE("a claim that failed rests on nothing, but still shows how many floats were tried") {
    Claim claim;
    claim.subject = lostbits::scene::check::TableSubject{.name = "arithmetic"};
    claim.evidence = Evidence::sample;
    ClaimResult result;
    result.state = ClaimResult::State::disagrees;
    const auto row = [&] {
        return claims_table(
            {.command = {}, .maps = {}, .sweeps = {}, .trades = {}, .claims = {claim}, .results = {result}});
    };
    CHECK(row().find("evidence") == std::string::npos);
    result.float_count = 12;
    CHECK(says(row(), "expected to hold, but does not: all 12 floats"));
}

}  // namespace test_claims_table
