// Tables, plots and texts of time against accuracy.
#include "output/trade/trade_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string_view>
#include <utility>

#include "output/file/atomic_file.hpp"
#include "output/file/number_text.hpp"
#include "output/image/figure.hpp"
#include "output/map/form_names.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::trade {

using measure::answer::Outcome;
using measure::trade::TradeKernel;
using plot::ScatterPlotSpec;
using table::or_missing;
using table::Table;

namespace {

constexpr const char* form_meaning = "form under test; with +contract or +fastmath: compiled with those flags";

}  // namespace

Table<TimeRow> make_time_table() {
    using R = TimeRow;
    using KernelTime = TradeResult::KernelTime;
    Table<R> table;
    table.add(kernel_columns(form_meaning), &R::kernel);

    // The load: rays and answers, and their place in memory.
    table.add({"working_set",
               "location of rays and answers: l1, l2 (half of the cache), memory (read again and again); scene: rays "
               "of the scene, taken evenly from its picture",
               [](const R& r) { return r.load->working_set; }});
    table.add<KernelTime>(
        {{"working_set_bytes", "B", "bytes of rays and answers", &KernelTime::bytes},
         {"working_set_rays", "number of rays in these bytes", &KernelTime::ray_count},
         {"hit_rate", "1",
          "share of the rays that hit; in l1 a processor can learn the few hundred rays, so kernels with "
          "branches look faster than they are",
          &KernelTime::hit_rate}},
        &R::timed);

    // Times.
    const auto timing = [](const R& r) -> const Timing& { return r.timed->timing; };
    table.add(
        time_columns("per ray, for a scene per ray and primitive; median of the repetitions, and so for the quartiles"),
        timing);
    table.add<Timing>({{"spread", "1", "(third - first quartile)/median",
                        [](const auto& t) { return (t.high_quartile - t.low_quartile) / t.median; }},
                       {"rays_per_second", "1/s", "1/time", [](const auto& t) { return 1 / t.median; }}},
                      timing);
    table.add({"repetitions", "number of measurements, one in each round over all kernels", &R::repetitions});

    // Operations of the form.
    for (std::size_t k = 0; k < operation_names.size(); ++k) {
        const std::string name(operation_names[k]);
        table.add({"ops_" + name,
                   fmt::format("{} in one evaluation of the form on a hit, as it is written, with constants folded",
                               name == "add"      ? "additions and subtractions"
                               : name == "choose" ? "selects, minima and maxima"
                               : name == "sign"   ? "changes of sign, absolute values and copied signs"
                                                  : name + " operations"),
                   [k](const R& r) { return r.operations->counts[k]; }});
    }
    return table;
}

Table<ParetoRow> make_pareto_table() {
    using R = ParetoRow;

    // Columns of one outcome, and of one quantile of a metric.
    const auto fraction = [](Outcome o, const auto& denominator) {
        return or_missing([o, denominator](const R& r) {
            return measure::truth::fraction(r.accuracy->count(o), std::invoke(denominator, *r.accuracy));
        });
    };
    const auto quantile = [](const measure::metric::Distribution* R::*metric, double q) {
        return or_missing([metric, q](const R& r) { return (r.*metric)->quantile(q); });
    };

    Table<R> table{{"ray_set", "set of rays on which accuracy is measured", &R::ray_set}};
    table.add(kernel_columns(form_meaning), &R::kernel);
    table.add({// time
               {"time_ns", "ns",
                "median, per ray, where half of the rays hit as in the easy set and half miss; working set l1; for a "
                "scene, per ray and primitive of the scene",
                [](const R& r) { return r.quality.time_ns; }},

               // bits lost and kept
               {"rays", "number of rays in the set", [](const R& r) { return r.accuracy->ray_count; }},
               {"lost_bits_p50", "bits", "median over the correct hits", quantile(&R::lost_bits, 0.5)},
               {"lost_bits_p99", "bits", "99th percentile over the correct hits", quantile(&R::lost_bits, 0.99)},
               {"excess_bits_p99", "bits", "99th percentile of the bits lost beyond what the problem itself costs",
                quantile(&R::excess_bits, 0.99)},
               {"kept_bits_p99", "bits", "significand bits of the format minus lost_bits_p99",
                or_missing([](const R& r) { return r.quality.kept_bits; })},

               // wrong decisions
               {"false_hit_fraction", "1", "false hits among the rays that truly miss",
                fraction(Outcome::false_hit, &measure::evaluate::FormSummary::true_miss_count)},
               {"false_miss_fraction", "1", "false misses among the rays that truly hit",
                fraction(Outcome::false_miss, &measure::evaluate::FormSummary::true_hit_count)},
               {"wrong_fraction", "1",
                "share of false hits, false misses, NaNs and, for a scene, hits of another primitive, among all rays "
                "whose truth is known",
                [](const R& r) { return r.quality.wrong_fraction; }},

               // comparison with the other entries
               {"dominated",
                "true if another entry of the set is at least as fast and at least as accurate, and better in one of "
                "the two; the more accurate entry has the smaller wrong_fraction or, if these are equal, the greater "
                "kept_bits_p99",
                &R::is_dominated}});
    return table;
}

