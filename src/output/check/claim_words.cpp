// Texts about claims: expected and measured values, evidence, and counts of verdicts.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>

#include "output/attribution/explain_command.hpp"
#include "output/check/claim_files.hpp"
#include "output/file/number_text.hpp"
#include "shapes/number_names.hpp"
#include "text/count_with_noun.hpp"
#include "text/shell_word.hpp"

namespace lostbits::output::check {

using text::shell_word;

std::string witness_text(const ClaimResult& result) {
    if (result.witness.x < 0) return "";
    const auto& w = result.witness;
    std::string text = fmt::format("origin {} {} {} direction {} {} {}", file::hex(w.ray.origin.x),
                                   file::hex(w.ray.origin.y), file::hex(w.ray.origin.z), file::hex(w.ray.direction.x),
                                   file::hex(w.ray.direction.y), file::hex(w.ray.direction.z));
    for (std::size_t i = 0; i < w.primitive.shape_numbers().size(); ++i)
        text += fmt::format(" {} {}", number_names(w.primitive.shape)[i], file::hex(w.primitive.numbers[i]));
    return text + " t " + file::hex(w.t);
}

std::string witness_command(const Claim& claim, const ClaimResult& result) {
    if (result.witness.x < 0) return "";
    const std::string name =
        result.witness.given ? attribution::explain_ray_arguments(result.witness.given.get())
        : claim.subject_if<scene::check::SceneSubject>()
            ? attribution::explain_pixel_arguments(shell_word(claim.subject_name()), static_cast<int>(result.witness.x),
                                                   result.witness.y)
            : "";
    if (name.empty()) return "";
    measure::evaluate::TestedForm tested_form = measure::check::tested_form_of(claim);
    tested_form.touching = result.witness.touching;
    return attribution::explain_command(name, tested_form);
}

std::string quantity_text(const Claim& claim) {
    if (!claim.operations.empty())
        return fmt::format("{} of {}", claim.metric, fmt::join(claim.operations, " and of "));
    return claim.onset.empty()
               ? claim.metric
               : fmt::format("onset of {} {} {}", claim.onset, claim.statistic, file::decimal(claim.threshold));
}

std::string floats_text(const ClaimResult& result) {
    return result.float_count == 0 ? "" : "all " + text::count_with_noun(result.float_count, "float");
}

std::string evidence_text(const Claim& claim, const ClaimResult& result) {
    using Evidence = Claim::Evidence;
    const bool is_refuted = claim.verdict == Claim::Verdict::refuted;
    if (claim.verdict == Claim::Verdict::qualified) return claim.condition;
    if (result.evaluation_count > 0)
        return fmt::format("{} in {} evaluations; the worst is {}", is_refuted ? "found" : "no worse case found",
                           result.evaluation_count, file::decimal(result.measured));
    switch (claim.evidence) {
        case Evidence::proof: return (is_refuted ? "refuted by proof: " : "proved: ") + claim.lemma;
        case Evidence::exhaustive: return result.float_count > 0 ? "" : "every case that it speaks of was measured";
        case Evidence::search:
            return is_refuted ? "by the worst case that a search found" : "for the worst case that a search found";
        case Evidence::counterexample: return "by a counterexample";
        case Evidence::sample: return "for a measured sample";
        case Evidence::none: break;
    }
    return "";
}

std::string criterion_text(const Claim& claim) {
    return claim.criterion ? "the statement says " + claim.criterion->text : "";
}

namespace {

using State = ClaimResult::State;

/// True if the verdict still follows from the criterion for every draw; nullopt if there is no criterion or the claim
/// agrees.
std::optional<bool> verdict_stands(const Claim& claim, const ClaimResult& result) {
    if (!claim.criterion || result.state != State::disagrees) return std::nullopt;
    const auto s = result.spread();
    return claim.criterion->is_met_by(claim.low, claim.high) ? claim.criterion->is_met_by(s.low, s.high)
                                                             : claim.criterion->is_failed_by(s.low, s.high);
}

std::string verdict_clause(const Claim& claim, const ClaimResult& result) {
    const auto stands = verdict_stands(claim, result);
    if (!stands) return "";
    return fmt::format("; {}: {}", criterion_text(claim),
                       *stands ? "the number has changed, but the verdict stands" : "the verdict no longer follows");
}

}  // namespace

std::string disagreement_text(const Claim& claim, const ClaimResult& result) {
    if (claim.verdict == Claim::Verdict::holds && !verdict_stands(claim, result).value_or(false))
        return "expected to hold, but does not";
    return fmt::format("{}, but the number has changed", name_of(claim.verdict));
}

namespace {

std::string expected_and_measured(const Claim& claim, const ClaimResult& result) {
    const std::string expected = fmt::format("expected {} in [{}, {}]", quantity_text(claim), file::decimal(claim.low),
                                             file::decimal(claim.high));
    if (result.state == State::unmeasurable && !result.further_measured.empty())
        return fmt::format("{}, but {} (it exists in {} of {} draws)", expected, result.reason, result.spread().draws,
                           1 + result.further_measured.size());
    if (result.state == State::unmeasurable || result.state == State::skipped)
        return fmt::format("{}, but {}", expected, result.reason);

    // The measured number, with what it rests on.
    if (result.evaluation_count > 0)
        return fmt::format("{}, measured {} as the worst of {} evaluations", expected, file::decimal(result.measured),
                           result.evaluation_count);
    if (result.float_count > 0)
        return fmt::format("{}, measured {} over {}", expected, file::decimal(result.measured), floats_text(result));
    if (result.further_measured.empty())
        return fmt::format("{}, measured {}", expected, file::decimal(result.measured));
    const auto s = result.spread();
    return fmt::format("{}, measured {}, and {} to {} over {}", expected, file::decimal(result.measured),
                       file::decimal(s.low), file::decimal(s.high), text::count_with_noun(s.draws, "draw"));
}

}  // namespace

std::string explanation_text(const Claim& claim, const ClaimResult& result) {
    return expected_and_measured(claim, result) + verdict_clause(claim, result);
}

const Metric* metric_of_column(const std::string& column) {
    const Metric* best = nullptr;
    for (const Metric& metric : measure::metric::metrics()) {
        if (column.starts_with(metric.name) && (best == nullptr || metric.name.size() > best->name.size()))
            best = &metric;
    }
    return best;
}

void VerdictCounts::add(const Claim& claim, const ClaimResult& result) {
    switch (result.state) {
        case ClaimResult::State::agrees: break;
        case ClaimResult::State::disagrees: ++differing; return;
        case ClaimResult::State::unmeasurable: ++broken; return;
        case ClaimResult::State::skipped: ++skipped; return;
    }
    with_criterion += claim.criterion.has_value();
    switch (claim.verdict) {
        case Claim::Verdict::holds: ++held; break;
        case Claim::Verdict::qualified: ++qualified; break;
        case Claim::Verdict::refuted: ++refuted; break;
    }
}

std::string VerdictCounts::text() const {
    std::string text;
    const auto add = [&text](std::size_t n, const char* singular, const char* plural) {
        if (n > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, n == 1 ? singular : plural);
    };
    add(held, "holds", "hold");
    add(qualified, "is qualified", "are qualified");
    add(refuted, "is refuted", "are refuted");
    return text.empty() ? "none" : text;
}

std::string CountsBySource::text() const {
    std::string text;
    if (sourced.agreeing_count() > 0) text = "from a source: " + sourced.text();
    if (own.agreeing_count() > 0) text += (text.empty() ? "" : "; ") + ("our own: " + own.text());
    return text.empty() ? "no verdict is confirmed" : text;
}

CountsBySource count_verdicts(const std::vector<Claim>& claims, const std::vector<ClaimResult>& results) {
    CountsBySource counts;
    for (std::size_t i = 0; i < claims.size(); ++i) {
        counts.all.add(claims[i], results[i]);
        (claims[i].is_sourced() ? counts.sourced : counts.own).add(claims[i], results[i]);
    }
    return counts;
}

}  // namespace lostbits::output::check
