// Claims about sweeps: along axes, or over named cases.
#include <algorithm>

#include "measure/claim/claim_columns.hpp"
#include "measure/claim/claim_subjects.hpp"
#include "measure/sweep/cases.hpp"

namespace lostbits::measure::claim {

using blame::SettingOf;
using map::MapRow;
using scene::claim::Claim;
using scene::sweep::SweepKind;
using truth::missing;

namespace {

void measure_cases(const std::vector<Claim>& claims, const Places& places, const std::filesystem::path& path,
                   truth::TruthLimit limit, std::vector<ClaimResult>& results) {
    const scene::sweep::CaseFile file(path);
    sweep::CaseRequest request{.file = &file, .rows = {}, .metrics = {}, .limit = limit};
    for (const std::size_t i : places) request.rows.push_back(row_for(claims[i], file));
    const SettingOf setting(file.rays(0, binary64).front());
    const ClaimColumns columns(claims_at(claims, places), request.rows, setting.get());
    request.metrics = columns.metrics();
    for (std::size_t k = 0; k < places.size(); ++k) {
        const Claim& claim = claims[places[k]];
        if (claim.case_name.empty())
            scene::toml::fail(claim.where, "sweep \"" + claim.sweep +
                                               "\" has cases, not axes; write `case = \"...\"` in claim.given");
        const auto summary = sweep::run_cases_together(request, k, file.matching(claim.case_name, claim.where));
        results[places[k]] = judge(claim, columns.value(claim, summary), &summary);
    }
}

std::optional<metric::Bounds> bounds_of(const Claim& claim, const ClaimColumns& columns,
                                        const map::MapSummary& summary) {
    if (!claim.metric.ends_with("_p99")) return std::nullopt;
    const auto end = [&](const char* name) {
        Claim other = claim;
        other.metric += name;
        return columns.value(other, summary);
    };
    return metric::Bounds{end("_low"), end("_high")};
}

/// InputError where a sweep has no such place.
void check_place(const Claim& claim, const scene::sweep::SweepFile& sweep) {
    if (claim.at.size() != sweep.axes.size()) {
        scene::toml::fail(claim.where, "sweep \"" + claim.sweep + "\" has " + std::to_string(sweep.axes.size()) +
                                           " axes; write as many values in `at`");
    }
    for (std::size_t a = 0; a < claim.at.size(); ++a) {
        const auto [low, high] = std::minmax(sweep.axes[a].from, sweep.axes[a].to);
        if (claim.at[a] < low || claim.at[a] > high)
            scene::toml::fail(claim.where, "`at` lies outside the axis " + sweep.axes[a].name + " of sweep \"" +
                                               claim.sweep + "\"; write a value between its ends");
    }
}

}  // namespace

void measure_sweep(const std::vector<Claim>& claims, const Places& places, const ClaimRequest& run, int draw,
                   std::vector<ClaimResult>& results) {
    const Claim& first = claims[places.front()];
    const auto path = find_or_blame_claim(first, [&] { return scene::sweep::find_sweep(first.sweep, run.data_dir); });
    switch (scene::sweep::sweep_kind(path)) {
        case SweepKind::cases: return measure_cases(claims, places, path, {.stop = run.stop}, results);
        case SweepKind::search:
        case SweepKind::edge_search:
            scene::toml::fail(first.where, "sweep \"" + first.sweep + "\" is a search; claims are about axes or cases");
        case SweepKind::every_float: return measure_exhaustive(claims, places, path, run, results);
        case SweepKind::axes: break;
    }
    for (const std::size_t i : places) {
        if (claims[i].exhaustive)
            scene::toml::fail(claims[i].where,
                              "`exhaustive = true` belongs to claims about sweeps over every float, and "
                              "sweep \"" +
                                  claims[i].sweep + "\" is none; leave it out");
    }
    const auto sweep = scene::sweep::SweepFile(path, run.data_dir).drawn_again(draw);
    sweep::SweepRequest request{.sweep = &sweep, .rows = {}, .metrics = {}, .limit = {.stop = run.stop}};
    std::vector<std::size_t> rows;
    bool onsets_wanted = false;
    for (const std::size_t i : places) {
        MapRow row = row_for(claims[i], sweep);
        if (!claims[i].convention) row.judged = sweep.convention;
        rows.push_back(place_or_added(request.rows, row));
        onsets_wanted |= !claims[i].onset.empty();
    }
    const SettingOf setting(sweep.first_rays());
    const ClaimColumns columns(claims_at(claims, places), request.rows, setting.get());
    request.metrics = columns.metrics();
    std::vector<sweep::Onset> onsets;
    if (onsets_wanted) onsets = sweep::find_onsets(request, sweep::run_sweep(request));
    for (std::size_t k = 0; k < places.size(); ++k) {
        const Claim& claim = claims[places[k]];
        if (claim.onset.empty()) {
            check_place(claim, sweep);
            const auto summary = sweep::run_place(request, rows[k], claim.at);
            results[places[k]] = judge(claim, columns.value(claim, summary), &summary);
            if (sweep.is_drawn()) results[places[k]].samples = summary.views;
            if (sweep.is_drawn() && summary.rays == summary.views)
                results[places[k]].bounds = bounds_of(claim, columns, summary);
            continue;
        }
        const auto found = std::ranges::find_if(onsets, [&](const sweep::Onset& o) {
            return o.row == rows[k] && o.event == claim.onset && o.statistic == claim.statistic &&
                   o.threshold == claim.threshold;
        });
        if (found == onsets.end()) {
            scene::toml::fail(
                claim.where,
                "no onset of \"" + claim.onset + "\" by \"" + claim.statistic +
                    "\" at that threshold; events are lost_bits (p50, p99, max; 1, 4, 8, p/2, p), false_hit, "
                    "false_miss, not_a_number and, of marches, max_dist, max_steps, stagnated (count; 1)");
        }
        results[places[k]] = judge(claim, found->found ? found->first_bad : missing, nullptr);
        if (sweep.is_drawn()) results[places[k]].samples = found->views;
        if (!found->found) results[places[k]].trouble = "it does not happen within the sweep";
    }
}

}  // namespace lostbits::measure::claim
