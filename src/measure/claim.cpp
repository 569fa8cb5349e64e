#include "measure/claim.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "number/error.hpp"
#include "scene/did_you_mean.hpp"

namespace lostbits {
namespace {

using scene::Claim;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

double share(std::uint64_t part, std::uint64_t whole) { return whole == 0 ? missing : static_cast<double>(part) / static_cast<double>(whole); }

std::map<std::string, double> columns_of(const MapSummary& s, const std::vector<const Metric*>& metrics) {
    std::map<std::string, double> columns;
    for (std::size_t o = 0; o < outcome_names.size(); ++o) columns[std::string(outcome_names[o])] = static_cast<double>(s.outcomes[o]);
    columns["rays"] = static_cast<double>(s.rays);
    columns["wrong_object"] = static_cast<double>(s.wrong_object);
    columns["false_hit_fraction"] = share(s.count(Outcome::false_hit), s.rays - s.true_hits - s.count(Outcome::unresolved));
    columns["false_miss_fraction"] = share(s.count(Outcome::false_miss), s.true_hits);
    columns["not_a_number_fraction"] = share(s.count(Outcome::not_a_number), s.rays);
    for (std::size_t m = 0; m < metrics.size(); ++m) {
        const std::string name(metrics[m]->name);
        columns[name + "_mean"] = s.metrics[m].mean();
        columns[name + "_p50"] = s.metrics[m].quantile(0.5);
        columns[name + "_p99"] = s.metrics[m].quantile(0.99);
        columns[name + "_max"] = s.metrics[m].quantile(1);
    }
    return columns;
}

MapRow row_of(const Claim& claim) {
    std::vector<std::string> names;
    for (const Intersector& i : intersectors()) {
        names.emplace_back(i.info->name);
        if (i.info->name != claim.form) continue;
        const auto format = find_format(claim.format);
        if (!format) scene::fail(claim.where, "unknown format \"" + claim.format + "\"; write f32, f64, fp16, bf16, tf32 or pN");
        if (!i.exists_in(*format)) scene::fail(claim.where, claim.form + " does not exist in " + claim.format);
        return {&i, *format};
    }
    scene::fail(claim.where, "unknown form \"" + claim.form + "\"; " + scene::did_you_mean(claim.form, names));
}

/// The claims about one scene or sweep: their places in the list.
using Places = std::vector<std::size_t>;

/// The default metrics, and those whose columns a claim names: measuring all would evaluate every form exactly.
std::vector<const Metric*> metrics_for(const std::vector<Claim>& claims, const Places& places) {
    std::vector<const Metric*> wanted;
    for (const Metric& m : metrics()) {
        const bool named = std::ranges::any_of(places, [&](std::size_t i) { return claims[i].metric.starts_with(std::string(m.name) + "_"); });
        if (m.by_default || named) wanted.push_back(&m);
    }
    return wanted;
}

ClaimResult judge(const Claim& claim, double measured, const MapSummary* summary) {
    ClaimResult result;
    result.measured = measured;
    if (summary) result.witness = summary->worst;
    if (summary && summary->count(Outcome::unresolved) > 0) {
        result.trouble = std::to_string(summary->count(Outcome::unresolved)) + " rays have no proved truth";
    } else if (std::isnan(measured)) {
        result.trouble = "there is no sample to measure it on";
    } else {
        result.state = measured >= claim.low && measured <= claim.high ? ClaimResult::State::agrees : ClaimResult::State::disagrees;
    }
    return result;
}

/// What `find` finds for a claim; an unknown name is the claim's fault, so its place starts the message.
template <class Find>
auto find_for(const Claim& claim, const Find& find) {
    try {
        return find();
    } catch (const InputError& error) {
        scene::fail(claim.where, error.what());
    }
}

void measure_scene(const std::vector<Claim>& claims, const Places& places, const std::filesystem::path& data_dir, std::vector<ClaimResult>& results) {
    const Claim& first = claims[places.front()];
    const auto name = find_for(first, [&] { return scene::find_scene(first.scene, data_dir); });
    const auto scenes = scene::load_scene(name.path, {.variant = name.variant});
    if (scenes.size() != 1) scene::fail(first.where, "scene \"" + first.scene + "\" has variants; name one, such as \"" + scenes.front().id + "\"");
    MapRequest request{.scene = &scenes.front(), .rows = {}, .metrics = metrics_for(claims, places)};
    for (const std::size_t i : places) request.rows.push_back(row_of(claims[i]));
    const auto summaries = run_map(request, {});
    for (std::size_t k = 0; k < places.size(); ++k) {
        const Claim& claim = claims[places[k]];
        results[places[k]] = judge(claim, summary_value(summaries[k], request.metrics, claim.metric, claim.where.text()), &summaries[k]);
    }
}

void measure_sweep(const std::vector<Claim>& claims, const Places& places, const std::filesystem::path& data_dir, std::vector<ClaimResult>& results) {
    const Claim& first = claims[places.front()];
    const scene::SweepFile sweep(find_for(first, [&] { return scene::find_sweep(first.sweep, data_dir); }), data_dir);
    if (sweep.axes.size() != 1) scene::fail(first.where, "sweep \"" + first.sweep + "\" has two axes; claims are about sweeps with one");
    SweepRequest request{.sweep = &sweep, .rows = {}, .metrics = metrics_for(claims, places)};
    bool onsets_wanted = false;
    for (const std::size_t i : places) {
        request.rows.push_back(row_of(claims[i]));
        onsets_wanted |= !claims[i].onset.empty();
    }
    std::vector<Onset> onsets;
    if (onsets_wanted) onsets = find_onsets(request, run_sweep(request));
    for (std::size_t k = 0; k < places.size(); ++k) {
        const Claim& claim = claims[places[k]];
        if (claim.onset.empty()) {
            const auto summary = run_place(request, k, {*claim.at});
            results[places[k]] = judge(claim, summary_value(summary, request.metrics, claim.metric, claim.where.text()), &summary);
            continue;
        }
        const auto found = std::ranges::find_if(onsets, [&](const Onset& o) {
            return o.row == k && o.event == claim.onset && o.statistic == claim.statistic && o.threshold == claim.threshold;
        });
        if (found == onsets.end()) {
            scene::fail(claim.where, "no onset of \"" + claim.onset + "\" by \"" + claim.statistic +
                                         "\" at that threshold; events are lost_bits (p50, p99, max; 1, 4, 8, p/2, p), false_hit, false_miss, not_a_number (count; 1)");
        }
        results[places[k]] = judge(claim, found->found ? found->first_bad : missing, nullptr);
        if (!found->found) results[places[k]].trouble = "it does not happen within the sweep";
    }
}

}  // namespace

double summary_value(const MapSummary& summary, const std::vector<const Metric*>& metrics, const std::string& column, const std::string& where) {
    const auto columns = columns_of(summary, metrics);
    const auto found = columns.find(column);
    if (found != columns.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [name, value] : columns) names.push_back(name);
    throw InputError(where + ": unknown metric \"" + column + "\"; " + scene::did_you_mean(column, names));
}

std::vector<ClaimResult> measure_claims(const std::vector<Claim>& claims, const std::filesystem::path& data_dir, const std::function<void()>& done) {
    std::vector<ClaimResult> results(claims.size());
    std::map<std::pair<bool, std::string>, Places> subjects;
    for (std::size_t i = 0; i < claims.size(); ++i) subjects[{claims[i].scene.empty(), claims[i].scene.empty() ? claims[i].sweep : claims[i].scene}].push_back(i);
    for (const auto& [subject, places] : subjects) {
        if (subject.first) measure_sweep(claims, places, data_dir, results);
        else measure_scene(claims, places, data_dir, results);
        done();
    }
    return results;
}

}  // namespace lostbits
