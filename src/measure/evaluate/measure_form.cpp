// Measures one row on one band: outcomes first, then errors in columns, then metrics that need each ray by itself.
#include "measure/evaluate/measure_form.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "measure/answer/against.hpp"
#include "measure/answer/owners.hpp"
#include "measure/answer/without_rounding.hpp"
#include "measure/evaluate/row_parts.hpp"
#include "measure/stability/stability.hpp"
#include "measure/truth/lost_bits.hpp"
#include "number/real.hpp"

namespace lostbits::measure::evaluate {

using answer::Outcome;
using attribution::RayAttribution;
using columns::TrueLengths;
using metric::ColumnKernel;
using metric::Metric;
using metric::MetricDomain;
using metric::Sample;
using truth::FormatInputs;
using truth::Truth;

namespace {

const truth::CertifiedNumber* in_unit_of(const Truth& ray_truth, const intersect::Info& info) {
    if (!ray_truth.is_hit()) return nullptr;
    return info.direction == intersect::Direction::unit ? &ray_truth.distance : &ray_truth.t;
}

/// Computes the metrics of a row on a band.
class Measurement {
public:
    Measurement(const FormRequest& request, const TrueLengths& truth, BandResult& result, RowColumns& columns_of_thread)
        : metrics_(request.metrics),
          row_(request.tested_form),
          request_(request),
          result_(result),
          truth_(truth),
          needs_(needs_of(metrics_) & needs_supported_by(*row_.form)),
          attributor_(*row_.form, row_.format, culprits_of(metrics_), (needs_ & metric::needs_counterfactuals) != 0),
          correct_t_(columns_of_thread.correct_t),
          spare_ulps_(columns_of_thread.spare_ulps) {}

    void measure(FormSummary& summary, std::span<const RaySubset> parts) {
        find_outcomes({*result_.answers, *result_.inputs, *result_.band, row_.convention()}, truth_, returns_t(),
                      {result_.outcomes, correct_t_}, summary);
        measure_columns();
        measure_pairs();
        measure_ray_by_ray();

        for (std::size_t m = 0; m < metrics_.size(); ++m) summary.add(m, *metrics_[m], result_.metrics[m]);
        const RowSums sums(request_, result_, truth_, ulps_);
        sums.keep_worst(summary, largest_ulps_);
        sums.keep_faults(summary);
        for (const RaySubset& part : parts) sums.add(part);
    }

private:
    [[nodiscard]] bool returns_t() const { return row_.form->info->roots != intersect::Roots::none; }

    static std::span<const std::string_view> culprits_of(const std::vector<const Metric*>& metrics) {
        const auto found = std::ranges::find_if(metrics, &Metric::depends_on_forms);
        return found == metrics.end() ? std::span<const std::string_view>() : (*found)->categories;
    }

    /// Column of a metric; null if it is not requested.
    [[nodiscard]] double* column_of(ColumnKernel kind) const {
        const auto found = std::ranges::find(metrics_, kind, &Metric::column_kernel);
        return found == metrics_.end() ? nullptr : result_.metrics[found - metrics_.begin()].data();
    }

    /// Computes the metrics that have a column kernel: most rays in columns, the remaining ones one by one.
    void measure_columns() {
        std::vector<std::uint32_t> remaining;
        measure_errors(remaining);
        measure_residuals(remaining);
        for (const std::uint32_t i : remaining) {
            const Ray<double> ray = ray_of(i);
            const Primitive<double> primitive = primitive_of(i);
            const Truth ray_truth = result_.truth(i);
            fill(i, sample_of(i, ray, primitive, ray_truth),
                 [](const Metric& metric) { return metric.column_kernel != ColumnKernel::none; });
        }
    }

    /// Computes the errors of t, and the largest of them. Adds the rays that the columns leave out to `remaining`.
    void measure_errors(std::vector<std::uint32_t>& remaining) {
        ulps_ = column_of(ColumnKernel::ulp_error);
        if (!ulps_) {
            spare_ulps_.resize(correct_t_.size());
            ulps_ = spare_ulps_.data();
        }

        largest_ulps_ = columns::compute_error_columns(correct_t_, truth_, row_.format.parameters,
                                                       {.ulp = ulps_,
                                                        .lost = column_of(ColumnKernel::lost_bits),
                                                        .correct = column_of(ColumnKernel::correct_bits),
                                                        .relative = column_of(ColumnKernel::relative_error),
                                                        .absolute = column_of(ColumnKernel::absolute_error)},
                                                       remaining);

        for (const std::uint32_t i : remaining) {
            const Truth ray_truth = result_.truth(i);
            ulps_[i] =
                truth::ulp_error(correct_t_[i], *in_unit_of(ray_truth, *row_.form->info), row_.format.parameters);
            if (std::fabs(ulps_[i]) > largest_ulps_) largest_ulps_ = std::fabs(ulps_[i]);
        }
    }

