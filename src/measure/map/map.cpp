#include "measure/map/map.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "intersect/process/parallel.hpp"
#include "measure/map/measure_row.hpp"

namespace lostbits::measure::map {

using answer::Outcome;
using metric::Metric;
using truth::Band;
using truth::BandNeeds;
using truth::FormatInputs;

columns::BandColumns columns_of(const Band& band, const std::vector<MapRow>& rows) {
    columns::BandColumns columns(band);
    for (const MapRow& row : rows) columns.find(row.convention(), row.form->info->direction);
    return columns;
}

std::map<std::string, BandNeeds> needs_by_format(const std::vector<MapRow>& rows,
                                                 const std::vector<const Metric*>& metrics) {
    std::map<std::string, BandNeeds> formats;
    for (const MapRow& row : rows) {
        BandNeeds& needs = formats[row.format.name];
        for (const intersect::table::Intersector* form : {row.form, row.against})
            needs.unit_rays |= form != nullptr && form->info->direction == intersect::Direction::unit;
        needs.own_truth |= (needs_of(metrics) & metric::needs_own_truth) != 0;
    }
    return formats;
}

std::vector<const intersect::table::Intersector*> forms_of(const std::vector<MapRow>& rows) {
    std::vector<const intersect::table::Intersector*> forms;
    for (const MapRow& row : rows) {
        if (std::ranges::find(forms, row.form) == forms.end()) forms.push_back(row.form);
    }
    return forms;
}

MapSummary::MapSummary(const std::vector<const Metric*>& measured) : metrics(measured.size()) {
    for (const Metric* m : measured) categories.emplace_back(m->categories.size());
}

void MapSummary::add(std::size_t m, const Metric& metric, std::span<const double> values) {
    if (metric.categories.empty()) return metrics[m].add(values);
    for (const double value : values) {
        if (!std::isnan(value)) ++categories[m][static_cast<std::size_t>(value)];
    }
}

void MapSummary::append(MapSummary&& after) {
    rays += after.rays;
    true_hits += after.true_hits;
    for (std::size_t o = 0; o < outcomes.size(); ++o) outcomes[o] += after.outcomes[o];
    for (std::size_t m = 0; m < metrics.size(); ++m) metrics[m].add(after.metrics[m]);
    for (std::size_t m = 0; m < categories.size(); ++m) {
        for (std::size_t c = 0; c < categories[m].size(); ++c) categories[m][c] += after.categories[m][c];
    }
    if (after.worst.size > worst.size) worst = std::move(after.worst);
    for (std::size_t kind = 0; kind < faults.size(); ++kind) {
        if (!faults[kind]) faults[kind] = std::move(after.faults[kind]);
    }
}

std::uint64_t MapSummary::wrong_count() const {
    std::uint64_t all = 0;
    for (const Outcome o : wrong_decisions) all += count(o);
    return all;
}

std::optional<Outcome> MapSummary::wrong() const {
    const auto most = std::ranges::max_element(wrong_decisions, {}, [this](Outcome o) { return count(o); });
    return count(*most) > 0 ? std::optional(*most) : std::nullopt;
}

const WorstRay* MapSummary::first_of(Outcome wrong) const {
    return faults[static_cast<std::size_t>(std::ranges::find(wrong_decisions, wrong) - wrong_decisions.begin())].get();
}

const WorstRay* MapSummary::fault() const {
    const auto most = wrong();
    return most ? first_of(*most) : nullptr;
}

const WorstRay* MapSummary::worst_ray() const {
    if (const WorstRay* const wrong = fault()) return wrong;
    return worst.x < 0 ? nullptr : &worst;
}

unsigned needs_of(const std::vector<const Metric*>& metrics) {
    unsigned needs = metric::needs_nothing;
    for (const Metric* m : metrics) needs |= m->needs;
    return needs;
}

std::vector<MapSummary> measure_groups(std::vector<scene::rays::RayGroup> groups, const std::vector<MapRow>& rows,
                                       const std::vector<const Metric*>& metrics, truth::TruthLimit limit) {
    std::vector<MapSummary> summaries;
    for (std::size_t r = 0; r < rows.size(); ++r) summaries.emplace_back(metrics);
    for (MapSummary& s : summaries) s.views = groups.size();
    for (std::size_t g = 0; g < groups.size(); ++g) {
        Band band(std::move(groups[g]), limit);
        if (needs_of(metrics) & metric::needs_condition) band.find_condition();
        std::map<std::string, FormatInputs> inputs;
        for (const auto& [name, needs] : needs_by_format(rows, metrics))
            inputs.emplace(name, band.inputs(*find_format(name), needs));
        const columns::BandColumns columns = columns_of(band, rows);
        for (std::size_t r = 0; r < rows.size(); ++r)
            measure_row({rows[r], metrics, nullptr, static_cast<int>(g)},
                        {band, inputs.at(rows[r].format.name), columns}, summaries[r]);
    }
    for (MapSummary& s : summaries) {
        for (metric::Distribution& d : s.metrics) d.seal();
    }
    return summaries;
}

int band_rows(int width) {
    constexpr int pixels = 32768, block = 16;
    return std::max(block, (pixels / width + block - 1) / block * block);
}

std::vector<int> bands_of(int width, int height, shard::Share share) {
    const int rows = band_rows(width);
    const auto units = share.of_units(static_cast<std::uint64_t>((height + rows - 1) / rows));
    std::vector<int> lines;
    for (std::uint64_t band = units.first; band < units.last; ++band) lines.push_back(static_cast<int>(band) * rows);
    return lines;
}

std::vector<MapSummary> run_map(const MapRequest& request, const std::vector<MapSink*>& sinks) {
    const scene::file::Scene& scene = *request.scene;
    std::vector<MapSummary> summaries;
    for (std::size_t r = 0; r < request.rows.size(); ++r) summaries.emplace_back(request.metrics);

    const auto formats = needs_by_format(request.rows, request.metrics);
    truth::Culler culler(scene);
    for (const int y0 : bands_of(scene.width, scene.height, request.share)) {
        Band band(scene, y0, std::min(scene.height, y0 + band_rows(scene.width)), request.limit, &culler);
        if (request.stages) *request.stages += band.stages();
        if (needs_of(request.metrics) & metric::needs_condition) band.find_condition();
        std::map<std::string, FormatInputs> inputs;
        for (const auto& [name, needs] : formats) inputs.emplace(name, band.inputs(*find_format(name), needs));
        const columns::BandColumns columns = columns_of(band, request.rows);
        intersect::process::in_parallel(std::size_t{0}, request.rows.size(), [&](std::size_t r) {
            const MapRow& row = request.rows[r];
            measure_row({row, request.metrics, r < sinks.size() ? sinks[r] : nullptr},
                        {band, inputs.at(row.format.name), columns}, summaries[r]);
            request.progress(band.pixels());
        });
    }
    return summaries;
}

}  // namespace lostbits::measure::map
