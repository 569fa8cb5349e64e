// Measures claims about sweeps: along axes, over named cases, about the worst ray of a search (metric `worst`), or
// about the counts of a search at edges of a mesh.
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "measure/check/claim_columns.hpp"
#include "measure/check/claim_subjects.hpp"
#include "measure/edges/edge_search.hpp"
#include "measure/sweep/sweep.hpp"
#include "measure/sweep/worst.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::measure::check {

using attribution::OwnedSetting;
using evaluate::TestedForm;
using scene::check::Claim;
using scene::check::SearchSubject;
using scene::check::SweepSubject;
using scene::sweep::SweepKind;
using truth::missing;

namespace {

void measure_cases(const SubjectClaims<SweepSubject>& claims, const std::filesystem::path& path,
                   truth::ProofLimit limit) {
    const scene::sweep::CaseFile file(path);
    sweep::CaseRequest request{.file = file, .tested_forms = {}, .metrics = {}, .limit = limit};
    for (const auto& subject_claim : claims) request.tested_forms.push_back(tested_form_for(subject_claim.claim, file));
    const OwnedSetting setting(file.rays(0, binary64).front());
    const ClaimColumns columns(claim_pointers(claims), request.tested_forms, setting.get());
    request.metrics = columns.metrics();
    for (std::size_t k = 0; k < claims.size(); ++k) {
        const auto& [claim, subject, result] = claims[k];
        const auto* const named_case = subject.part_if<SweepSubject::Case>();
        if (!named_case)
            scene::toml::fail(claim.where, "sweep \"" + subject.name +
                                               "\" has cases, not axes; write `case = \"...\"` in claim.given");
        const auto summary = sweep::run_cases_together(request, k, file.cases_matching(named_case->name, claim.where));
        result = judge_measured_value(claim, columns.value(claim, summary), &summary);
    }
}

/// Bounds of the 99th percentile that a claim is about; empty for a claim about another number.
std::optional<metric::Bounds> compute_quantile_bounds(const Claim& claim, const ClaimColumns& columns,
                                                      const evaluate::FormSummary& summary) {
    if (!claim.metric.ends_with("_p99")) return std::nullopt;
    const auto bound = [&](const char* name) {
        Claim bound_claim = claim;
        bound_claim.metric += name;
        return columns.value(bound_claim, summary);
    };
    return metric::Bounds{bound("_low"), bound("_high")};
}

/// Position of the claim on the axes. Throws InputError if the position does not fit the axes.
std::vector<double> position_on_axes(const SubjectClaim<SweepSubject>& subject_claim,
                                     const scene::sweep::SweepFile& sweep) {
    const auto& [claim, subject, result] = subject_claim;
    const auto* const part = subject.part_if<SweepSubject::SweepPosition>();
    std::vector<double> position = part ? part->values : std::vector<double>{};
    if (position.size() != sweep.axes.size()) {
        scene::toml::fail(claim.where, "sweep \"" + subject.name + "\" has " +
                                           text::count_with_noun(sweep.axes.size(), "axis", "axes") +
                                           "; write as many values in `at`");
    }
    for (std::size_t a = 0; a < position.size(); ++a) {
        const auto [low, high] = std::minmax(sweep.axes[a].from, sweep.axes[a].to);
        if (position[a] < low || position[a] > high)
            scene::toml::fail(claim.where, "`at` lies outside the axis " + sweep.axes[a].name + " of sweep \"" +
                                               subject.name + "\"; write a value between its ends");
    }
    return position;
}

/// Claims about one position on the axes of a sweep, or about its onsets.
struct AxesClaims {
    const SubjectClaims<SweepSubject>& claims;
    const ClaimColumns& columns;
    const std::vector<std::size_t>& rows;  ///< row of each claim, among those of the request
};

void measure_position(const AxesClaims& axes_claims, const sweep::SweepRequest& request,
                      const std::vector<double>& position) {
    const auto summaries = sweep::measure_at(request, position);
    for (std::size_t k = 0; k < axes_claims.claims.size(); ++k) {
        const auto& [claim, subject, result] = axes_claims.claims[k];
        const evaluate::FormSummary& summary = summaries[axes_claims.rows[k]];
        result = judge_measured_value(claim, axes_claims.columns.value(claim, summary), &summary);
        if (!request.sweep.has_random_rays()) continue;
        result.sample_count = summary.view_count;
        if (summary.ray_count == summary.view_count)
            result.bounds = compute_quantile_bounds(claim, axes_claims.columns, summary);
    }
}

void measure_onsets(const AxesClaims& axes_claims, sweep::SweepRequest request) {
    for (std::size_t k = 0; k < axes_claims.claims.size(); ++k) {
        const Claim& claim = axes_claims.claims[k].claim;
        request.wanted_onsets.push_back({axes_claims.rows[k], claim.onset, claim.statistic, claim.threshold});
    }

    const auto onsets = sweep::find_onsets(request, sweep::run_sweep(request));
    for (std::size_t k = 0; k < axes_claims.claims.size(); ++k) {
        const Claim& claim = axes_claims.claims[k].claim;
        ClaimResult& result = axes_claims.claims[k].result;
        const auto onset = std::ranges::find_if(
            onsets, [&](const sweep::Onset& candidate) { return candidate.is_same_event(request.wanted_onsets[k]); });

        if (onset == onsets.end()) {
            scene::toml::fail(
                claim.where,
                "no onset of \"" + claim.onset + "\" by \"" + claim.statistic +
                    "\" at that threshold; events are lost_bits (p50, p99, max; 1, 4, 8, p/2, p), false_hit, "
                    "false_miss, not_a_number and, for marches, max_dist, max_steps, stagnated (count; 1)");
        }

        result = judge_measured_value(claim, onset->found ? onset->first_bad : missing, nullptr);
        if (request.sweep.has_random_rays()) result.sample_count = onset->view_count;
        if (!onset->found) result.reason = "it does not happen within the sweep";
    }
}

/// Position on the axes of a sweep; absent for claims about onsets.
using AxesPosition = std::optional<std::vector<double>>;

void measure_axes(const SubjectClaims<SweepSubject>& claims, const AxesPosition& position,
                  const scene::sweep::SweepFile& sweep, truth::ProofLimit limit) {
    sweep::SweepRequest request{.sweep = sweep, .tested_forms = {}, .metrics = {}, .limit = limit};
    std::vector<std::size_t> rows;
    for (const auto& [claim, subject, result] : claims) {
        TestedForm tested_form = tested_form_for(claim, sweep);
        if (!tested_form.touching) tested_form.touching = sweep.convention;
        rows.push_back(find_or_add_tested_form(request.tested_forms, tested_form));
    }
    const OwnedSetting setting(sweep.first_rays());
    const ClaimColumns columns(claim_pointers(claims), request.tested_forms, setting.get());
    request.metrics = columns.metrics();
    if (position) measure_position({claims, columns, rows}, request, *position);
    else measure_onsets({claims, columns, rows}, std::move(request));
}

/// Fails for a claim about every float, if the sweep is over axes.
void require_no_every_float(const SubjectClaims<SweepSubject>& claims, const std::string& sweep_name) {
    for (const auto& [claim, subject, result] : claims) {
        if (subject.part_if<SweepSubject::EveryFloat>())
            scene::toml::fail(claim.where,
                              "`exhaustive = true` belongs to claims about sweeps over every float, and "
                              "sweep \"" +
                                  sweep_name + "\" is of another kind; leave it out");
    }
}

}  // namespace

