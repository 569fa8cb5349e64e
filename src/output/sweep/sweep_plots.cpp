// Plots of sweeps along one axis.
#include "output/sweep/sweep_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "measure/attribution/culprits.hpp"
#include "measure/truth/missing.hpp"
#include "output/file/number_text.hpp"
#include "output/image/figure.hpp"
#include "output/map/form_names.hpp"
#include "output/map/map_tables.hpp"
#include "output/plot/form_look.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::sweep {

using measure::evaluate::TestedForm;
using measure::sweep::Onset;
using plot::LinePlotSpec;
using plot::Series;

plot::AxisSpec plot_axis(const scene::sweep::Axis& axis) {
    using S = plot::AxisSpec::Scale;
    return {.title = axis.label, .scale = axis.spacing == scene::sweep::Axis::Spacing::log2 ? S::log2 : S::linear};
}

plot::AxisSpec lost_bits_axis(const FloatFormat& format, std::string_view name) {
    const double precision = format.precision;
    return {.title = fmt::format("lost bits, of {} in {}", precision, name), .low = 0.0, .limit = precision};
}

double wrong_fraction(const FormSummary& summary) {
    return static_cast<double>(summary.wrong_count()) / static_cast<double>(summary.ray_count);
}

namespace {

using plot::fraction_axis;

/// The value of one tested form at each step, sorted by the axis.
Series make_series(const std::vector<SweepStep>& steps, std::size_t form_index, const std::string& label,
                   const std::function<double(const FormSummary&)>& value) {
    Series series{label};
    for (const SweepStep& step : steps) {
        series.x.push_back(step.values.front());
        series.y.push_back(value(step.summaries[form_index]));
    }
    if (series.x.front() > series.x.back()) {
        std::ranges::reverse(series.x);
        std::ranges::reverse(series.y);
    }
    return series;
}

struct Quantity {
    std::string title;
    plot::AxisSpec axis;
    std::function<double(const FormSummary&)> value;
    std::function<double(const FormSummary&)> envelope = {};  ///< empty: no envelope
    bool is_over_hits = false;  ///< the value is a quantile over agreed hits, withheld if few agree
    std::string note = {};      ///< text that ends the subtitle
    bool (*shows)(const TestedForm&) = [](const TestedForm&) { return true; };
    std::string empty_text = {};  ///< reason why there is nothing to draw; empty: there is something to draw
};

bool is_marching(const TestedForm& tested_form) { return !is_primitive(tested_form.form->shape); }

/// Number of rays per step, and how many of them are independent.
std::string rays_text(const MeasuredSweep& sweep) {
    const FormSummary& first_summary = sweep.steps.front().summaries.front();
    if (!sweep.request.sweep.has_random_rays())
        return text::count_with_noun(first_summary.ray_count, "ray") + " per step";
    if (first_summary.view_count == first_summary.ray_count)
        return text::count_with_noun(first_summary.ray_count, "independent ray") + " per step";
    return fmt::format("{} rays per step, of {}", first_summary.ray_count,
                       text::count_with_noun(first_summary.view_count, "independent view"));
}

/// The parts that all plots along a sweep share: its title, its axis, and the number of rays per step.
LinePlotSpec common_spec(const MeasuredSweep& sweep, const std::string& title, const plot::AxisSpec& y) {
    const scene::sweep::SweepFile& file = sweep.request.sweep;
    return {.title = title, .subtitle = {file.title, rays_text(sweep)}, .x = plot_axis(file.axes.front()), .y = y};
}

/// Adds a line for each form that the plot of the quantity shows, and the envelope if the quantity has one.
void add_form_lines(LinePlotSpec& spec, const MeasuredSweep& sweep, const Format& format, const Quantity& quantity) {
    const SweepRequest& request = sweep.request;
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        if (request.tested_forms[r].format != format || !quantity.shows(request.tested_forms[r])) continue;
        spec.series.push_back(
            make_series(sweep.steps, r, map::short_name(*request.tested_forms[r].form->info), quantity.value));
        spec.series.back().look = plot::form_look(*request.tested_forms[r].form);
        spec.series.back().key = map::tested_form_name(request.tested_forms[r]);

        // Any form that hits at every step gives the same envelope. Skip forms without t: they have no line to compare
        // it with.
        const auto& line = spec.series.back().y;
        if (quantity.envelope && !spec.envelope && std::ranges::any_of(line, [](double y) { return !std::isnan(y); })) {
            Series envelope = make_series(sweep.steps, r, "envelope: half an ulp in each input", quantity.envelope);
            if (std::ranges::none_of(envelope.y, [](double y) { return std::isnan(y); }))
                spec.envelope = std::move(envelope);
        }
    }
}

