// Measures claims about the origin of the next ray: the safe strategies on a scene, and by what factor they are too
// large. Also measures claims about consistency: how often a form answers the same question differently.
#include <algorithm>

#include "measure/claim/claim_subjects.hpp"
#include "measure/consistency/consistency.hpp"
#include "measure/offset/offsets.hpp"
#include "measure/study/study.hpp"

namespace lostbits::measure::claim {

using consistency::Check;
using consistency::CheckResult;
using consistency::CheckSummary;
using offset::Fault;
using offset::OffsetSummary;
using scene::claim::Claim;
using scene::claim::ConsistencySubject;
using scene::claim::OffsetsSubject;

namespace {

/// Work of one row, limited to what its claims name: every strategy has rays of its own, and the search for a quiet
/// offset takes as long as all the rest.
struct RowClaims {
    offset::OffsetRow row;
    SubjectClaims<OffsetsSubject> claims = {};
    std::vector<const offset::Strategy*> strategies = {};
    bool quiet = false;
};

/// The ray with the fault that a metric counts; for any other metric, a self-hit if there is one.
std::optional<offset::BadRay> shown_by(const Claim& claim, const offset::StrategySummary& s) {
    for (std::size_t f = 0; f < offset::fault_names.size(); ++f) {
        if (claim.metric == std::string(offset::fault_names[f]) + "_fraction") return s.first[f];
    }
    for (const Fault f : {Fault::self_hit, Fault::lost_occluder, Fault::lost_exit, Fault::self_hit_by_form}) {
        if (s.first_with(f)) return s.first_with(f);
    }
    return std::nullopt;
}

/// The next ray with the primitive that it leaves, in a form that `lostbits explain` accepts.
evaluate::WorstRay witness_of(const offset::BadRay& bad) {
    const auto given = std::make_shared<scene::rays::RayGroup>(scene::rays::group_of(bad.ray.ray));
    given->primitives = {bad.primitive};
    return {.x = bad.x,
            .y = bad.y,
            .object = bad.object,
            .size = 0,
            .ray = bad.ray.ray,
            .primitive = bad.primitive,
            .given = given};
}

const offset::Strategy* strategy_of(const Claim& claim, const OffsetsSubject& on) {
    const auto all = offset::strategies();
    return &all[place_of_word(claim, "strategy", on.strategy, all, &offset::Strategy::name)];
}

offset::Side side_of(const Claim& claim, const OffsetsSubject& on) {
    return static_cast<offset::Side>(place_of_word(claim, "side", on.side, offset::side_names));
}

/// Finds or adds the row of a claim, and adds the claim to it.
RowClaims& row_of(const SubjectClaim<OffsetsSubject>& asked, const scene::file::Scene& scene,
                  std::vector<RowClaims>& rows) {
    const Claim& claim = asked.claim;
    const evaluate::TestedForm row = row_for(claim, scene);
    if (!offset::can_measure_offsets(*row.form))
        scene::toml::fail(claim.where, claim.form +
                                           " does not answer the t at which a ray meets a primitive, so no next ray "
                                           "can start there; name another form");
    const auto point =
        static_cast<offset::HitPoint>(place_of_word(claim, "points", asked.on.points, offset::point_names));
    const offset::OffsetRow of_claim{row, point};
    auto found = std::ranges::find(rows, of_claim, &RowClaims::row);
    if (found == rows.end()) found = rows.insert(found, {of_claim});
    found->claims.push_back(asked);
    return *found;
}

void judge_row(const RowClaims& row, const OffsetSummary& summary) {
    for (const auto& [claim, on, result] : row.claims) {
        const auto strategy = static_cast<std::size_t>(std::ranges::find(row.strategies, strategy_of(claim, on)) -
                                                       row.strategies.begin());
        const offset::Side side = side_of(claim, on);
        const auto& column = column_named(offset::offset_columns(), claim.metric, claim.where.text());
        result = judge(claim, column.value(summary, side, strategy), nullptr);
        if (const auto bad = shown_by(claim, summary.side_summary(side).strategies[strategy]))
            result.witness = witness_of(*bad);
        require_proof(result, summary.unresolved, "pixel has no proved truth", "pixels have no proved truth");
    }
}

}  // namespace

void measure(const SubjectClaims<OffsetsSubject>& claims, const ClaimRequest& run) {
    const scene::file::Scene scene = one_scene(claims.front().claim, run);
    find_for_claim(claims.front().claim, [&] { offset::require_few_primitives(scene); });
    std::vector<RowClaims> rows;
    for (const auto& asked : claims) {
        RowClaims& row = row_of(asked, scene, rows);
        const offset::Strategy* const strategy = strategy_of(asked.claim, asked.on);
        if (std::ranges::find(row.strategies, strategy) == row.strategies.end()) row.strategies.push_back(strategy);
        row.quiet |= asked.claim.metric.find("quiet") != std::string::npos;
        side_of(asked.claim, asked.on);  // throws before the measurement starts
    }
    for (const RowClaims& row : rows) {
        const auto summaries = study::run_study(offset::OffsetStudy{.scene = scene,
                                                                    .rows = {row.row},
                                                                    .strategies = row.strategies,
                                                                    .limit = {.stop = run.stop},
                                                                    .quiet = row.quiet});
        judge_row(row, summaries.front());
    }
}

namespace {

/// Finds the check of a claim; it must apply to the claim's form.
const Check& check_of(const Claim& claim, const std::string& name, const scene::file::Scene& scene,
                      const evaluate::TestedForm& row) {
    const auto all = consistency::checks();
    const Check& check = all[place_of_word(claim, "check", name, all, &Check::name)];
    if (consistency::can_be_compared(*row.form) && check.applies(scene, *row.form)) return check;
    scene::toml::fail(claim.where, "check \"" + name + "\" does not apply to " + claim.form + " on " + scene.id +
                                       ": light needs a [light]; segment, short and light need a form that takes "
                                       "directions of any length; forms that march are not compared. Name another "
                                       "check or form");
}

/// The ray of the first question with its primitives, in a form that `lostbits explain` accepts.
evaluate::WorstRay witness_of_disagreement(const consistency::ShownDisagreement& shown) {
    const scene::rays::RayGroup& first = shown.rays.first;
    return {.x = shown.x,
            .y = shown.y,
            .object = 0,
            .size = 0,
            .ray = first.rays[0],
            .primitive = first.primitives.front(),
            .given = std::make_shared<const scene::rays::RayGroup>(first)};
}

}  // namespace

void measure(const SubjectClaims<ConsistencySubject>& claims, const ClaimRequest& run) {
    const scene::file::Scene scene = one_scene(claims.front().claim, run);
    find_for_claim(claims.front().claim, [&] { offset::require_few_primitives(scene); });
    consistency::ConsistencyStudy study{.scene = scene, .rows = {}, .checks = {}, .limit = {.stop = run.stop}};
    std::vector<std::pair<std::size_t, std::size_t>> at;  // row and check of each claim
    for (const auto& [claim, on, result] : claims) {
        const evaluate::TestedForm row = row_for(claim, scene);
        const Check* const check = &check_of(claim, on.check, scene, row);
        auto found = std::ranges::find(study.checks, check);
        if (found == study.checks.end()) found = study.checks.insert(found, check);
        at.emplace_back(place_or_added(study.rows, row), static_cast<std::size_t>(found - study.checks.begin()));
    }
    const auto rows = study::run_study(study);
    for (std::size_t k = 0; k < claims.size(); ++k) {
        const auto& [claim, on, result] = claims[k];
        const CheckSummary& summary = rows[at[k].first][at[k].second];
        const auto& column = column_named(consistency::consistency_columns(), claim.metric, claim.where.text());
        result = judge(claim, column.value(summary), nullptr);
        if (summary.shown && !summary.shown->rays.first.primitives.empty())
            result.witness = witness_of_disagreement(*summary.shown);
        require_proof(result, summary.of(CheckResult::unresolved), "pixel has no proved truth",
                      "pixels have no proved truth");
    }
}

}  // namespace lostbits::measure::claim