    /// Computes the residuals, if they are requested. Adds the rays that the column leaves out to `remaining`.
    void measure_residuals(std::vector<std::uint32_t>& remaining) {
        double* const residuals = column_of(ColumnKernel::residual);
        if (!residuals) return;
        const FormatInputs& in = *result_.inputs;
        columns::compute_residual_columns(
            correct_t_, {in.rays_for(*row_.form->info), in.primitives, result_.answers->primitive, row_.format.engine},
            residuals, remaining);
    }

    /// Compares the answers with those of `row_.against`, if there is one.
    void measure_pairs() {
        if (row_.against == nullptr) return;
        const auto column = [this](std::string_view name) {
            const std::size_t m = metric::index_of(metrics_, name);
            return m == metrics_.size() ? std::span<double>() : std::span<double>(result_.metrics[m]);
        };
        const std::span<double> against_column = column("against"), apart_column = column("apart");
        if (against_column.empty() && apart_column.empty()) return;
        answer::compare_against(*result_.answers, answer::evaluate(*row_.against, *result_.inputs),
                                answer::are_comparable(*row_.form->info, *row_.against->info), row_.format.parameters,
                                against_column, apart_column);
    }

    /// Computes the metrics that cannot be computed in columns, for each ray with an outcome that they are about.
    void measure_ray_by_ray() {
        // Finds the kinds of metrics to compute.
        const auto has_metric = [this](const auto& applies) {
            return std::ranges::any_of(metrics_, [&](const Metric* m) { return applies(*m); });
        };
        const auto is_of_marches = [](const Metric& metric) { return metric.domain == MetricDomain::marches; };
        const auto is_of_hits = [](const Metric& metric) {
            return (metric.domain == MetricDomain::agreed_hits || metric.domain == MetricDomain::blamed) &&
                   metric.column_kernel == ColumnKernel::none;
        };
        const auto is_of_every = [](const Metric& metric) { return metric.domain == MetricDomain::every; };
        const auto is_of_blamed = [](const Metric& metric) { return metric.domain == MetricDomain::blamed; };
        const bool measures_marches = has_metric(is_of_marches) && !result_.answers->march.empty(),
                   measures_hits = has_metric(is_of_hits);
        const bool measures_every = has_metric(is_of_every);
        const bool measures_faults = (needs_ & metric::needs_attribution) != 0;
        if (!measures_marches && !measures_every && !measures_hits && !measures_faults) return;

        for (std::size_t i = 0; i < correct_t_.size(); ++i) {
            result_.inputs->stop.check();  // attributing the errors of a band takes seconds
            const Outcome outcome = result_.outcomes[i];
            const bool is_fault = outcome != Outcome::not_a_number && is_wrong(outcome);
            const Ray<double> ray = ray_of(i);

            if (measures_marches) fill(i, plain_sample_of(i, ray), is_of_marches);
            if (measures_every) measure_statements(i, ray, is_of_every);
            if (measures_faults && is_fault) {
                const RayAttribution attribution = attribute_ray(i);
                Sample sample = plain_sample_of(i, ray);
                sample.attribution = &attribution;
                fill(i, sample, is_of_blamed);
            }
            if (measures_hits && outcome == Outcome::agree_hit && returns_t()) measure_hit(i, ray, is_of_hits);
        }
    }

