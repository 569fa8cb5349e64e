#include "measure/map/map.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "measure/answer/self.hpp"
#include "measure/truth/lost_bits.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::map {

using answer::Outcome;
using blame::Blame;
using metric::Metric;
using metric::Over;
using metric::Sample;
using truth::Band;
using truth::BandNeeds;
using truth::FormatInputs;
using truth::missing;
using truth::Truth;

namespace {

const truth::Certified* in_unit_of(const Truth& truth, const intersect::Info& info) {
    if (!truth.is_hit()) return nullptr;
    return info.direction == intersect::Direction::unit ? &truth.distance : &truth.t;
}

/// The metrics of the samples where form and truth agree that there is a hit.
class Measurement {
public:
    Measurement(const RowRequest& request, BandResult& result)
        : metrics_(request.metrics),
          row_(request.row),
          group_(request.group),
          result_(result),
          needs_(needs_of(metrics_)),
          blamer_(*row_.form, row_.format, culprits_of(metrics_)) {}

    void measure(std::size_t i, MapSummary& summary) {
        const answer::Answers& answers = *result_.answers;
        const FormatInputs& in = *result_.inputs;
        const Truth& truth = result_.truth(i);
        const intersect::Info& info = *row_.form->info;
        const Ray<double> ray = in.rays_for(info)[i];
        const Solid<double>& solid = in.solids[static_cast<std::size_t>(answers.object[i])];
        Sample sample{.t = answers.t[i],
                      .format = &row_.format,
                      .truth = in_unit_of(truth, info),
                      .ray = &ray,
                      .solid = &solid,
                      .march = march_of(i)};
        if (needs_ & metric::needs_rounded_truth)
            sample.truth_rounded = result_.band->rounded_truth(i, row_.format.shape, info.direction, row_.convention());
        if (needs_ & metric::needs_own_truth)
            sample.own = in.ideal ? sample.truth : in_unit_of(in.own(i, row_.convention()), info);
        if (needs_ & metric::needs_condition) sample.condition = result_.band->condition(i, row_.convention());
        std::optional<truth::Certified> self;
        if (needs_ & metric::needs_self) {
            self = answer::without_rounding(*row_.form, ray,
                                            in.target_for(*row_.form, static_cast<std::size_t>(truth.object)));
            if (self) sample.self = &*self;
        }
        const Blame blame = blame_of(i, answers.object[i]);
        if (needs_ & metric::needs_attribution) sample.blame = &blame;
        take(i, sample, Over::agreed_hits, summary);
        take(i, sample, Over::blamed, summary);
        keep_worst(i, sample, summary);
    }

    /// The metrics of a false hit or a false miss.
    void measure_fault(std::size_t i, MapSummary& summary) {
        if (!(needs_ & metric::needs_attribution)) return;
        const int object = result_.answers->hit[i] != 0 ? result_.answers->object[i] : result_.truth(i).object;
        const Ray<double> ray = result_.inputs->rays_for(*row_.form->info)[i];
        const Blame blame = blame_of(i, object);
        take(i,
             {.t = result_.answers->t[i], .format = &row_.format, .ray = &ray, .march = march_of(i), .blame = &blame},
             Over::blamed, summary);
    }

    /// Keeps the first ray of a wrong decision.
    void keep_fault(std::size_t i, Outcome outcome, MapSummary& summary) const {
        const auto kind = std::ranges::find(wrong_decisions, outcome) - wrong_decisions.begin();
        auto& fault = summary.faults.at(static_cast<std::size_t>(kind));
        if (!fault) fault = std::make_unique<WorstRay>(named(i, outcome));
    }

