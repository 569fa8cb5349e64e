// Measures claims about every float of a range.
#include <algorithm>
#include <cmath>

#include "measure/check/claim_subjects.hpp"
#include "measure/sweep/exhaustive.hpp"
#include "measure/truth/lost_bits.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::measure::check {

using answer::Outcome;
using evaluate::TestedForm;
using scene::check::Claim;
using scene::check::SweepSubject;
using scene::sweep::ExhaustiveFile;
using scene::sweep::float_at;
using sweep::ExhaustiveRequest;
using sweep::FloatTally;
using sweep::RangeFinding;

namespace {

/// Index of the ray that a claim names in the file; if the claim names none, the file must have only one ray.
std::size_t ray_index(const Claim& claim, const std::string& ray, const ExhaustiveFile& file) {
    if (ray.empty() && file.rays.size() == 1) return 0;
    std::vector<std::string> names;
    for (const auto& file_ray : file.rays) names.push_back(file_ray.name);
    const auto found = static_cast<std::size_t>(std::ranges::find(names, ray) - names.begin());
    if (found < names.size()) return found;
    scene::toml::fail(
        claim.where, ray.empty()
                         ? "claim.given names no ray, and " + file.id + " has several; " + text::did_you_mean("", names)
                         : "unknown ray \"" + ray + "\" in " + file.id + "; " + text::did_you_mean(ray, names));
}

/// Returns the file with only the range and the ray of a claim.
ExhaustiveFile narrow_to_claim(const Claim& claim, const SweepSubject::EveryFloat& subject, ExhaustiveFile file) {
    const std::size_t ray = ray_index(claim, subject.ray, file);
    file.rays = {file.rays[ray]};
    if (subject.from.has_value() != subject.to.has_value())
        scene::toml::fail(claim.where, "claim.given has one of from and to; write both, or neither for the whole axis");
    if (subject.from) file.narrow(*subject.from, *subject.to, claim.where);
    return file;
}

/// Number of a tally with its name. The number `wrong` counts every wrong decision.
struct TallyNumber {
    std::string name;
    double value;
};
std::vector<TallyNumber> tally_numbers(const TestedForm& tested_form, const FloatTally& tally) {
    const double worst = tally.worst ? std::fabs(tally.worst->ulps) : truth::missing;
    std::vector<TallyNumber> numbers{
        {"wrong", static_cast<double>(tally.wrong_count())},
        {"padding_max", sweep::max_padding(tested_form, tally)},
        {"ulp_error_max", worst},
        {"lost_bits_max", tally.worst ? truth::lost_bits(worst, binary32.precision) : truth::missing}};
    for (std::size_t o = 0; o < tally.outcomes.size(); ++o) {
        const std::string name(answer::outcome_names[o]);
        numbers.push_back({name, static_cast<double>(tally.outcomes[o])});
        numbers.push_back({name + "_fraction", truth::fraction(tally.outcomes[o], tally.float_count())});
    }
    return numbers;
}

double metric_value(const Claim& claim, const TestedForm& tested_form, const FloatTally& tally) {
    const auto numbers = tally_numbers(tested_form, tally);
    const auto found = std::ranges::find(numbers, claim.metric, &TallyNumber::name);
    if (found != numbers.end()) return found->value;
    std::vector<std::string> names;
    for (const TallyNumber& number : numbers) names.push_back(number.name);
    scene::toml::fail(claim.quantity, "claim.expect.metric is \"" + claim.metric +
                                          "\", which a sweep over every float does not measure; " +
                                          text::did_you_mean(claim.metric, names));
}

std::size_t onset_event(const Claim& claim) {
    for (std::size_t e = 0; e < sweep::first_events.size(); ++e) {
        const auto& event = sweep::first_events[e];
        const auto name = event.lost_bits > 0 ? std::string_view("lost_bits")
                                              : answer::outcome_names[static_cast<std::size_t>(event.outcome)];
        if (claim.onset == name && claim.threshold == std::max(event.lost_bits, 1)) return e;
    }
    scene::toml::fail(claim.where,
                      "no onset of \"" + claim.onset +
                          "\" at that threshold; a sweep over every float has false_miss, false_hit, "
                          "not_a_number and, for meshes, wrong_primitive, crack, double_hit and out_of_order "
                          "(threshold 1), and lost_bits (thresholds 1, 4, 8, 12)");
}

/// Float behind the number of a claim: an onset, the first wrong decision, or the worst error.
std::optional<std::uint32_t> witness_float(const Claim& claim, const FloatTally& tally) {
    if (!claim.onset.empty()) return tally.first_floats[onset_event(claim)];
    for (std::size_t e = 0; e < sweep::first_events.size(); ++e) {
        const auto& event = sweep::first_events[e];
        const auto name = answer::outcome_names[static_cast<std::size_t>(event.outcome)];
        if (event.lost_bits == 0 && claim.metric.starts_with(name)) return tally.first_floats[e];
    }
    if (claim.metric == "padding_max" && tally.padding) return tally.padding->float_index;
    if (claim.metric == "wrong" && tally.first_wrong) return tally.first_wrong->float_index;
    if (tally.worst) return tally.worst->float_index;
    return std::nullopt;
}

evaluate::WorstRay make_witness_at(const ExhaustiveRequest& request, std::size_t form_index,
                                   std::uint32_t float_index) {
    const auto float_answer = sweep::answer_at(request, 0, form_index, float_index);
    const auto ray_group =
        std::make_shared<const scene::rays::RayGroup>(request.sweep.group_at(0, float_at(float_index)));
    return {.x = 0,
            .y = 0,
            .ray = ray_group->rays[0],
            .primitive = ray_group->primitives.front(),
            .t = float_answer.t,
            .outcome = float_answer.outcome,
            .ulps = float_answer.ulps,
            .truth = float_answer.truth,
            .touching = request.tested_forms[form_index].touching,
            .given = ray_group};
}

TestedForm row_in_binary32(const Claim& claim, const ExhaustiveFile& file) {
    TestedForm tested_form = tested_form_for(claim, file);
    if (tested_form.format.engine != Format::Engine::native32)
        scene::toml::fail(claim.where,
                          claim.subject_name() + " tries every number of f32 only; write format = \"f32\"");
    if (!tested_form.touching) tested_form.touching = file.convention;
    return tested_form;
}

/// Compares the findings of a row in all ranges with the expectation of a claim.
ClaimResult judge_tally(const Claim& claim, std::size_t form_index, const ExhaustiveRequest& request,
                        const std::vector<RangeFinding>& findings) {
    FloatTally tally;
    std::optional<float> onset;
    // A sweep over all floats has two ranges, from each zero outwards. The onset is that of the first range with an
    // onset.
    for (const RangeFinding& finding : findings) {
        if (finding.row != form_index) continue;
        tally.append(finding.tally);
        if (!claim.onset.empty() && !onset && finding.tally.first_floats[onset_event(claim)])
            onset = float_at(*finding.tally.first_floats[onset_event(claim)]);
    }
    const double measured = claim.onset.empty() ? metric_value(claim, request.tested_forms[form_index], tally)
                            : onset             ? static_cast<double>(*onset)
                                                : truth::missing;
    ClaimResult result = judge_measured_value(claim, measured, nullptr);
    result.float_count = tally.float_count();
    if (!claim.onset.empty() && !onset) result.reason = "it does not happen at any of the floats";
    mark_if_unproved(result, tally.count(Outcome::unresolved), "float has no proved truth",
                     "floats have no proved truth");
    // A command names a ray and its primitives by their numbers, and a mesh has too many numbers for that.
    if (const auto float_index = witness_float(claim, tally); float_index && !request.sweep.mesh)
        result.witness = make_witness_at(request, form_index, *float_index);
    return result;
}

/// Claims about one range of one ray. The truth of a float is found once for all of them.
struct RangeClaims {
    ExhaustiveFile file;
    SubjectClaims<SweepSubject> claims = {};
};

void measure_range(const RangeClaims& range_claims, truth::ProofLimit limit) {
    ExhaustiveRequest request{.sweep = range_claims.file, .limit = limit};
    std::vector<std::size_t> rows;
    for (const auto& subject_claim : range_claims.claims)
        rows.push_back(
            find_or_add_tested_form(request.tested_forms, row_in_binary32(subject_claim.claim, range_claims.file)));
    sweep::ExhaustiveState state;
    sweep::run_exhaustive(request, state);
    const auto findings = sweep::collect_findings(request, state);
    for (std::size_t k = 0; k < rows.size(); ++k)
        range_claims.claims[k].result = judge_tally(range_claims.claims[k].claim, rows[k], request, findings);
}

}  // namespace

void measure_exhaustive(const SubjectClaims<SweepSubject>& claims, const std::filesystem::path& path,
                        const ClaimRequest& run) {
    const ExhaustiveFile whole_file(path, run.data_dir, run.stop);
    std::vector<RangeClaims> claims_by_range;
    for (const auto& subject_claim : claims) {
        const auto& [claim, subject, result] = subject_claim;
        const auto* const range = subject.part_if<SweepSubject::EveryFloat>();
        if (!range)
            scene::toml::fail(claim.where, "sweep \"" + subject.name +
                                               "\" tries every float; write `exhaustive = true` in claim.given");
        ExhaustiveFile file = narrow_to_claim(claim, *range, whole_file);
        const auto match = std::ranges::find_if(claims_by_range, [&file](const RangeClaims& range_claims) {
            return range_claims.file.rays.front().name == file.rays.front().name &&
                   range_claims.file.ranges() == file.ranges();
        });
        (match != claims_by_range.end() ? *match : claims_by_range.emplace_back(RangeClaims{std::move(file)}))
            .claims.push_back(subject_claim);
    }
    for (const RangeClaims& range_claims : claims_by_range) measure_range(range_claims, {.stop = run.stop});
}

}  // namespace lostbits::measure::check
