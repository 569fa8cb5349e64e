#include "output/report/map_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "measure/truth/reach.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/image/exr_parts.hpp"
#include "output/map/form_names.hpp"
#include "output/map/map_colour.hpp"

namespace lostbits::output::report {

using intersect::Direction;
using measure::evaluate::BandResult;
using measure::metric::Metric;

namespace {

/// Metrics that are functions of t and t* alone. src/output/report/script/numbers.js computes them too, and the browser
/// test compares every pixel of a map with its CSV.
constexpr std::array<std::string_view, 5> derived_metrics{"lost_bits", "correct_bits", "ulp_error", "relative_error",
                                                          "absolute_error"};

bool is_derived(const Metric& metric) {
    return std::ranges::find(derived_metrics, metric.name) != derived_metrics.end();
}
/// True for `inherent_bits`. It is stored for every true hit, whatever the form answers, so that the values of
/// neighbours lie nearly on a line.
bool is_inherent_bits(const Metric& metric) { return metric.name == "inherent_bits"; }
bool is_condition(const Metric& metric) { return metric.name == "condition"; }

constexpr std::int16_t exact_bound = -32768;

/// Exponent of the least power of two that is at least the bound.
std::int16_t bound_exponent(const measure::truth::CertifiedNumber& x) {
    if (x.bound == 0) return exact_bound;
    int e = 0;
    const double m = std::frexp(x.bound, &e);  // bound = m 2^e, 1/2 <= m < 1
    return static_cast<std::int16_t>(std::clamp<std::int64_t>(x.exponent + e - (m == 0.5), -32767, 32767));
}

}  // namespace

/// Data that all rows with the same truth share. The first of these rows fills it.
struct MapData::Group {
    map::TruthKey kind;
    Layer decision, primitive, truth, remainder, bound, condition;

    Group(const TestedForm& tested_form, std::size_t pixel_count)
        : kind(map::truth_key(tested_form)),
          decision(1, pixel_count),
          primitive(4, pixel_count),
          truth(8, pixel_count),
          remainder(4, pixel_count),
          bound(2, pixel_count),
          condition(4, pixel_count) {}

    void set_pixel(std::size_t pixel, std::size_t i, const BandResult& result, bool stores_condition) {
        const auto& [direction, convention, generator] = kind;
        const measure::truth::Truth& ray_truth = result.truth(i);
        decision.set(pixel, static_cast<std::uint64_t>(ray_truth.decision));
        primitive.set(pixel, static_cast<std::uint64_t>(ray_truth.primitive + 1));
        if (i % static_cast<std::size_t>(result.width) == 0) truth_predictor_.begin_row();
        if (!ray_truth.is_hit()) return;

        // A true hit also has t*: rounded, with the remainder and its bound.
        const measure::truth::CertifiedNumber& exact = direction == Direction::unit ? ray_truth.distance : ray_truth.t;
        const double rounded = result.band->rounded_truth(i, binary64, direction, convention);
        truth.set(pixel, truth_predictor_.encode(std::bit_cast<std::uint64_t>(rounded), 8));
        remainder.set(pixel, static_cast<float>(
                                 measure::truth::scaled_difference(exact, measure::truth::as_certified(rounded), 0)));
        bound.set(pixel, std::uint64_t{static_cast<std::uint16_t>(bound_exponent(exact))});
        if (stores_condition) condition.set(pixel, static_cast<float>(result.band->condition(i, convention)));
    }

private:
    HitPredictor truth_predictor_;
};

class MapData::Row {
public:
    Row(const MapStudy& study, const TestedForm& tested_form, std::size_t pixel_count, std::size_t group,
        Group* group_to_fill)
        : tested_form_(tested_form),
          group_(group),
          group_to_fill_(group_to_fill),
          outcome_(1, pixel_count),
          primitive_(4, pixel_count),
          t_(tested_form.format.engine == Format::Engine::native32 ? 4 : 8, pixel_count),
          error_sizes_(pixel_count, std::numeric_limits<float>::quiet_NaN()) {
        for (std::size_t m = 0; m < study.metrics.size(); ++m) {
            stores_condition_ |=
                (measure::evaluate::needs_of({study.metrics[m]}) & measure::metric::needs_condition) != 0;
            const Metric& metric = *study.metrics[m];
            if (is_inherent_bits(metric)) inherent_index_ = m;
            if (metric.name == "ulp_error") ulp_error_index_ = m;
            if (!is_derived(metric) && !is_condition(metric)) stored_metrics_.push_back({m, Layer(4, pixel_count)});
        }
    }

