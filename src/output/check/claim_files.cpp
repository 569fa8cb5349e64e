#include "output/check/claim_files.hpp"

#include <fmt/format.h>

#include <pugixml.hpp>

#include <sstream>

#include "output/file/atomic_file.hpp"
#include "output/file/escape.hpp"
#include "output/file/json.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::check {

namespace {

using State = ClaimResult::State;

std::string verdict_name(const Claim& claim) { return std::string(name_of(claim.verdict)); }

struct ClaimRow {
    const Claim& claim;
    const ClaimResult& result;
    measure::metric::Spread spread;
};

table::Table<ClaimRow> make_claim_table() {
    using R = ClaimRow;
    using table::when;
    const auto claim_value = [](const auto& value) {
        return [value](const R& r) { return std::invoke(value, r.claim); };
    };
    const auto result_value_unless_zero = [](const auto& value) {
        return [value](const R& r) { return when(std::invoke(value, r.result) != 0, std::invoke(value, r.result)); };
    };
    const auto draws_value = [](const auto& value) {
        return [value](const R& r) {
            return when(r.result.is_random() && r.spread.draws > 0, std::invoke(value, r.spread));
        };
    };
    using S = measure::metric::Spread;
    return {
        // The statement and its verdict.
        {"id", "the claim", claim_value(&Claim::id)},
        {"statement", "its statement", claim_value(&Claim::statement)},
        {"source", "source of the statement", claim_value(&Claim::source)},
        {"quotation", "words of the source that state the claim; empty if they were not looked up",
         claim_value(&Claim::quotation)},
        {"verdict", "what was found: holds, qualified or refuted", claim_value(verdict_name)},
        {"condition", "condition under which a qualified statement is true, which its source does not state",
         claim_value(&Claim::condition)},
        {"sourced", "true: the statement is from a source; false: it is our own", claim_value(&Claim::is_sourced)},

        // The measured quantity and its expected value.
        {"subject", "scene, sweep or table, and the position in it",
         [](const R& r) { return subject_texts(r.claim).subject; }},
        {"form", "form under test", claim_value(&Claim::form)},
        {"format", "format it computes in", claim_value(&Claim::format)},
        {"quantity", "what is measured", claim_value(quantity_text)},
        {"criterion",
         "what the statement says about the quantity, from which the verdict follows; empty if it describes the "
         "number, which the expected interval then does",
         [](const R& r) { return r.claim.criterion ? r.claim.criterion->text : ""; }},
        {"expected_low", "smallest value that agrees", claim_value(&Claim::low)},
        {"expected_high", "largest value that agrees", claim_value(&Claim::high)},

        // The measured number, and what it rests on.
        {"measured", "the measured number; missing if nothing could be measured",
         table::or_missing([](const R& r) { return r.result.measured; })},
        {"samples", "number of independent random samples; 0: nothing is random",
         [](const R& r) { return r.result.sample_count; }},
        {"floats",
         "number of floats, every one in a range; missing if the claim does not rest on all floats of a range",
         result_value_unless_zero(&ClaimResult::float_count)},
        {"evidence", "what a statement about all cases rests on: proof, exhaustive, search or sample; empty for others",
         [](const R& r) { return std::string(name_of(r.claim.evidence)); }},
        {"lemma", "the inequality of a proof", claim_value(&Claim::lemma)},
        {"evaluations", "rays that a search tried; missing if there was no search",
         result_value_unless_zero(&ClaimResult::evaluation_count)},

        // The numbers of all draws.
        {"draws", "number of draws of the samples, one per seed; missing if nothing is random", draws_value(&S::draws)},
        {"draw_low", "smallest number measured over the draws", draws_value(&S::low)},
        {"draw_median", "median over the draws, the lower of two", draws_value(&S::median)},
        {"draw_high", "largest number measured over the draws", draws_value(&S::high)},
        {"interval_draws",
         "number of draws that the expected interval comes from: their range, widened by half on either side (in "
         "logarithms for onsets and fractions)",
         [](const R& r) { return when(r.claim.draws != 0, r.claim.draws); }},

        // The verdict, and the worst ray.
        {"state", "agrees, disagrees, broken (could not be measured) or skipped",
         [](const R& r) { return state_name(r.result.state); }},
        {"witness", "the worst ray of the measurement in hexadecimal floats",
         [](const R& r) { return witness_text(r.result); }},
        {"witness_explain", "the command that explains that ray",
         [](const R& r) { return witness_command(r.claim, r.result); }}};
}

}  // namespace

void write_claims_csv(const std::filesystem::path& path, const std::vector<Claim>& claims,
                      const std::vector<ClaimResult>& results) {
    const auto table = make_claim_table();
    file::CsvWriter csv(path, table.columns());
    for (std::size_t i = 0; i < claims.size(); ++i) table.add_row(csv, {claims[i], results[i], results[i].spread()});
    csv.close();
}

