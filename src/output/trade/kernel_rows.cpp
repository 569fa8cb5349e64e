// Columns that name and time a kernel, and the points of a plot of time against accuracy.
#include "output/trade/trade_files.hpp"

#include <algorithm>
#include <cmath>

#include "output/map/form_names.hpp"

namespace lostbits::output::trade {

table::Table<KernelKey> kernel_columns(const std::string& meaning_of_form) {
    return {{"form", meaning_of_form, &KernelKey::form},
            {"format", "format of the computation", &KernelKey::format},
            {"isa", "bits of the registers that hold rays side by side; scalar: one ray at a time", &KernelKey::isa}};
}

table::Table<Timing> time_columns(const std::string& median_meaning, const std::string& quartile_prefix) {
    return {{"time_ns", "ns", median_meaning, [](const Timing& timing) { return timing.median * 1e9; }},
            {"time_ns_q1", "ns", quartile_prefix + "first quartile",
             [](const Timing& timing) { return timing.low_quartile * 1e9; }},
            {"time_ns_q3", "ns", quartile_prefix + "third quartile",
             [](const Timing& timing) { return timing.high_quartile * 1e9; }}};
}

std::size_t colour_of(const Format& format) { return format.engine == Format::Engine::native64 ? 1 : 0; }

void add_kernel_points(plot::ScatterPlotSpec& spec, const std::vector<KernelPoint>& points) {
    std::vector<ParetoPoint> qualities;
    for (const KernelPoint& p : points) qualities.push_back(p.quality);
    const auto is_dominated = measure::trade::find_dominated(qualities);

    // A point for each kernel. Kernels that are neither on the front nor named are faint.
    std::vector<std::size_t> front_indices;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const KernelPoint& p = points[k];
        const bool has_label = !is_dominated[k] || p.is_named;
        spec.points.push_back({.x = p.quality.time_ns,
                               .y = p.quality.kept_bits,
                               .x_low = p.time ? p.time->low_quartile * 1e9 : p.quality.time_ns,
                               .x_high = p.time ? p.time->high_quartile * 1e9 : p.quality.time_ns,
                               .marker = p.marker,
                               .colour = colour_of(p.tested_form.format),
                               .is_faint = !has_label,
                               .is_hollow = p.is_hollow,
                               .label = !has_label        ? std::string()
                                        : p.label.empty() ? map::short_name(*p.tested_form.form->info)
                                                          : p.label,
                               .script_id = map::tested_form_name(p.tested_form) + " " + std::to_string(k)});
        if (!is_dominated[k] && !std::isnan(p.quality.kept_bits)) front_indices.push_back(k);
    }

    // The line of the front goes from fast to slow.
    std::ranges::stable_sort(front_indices, {}, [&points](std::size_t k) { return points[k].quality.time_ns; });
    for (const std::size_t k : front_indices)
        spec.pareto_front.push_back(
            {points[k].quality.time_ns, points[k].quality.kept_bits, points[k].quality.never_wrong()});
}

}  // namespace lostbits::output::trade