    void add_band(const BandResult& result) {
        for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
            const std::size_t pixel = static_cast<std::size_t>(result.y0) * static_cast<std::size_t>(result.width) + i;
            if (group_to_fill_) group_to_fill_->set_pixel(pixel, i, result, stores_condition_);

            // The outcome, and the errors by which rays are chosen.
            outcome_.set(pixel, static_cast<std::uint64_t>(result.outcomes[i]));
            if (measure::evaluate::is_wrong(result.outcomes[i]))
                error_sizes_[pixel] = std::numeric_limits<float>::infinity();
            else if (ulp_error_index_)
                error_sizes_[pixel] = std::fabs(static_cast<float>(result.metrics[*ulp_error_index_][i]));

            // The metrics, and the answer of a hit.
            for (auto& [m, layer] : stored_metrics_) {
                if (m == inherent_index_) set_inherent_bits(layer, pixel, i, result);
                else layer.set(pixel, static_cast<float>(result.metrics[m][i]));
            }
            if (!result.answers->hit[i]) continue;
            primitive_.set(pixel, static_cast<std::uint64_t>(result.answers->primitive[i] + 1));
            t_.set(pixel, encoded_t(result.answers->t[i], result, i));
        }
    }

    /// Bytes of the outcomes, the primitives and t, then of the stored metrics.
    [[nodiscard]] std::string bytes() const {
        std::string result(outcome_.planes());
        result += primitive_.planes();
        result += t_.planes();
        for (const auto& [m, layer] : stored_metrics_) result += layer.planes();
        return result;
    }
    [[nodiscard]] std::size_t group() const { return group_; }
    /// Sizes of the errors for `choose_rays`.
    [[nodiscard]] std::span<const float> error_sizes() const { return error_sizes_; }

private:
    /// Difference of the bits of t from the bits of the truth. For formats other than f32 and f64: the bits of t in
    /// binary64, whose low bits are zero anyway.
    [[nodiscard]] std::uint64_t encoded_t(double t, const BandResult& result, std::size_t i) const {
        const double true_t =
            result.truth(i).is_hit()
                ? result.band->rounded_truth(i, binary64, tested_form_.form->info->direction, result.convention)
                : 0;
        switch (tested_form_.format.engine) {
            case Format::Engine::native32: return folded_difference(image::float_word(t), image::float_word(true_t), 4);
            case Format::Engine::native64:
                return folded_difference(std::bit_cast<std::uint64_t>(t), std::bit_cast<std::uint64_t>(true_t), 8);
            case Format::Engine::rounded: break;
        }
        return std::bit_cast<std::uint64_t>(t);
    }

    /// Stores the inherent bits of a pixel. Called for every pixel; only true hits have a value.
    void set_inherent_bits(Layer& layer, std::size_t pixel, std::size_t i, const BandResult& result) {
        if (i % static_cast<std::size_t>(result.width) == 0) inherent_predictor_.begin_row();
        const measure::truth::Truth ray_truth = result.truth(i);
        if (!ray_truth.is_hit()) return;
        const Direction direction = tested_form_.form->info->direction;
        const double reach = result.band->reach(i, result.convention, direction, *result.inputs);
        const double bits = measure::truth::inherent_bits(
            reach, direction == Direction::unit ? ray_truth.distance : ray_truth.t, tested_form_.format.parameters);
        layer.set(pixel, inherent_predictor_.encode(image::float_word(bits), 4));
    }

    struct StoredMetric {
        std::size_t metric;
        Layer layer;
    };
    const TestedForm& tested_form_;
    std::size_t group_;
    Group* group_to_fill_;
    bool stores_condition_ = false;
    std::optional<std::size_t> inherent_index_ = {};  ///< index of `inherent_bits`
    HitPredictor inherent_predictor_ = {};
    std::optional<std::size_t> ulp_error_index_ = {};  ///< index of `ulp_error`
    Layer outcome_, primitive_, t_;
    std::vector<float> error_sizes_;
    std::vector<StoredMetric> stored_metrics_;
};

MapData::MapData(const MapStudy& study) : study_(study) {
    const std::size_t pixel_count = study.scene->pixel_count();
    for (const TestedForm& tested_form : study.tested_forms) {
        const auto known_group = std::ranges::find_if(
            groups_, [&tested_form](const auto& g) { return g->kind == map::truth_key(tested_form); });
        const auto g = static_cast<std::size_t>(known_group - groups_.begin());
        const bool is_first = known_group == groups_.end();
        if (is_first) groups_.push_back(std::make_unique<Group>(tested_form, pixel_count));
        rows_.push_back(
            std::make_unique<Row>(study, tested_form, pixel_count, g, is_first ? groups_[g].get() : nullptr));
    }
}

MapData::~MapData() = default;

measure::evaluate::ShowForms MapData::band_receiver() {
    return [this](std::size_t form_index, const BandResult& result) { rows_.at(form_index)->add_band(result); };
}