void measure(const SubjectClaims<SweepSubject>& claims, const ClaimRequest& run) {
    const Claim& first_claim = claims.front().claim;
    const std::string& subject_name = first_claim.subject_name();
    const auto path = find_for_claim(first_claim, [&] { return scene::sweep::find_sweep(subject_name, run.data_dir); });
    switch (scene::sweep::read_sweep_kind(path)) {
        case SweepKind::cases: return measure_cases(claims, path, {.stop = run.stop});
        case SweepKind::search:
        case SweepKind::edge_search:
            scene::toml::fail(first_claim.where,
                              "sweep \"" + subject_name + "\" is a search; write `search = ` in place of `sweep = `");
        case SweepKind::every_float: return measure_exhaustive(claims, path, run);
        case SweepKind::axes: break;
    }
    require_no_every_float(claims, subject_name);

    // Claims about one position are measured together, and so are all claims about onsets.
    const scene::sweep::SweepFile sweep(path, run.data_dir, {}, run.stop);
    std::map<AxesPosition, SubjectClaims<SweepSubject>> claims_by_position;
    for (const auto& subject_claim : claims)
        claims_by_position[subject_claim.claim.onset.empty() ? AxesPosition(position_on_axes(subject_claim, sweep))
                                                             : std::nullopt]
            .push_back(subject_claim);

    for (const auto& entry : claims_by_position) {
        measure_draws(entry.second, run, [&](const SubjectClaims<SweepSubject>& draw_claims, int draw) {
            measure_axes(draw_claims, entry.first, sweep.with_seed_offset(draw), {.stop = run.stop});
        });
    }
}