    /// The metrics of how a ray was marched, whatever came of it.
    void measure_march(std::size_t i, MapSummary& summary) {
        const Ray<double> ray = result_.inputs->rays_for(*row_.form->info)[i];
        take(i, {.t = result_.answers->t[i], .format = &row_.format, .ray = &ray, .march = march_of(i)}, Over::marches,
             summary);
    }

private:
    static std::span<const std::string_view> culprits_of(const std::vector<const Metric*>& metrics) {
        const auto found = std::ranges::find_if(metrics, &Metric::by_run);
        return found == metrics.end() ? std::span<const std::string_view>() : (*found)->categories;
    }

    Blame blame_of(std::size_t i, std::int32_t object) {
        if (!(needs_ & metric::needs_attribution)) return {};
        const FormatInputs& in = *result_.inputs;
        const auto& rays = in.rays_for(*row_.form->info);
        return blamer_.of(rays[i], in.target_for(*row_.form, static_cast<std::size_t>(std::max(0, object))),
                          rays.tmax.empty() ? HUGE_VAL : rays.tmax[i]);
    }

    [[nodiscard]] const intersect::MarchRecord* march_of(std::size_t i) const {
        return result_.answers->march.empty() ? nullptr : &result_.answers->march[i];
    }

    void take(std::size_t i, Sample sample, Over over, MapSummary& summary) {
        for (std::size_t m = 0; m < metrics_.size(); ++m) {
            if (metrics_[m]->over != over) continue;
            sample.label = metrics_[m]->label;
            const double value = metrics_[m]->value(sample);
            result_.metrics[m][i] = value;
            summary.add(m, *metrics_[m], value);
        }
    }

    void keep_worst(std::size_t i, const Sample& sample, MapSummary& summary) {
        const double ulps = truth::ulp_error(sample.t, *sample.truth, row_.format.shape);
        if (!(std::fabs(ulps) > summary.worst.size)) return;
        summary.worst = named(i, Outcome::agree_hit);
        summary.worst.ulps = ulps;
        summary.worst.size = std::fabs(ulps);
    }

    /// Ray i as a summary names it.
    [[nodiscard]] WorstRay named(std::size_t i, Outcome outcome) const {
        const bool hit = result_.answers->hit[i] != 0;
        const Truth& truth = result_.truth(i);
        const int object = hit ? result_.answers->object[i] : truth.object;
        WorstRay w{.x = static_cast<int>(i % static_cast<std::size_t>(result_.width)),
                   .y = result_.y0 + static_cast<int>(i / static_cast<std::size_t>(result_.width)),
                   .group = group_,
                   .object = object,
                   .size = 0,
                   .ray = result_.inputs->rays[i],
                   .solid = result_.inputs->solids[static_cast<std::size_t>(std::max(0, object))],
                   .t = hit ? result_.answers->t[i] : missing,
                   .outcome = outcome,
                   .judged = row_.judged};
        if (truth.is_hit())
            w.truth = result_.band->rounded_truth(i, binary64, row_.form->info->direction, row_.convention());
        // The nearest of all solids is the nearer of these two; a field of distances is of all of them.
        std::set<int> deciding;
        if (row_.form->shape != Shape::sdf) {
            if (hit) deciding.insert(object);
            if (truth.is_hit()) deciding.insert(truth.object);
        }
        w.given = result_.band->given(i, deciding);
        return w;
    }

    const std::vector<const Metric*>& metrics_;
    const MapRow& row_;
    int group_;
    BandResult& result_;
    unsigned needs_;
    blame::Blamer blamer_;
};

std::map<std::string, BandNeeds> needs_by_format(const std::vector<MapRow>& rows,
                                                 const std::vector<const Metric*>& metrics) {
    std::map<std::string, BandNeeds> formats;
    for (const MapRow& row : rows) {
        BandNeeds& needs = formats[row.format.name];
        needs.unit_rays |= row.form->info->direction == intersect::Direction::unit;
        needs.own_truth |= (needs_of(metrics) & metric::needs_own_truth) != 0;
    }
    return formats;
}

}  // namespace

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

void MapSummary::add(std::size_t m, const Metric& metric, double value) {
    if (metric.categories.empty()) metrics[m].add(value);
    else if (!std::isnan(value)) ++categories[m][static_cast<std::size_t>(value)];
}