namespace {

Json metric_json(const Metric& metric, std::span<const TestedForm> tested_forms) {
    const map::MetricPaint paint(metric, tested_forms.front().format.parameters);
    Json json{{"name", metric.name},
              {"unit", metric.unit},
              {"meaning", metric.meaning},
              {"marches", metric.domain == measure::metric::MetricDomain::marches},
              {"every_ray", metric.domain == measure::metric::MetricDomain::every},
              {"blamed", metric.domain == measure::metric::MetricDomain::blamed},
              {"kind", is_inherent_bits(metric) ? "hits"
                       : is_derived(metric)     ? "derived"
                       : is_condition(metric)   ? "shared"
                                                : "stored"}};
    // One scale for each format, as in the pictures, or the categories with their colours.
    if (paint.scale()) {
        Json& scales = json["scales"] = Json::object();
        for (const TestedForm& tested_form : tested_forms)
            scales[tested_form.format.name] = scale_json(map::metric_scale(metric, tested_form.format.parameters));
        return json;
    }
    Json& categories = json["categories"] = Json::array();
    for (std::size_t c = 0; c < metric.categories.size(); ++c) {
        const image::Rgb8 colour = paint.colour(measure::answer::Outcome::agree_hit, static_cast<double>(c));
        categories.push_back(Json::array({metric.categories[c], colour_json(colour)}));
    }
    return json;
}

const char* coding_name(const Format& format) {
    switch (format.engine) {
        case Format::Engine::native32: return "bits32";
        case Format::Engine::native64: return "bits64";
        case Format::Engine::rounded: break;
    }
    return "plain64";
}

/// Quantiles of each metric that has numbers.
Json statistics_json(const MapStudy& study, const FormSummary& summary) {
    Json statistics = Json::object();
    for (std::size_t m = 0; m < study.metrics.size(); ++m) {
        if (!study.metrics[m]->categories.empty()) continue;
        statistics[std::string(study.metrics[m]->name)] = json_array(
            measure::metric::quantile_statistics,
            [&](const measure::metric::Statistic& statistic) { return number_json(statistic.of(summary.metrics[m])); });
    }
    return statistics;
}

Json summary_json(const MapStudy& study, const TestedForm& tested_form, const FormSummary& summary, std::size_t group,
                  const std::string& scene_with_size) {
    const FloatFormat& format = tested_form.format.parameters;
    const measure::evaluate::WorstRay* const worst = summary.worst_ray();
    return {// the row
            {"form", tested_form.form->info->name},
            {"format", tested_form.format.name},
            {"title", map::title_of(*tested_form.form->info)},
            {"precision", format.precision},
            {"emin", format.emin},
            {"coding", coding_name(tested_form.format)},
            {"direction", tested_form.form->info->direction == Direction::unit ? "unit" : "any"},
            {"formula", tested_form.form->is_template()},
            {"from", attribution::plugin_options_for(tested_form.form->info->name)},
            {"group", group},

            // its results
            {"outcomes", summary.outcomes},
            {"true_hits", summary.true_hit_count},
            {"statistics", statistics_json(study, summary)},
            {"worst_explain",
             worst ? attribution::explain_command(
                         attribution::explain_pixel_arguments(scene_with_size, static_cast<int>(worst->x), worst->y),
                         tested_form)
                   : ""},
            {"worst", worst ? Json{{"x", worst->x}, {"y", worst->y}} : Json()}};
}

}  // namespace

Json MapData::index(const std::vector<FormSummary>& summaries, bool has_scene_size,
                    const std::string& scene_with_size) const {
    const scene::file::Scene& scene = *study_.scene;
    Json rows = Json::array();
    for (std::size_t r = 0; r < rows_.size(); ++r)
        rows.push_back(summary_json(study_, study_.tested_forms[r], summaries[r], rows_[r]->group(), scene_with_size));
    return {
        {"id", scene.id},
        {"title", scene.title},
        {"note", scene.note},
        {"named", scene_with_size},
        {"width", scene.width},
        {"height", scene.height},
        {"own_size", has_scene_size},
        {"metrics", json_array(study_.metrics, [&](const Metric* m) { return metric_json(*m, study_.tested_forms); })},
        {"rows", std::move(rows)}};
}

std::vector<NamedData> MapData::named_data(const std::vector<FormSummary>& summaries) const {
    std::vector<NamedData> result;

    // The truths, each shared by several rows.
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        std::string bytes;
        const Group& group = *groups_[g];
        for (const Layer* layer :
             {&group.decision, &group.primitive, &group.truth, &group.remainder, &group.bound, &group.condition})
            bytes += layer->planes();
        result.push_back({fmt::format("truth:{}:{}", study_.scene->id, g), pack(bytes)});
    }

    // The rows. Only forms that can be recorded have operations.
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const TestedForm& tested_form = study_.tested_forms[r];
        const std::string name = fmt::format("{}:{}", study_.scene->id, map::tested_form_name(tested_form));
        if (tested_form.form->is_template()) {
            const auto rays = choose_rays(summaries[r], rows_[r]->error_sizes(), study_.scene->width);
            result.push_back({"rays:" + name, pack(compact_json(rays_json(study_, tested_form, rays)))});
        }
        result.push_back({"row:" + name, pack(rows_[r]->bytes())});
    }
    return result;
}

}  // namespace lostbits::output::report