namespace {

const measure::metric::Distribution& find_metric_values(const TradeRequest& request,
                                                        const measure::evaluate::FormSummary& summary,
                                                        const char* name) {
    return summary.metrics[measure::metric::index_of(request.metrics, name)];
}

/// Sentences on how the times were measured.
std::string timing_text(const TradeRequest& request, const TradeResult& result) {
    if (!request.scene)
        return "Time per ray: half of the timed rays hit, like those of the set `easy`; the other half miss. The data "
               "fill half of the L1 cache (`l1`). The times are from this run, and vary from run to run.\n";
    const auto& timed = result.times.front().front();
    return fmt::format(
        "Time per ray and primitive: {} of the scene against {} of its primitives. The times are from this run, and "
        "vary from run to run.\n",
        text::count_with_noun(timed.ray_count, "ray"), timed.primitive_count);
}

KernelKey kernel_key(const TradeKernel& kernel) {
    return {kernel.measured.form->info->name, kernel.measured.format.name, kernel.isa};
}

std::string kernel_phrase(const TradeKernel& kernel) {
    const std::string width = kernel.isa == "scalar" ? "one ray at a time" : fmt::format("at {} bits", kernel.isa);
    return fmt::format("{} in {} {}", kernel.measured.form->info->name, kernel.measured.format.name, width);
}

}  // namespace

std::vector<ParetoPoint> pareto_points(const TradeRequest& request, const TradeResult& result, std::size_t set_index) {
    std::vector<ParetoPoint> points;
    const std::size_t load = measure::trade::reference_load(request.loads);
    for (std::size_t k = 0; k < request.kernels.size(); ++k) {
        points.push_back(measure::trade::make_pareto_point(result.times[k][load].timing, request.kernels[k].measured,
                                                           result.accuracy(set_index, k), request.metrics));
    }
    return points;
}

namespace {

/// Marker of the kernels with one register width.
struct KernelMarker {
    std::string_view isa;
    int marker;
    const char* label;
};
constexpr KernelMarker kernel_markers[] = {
    {"scalar", 0, "one ray at a time"}, {"128", 1, "128-bit registers"}, {"256", 2, "256-bit"}, {"512", 3, "512-bit"}};

bool has_marker(const TradeKernel& kernel, const KernelMarker& mark) { return kernel.isa == mark.isa; }

int marker_of(const TradeKernel& kernel) {
    const auto entry =
        std::ranges::find_if(kernel_markers, [&kernel](const KernelMarker& mark) { return has_marker(kernel, mark); });
    return entry == std::end(kernel_markers) ? 0 : entry->marker;
}

std::vector<ScatterPlotSpec::LegendEntry> make_legend_keys(const TradeRequest& request) {
    std::vector<ScatterPlotSpec::LegendEntry> keys;
    // The colours of the formats, and the markers of the register widths.
    for (const auto& [engine, name] : {std::pair{Format::Engine::native32, "f32"}, {Format::Engine::native64, "f64"}}) {
        const auto has_engine = [engine = engine](const TradeKernel& kernel) {
            return kernel.measured.format.engine == engine;
        };
        if (std::ranges::any_of(request.kernels, has_engine))
            keys.push_back({name, 0, colour_of(std::ranges::find_if(request.kernels, has_engine)->measured.format)});
    }
    for (const KernelMarker& mark : kernel_markers) {
        if (std::ranges::any_of(request.kernels,
                                [&mark](const TradeKernel& kernel) { return has_marker(kernel, mark); }))
            keys.push_back({mark.label, mark.marker, plot::ink_colour});
    }

    // Properties that any colour and marker can have.
    keys.push_back({.label = "decides some rays wrongly", .marker = 0, .colour = plot::ink_colour, .is_hollow = true});
    keys.push_back({.label = "not on the Pareto front", .marker = 0, .colour = 0, .is_faint = true});
    return keys;
}

/// Subtitle of a plot: the rays on which accuracy and time were measured.
std::string rays_text(const TradeRequest& request, const TradeResult& result, std::size_t set_index) {
    const auto& timed = result.times.front()[measure::trade::reference_load(request.loads)];
    const std::string repetition_text =
        fmt::format("median of {}, bars from quartile to quartile.",
                    text::count_with_noun(request.plan.repetitions, "interleaved repetition"));
    const std::uint64_t judged_ray_count = result.accuracy(set_index, 0).ray_count;
    if (request.scene)
        return fmt::format("Accuracy: {} of the scene. Time: {} of its rays against {} of its primitives; {}",
                           text::count_with_noun(judged_ray_count, "ray"), timed.ray_count, timed.primitive_count,
                           repetition_text);
    const auto sets = measure::trade::make_trade_sets(request);
    return fmt::format(
        "Accuracy: {} rays of the set {}. Time{}: rays like those of the set {}, {:.0f} KiB of them and of answers in "
        "the L1 cache, every other ray a hit; {}",
        judged_ray_count, sets[set_index].name, set_index == 0 ? "" : ", the same in the pictures of all sets",
        sets.front().name, static_cast<double>(timed.bytes) / 1024, repetition_text);
}

}  // namespace

