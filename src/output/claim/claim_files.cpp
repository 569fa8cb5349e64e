#include "output/claim/claim_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <optional>

#include "output/blame/explain_command.hpp"
#include "output/claim/subject_words.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/json.hpp"
#include "output/table/table.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::output::claim {

using blame::shell_word;
using measure::claim::ClaimResult;
using measure::metric::Metric;

namespace {

using scene::claim::Claim;
using State = ClaimResult::State;

std::string verdict_name(const Claim& c) { return std::string(name_of(c.verdict)); }

}  // namespace

std::string witness_text(const ClaimResult& r) {
    if (r.witness.x < 0) return "";
    const auto& w = r.witness;
    std::string text = fmt::format("origin {} {} {} direction {} {} {}", file::hex(w.ray.origin.x),
                                   file::hex(w.ray.origin.y), file::hex(w.ray.origin.z), file::hex(w.ray.direction.x),
                                   file::hex(w.ray.direction.y), file::hex(w.ray.direction.z));
    for (std::size_t i = 0; i < w.solid.used().size(); ++i)
        text += fmt::format(" {} {}", number_names(w.solid.shape)[i], file::hex(w.solid.numbers[i]));
    return text + " t " + file::hex(w.t);
}

std::string explain_witness(const Claim& c, const ClaimResult& r) {
    if (r.witness.x < 0) return "";
    const std::string name =
        r.witness.given ? blame::name_of_ray(r.witness.given.get())
        : c.on<scene::claim::SceneSubject>()
            ? blame::name_of_pixel(shell_word(c.subject_name()), static_cast<int>(r.witness.x), r.witness.y)
            : "";
    if (name.empty()) return "";
    measure::evaluate::TestedForm row = measure::claim::claim_row(c);
    row.judged = r.witness.judged;
    return blame::explain_command(name, row);
}

std::string quantity(const Claim& c) {
    if (!c.operations.empty()) return fmt::format("{} of {}", c.metric, fmt::join(c.operations, " and of "));
    return c.onset.empty() ? c.metric
                           : fmt::format("onset of {} {} {}", c.onset, c.statistic, file::decimal(c.threshold));
}

std::string floats_text(const ClaimResult& r) { return r.floats == 0 ? "" : fmt::format("all {} floats", r.floats); }

std::string evidence_text(const Claim& c, const ClaimResult& r) {
    using Evidence = Claim::Evidence;
    const bool found = c.verdict == Claim::Verdict::refuted;
    if (c.verdict == Claim::Verdict::qualified) return c.condition;
    if (r.evaluations > 0)
        return fmt::format("{} in {} evaluations; the worst is {}", found ? "found" : "no worse one found",
                           r.evaluations, file::decimal(r.measured));
    switch (c.evidence) {
        case Evidence::proof: return (found ? "refuted by proof: " : "proved: ") + c.lemma;
        case Evidence::exhaustive: return r.floats > 0 ? "" : "all that it speaks of was measured";
        case Evidence::search: return found ? "by the worst that a search found" : "of the worst that a search found";
        case Evidence::counterexample: return "by a counterexample";
        case Evidence::sample: return "of what was measured, a sample";
        case Evidence::none: break;
    }
    return "";
}

std::string says_text(const Claim& c) { return c.criterion ? "the sentence says " + c.criterion->text : ""; }

namespace {

/// Whether the verdict still follows from the criterion, for every draw; nothing where there is no criterion.
std::optional<bool> stands(const Claim& c, const ClaimResult& r) {
    if (!c.criterion || r.state != State::disagrees) return std::nullopt;
    const auto s = r.spread();
    return c.criterion->is_met_by(c.low, c.high) ? c.criterion->is_met_by(s.low, s.high)
                                                 : c.criterion->is_failed_by(s.low, s.high);
}

std::string fate_of_verdict(const Claim& c, const ClaimResult& r) {
    const auto still = stands(c, r);
    if (!still) return "";
    return fmt::format(
        "; {}: {}", says_text(c),
        *still ? "the number has moved, and the verdict stands" : "the verdict does not follow any more");
}

}  // namespace

