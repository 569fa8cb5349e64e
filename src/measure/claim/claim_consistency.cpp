// Claims about one question put in two ways: how often a form answers it differently.
#include "measure/claim/claim_subjects.hpp"
#include "measure/consistency/consistency.hpp"
#include "measure/offset/offsets.hpp"

namespace lostbits::measure::claim {

using consistency::Accord;
using consistency::Check;
using consistency::CheckSummary;
using scene::claim::Claim;
using scene::claim::ConsistencySubject;

namespace {

std::vector<std::string> check_names() {
    std::vector<std::string> names;
    for (const Check& c : consistency::checks()) names.emplace_back(c.name);
    return names;
}

/// The check of a claim, which can be asked of its form.
const Check& check_of(const Claim& claim, const std::string& name, const scene::file::Scene& scene,
                      const evaluate::TestedForm& row) {
    const Check& check = consistency::checks()[place_of_word(claim, "check", name, check_names())];
    if (consistency::can_be_compared(*row.form) && check.applies(scene, *row.form)) return check;
    scene::toml::fail(claim.where, "check \"" + name + "\" cannot be asked of " + claim.form + " on " + scene.id +
                                       ": light needs a [light], segment, short and light need a form that takes "
                                       "directions of any length, and forms that march are not compared; name another "
                                       "check or form");
}

/// The ray of the first question, with its solids: it pastes into `lostbits explain`.
evaluate::WorstRay witness_of_disagreement(const consistency::ShownDisagreement& shown) {
    evaluate::WorstRay w;
    w.x = shown.x;
    w.y = shown.y;
    w.object = 0;
    w.ray = shown.rays.first.rays[0];
    w.solid = shown.rays.first.solids.front();
    w.size = 0;
    w.given = std::make_shared<const scene::rays::RayGroup>(shown.rays.first);
    return w;
}

}  // namespace

void measure(const ClaimsOn<ConsistencySubject>& claims, const ClaimRequest& run) {
    const scene::file::Scene scene = one_scene(claims.front().claim, run);
    find_or_blame_claim(claims.front().claim, [&] { offset::require_few_solids(scene); });
    consistency::ConsistencyRequest request{.scene = &scene, .rows = {}, .checks = {}, .limit = {.stop = run.stop}};
    std::vector<std::pair<std::size_t, std::size_t>> at;  // row and check of each claim
    for (const auto& [claim, on, result] : claims) {
        const evaluate::TestedForm row = row_for(claim, scene);
        const Check* const check = &check_of(claim, on.check, scene, row);
        auto found = std::ranges::find(request.checks, check);
        if (found == request.checks.end()) found = request.checks.insert(found, check);
        at.emplace_back(place_or_added(request.rows, row), static_cast<std::size_t>(found - request.checks.begin()));
    }
    const auto rows = consistency::run_consistency(request);
    for (std::size_t k = 0; k < claims.size(); ++k) {
        const auto& [claim, on, result] = claims[k];
        const CheckSummary& summary = rows[at[k].first][at[k].second];
        result = judge(claim, consistency::consistency_value(summary, claim.metric, claim.where.text()), nullptr);
        if (summary.shown && !summary.shown->rays.first.solids.empty())
            result.witness = witness_of_disagreement(*summary.shown);
        require_proof(result, summary.of(Accord::unresolved), "pixels have no proved truth");
    }
}

}  // namespace lostbits::measure::claim
