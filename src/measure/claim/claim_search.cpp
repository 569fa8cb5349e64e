// Claims about the worst ray that a search finds: its metric, as `worst`.
#include <limits>
#include <memory>

#include "measure/claim/claim_subjects.hpp"
#include "measure/sweep/worst.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::measure::claim {

using scene::claim::Claim;
using scene::claim::SearchSubject;

void measure(const ClaimsOn<SearchSubject>& claims, const ClaimRequest& run) {
    const Claim& first = claims.front().claim;
    const std::string& called = first.subject_name();
    const auto path = find_or_blame_claim(first, [&] { return scene::sweep::find_sweep(called, run.data_dir); });
    if (scene::sweep::sweep_kind(path) != scene::sweep::SweepKind::search)
        scene::toml::fail(first.where, "\"" + called +
                                           "\" has no [search] table; write `sweep = ` for axes and cases, or name a "
                                           "search (data/sweeps/worst)");
    const scene::sweep::SearchFile file(path);
    const metric::Metric* const searched = metric::find_metric(file.metric);
    if (searched == nullptr)
        scene::toml::fail(first.where, "search \"" + called + "\" asks for the unknown metric \"" + file.metric +
                                           "\"; `lostbits list metrics` shows them");
    sweep::WorstRequest request{
        .search = file,
        .rows = {},
        .metrics = {metric::find_metric("lost_bits"), metric::find_metric("ulp_error"), searched},
        .limit = {.stop = run.stop}};
    std::vector<std::size_t> rows;
    for (const auto& [claim, on, result] : claims) {
        if (claim.metric != "worst")
            scene::toml::fail(claim.quantity, "of a search only `metric = \"worst\"` is measured: the largest " +
                                                  file.metric + " that it finds");
        const evaluate::TestedForm row = claim_row(claim);
        if (row.form->shape != file.shape)
            scene::toml::fail(claim.where, "search \"" + called + "\" is not about the solids of " + claim.form +
                                               "; name a form of its shape");
        rows.push_back(place_or_added(request.rows, row));
    }
    const auto found = sweep::find_worst(request);
    for (std::size_t k = 0; k < claims.size(); ++k) {
        const auto& [claim, on, result] = claims[k];
        const auto& worst = found[rows[k]];
        if (!worst) {
            result.trouble = "no ray of the search's ranges is hit";
            continue;
        }
        const bool decided = worst->outcome == answer::Outcome::agree_hit;
        result = judge(claim, decided ? worst->value : std::numeric_limits<double>::infinity(), nullptr);
        result.evaluations = worst->evaluations;
        scene::rays::RayGroup one = scene::rays::group_of(worst->ray);
        one.solids = {worst->solid};
        result.witness = {.x = 0,
                          .y = 0,
                          .ray = worst->ray,
                          .solid = worst->solid,
                          .t = worst->t,
                          .outcome = worst->outcome,
                          .given = std::make_shared<const scene::rays::RayGroup>(std::move(one))};
    }
}

}  // namespace lostbits::measure::claim