namespace {

using Json = file::OrderedJson;

Json claim_json(const Claim& claim, const ClaimResult& result) {
    using file::json_number;
    auto further = Json::array();
    for (const double x : result.further_measured) further.push_back(json_number(x));
    const auto bounds =
        result.bounds ? Json{json_number(result.bounds->low), json_number(result.bounds->high)} : Json();

    return {// The statement and its verdict.
            {"id", claim.id},
            {"statement", claim.statement},
            {"source", claim.source},
            {"quotation", claim.quotation},
            {"note", claim.note},
            {"verdict", verdict_name(claim)},
            {"condition", claim.condition},
            {"sourced", claim.is_sourced()},

            // The measured quantity and its expected value.
            {"subject", subject_texts(claim).subject},
            {"form", claim.form},
            {"format", claim.format},
            {"quantity", quantity_text(claim)},
            {"criterion", claim.criterion ? claim.criterion->text : ""},
            {"expected", {json_number(claim.low), json_number(claim.high)}},

            // The measured number, and what it rests on.
            {"measured", json_number(result.measured)},
            {"samples", result.sample_count},
            {"p99_bounds", bounds},
            {"floats", result.float_count},
            {"evidence", std::string(name_of(claim.evidence))},
            {"lemma", claim.lemma},
            {"evaluations", result.evaluation_count},

            // The numbers of the other draws.
            {"further_draws", further},
            {"interval_draws", claim.draws},

            // The verdict, the worst ray, and the command that measures it again.
            {"state", state_name(result.state)},
            {"witness", witness_text(result)},
            {"witness_explain", witness_command(claim, result)},
            {"reproduce", subject_texts(claim).command}};
}

/// Numbers of test cases by what JUnit makes of them, and the seconds of all.
struct JunitCounts {
    std::size_t failures = 0, errors = 0, skips = 0;
    double seconds = 0;
};

/// Adds the counts of the verdicts as properties of the suite.
void add_verdict_properties(pugi::xml_node suite, const CountsBySource& counts) {
    auto properties = suite.append_child("properties");
    for (const auto& [name, text] :
         {std::pair{"from a source", counts.sourced.text()}, {"our own", counts.own.text()}}) {
        auto property = properties.append_child("property");
        property.append_attribute("name") = name;
        property.append_attribute("value") = text.c_str();
    }
}

/// Adds the test case of a claim, with its failure, its error or the reason why it was skipped.
void add_test_case(pugi::xml_node suite, const Claim& claim, const ClaimResult& result, bool strict,
                   JunitCounts& counts) {
    auto test = suite.append_child("testcase");
    test.append_attribute("name") = file::xml_text(claim.id).c_str();
    test.append_attribute("classname") = file::xml_text(claim.subject_name()).c_str();
    test.append_attribute("time") = fmt::format("{:.6f}", result.seconds).c_str();
    counts.seconds += result.seconds;
    if (result.state == State::agrees) return;
    if (result.state == State::skipped) {
        ++counts.skips;
        test.append_child("skipped").append_attribute("message") = file::xml_text(result.reason).c_str();
        return;
    }

    const std::string explanation = file::xml_text(explanation_text(claim, result));
    const std::string details =
        file::xml_text(fmt::format("{}\n{}: {}\n{}\n{}\n{}\n", claim.statement, claim.where.text(), explanation,
                                   witness_text(result), witness_command(claim, result), subject_texts(claim).command));
    if (claim.severity == Claim::Severity::warn && !strict) {
        test.append_child("system-out").text().set(details.c_str());
        return;
    }
    const bool is_failure = result.state == State::disagrees;
    ++(is_failure ? counts.failures : counts.errors);
    auto node = test.append_child(is_failure ? "failure" : "error");
    node.append_attribute("message") = explanation.c_str();
    node.text().set(details.c_str());
}

}  // namespace

void write_claims_json(const std::filesystem::path& path, const std::vector<Claim>& claims,
                       const std::vector<ClaimResult>& results) {
    auto array = Json::array();
    for (std::size_t i = 0; i < claims.size(); ++i) array.push_back(claim_json(claims[i], results[i]));
    file::write_file(path, file::json_text(array));
}

void write_junit(const std::filesystem::path& path, const std::vector<Claim>& claims,
                 const std::vector<ClaimResult>& results, bool strict) {
    // The attributes of the suite stand before its test cases, and get their values after them.
    pugi::xml_document document;
    auto suite = document.append_child("testsuites").append_child("testsuite");
    suite.append_attribute("name") = "lostbits claims";
    const auto tests = suite.append_attribute("tests"), failed = suite.append_attribute("failures"),
               broken = suite.append_attribute("errors"), skipped = suite.append_attribute("skipped"),
               time = suite.append_attribute("time");

    add_verdict_properties(suite, count_verdicts(claims, results));
    JunitCounts counts;
    for (std::size_t i = 0; i < claims.size(); ++i) add_test_case(suite, claims[i], results[i], strict, counts);

    pugi::xml_attribute(time).set_value(fmt::format("{:.6f}", counts.seconds).c_str());
    pugi::xml_attribute(tests).set_value(static_cast<unsigned long long>(claims.size()));
    pugi::xml_attribute(failed).set_value(static_cast<unsigned long long>(counts.failures));
    pugi::xml_attribute(broken).set_value(static_cast<unsigned long long>(counts.errors));
    pugi::xml_attribute(skipped).set_value(static_cast<unsigned long long>(counts.skips));

    std::ostringstream text;
    document.save(text, "  ");
    file::write_file(path, text.str());
}

}  // namespace lostbits::output::check