/// Adds the marks that the sweep's file states for the format, and beside each the measured onset of the same event.
void add_marks(LinePlotSpec& spec, const MeasuredSweep& sweep, const Format& format) {
    const SweepRequest& request = sweep.request;
    for (const auto& mark : request.sweep.marks) {
        if (!mark.format.empty() && mark.format != format.name) continue;
        spec.marks.push_back({mark.at, mark.label});

        const auto onset = std::ranges::find_if(sweep.onsets, [&](const Onset& onset) {
            const TestedForm& tested_form = request.tested_forms[onset.form_index];
            return onset.found && !onset.reads_backwards && tested_form.form->info->name == mark.form &&
                   tested_form.format == format && onset.event == mark.event && onset.statistic == mark.statistic &&
                   onset.threshold == mark.threshold;
        });
        if (onset == sweep.onsets.end()) continue;
        const std::string form_name = map::short_name(*request.tested_forms[onset->form_index].form->info);
        spec.marks.push_back({onset->first_bad, mark.event == "lost_bits"
                                                    ? fmt::format("{}: its {} reaches {} bits", form_name,
                                                                  mark.statistic == "p50" ? "median" : mark.statistic,
                                                                  file::decimal(mark.threshold))
                                                    : fmt::format("{}: measured", form_name)});
    }
}

image::Canvas draw_line_chart(const MeasuredSweep& sweep, const Format& format, const Quantity& quantity,
                              PlotSize size = {}) {
    LinePlotSpec spec = common_spec(sweep, fmt::format("{} in {}", quantity.title, format.name), quantity.axis);
    spec.width = size.width;
    spec.height = size.height;
    if (!quantity.note.empty()) spec.subtitle.back() += "; " + quantity.note;

    // Without anything to draw, the page only says why.
    if (!quantity.empty_text.empty()) {
        spec.empty_text = quantity.empty_text;
        return plot::draw_line_plot(spec);
    }
    add_form_lines(spec, sweep, format, quantity);
    add_shade_and_notes(spec, sweep, format, quantity.is_over_hits);
    add_marks(spec, sweep, format);
    return plot::draw_line_plot(spec);
}

}  // namespace

image::Canvas draw_lost_bits_plot(const MeasuredSweep& sweep, const Format& format, double q, PlotSize size) {
    const SweepRequest& request = sweep.request;
    const std::size_t lost_index = measure::metric::index_of(request.metrics, "lost_bits"),
                      inherent_index = measure::metric::index_of(request.metrics, "inherent_bits");
    Quantity quantity{
        .title = fmt::format("Lost bits, {}", q == 0.5 ? "median" : "99th percentile"),
        .axis = lost_bits_axis(format.parameters, format.name),
        .value = [lost_index, q](const FormSummary& summary) { return drawn_quantile(summary, lost_index, q); },
        .is_over_hits = true};
    if (inherent_index < request.metrics.size())
        quantity.envelope = [inherent_index, q](const FormSummary& summary) {
            return drawn_quantile(summary, inherent_index, q);
        };
    return draw_line_chart(sweep, format, quantity, size);
}