namespace {

/// Metric of a claim about the census of an edge search: it counts the rays at `target` with this outcome.
struct CensusMetric {
    std::string_view name;
    answer::Outcome outcome;
    std::optional<edges::EdgeTarget> target;  ///< absent: edges and vertices
};
constexpr std::array census_metrics{
    CensusMetric{"cracks", answer::Outcome::crack, std::nullopt},
    CensusMetric{"edge_cracks", answer::Outcome::crack, edges::EdgeTarget::edge},
    CensusMetric{"vertex_cracks", answer::Outcome::crack, edges::EdgeTarget::vertex},
    CensusMetric{"double_hits", answer::Outcome::double_hit, std::nullopt},
    CensusMetric{"edge_double_hits", answer::Outcome::double_hit, edges::EdgeTarget::edge},
    CensusMetric{"vertex_double_hits", answer::Outcome::double_hit, edges::EdgeTarget::vertex}};

const CensusMetric& census_metric(const Claim& claim) {
    const auto found = std::ranges::find(census_metrics, claim.metric, &CensusMetric::name);
    if (found != census_metrics.end()) return *found;
    std::vector<std::string> names;
    for (const CensusMetric& metric : census_metrics) names.emplace_back(metric.name);
    scene::toml::fail(claim.quantity, "\"" + claim.metric + "\" is not counted by a search at edges; " +
                                          text::did_you_mean(claim.metric, names));
}

/// Number of rays of the census that the metric counts.
std::uint64_t count_rays(const edges::EdgeResults& finding, const CensusMetric& metric) {
    const auto outcome = static_cast<std::size_t>(std::ranges::find(edges::searched_outcomes, metric.outcome) -
                                                  edges::searched_outcomes.begin());
    std::uint64_t sum = 0;
    for (std::size_t k = 0; k < finding.census.size(); ++k)
        if (!metric.target || static_cast<std::size_t>(*metric.target) == k)
            sum += finding.census.at(k).outcome_counts.at(outcome);
    return sum;
}

/// Runs the census of an edge search, without the search for the nearest crack.
void measure_census(const SubjectClaims<SearchSubject>& claims, const std::filesystem::path& path,
                    const ClaimRequest& run) {
    edges::EdgeRequest request{.search = scene::sweep::EdgeSearchFile(path, run.data_dir, {}, run.stop),
                               .tested_forms = {},
                               .limit = {.stop = run.stop},
                               .census_only = true};
    std::vector<std::size_t> rows;
    for (const auto& [claim, subject, result] : claims) {
        census_metric(claim);
        const evaluate::TestedForm tested_form = tested_form_of(claim);
        if (!request.search.accepts(tested_form.form->shapes()))
            scene::toml::fail(claim.where, claim.form + " does not take triangles; name a form that does");
        rows.push_back(find_or_add_tested_form(request.tested_forms, tested_form));
    }
    const auto findings = edges::search_edges(request);
    for (std::size_t k = 0; k < claims.size(); ++k) {
        const auto& [claim, subject, result] = claims[k];
        result = judge_measured_value(claim, static_cast<double>(count_rays(findings[rows[k]], census_metric(claim))),
                                      nullptr);
    }
}

/// Returns the metric that a search maximises. Throws InputError if the metric is unknown.
const metric::Metric& check_search_file(const Claim& claim, const scene::sweep::SearchFile& file) {
    const metric::Metric* const searched_metric = metric::find_metric(file.metric);
    if (searched_metric == nullptr)
        scene::toml::fail(claim.where, "search \"" + claim.subject_name() + "\" maximises the unknown metric \"" +
                                           file.metric + "\"; `lostbits list metrics` shows the metrics");
    return *searched_metric;
}

/// Adds the forms of the claims to the request, and returns the row of each claim.
std::vector<std::size_t> add_searched_forms(const SubjectClaims<SearchSubject>& claims, sweep::WorstRequest& request) {
    const scene::sweep::SearchFile& file = request.search;
    std::vector<std::size_t> rows;
    for (const auto& [claim, subject, result] : claims) {
        if (claim.metric != "worst")
            scene::toml::fail(claim.quantity, "a search measures only `metric = \"worst\"`: the largest " +
                                                  file.metric + " that it finds");
        const evaluate::TestedForm tested_form = tested_form_of(claim);
        if (tested_form.form->shape != file.shape)
            scene::toml::fail(claim.where, "search \"" + claim.subject_name() + "\" has other primitives than " +
                                               claim.form + " takes; name a form of its shape");
        rows.push_back(find_or_add_tested_form(request.tested_forms, tested_form));
    }
    return rows;
}

/// Judges a claim by the worst ray that was found. A wrong decision counts more than any number.
ClaimResult judge_worst(const Claim& claim, const sweep::WorstResult& worst) {
    const bool is_right = worst.outcome == answer::Outcome::agree_hit;
    ClaimResult result =
        judge_measured_value(claim, is_right ? worst.value : std::numeric_limits<double>::infinity(), nullptr);
    result.evaluation_count = worst.evaluation_count;
    scene::rays::RayGroup group = scene::rays::make_group(worst.ray);
    group.primitives = {worst.primitive};
    result.witness = {.x = 0,
                      .y = 0,
                      .ray = worst.ray,
                      .primitive = worst.primitive,
                      .t = worst.t,
                      .outcome = worst.outcome,
                      .given = std::make_shared<const scene::rays::RayGroup>(std::move(group))};
    return result;
}

}  // namespace

