// A sentence about all cases says what its verdict rests on, and the claim has that.
#include "catch.hpp"
#include "measure/claim/claim.hpp"
#include "number/error.hpp"
#include "scene/claim/claims_file.hpp"

namespace test_evidence {

using namespace lostbits;
using scene::claim::Claim;

namespace {

std::vector<Claim> all_claims() {
    std::vector<Claim> all;
    for (const auto& file : scene::claim::claim_files(std::filesystem::path(LOSTBITS_DATA_DIR) / "claims")) {
        for (Claim& claim : scene::claim::read_claims(file)) all.push_back(std::move(claim));
    }
    return all;
}

}  // namespace

TEST_CASE("every claim whose sentence speaks of all cases says what it rests on") {
    int universal = 0, proofs = 0, searches = 0;
    for (const Claim& claim : all_claims()) {
        const std::string word = scene::claim::universal_word(claim.statement);
        INFO(claim.where.text() << ": " << claim.id << " says \"" << word << "\": " << claim.statement);
        const bool sample = claim.evidence == Claim::Evidence::sample;
        if (!word.empty()) {
            ++universal;
            CHECK(claim.evidence != Claim::Evidence::none);
        }
        // Of a promise of a bound, samples say nothing.
        if (word == "sound") CHECK_FALSE(sample);
        CHECK(scene::claim::universal_word(claim.note) != "sound");
        if (claim.evidence == Claim::Evidence::exhaustive) CHECK(claim.exhaustive);
        const bool searched = !claim.search.empty() || claim.sweep.starts_with("hard/");
        if (claim.evidence == Claim::Evidence::search) CHECK(searched);
        proofs += claim.evidence == Claim::Evidence::proof;
        searches += !claim.search.empty();
    }
    CHECK(universal > 100);
    CHECK(proofs >= 5);
    CHECK(searches >= 1);
}

TEST_CASE("words of all cases are found as words") {
    CHECK(scene::claim::universal_word("Two ulps are Always enough") == "Always");
    CHECK(scene::claim::universal_word("by at most 6u") == "at most");
    CHECK(scene::claim::universal_word("Neverland has an allowance and a knot").empty());
}

TEST_CASE("a claim about a search measures the worst ray that it finds, and in how many evaluations") {
    std::vector<Claim> claims;
    for (Claim& claim : all_claims()) {
        if (claim.id == "bound.slabs-ize-search") claims.push_back(std::move(claim));
    }
    REQUIRE(claims.size() == 1);
    const auto results = measure::claim::measure_claims(claims, {.data_dir = LOSTBITS_DATA_DIR});
    CHECK(results[0].state == measure::claim::ClaimResult::State::agrees);
    CHECK(results[0].measured > 4);  // more than Ize's two ulps
    CHECK(results[0].measured < 6);  // and less than can be
    CHECK(results[0].evaluations == 256 * 512 * 32);
    CHECK(results[0].witness.given != nullptr);
    claims[0].metric = "lost_bits_max";
    CHECK_THROWS_AS(measure::claim::measure_claims(claims, {.data_dir = LOSTBITS_DATA_DIR}), InputError);
}

}  // namespace test_evidence