image::Canvas draw_outcome_plot(const MeasuredSweep& sweep, const Format& format, Outcome outcome, PlotSize size) {
    const auto outcome_fraction = [outcome](const FormSummary& summary) {
        return measure::truth::fraction(summary.count(outcome), summary.ray_count);
    };
    std::uint64_t max_rays = 1;
    for (const SweepStep& step : sweep.steps) {
        for (const FormSummary& summary : step.summaries) max_rays = std::max(max_rays, summary.ray_count);
    }
    // The axis begins at half the fraction of one ray, so only a fraction of 0 lies below it.
    Quantity quantity{.title = outcome_title(outcome),
                      .axis = {.title = "share of rays",
                               .scale = plot::AxisSpec::Scale::log10,
                               .low = 1.0 / static_cast<double>(2 * max_rays),
                               .high = 1.0,
                               .shows_zero = true},
                      .value = outcome_fraction};

    const auto truly_misses = [](const FormSummary& summary) { return summary.true_miss_count() > 0; };
    const bool is_possible =
        outcome != Outcome::false_hit || std::ranges::any_of(sweep.steps, [&](const SweepStep& step) {
            return std::ranges::any_of(step.summaries, truly_misses);
        });
    if (is_possible) quantity.note = "a line at 0, below the log scale, means no such ray in that step";
    else quantity.empty_text = "No ray of this sweep truly misses, so none can be a false hit.";
    return draw_line_chart(sweep, format, quantity, size);
}

bool has_outcome(const MeasuredSweep& sweep, const Format& format, Outcome outcome) {
    return std::ranges::any_of(sweep.steps, [&](const SweepStep& step) {
        for (std::size_t r = 0; r < step.summaries.size(); ++r)
            if (sweep.request.tested_forms[r].format == format && step.summaries[r].count(outcome) > 0) return true;
        return false;
    });
}

std::vector<Outcome> wrong_outcomes(const MeasuredSweep& sweep, const Format& format) {
    std::vector<Outcome> outcomes{Outcome::false_hit, Outcome::false_miss};
    for (const Outcome o :
         {Outcome::wrong_primitive, Outcome::crack, Outcome::double_hit, Outcome::out_of_order, Outcome::not_a_number})
        if (has_outcome(sweep, format, o)) outcomes.push_back(o);
    return outcomes;
}

std::string outcome_title(Outcome outcome) {
    switch (outcome) {
        case Outcome::false_hit: return "False hits";
        case Outcome::false_miss: return "False misses";
        case Outcome::wrong_primitive: return "Hits of the wrong primitive";
        case Outcome::crack: return "Cracks";
        case Outcome::double_hit: return "Double hits";
        case Outcome::out_of_order: return "Triangles out of order";
        default: return "Answers that are not a number";
    }
}