void measure(const SubjectClaims<SearchSubject>& claims, const ClaimRequest& run) {
    const Claim& first_claim = claims.front().claim;
    const std::string& subject_name = first_claim.subject_name();
    const auto path = find_for_claim(first_claim, [&] { return scene::sweep::find_sweep(subject_name, run.data_dir); });
    const auto kind = scene::sweep::read_sweep_kind(path);
    if (kind == scene::sweep::SweepKind::edge_search) return measure_census(claims, path, run);
    if (kind != scene::sweep::SweepKind::search)
        scene::toml::fail(first_claim.where,
                          "\"" + subject_name +
                              "\" has no [search] or [edge_search] table; write `sweep = ` for axes and "
                              "cases, or name a search (data/sweeps/worst)");

    const scene::sweep::SearchFile file(path);
    const metric::Metric& searched_metric = check_search_file(first_claim, file);
    sweep::WorstRequest request{
        .search = file,
        .tested_forms = {},
        .metrics = {metric::find_metric("lost_bits"), metric::find_metric("ulp_error"), &searched_metric},
        .limit = {.stop = run.stop}};
    const std::vector<std::size_t> rows = add_searched_forms(claims, request);

    const auto worst_cases = sweep::find_worst(request);
    for (std::size_t k = 0; k < claims.size(); ++k) {
        const auto& [claim, subject, result] = claims[k];
        if (const auto& worst = worst_cases[rows[k]]) result = judge_worst(claim, *worst);
        else result.reason = "no ray of the search's ranges hits";
    }
}

}  // namespace lostbits::measure::check