std::string register_text(const TradeKernel& kernel) {
    return kernel.isa == "scalar" ? "one ray at a time" : fmt::format("{}-bit registers", kernel.isa);
}

ScatterPlotSpec make_trade_plot(const TradeRequest& request, const TradeResult& result, std::size_t set_index) {
    const auto qualities = pareto_points(request, result, set_index);
    const std::size_t load = measure::trade::reference_load(request.loads);
    ScatterPlotSpec spec;
    spec.title = fmt::format("Time against kept bits: {}", measure::trade::make_trade_sets(request)[set_index].title);
    spec.subtitle = {rays_text(request, result, set_index),
                     "Named: the Pareto front, and every form from outside lostbits. Fewer wrong decisions count "
                     "before more bits, so the front may step down to a form that is never wrong."};
    spec.x = {.title = request.scene ? scene_time_title : time_title,
              .scale = plot::AxisSpec::Scale::log2,
              .has_decimal_ticks = true};
    spec.y = {.title = kept_title};

    std::vector<KernelPoint> points;
    for (std::size_t k = 0; k < qualities.size(); ++k) {
        const TradeKernel& kernel = request.kernels[k];
        points.push_back({.tested_form = kernel.measured,
                          .quality = qualities[k],
                          .time = result.times[k][load].timing,
                          .marker = marker_of(kernel),
                          // A form from outside is always named, because its author looks for it.
                          .is_named = !map::is_in_catalogue(*kernel.measured.form->info),
                          .is_hollow = !qualities[k].never_wrong()});
    }
    add_kernel_points(spec, points);
    spec.legend = make_legend_keys(request);
    return spec;
}

namespace {

/// Table of the kernels on a set of rays by time. Each form and format is listed once, with its fastest register width.
std::string ranking_text(const TradeRequest& request, const TradeResult& result,
                         const std::vector<ParetoPoint>& qualities) {
    const auto is_dominated = measure::trade::find_dominated(qualities);
    const auto timing = [&](std::size_t k) {
        return result.times[k][measure::trade::reference_load(request.loads)].timing;
    };

    // Sort the kernels by time, and list each form and format at its first, fastest kernel.
    std::vector<std::size_t> order(qualities.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&qualities](std::size_t k) { return qualities[k].time_ns; });
    std::set<std::pair<std::string_view, std::string_view>> listed_forms;
    std::string text = fmt::format("    {:<28} {:<5} {:>9} {:>9} {:>6} {:>15} {:>8}\n", "form", "fmt", "registers",
                                   "ns", "+-", "bits kept (p99)", "wrong");
    for (const std::size_t k : order) {
        const auto [form, format, isa] = kernel_key(request.kernels[k]);
        if (!listed_forms.emplace(form, format).second) continue;

        const Timing t = timing(k);
        const double kept_bits = qualities[k].kept_bits;
        text += fmt::format(
            "  {} {:<28} {:<5} {:>9} {:>9.2f} {:>5.1f}% {:>15} {:>7.3g}%\n", is_dominated[k] ? ' ' : '*', form, format,
            isa, qualities[k].time_ns, 50 * (t.high_quartile - t.low_quartile) / t.median,
            std::isnan(kept_bits) ? "-" : file::kept_bits_text(kept_bits), 100 * qualities[k].wrong_fraction);
    }
    return text + "  * on the Pareto front; +-: half the distance between the quartiles\n";
}