    /// Measures a form's statements about its own answer, whether or not that answer is right.
    template <class Which>
    void measure_statements(std::size_t i, const Ray<double>& ray, const Which& applies) {
        const Truth ray_truth = result_.truth(i);
        const FormStatements statements(row_, needs_ & ~unsigned{metric::needs_end_margin}, *result_.inputs, ray, i,
                                        measured_index(i), ray_truth.is_hit() ? truth_.primitive[i] : -1);
        const Primitive<double> primitive = result_.inputs->primitives[measured_index(i)];
        Sample sample = sample_of(i, ray, primitive, ray_truth);
        statements.fill(sample);

        const bool has_true_ray = (needs_ & metric::needs_true_ray) != 0;
        const std::optional<Ray<Real>> true_ray =
            has_true_ray ? std::optional(result_.band->true_ray(i)) : std::nullopt;
        if (has_true_ray) {
            sample.true_ray = &*true_ray;
            sample.frame = result_.band->camera_frame();
        }

        // The decision margin of a miss among several primitives is that of the one missed most narrowly.
        const auto is_margin = [](const Metric& metric) { return metric.name == "decision_margin"; };
        const bool misses_several = result_.outcomes[i] == Outcome::agree_miss && !result_.inputs->is_paired &&
                                    result_.inputs->primitives.size() > 1;
        fill(i, sample,
             [&](const Metric& metric) { return applies(metric) && !(misses_several && is_margin(metric)); });
        if (!misses_several || std::ranges::none_of(metrics_, [&](const Metric* m) { return is_margin(*m); })) return;
        const std::optional<Primitive<double>> nearest = narrowly_missed(sample);
        sample.primitive = nearest ? &*nearest : nullptr;
        fill(i, sample, is_margin);
    }

    /// Index of the primitive that the form hits, otherwise of the one that is truly hit; for a miss, see
    /// `measured_primitive`.
    [[nodiscard]] std::size_t measured_index(std::size_t i) const {
        const bool hit = result_.answers->hit[i] != 0;
        return answer::measured_primitive(*result_.inputs, i,
                                          hit ? result_.answers->primitive[i] : truth_.primitive[i]);
    }

    /// The primitive that a ray misses most narrowly; empty if there are too many to compare.
    [[nodiscard]] std::optional<Primitive<double>> narrowly_missed(const Sample& sample) const {
        constexpr std::size_t max_compared_primitives = 4096;
        const auto& primitives = result_.inputs->primitives;
        if (primitives.size() > max_compared_primitives || !is_primitive(row_.form->shape)) return std::nullopt;
        return primitives[stability::find_nearest_decision(*sample.ray, primitives, sample.convention, sample.range)];
    }

    /// Measures a correct hit. Everything that the sample points to lives until it has been measured.
    template <class Which>
    void measure_hit(std::size_t i, const Ray<double>& ray, const Which& applies) {
        const FormatInputs& in = *result_.inputs;
        const intersect::Info& info = *row_.form->info;
        const Primitive<double> primitive = primitive_of(i);
        const Truth ray_truth = result_.truth(i);
        Sample sample = sample_of(i, ray, primitive, ray_truth);

        // Other truths of the ray: rounded, and of the inputs as the format holds them.
        if (needs_ & metric::needs_rounded_truth)
            sample.rounded_truth =
                result_.band->rounded_truth(i, row_.format.parameters, info.direction, row_.convention());
        const Truth stored = (needs_ & metric::needs_stored_truth) && !in.is_ideal
                                 ? in.find_stored_truth(i, row_.convention())
                                 : Truth{};
        if (needs_ & metric::needs_stored_truth)
            sample.stored_truth = in.is_ideal ? sample.true_t : in_unit_of(stored, info);

        // Sensitivity of the truth to the inputs.
        if (needs_ & metric::needs_condition) sample.condition = result_.band->condition(i, row_.convention());
        const auto reach = [&](truth::Perturbation inputs) {
            return result_.band->reach(i, row_.convention(), info.direction, in, inputs);
        };
        if (needs_ & metric::needs_reach) sample.reach = reach(truth::Perturbation::componentwise);
        if (needs_ & metric::needs_reach_normwise) sample.reach_normwise = reach(truth::Perturbation::normwise);

        // The form without rounding, the operations to blame, and the form's own statements.
        std::optional<truth::CertifiedNumber> unrounded;
        if (needs_ & metric::needs_unrounded)
            unrounded = answer::evaluate_exactly(*row_.form, ray, in.target_for(*row_.form, measured_index(i)));
        if (unrounded) sample.unrounded_t = &*unrounded;
        const RayAttribution attribution = attribute_ray(i);
        if (needs_ & metric::needs_attribution) sample.attribution = &attribution;
        const unsigned statement_needs = needs_ & ~unsigned{metric::needs_deciding_arithmetic | metric::needs_levels};
        const FormStatements statements(row_, statement_needs, in, ray, i, measured_index(i), -1);
        statements.fill(sample);

        fill(i, sample, applies);
    }

    /// Attribution to the operations on the primitive that the ray is measured at.
    RayAttribution attribute_ray(std::size_t i) {
        if (!(needs_ & metric::needs_attribution)) return {};
        const FormatInputs& in = *result_.inputs;
        const auto& rays = in.rays_for(*row_.form->info);
        return attributor_.attribute_ray(rays[i], in.target_for(*row_.form, measured_index(i)), rays.range(i),
                                         result_.band->recorded_ray(i, row_.format));
    }

