// A sentence about all cases states what its verdict rests on, and the claim has that evidence.
#include <regex>

#include "catch.hpp"
#include "measure/check/claim.hpp"
#include "number/error.hpp"
#include "scene/check/claims_file.hpp"
#include "scene/scene_text.hpp"

namespace test_evidence {

using namespace lostbits;
using scene::check::Claim;

namespace {

std::vector<Claim> all_claims() {
    std::vector<Claim> all;
    for (const auto& file : scene::check::list_claim_files(std::filesystem::path(LOSTBITS_DATA_DIR) / "claims")) {
        for (Claim& claim : scene::check::read_claims(file)) all.push_back(std::move(claim));
    }
    return all;
}

/// The first word of a sentence that speaks of all cases ("never", "at most"); empty where the sentence has no such
/// word.
std::string universal_word(const std::string& statement) {
    static const std::regex word(
        R"(\b(sound|never|always|every|everywhere|none|nothing|no|cannot|any|all|at most|at least)\b)",
        std::regex::icase);
    std::smatch found;
    return std::regex_search(statement, found, word) ? found[1].str() : "";
}

/// True if a sentence says that it is about a sample: by that word, as "random", or by how many were tried ("none of
/// 1024 rays", "of the 65,536 pixels").
bool tells_of_a_sample(const std::string& text) {
    static const std::regex words(R"(\b(samples?|random|[0-9][0-9,]* (rays|pixels|points|numbers|marches))\b)",
                                  std::regex::icase);
    return std::regex_search(text, words);
}

}  // namespace

TEST_CASE("every claim about all cases states what it rests on") {
    int universal = 0, proofs = 0, searches = 0;
    for (const Claim& claim : all_claims()) {
        const std::string word = universal_word(claim.statement);
        INFO(claim.where.text() << ": " << claim.id << " says \"" << word << "\": " << claim.statement);
        const bool sample = claim.evidence == Claim::Evidence::sample;
        if (!word.empty()) {
            ++universal;
            CHECK(claim.evidence != Claim::Evidence::none);
            if (sample) CHECK(tells_of_a_sample(claim.statement + " " + claim.note));
            // One case is enough to refute it.
            if (sample) CHECK(claim.verdict != Claim::Verdict::refuted);
        }
        // The largest value of a sample is a lower bound of the largest there is.
        const bool by_largest = claim.metric.ends_with("_max") || claim.metric == "worst";
        if (by_largest && claim.verdict == Claim::Verdict::holds) CHECK(claim.evidence != Claim::Evidence::none);
        // Samples cannot show that a bound holds.
        if (word == "sound") CHECK_FALSE(sample);
        CHECK(universal_word(claim.note) != "sound");
        const auto* const sweep = claim.subject_if<scene::check::SweepSubject>();
        const bool searched = claim.subject_if<scene::check::SearchSubject>();
        if (claim.evidence == Claim::Evidence::exhaustive)
            CHECK((sweep && sweep->part_if<scene::check::SweepSubject::EveryFloat>()));
        if (claim.evidence == Claim::Evidence::search) CHECK((searched || (sweep && sweep->name.starts_with("hard/"))));
        proofs += claim.evidence == Claim::Evidence::proof;
        searches += searched;
    }
    CHECK(universal > 100);
    CHECK(proofs >= 5);
    CHECK(searches >= 1);
}

TEST_CASE("every verdict follows from a criterion, unless the sentence only describes a number") {
    int with = 0, qualified = 0, sourced = 0, describing = 0;
    for (const Claim& claim : all_claims()) {
        INFO(claim.where.text() << ": " << claim.id << ": " << claim.statement);
        // A sentence without a criterion cannot be contradicted, nor be true on a condition.
        if (claim.verdict != Claim::Verdict::holds) CHECK(claim.criterion);
        with += claim.criterion.has_value();
        describing += !claim.criterion && claim.is_sourced();
        qualified += claim.verdict == Claim::Verdict::qualified;
        sourced += claim.is_sourced();
    }
    CHECK(with > 600);
    CHECK(qualified > 30);
    CHECK(sourced > 200);
    CHECK(describing < 20);
}

TEST_CASE("a sentence from a source names the source's page or line") {
    // An address, the section or chapter of a book, the year of a paper, or the comment in a file that is named.
    static const std::regex place(R"(https?://|section [0-9]|chapter [0-9]|the comment there|\((19|20)[0-9][0-9]\))");
    for (const Claim& claim : all_claims()) {
        INFO(claim.where.text() << ": " << claim.id << ": " << claim.source);
        if (claim.is_sourced()) CHECK(std::regex_search(claim.source, place));
    }
}

TEST_CASE("a counterexample refutes a claim about all cases") {
    const lostbits::test::Scratch folder;
    const auto claim = [&](const std::string& verdict) {
        return folder.write("claims.toml", R"(schema = "lostbits-claims/1"
[[claim]]
id = "c"
statement = "Two ulps are always enough"
source = "-"
evidence = "counterexample"
verdict = ")" + verdict + R"("
[claim.given]
scene = "near-benign"
form = "sphere.unified"
format = "f32"
[claim.expect]
metric = "false_miss"
in = [0, 0]
)");
    };
    CHECK(scene::check::read_claims(claim("refuted")).front().evidence == Claim::Evidence::counterexample);
    CHECK_THROWS_AS(scene::check::read_claims(claim("holds")), InputError);
}

TEST_CASE("a claim about a search refers to the worst ray found") {
    std::vector<Claim> claims;
    for (Claim& claim : all_claims()) {
        if (claim.id == "stability.slabs-search") claims.push_back(std::move(claim));
    }
    REQUIRE(claims.size() == 1);
    claims[0].metric = "lost_bits_max";
    CHECK_THROWS_AS(measure::check::measure_claims(claims, {.data_dir = LOSTBITS_DATA_DIR}), InputError);
}

}  // namespace test_evidence