/// The cheapest kernel for each number of bits; numbers of bits with the same answer share a line.
std::string cheapest_text(const TradeRequest& request, const std::vector<ParetoPoint>& qualities) {
    std::vector<std::pair<std::string, std::string>> lines;  // bits, answer
    for (const int bits : measure::trade::summary_bits) {
        const auto best = measure::trade::find_cheapest(qualities, bits);
        const std::string answer =
            best ? fmt::format("{}: {:.2f} ns", kernel_phrase(request.kernels[*best]), qualities[*best].time_ns)
                 : "none";
        if (!lines.empty() && lines.back().second == answer) lines.back().first += fmt::format(", {}", bits);
        else lines.emplace_back(std::to_string(bits), answer);
    }
    std::string text = "  cheapest form that is never wrong on this set and keeps at least\n";
    for (const auto& [bits, answer] : lines) text += fmt::format("    {} bits (p99): {}\n", bits, answer);
    return text;
}

}  // namespace

std::string trade_text(const TradeRequest& request, const TradeResult& result) {
    std::string text;
    const auto sets = measure::trade::make_trade_sets(request);
    for (std::size_t s = 0; s < sets.size(); ++s) {
        const auto qualities = pareto_points(request, result, s);
        text += fmt::format("{}: {}, {}\n", sets[s].name, sets[s].title,
                            text::count_with_noun(result.accuracy(s, 0).ray_count, "ray"));
        text += ranking_text(request, result, qualities) + cheapest_text(request, qualities) + "\n";
    }
    return text + timing_text(request, result);
}

TradeWriter::TradeWriter(const TradeRequest& request, const std::filesystem::path& folder)
    : request_(request),
      folder_(folder),
      times_(folder, "trade.csv",
             "One row per form, format, register width, working set and hit rate; times vary from run to run",
             make_time_table()),
      pareto_(folder, "pareto.csv",
              "One row per set of rays, form, format and register width; times vary from run to run",
              make_pareto_table()) {}

std::vector<TimeRow> make_time_rows(const TradeRequest& request, const TradeResult& result) {
    std::vector<TimeRow> rows;
    for (std::size_t k = 0; k < request.kernels.size(); ++k)
        for (std::size_t load = 0; load < request.loads.size(); ++load)
            rows.push_back({kernel_key(request.kernels[k]), &request.loads[load], &result.times[k][load],
                            request.plan.repetitions, &result.operations[k]});
    return rows;
}

std::vector<ParetoRow> make_pareto_rows(const TradeRequest& request, const TradeResult& result) {
    std::vector<ParetoRow> rows;
    const auto sets = measure::trade::make_trade_sets(request);
    for (std::size_t s = 0; s < sets.size(); ++s) {
        const auto qualities = pareto_points(request, result, s);
        const auto is_dominated = measure::trade::find_dominated(qualities);
        for (std::size_t k = 0; k < qualities.size(); ++k) {
            const measure::evaluate::FormSummary& accuracy = result.accuracy(s, k);
            rows.push_back({sets[s].name, kernel_key(request.kernels[k]), qualities[k], &accuracy,
                            &find_metric_values(request, accuracy, "lost_bits"),
                            &find_metric_values(request, accuracy, "excess_bits"), static_cast<bool>(is_dominated[k])});
        }
    }
    return rows;
}

void TradeWriter::finish(const TradeResult& result) {
    times_.add_all(make_time_rows(request_, result));
    pareto_.add_all(make_pareto_rows(request_, result));
    const auto sets = measure::trade::make_trade_sets(request_);
    for (std::size_t s = 0; s < sets.size(); ++s)
        image::save_figure(folder_ / fmt::format("{}.png", sets[s].name),
                           plot::draw_scatter_plot(make_trade_plot(request_, result, s)));

    file::write_file(folder_ / "trade.txt", trade_text(request_, result));
    table::close_tables(folder_,
                        request_.scene ? fmt::format("Speed against accuracy on {}", request_.scene->id)
                                       : fmt::format("Speed against accuracy of the {} forms",
                                                     shape_names[static_cast<std::size_t>(request_.shape)]),
                        times_, pareto_);
}

}  // namespace lostbits::output::trade