    [[nodiscard]] Ray<double> ray_of(std::size_t i) const { return result_.inputs->rays_for(*row_.form->info)[i]; }

    /// Sample of any ray, with the members that do not need the truth.
    [[nodiscard]] Sample plain_sample_of(std::size_t i, const Ray<double>& ray) const {
        const auto& march = result_.answers->march;
        return {.t = result_.answers->t[i],
                .format = &row_.format,
                .ray = &ray,
                .march = march.empty() ? nullptr : &march[i],
                .convention = row_.convention(),
                .direction = row_.form->info->direction,
                .range = result_.inputs->rays_for(*row_.form->info).range(i),
                .outcome = result_.outcomes[i]};
    }

    /// Sample of a correct hit, with the members that need no further computation.
    [[nodiscard]] Sample sample_of(std::size_t i, const Ray<double>& ray, const Primitive<double>& primitive,
                                   const Truth& ray_truth) const {
        Sample sample = plain_sample_of(i, ray);
        sample.true_t = in_unit_of(ray_truth, *row_.form->info);
        sample.primitive = &primitive;
        sample.weights = row_.form->form_for(primitive.shape).info->weights;
        return sample;
    }

    /// The primitive that the form hit.
    [[nodiscard]] Primitive<double> primitive_of(std::size_t i) const {
        return result_.inputs->primitives[result_.answers->primitive[i]];
    }

    template <class Which>
    void fill(std::size_t i, Sample sample, const Which& applies) {
        for (std::size_t m = 0; m < metrics_.size(); ++m) {
            if (!applies(*metrics_[m])) continue;
            sample.label = metrics_[m]->label;
            result_.metrics[m][i] = metrics_[m]->value(sample);
        }
    }

    const std::vector<const Metric*>& metrics_;
    const TestedForm& row_;
    const FormRequest& request_;
    BandResult& result_;
    const TrueLengths& truth_;
    unsigned needs_;
    attribution::Attributor attributor_;
    std::vector<double>& correct_t_;   ///< the form's t at correct hits, NaN elsewhere
    std::vector<double>& spare_ulps_;  ///< used if `ulp_error` is not among the metrics
    double* ulps_ = nullptr;
    double largest_ulps_ = 0;  ///< largest |ulp_error|
};

}  // namespace

void measure_form(const FormRequest& request, const FormInputs& form_inputs, FormSummary& summary,
                  std::span<const RaySubset> parts) {
    const TestedForm& tested_form = request.tested_form;
    const answer::Answers evaluated =
        request.answers ? answer::Answers{} : answer::evaluate(*tested_form.form, form_inputs.inputs);
    const answer::Answers& answers = request.answers ? *request.answers : evaluated;

    // The columns are taken out of `idle_columns`: a thread that waits in here may start another form.
    thread_local std::optional<RowColumns> idle_columns;
    RowColumns columns_of_thread = std::exchange(idle_columns, std::nullopt).value_or(RowColumns{});
    columns_of_thread.make(form_inputs.band.pixel_count(), request.metrics);

    BandResult result{.y0 = form_inputs.band.y0(),
                      .scanlines = form_inputs.band.scanlines(),
                      .width = form_inputs.inputs.rays.width,
                      .band = &form_inputs.band,
                      .inputs = &form_inputs.inputs,
                      .answers = &answers,
                      .convention = tested_form.convention(),
                      .outcomes = std::move(columns_of_thread.outcomes),
                      .metrics = std::move(columns_of_thread.metrics)};
    const TrueLengths& true_lengths =
        form_inputs.columns.lengths(tested_form.convention(), tested_form.form->info->direction);
    Measurement(request, true_lengths, result, columns_of_thread).measure(summary, parts);
    if (request.show) request.show(result);

    columns_of_thread.outcomes = std::move(result.outcomes);
    columns_of_thread.metrics = std::move(result.metrics);
    idle_columns = std::move(columns_of_thread);
}

void measure_form(const FormRequest& request, const truth::Band& band, const truth::FormatInputs& inputs,
                  FormSummary& summary) {
    columns::BandTruthColumns columns(band);
    columns.compute_lengths(request.tested_form.convention(), request.tested_form.form->info->direction);
    measure_form(request, {band, inputs, columns}, summary);
}

}  // namespace lostbits::measure::evaluate
