// Claims about the worst ray that a search finds: its metric, as `worst`.
#include <limits>
#include <memory>

#include "measure/claim/claim_subjects.hpp"
#include "measure/sweep/worst.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::measure::claim {

using scene::claim::Claim;

void measure_search(const std::vector<Claim>& claims, const Places& places, const ClaimRequest& run,
                    std::vector<ClaimResult>& results) {
    const Claim& first = claims[places.front()];
    const auto path = find_or_blame_claim(first, [&] { return scene::sweep::find_sweep(first.search, run.data_dir); });
    if (scene::sweep::sweep_kind(path) != scene::sweep::SweepKind::search)
        scene::toml::fail(first.where, "\"" + first.search +
                                           "\" has no [search] table; write `sweep = ` for axes and cases, or name a "
                                           "search (data/sweeps/worst)");
    const scene::sweep::SearchFile file(path);
    const metric::Metric* const searched = metric::find_metric(file.metric);
    if (searched == nullptr)
        scene::toml::fail(first.where, "search \"" + first.search + "\" asks for the unknown metric \"" + file.metric +
                                           "\"; `lostbits list metrics` shows them");
    sweep::WorstRequest request{
        .search = &file,
        .rows = {},
        .metrics = {metric::find_metric("lost_bits"), metric::find_metric("ulp_error"), searched},
        .limit = {.stop = run.stop}};
    std::vector<std::size_t> rows;
    for (const std::size_t i : places) {
        if (claims[i].metric != "worst")
            scene::toml::fail(claims[i].quantity, "of a search only `metric = \"worst\"` is measured: the largest " +
                                                      file.metric + " that it finds");
        const map::MapRow row = claim_row(claims[i]);
        if (row.form->shape != file.shape)
            scene::toml::fail(claims[i].where, "search \"" + first.search + "\" is not about the solids of " +
                                                   claims[i].form + "; name a form of its shape");
        rows.push_back(place_or_added(request.rows, row));
    }
    const auto found = sweep::find_worst(request);
    for (std::size_t k = 0; k < places.size(); ++k) {
        ClaimResult& result = results[places[k]];
        const auto& worst = found[rows[k]];
        if (!worst) {
            result.trouble = "no ray of the search's ranges is hit";
            continue;
        }
        const bool decided = worst->outcome == answer::Outcome::agree_hit;
        result = judge(claims[places[k]], decided ? worst->value : std::numeric_limits<double>::infinity(), nullptr);
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
