// Texts about claims: expected and measured values, verdicts, and how many hold.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>

#include "output/attribution/explain_command.hpp"
#include "output/claim/claim_files.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/counted.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::output::claim {

using attribution::shell_word;

std::string witness_text(const ClaimResult& r) {
    if (r.witness.x < 0) return "";
    const auto& w = r.witness;
    std::string text = fmt::format("origin {} {} {} direction {} {} {}", file::hex(w.ray.origin.x),
                                   file::hex(w.ray.origin.y), file::hex(w.ray.origin.z), file::hex(w.ray.direction.x),
                                   file::hex(w.ray.direction.y), file::hex(w.ray.direction.z));
    for (std::size_t i = 0; i < w.primitive.used().size(); ++i)
        text += fmt::format(" {} {}", number_names(w.primitive.shape)[i], file::hex(w.primitive.numbers[i]));
    return text + " t " + file::hex(w.t);
}

std::string explain_witness(const Claim& c, const ClaimResult& r) {
    if (r.witness.x < 0) return "";
    const std::string name = r.witness.given ? attribution::explain_ray_arguments(r.witness.given.get())
                             : c.on<scene::claim::SceneSubject>()
                                 ? attribution::explain_pixel_arguments(shell_word(c.subject_name()),
                                                                        static_cast<int>(r.witness.x), r.witness.y)
                                 : "";
    if (name.empty()) return "";
    measure::evaluate::TestedForm form_row = measure::claim::claim_row(c);
    form_row.touching = r.witness.touching;
    return attribution::explain_command(name, form_row);
}

std::string quantity(const Claim& c) {
    if (!c.operations.empty()) return fmt::format("{} of {}", c.metric, fmt::join(c.operations, " and of "));
    return c.onset.empty() ? c.metric
                           : fmt::format("onset of {} {} {}", c.onset, c.statistic, file::decimal(c.threshold));
}

std::string floats_text(const ClaimResult& r) {
    return r.floats == 0 ? "" : "all " + scene::toml::count_with_noun(r.floats, "float");
}

std::string evidence_text(const Claim& c, const ClaimResult& r) {
    using Evidence = Claim::Evidence;
    const bool is_refuted = c.verdict == Claim::Verdict::refuted;
    if (c.verdict == Claim::Verdict::qualified) return c.condition;
    if (r.evaluations > 0)
        return fmt::format("{} in {} evaluations; the worst is {}", is_refuted ? "found" : "no worse case found",
                           r.evaluations, file::decimal(r.measured));
    switch (c.evidence) {
        case Evidence::proof: return (is_refuted ? "refuted by proof: " : "proved: ") + c.lemma;
        case Evidence::exhaustive: return r.floats > 0 ? "" : "every case that it speaks of was measured";
        case Evidence::search:
            return is_refuted ? "by the worst case that a search found" : "for the worst case that a search found";
        case Evidence::counterexample: return "by a counterexample";
        case Evidence::sample: return "for a measured sample";
        case Evidence::none: break;
    }
    return "";
}

std::string says_text(const Claim& c) { return c.criterion ? "the statement says " + c.criterion->text : ""; }

namespace {

using State = ClaimResult::State;

/// True if the verdict still follows from the criterion for every draw; nullopt if there is no criterion or the claim
/// agrees.
std::optional<bool> verdict_stands(const Claim& c, const ClaimResult& r) {
    if (!c.criterion || r.state != State::disagrees) return std::nullopt;
    const auto s = r.spread();
    return c.criterion->is_met_by(c.low, c.high) ? c.criterion->is_met_by(s.low, s.high)
                                                 : c.criterion->is_failed_by(s.low, s.high);
}

std::string verdict_clause(const Claim& c, const ClaimResult& r) {
    const auto stands = verdict_stands(c, r);
    if (!stands) return "";
    return fmt::format("; {}: {}", says_text(c),
                       *stands ? "the number has changed, but the verdict stands" : "the verdict no longer follows");
}

}  // namespace

std::string changed_text(const Claim& c, const ClaimResult& r) {
    if (c.verdict == Claim::Verdict::holds && !verdict_stands(c, r).value_or(false))
        return "expected to hold, but does not";
    return fmt::format("{}, but the number has changed", name_of(c.verdict));
}

namespace {

std::string expected_and_measured(const Claim& c, const ClaimResult& r) {
    const std::string expected =
        fmt::format("expected {} in [{}, {}]", quantity(c), file::decimal(c.low), file::decimal(c.high));
    if (r.state == State::unmeasurable && !r.further_measured.empty())
        return fmt::format("{}, but {} (it exists in {} of {} draws)", expected, r.reason, r.spread().draws,
                           1 + r.further_measured.size());
    if (r.state == State::unmeasurable || r.state == State::skipped)
        return fmt::format("{}, but {}", expected, r.reason);
    if (r.evaluations > 0)
        return fmt::format("{}, measured {} as the worst of {} evaluations", expected, file::decimal(r.measured),
                           r.evaluations);
    if (r.floats > 0)
        return fmt::format("{}, measured {} over {}", expected, file::decimal(r.measured), floats_text(r));
    if (r.further_measured.empty()) return fmt::format("{}, measured {}", expected, file::decimal(r.measured));
    const auto s = r.spread();
    return fmt::format("{}, measured {}, and {} to {} over {}", expected, file::decimal(r.measured),
                       file::decimal(s.low), file::decimal(s.high), scene::toml::count_with_noun(s.draws, "draw"));
}

}  // namespace

std::string explain(const Claim& c, const ClaimResult& r) { return expected_and_measured(c, r) + verdict_clause(c, r); }

const Metric* metric_of_column(const std::string& column) {
    const Metric* best = nullptr;
    for (const Metric& m : measure::metric::metrics()) {
        if (column.starts_with(m.name) && (best == nullptr || m.name.size() > best->name.size())) best = &m;
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
    if (sourced.confirmed() > 0) text = "from a source: " + sourced.text();
    if (own.confirmed() > 0) text += (text.empty() ? "" : "; ") + ("our own: " + own.text());
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

}  // namespace lostbits::output::claim