std::string changed_text(const Claim& c, const ClaimResult& r) {
    if (c.verdict == Claim::Verdict::holds && !stands(c, r).value_or(false)) return "expected to hold, does not";
    return fmt::format("{}, but the number has changed", name_of(c.verdict));
}

namespace {

std::string expected_and_measured(const Claim& c, const ClaimResult& r) {
    const std::string expected =
        fmt::format("expected {} in [{}, {}]", quantity(c), file::decimal(c.low), file::decimal(c.high));
    if (r.state == State::broken && !r.further.empty())
        return fmt::format("{}, but {} (it exists in {} of {} draws)", expected, r.trouble, r.spread().draws,
                           1 + r.further.size());
    if (r.state == State::broken || r.state == State::skipped) return fmt::format("{}, but {}", expected, r.trouble);
    if (r.evaluations > 0)
        return fmt::format("{}, measured {} as the worst of {} evaluations", expected, file::decimal(r.measured),
                           r.evaluations);
    if (r.floats > 0)
        return fmt::format("{}, measured {} over {}", expected, file::decimal(r.measured), floats_text(r));
    if (r.further.empty()) return fmt::format("{}, measured {}", expected, file::decimal(r.measured));
    const auto s = r.spread();
    return fmt::format("{}, measured {}, and {} to {} over {} draws", expected, file::decimal(r.measured),
                       file::decimal(s.low), file::decimal(s.high), s.draws);
}

}  // namespace

std::string explain(const Claim& c, const ClaimResult& r) {
    return expected_and_measured(c, r) + fate_of_verdict(c, r);
}

const Metric* metric_of_column(const std::string& column) {
    const Metric* best = nullptr;
    for (const Metric& m : measure::metric::metrics()) {
        if (column.starts_with(m.name) && (best == nullptr || m.name.size() > best->name.size())) best = &m;
    }
    return best;
}

namespace {

struct ClaimRow {
    const Claim& claim;
    const ClaimResult& result;
    measure::metric::Spread spread;
};

table::Table<ClaimRow> claim_table() {
    using R = ClaimRow;
    using table::when;
    const auto of_claim = [](const auto& value) { return [value](const R& r) { return std::invoke(value, r.claim); }; };
    const auto counted = [](const auto& value) {
        return [value](const R& r) { return when(std::invoke(value, r.result) != 0, std::invoke(value, r.result)); };
    };
    const auto drawn = [](const auto& value) {
        return [value](const R& r) {
            return when(r.result.is_drawn() && r.spread.draws > 0, std::invoke(value, r.spread));
        };
    };
    using S = measure::metric::Spread;
    return {
        {"id", "string", "", "the claim", of_claim(&Claim::id)},
        {"statement", "string", "", "its sentence", of_claim(&Claim::statement)},
        {"source", "string", "", "where the sentence is from", of_claim(&Claim::source)},
        {"verdict", "string", "", "what was found: holds, qualified or refuted", of_claim(verdict_name)},
        {"condition", "string", "", "of a qualified sentence: when it is true, which its source does not say",
         of_claim(&Claim::condition)},
        {"sourced", "boolean", "", "whether it is from a source; false: it is our own", of_claim(&Claim::is_sourced)},
        {"subject", "string", "", "scene, sweep or table, and the place in it",
         [](const R& r) { return words_of(r.claim).where; }},
        {"form", "string", "", "form under test", of_claim(&Claim::form)},
        {"format", "string", "", "format it computes in", of_claim(&Claim::format)},
        {"quantity", "string", "", "what is measured", of_claim(quantity)},
        {"criterion", "string", "",
         "what the sentence says of the quantity, from which the verdict follows; empty where it describes the "
         "number and the expected interval says as much",
         [](const R& r) { return r.claim.criterion ? r.claim.criterion->text : ""; }},
        {"expected_low", "number", "", "smallest value that agrees", of_claim(&Claim::low)},
        {"expected_high", "number", "", "largest value that agrees", of_claim(&Claim::high)},
        {"measured", "number", "", "missing where nothing could be measured",
         [](const R& r) { return file::number_or_missing(r.result.measured); }},
        {"samples", "integer", "", "independent random samples that it rests on; 0: nothing is random",
         [](const R& r) { return r.result.samples; }},
        {"floats", "integer", "",
         "every float of a range was tried, so many; missing where the claim does not rest on all of them",
         counted(&ClaimResult::floats)},
        {"evidence", "string", "",
         "what a sentence about all cases rests on: proof, exhaustive, search or sample; empty for others",
         [](const R& r) { return std::string(name_of(r.claim.evidence)); }},
        {"lemma", "string", "", "the inequality of a proof", of_claim(&Claim::lemma)},
        {"evaluations", "integer", "", "rays that a search tried; missing where none did",
         counted(&ClaimResult::evaluations)},
        {"draws", "integer", "", "of those samples, one a seed: missing where nothing is random", drawn(&S::draws)},
        {"draw_low", "number", "", "smallest number measured over the draws", drawn(&S::low)},
        {"draw_median", "number", "", "the middle one, the lower of two", drawn(&S::median)},
        {"draw_high", "number", "", "the largest", drawn(&S::high)},
        {"interval_draws", "integer", "",
         "draws that the expected interval comes from: their range, and half as much again on either side (in "
         "logarithms of onsets and fractions)",
         [](const R& r) { return when(r.claim.draws != 0, r.claim.draws); }},
        {"state", "string", "", "agrees, disagrees, broken (could not be measured) or skipped",
         [](const R& r) { return state_name(r.result.state); }},
        {"witness", "string", "", "the worst ray of the measurement in hexadecimal floats",
         [](const R& r) { return witness_text(r.result); }},
        {"witness_explain", "string", "", "the command that explains that ray",
         [](const R& r) { return explain_witness(r.claim, r.result); }}};
}

}  // namespace