std::optional<Outcome> MapSummary::wrong() const {
    const auto most = std::ranges::max_element(wrong_decisions, {}, [this](Outcome o) { return count(o); });
    return count(*most) > 0 ? std::optional(*most) : std::nullopt;
}

const WorstRay* MapSummary::fault() const {
    const auto most = wrong();
    if (!most) return nullptr;
    return faults[static_cast<std::size_t>(std::ranges::find(wrong_decisions, *most) - wrong_decisions.begin())].get();
}

unsigned needs_of(const std::vector<const Metric*>& metrics) {
    unsigned needs = metric::needs_nothing;
    for (const Metric* m : metrics) needs |= m->needs;
    return needs;
}

void measure_row(const RowRequest& request, const Band& band, const FormatInputs& inputs, MapSummary& summary) {
    const MapRow& row = request.row;
    const answer::Answers answers = answer::evaluate(*row.form, inputs);
    const std::size_t n = band.pixels();
    BandResult result{.y0 = band.y0(),
                      .rows = band.rows(),
                      .width = inputs.rays.width,
                      .band = &band,
                      .inputs = &inputs,
                      .answers = &answers,
                      .convention = row.convention(),
                      .outcomes = std::vector<Outcome>(n),
                      .metrics = {request.metrics.size(), std::vector<double>(n, missing)}};
    Measurement measurement(request, result);
    for (std::size_t i = 0; i < n; ++i) {
        const Truth& truth = result.truth(i);
        const Outcome outcome = answer::classify(truth.decision, answers.hit[i] != 0, answers.t[i]);
        result.outcomes[i] = outcome;
        ++summary.outcomes[static_cast<std::size_t>(outcome)];
        summary.true_hits += truth.is_hit();
        if (!answers.march.empty()) measurement.measure_march(i, summary);
        if (outcome == Outcome::false_hit || outcome == Outcome::false_miss) measurement.measure_fault(i, summary);
        if (std::ranges::find(wrong_decisions, outcome) != wrong_decisions.end())
            measurement.keep_fault(i, outcome, summary);
        if (outcome != Outcome::agree_hit) continue;
        summary.wrong_object += answers.object[i] != truth.object;
        measurement.measure(i, summary);
    }
    summary.rays += n;
    if (request.sink) request.sink->band(result);
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
        for (std::size_t r = 0; r < rows.size(); ++r)
            measure_row({rows[r], metrics, nullptr, static_cast<int>(g)}, band, inputs.at(rows[r].format.name),
                        summaries[r]);
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

std::vector<MapSummary> run_map(const MapRequest& request, const std::vector<MapSink*>& sinks) {
    const scene::file::Scene& scene = *request.scene;
    std::vector<MapSummary> summaries;
    for (std::size_t r = 0; r < request.rows.size(); ++r) summaries.emplace_back(request.metrics);

    const auto formats = needs_by_format(request.rows, request.metrics);
    truth::Culler culler(scene);
    for (int y0 = 0; y0 < scene.height; y0 += band_rows(scene.width)) {
        Band band(scene, y0, std::min(scene.height, y0 + band_rows(scene.width)), request.limit, &culler);
        if (needs_of(request.metrics) & metric::needs_condition) band.find_condition();
        std::map<std::string, FormatInputs> inputs;
        for (const auto& [name, needs] : formats) inputs.emplace(name, band.inputs(*find_format(name), needs));
        tbb::parallel_for(std::size_t{0}, request.rows.size(), [&](std::size_t r) {
            const MapRow& row = request.rows[r];
            measure_row({row, request.metrics, r < sinks.size() ? sinks[r] : nullptr}, band, inputs.at(row.format.name),
                        summaries[r]);
            request.progress(band.pixels());
        });
    }
    return summaries;
}

}  // namespace lostbits::measure::map