namespace {

/// Metrics of one plot, each with the label of its line.
using LabelledMetrics = std::vector<std::pair<std::string, std::string>>;

/// Plots the medians of the parts of one row's error side by side, and where each step of a transform first loses an
/// ulp.
image::Canvas draw_parts_plot(const MeasuredSweep& sweep, std::size_t form_index, const std::string& title,
                              const LabelledMetrics& parts) {
    const SweepRequest& request = sweep.request;
    const TestedForm& tested_form = request.tested_forms[form_index];
    LinePlotSpec spec = common_spec(
        sweep, fmt::format("{} of {} in {}, medians", title, tested_form.form->info->name, tested_form.format.name),
        {.title = "ulp", .scale = plot::AxisSpec::Scale::log2, .low = 0x1p-6});

    // A line for each part, with a mark where it first reaches an ulp.
    for (const auto& [metric, label] : parts) {
        const std::size_t metric_index = measure::metric::index_of(request.metrics, metric);
        spec.series.push_back(make_series(sweep.steps, form_index, label, [metric_index](const FormSummary& summary) {
            return drawn_quantile(summary, metric_index, 0.5);
        }));
        for (const Onset& onset : sweep.onsets)
            if (onset.found && !onset.happens_at_start && onset.form_index == form_index && onset.event == metric)
                spec.marks.push_back({onset.first_bad, label + ": 1 ulp"});
    }

    for (const auto& mark : request.sweep.marks) {
        if (mark.format.empty() || mark.format == tested_form.format.name) spec.marks.push_back({mark.at, mark.label});
    }
    return plot::draw_line_plot(spec);
}

/// The metrics of the steps of a transform that the request measures.
LabelledMetrics transform_step_metrics(const SweepRequest& request) {
    LabelledMetrics steps;
    for (const auto* metric : request.metrics)
        if ((metric->needs & measure::metric::needs_steps) && !metric->label.empty())
            steps.emplace_back(metric->name, metric->label);
    return steps;
}

/// Saves a plot of a format under a name.
using SaveAs = std::function<void(const std::string& name, const image::Canvas& plot)>;

/// Saves the plots that a sweep has in addition if forms march; saves none otherwise.
void write_march_plots(const SaveAs& save, const MeasuredSweep& sweep, const Format& format) {
    const SweepRequest& request = sweep.request;
    const std::size_t stop_index = measure::metric::index_of(request.metrics, "stop"),
                      iterations_index = measure::metric::index_of(request.metrics, "iterations");
    if (stop_index == request.metrics.size()) return;

    // Fraction of marches that ran out of steps or stopped moving.
    const auto unfinished = [stop_index](const FormSummary& summary) {
        const auto count_of = [&](intersect::StopReason reason) {
            return summary.categories[stop_index][static_cast<std::size_t>(reason)];
        };
        return static_cast<double>(count_of(intersect::StopReason::max_steps) +
                                   count_of(intersect::StopReason::stagnated)) /
               static_cast<double>(summary.ray_count);
    };
    save("unfinished", draw_line_chart(sweep, format,
                                       {.title = "Marches that did not finish",
                                        .axis = fraction_axis,
                                        .value = unfinished,
                                        .shows = is_marching}));

    // Number of samples of the field.
    save("iterations", draw_line_chart(sweep, format,
                                       {.title = "Samples of the field, 99th percentile",
                                        .axis = {.title = "samples", .scale = plot::AxisSpec::Scale::log2, .low = 1.0},
                                        .value =
                                            [iterations_index](const FormSummary& summary) {
                                                return summary.metrics[iterations_index].quantile(0.99);
                                            },
                                        .shows = is_marching}));

    // Errors of each form, split into those of the model and those of rounding.
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        const TestedForm& tested_form = request.tested_forms[r];
        if (tested_form.format == format && is_marching(tested_form))
            save(fmt::format("split.{}", tested_form.form->info->name),
                 draw_parts_plot(
                     sweep, r, "Model and rounding error",
                     {{"model_error", "model"}, {"rounding_error", "rounding"}, {"ulp_error", "total error"}}));
    }
}

/// The operations that are blamed at any step, with the largest fraction at any step first.
std::vector<std::size_t> rank_culprits(const MeasuredSweep& sweep, std::size_t form_index, std::size_t culprit_metric) {
    std::vector<double> peak_fraction(sweep.request.metrics[culprit_metric]->categories.size());
    for (const SweepStep& step : sweep.steps) {
        for (std::size_t c = 1; c < peak_fraction.size(); ++c)
            peak_fraction[c] =
                std::fmax(peak_fraction[c], measure::attribution::culprit_fraction(
                                                step.summaries[form_index].categories[culprit_metric], std::array{c}));
    }

    std::vector<std::size_t> order;
    for (std::size_t c = 1; c < peak_fraction.size(); ++c) {
        if (peak_fraction[c] > 0) order.push_back(c);
    }
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return peak_fraction[a] > peak_fraction[b]; });
    return order;
}