void write_claims_csv(const std::filesystem::path& path, const std::vector<Claim>& claims,
                      const std::vector<ClaimResult>& results) {
    const auto table = claim_table();
    file::CsvWriter csv(path, table.columns());
    for (std::size_t i = 0; i < claims.size(); ++i) table.add_row(csv, {claims[i], results[i], results[i].spread()});
    csv.close();
}

void write_claims_json(const std::filesystem::path& path, const std::vector<Claim>& claims,
                       const std::vector<ClaimResult>& results) {
    using Json = file::OrderedJson;
    using file::json_number;
    auto array = Json::array();
    for (std::size_t i = 0; i < claims.size(); ++i) {
        const Claim& c = claims[i];
        auto further = Json::array();
        for (const double x : results[i].further) further.push_back(json_number(x));
        const auto& b = results[i].bounds;
        const auto bounds = b ? Json{json_number(b->low), json_number(b->high)} : Json();
        array.push_back({{"id", c.id},
                         {"statement", c.statement},
                         {"source", c.source},
                         {"note", c.note},
                         {"verdict", verdict_name(c)},
                         {"condition", c.condition},
                         {"sourced", c.is_sourced()},
                         {"subject", words_of(c).where},
                         {"form", c.form},
                         {"format", c.format},
                         {"quantity", quantity(c)},
                         {"criterion", c.criterion ? c.criterion->text : ""},
                         {"expected", {json_number(c.low), json_number(c.high)}},
                         {"measured", json_number(results[i].measured)},
                         {"samples", results[i].samples},
                         {"p99_bounds", bounds},
                         {"floats", results[i].floats},
                         {"evidence", std::string(name_of(c.evidence))},
                         {"lemma", c.lemma},
                         {"evaluations", results[i].evaluations},
                         {"further_draws", further},
                         {"interval_draws", c.draws},
                         {"state", state_name(results[i].state)},
                         {"witness", witness_text(results[i])},
                         {"witness_explain", explain_witness(c, results[i])},
                         {"reproduce", words_of(c).command}});
    }
    file::write_file(path, file::json_text(array));
}

}  // namespace lostbits::output::claim