/// Plots the culprits of one row along the axis: the fractions of the operations that are blamed most at any step, and
/// the fraction of all other operations together. Nothing if no operation is blamed.
std::optional<image::Canvas> draw_culprit_plot(const MeasuredSweep& sweep, std::size_t form_index) {
    const SweepRequest& request = sweep.request;
    constexpr std::size_t max_operations = 7;
    constexpr std::size_t max_letters = 70;
    const TestedForm& tested_form = request.tested_forms[form_index];
    const auto culprit_metric = static_cast<std::size_t>(
        std::ranges::find_if(request.metrics, &measure::metric::Metric::depends_on_forms) - request.metrics.begin());
    const std::vector<std::size_t> order = rank_culprits(sweep, form_index, culprit_metric);
    if (order.empty()) return {};

    LinePlotSpec spec =
        common_spec(sweep, fmt::format("Culprits of {} in {}", tested_form.form->info->name, tested_form.format.name),
                    fraction_axis);
    spec.subtitle.back() += "; an operation's share of the rays that have a culprit";
    const auto add = [&](const std::string& label, std::span<const std::size_t> categories) {
        spec.series.push_back(make_series(sweep.steps, form_index, label, [&](const FormSummary& summary) {
            return measure::attribution::culprit_fraction(summary.categories[culprit_metric], categories);
        }));
    };

    // Draw the operations with the largest fractions.
    const std::size_t named_count = order.size() <= max_operations + 1 ? order.size() : max_operations;
    for (std::size_t k = 0; k < named_count; ++k) {
        const std::string_view operation = request.metrics[culprit_metric]->categories[order[k]];
        add(operation.size() <= max_letters ? std::string(operation)
                                            : std::string(operation.substr(0, max_letters - 2)) + "..",
            std::span(order).subspan(k, 1));
    }

    // Sum the rest.
    if (named_count < order.size())
        add(text::count_with_noun(order.size() - named_count, "other operation"),
            std::span(order).subspan(named_count));
    return plot::draw_line_plot(spec);
}

}  // namespace

std::vector<Format> list_formats(const MeasuredSweep& sweep) {
    std::vector<Format> formats;
    for (const TestedForm& tested_form : sweep.request.tested_forms) {
        if (std::ranges::find(formats, tested_form.format) == formats.end()) formats.push_back(tested_form.format);
    }
    return formats;
}

void write_sweep_plots(const std::filesystem::path& folder, const MeasuredSweep& sweep, bool draws_single_pictures) {
    const SweepRequest& request = sweep.request;
    if (request.sweep.axes.size() == 2) return write_planes(folder, request, sweep.steps, draws_single_pictures);
    for (const Format& format : list_formats(sweep)) {
        const SaveAs save = [&](const std::string& name, const image::Canvas& plot) {
            image::save_figure(folder / fmt::format("{}.{}.png", name, format.name), plot);
        };

        // Plots of every sweep.
        save("lost_bits_p50", draw_lost_bits_plot(sweep, format, 0.5));
        save("lost_bits_p99", draw_lost_bits_plot(sweep, format, 0.99));
        for (const Outcome o : wrong_outcomes(sweep, format))
            save(std::string(measure::answer::outcome_names[static_cast<std::size_t>(o)]),
                 draw_outcome_plot(sweep, format, o));
        write_march_plots(save, sweep, format);

        // Plots of one form each, if steps of transforms or culprits are measured.
        for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
            const TestedForm& tested_form = request.tested_forms[r];
            if (tested_form.format != format) continue;
            const LabelledMetrics step_metrics = transform_step_metrics(request);
            if (!step_metrics.empty() && tested_form.form->has_transform_method)
                save(fmt::format("steps.{}", tested_form.form->info->name),
                     draw_parts_plot(sweep, r, "Steps", step_metrics));
            if (!map::asks_for_culprits(request.metrics)) continue;
            if (const auto plot = draw_culprit_plot(sweep, r))
                save(fmt::format("culprit.{}", tested_form.form->info->name), *plot);
        }
    }
}

}  // namespace lostbits::output::sweep
