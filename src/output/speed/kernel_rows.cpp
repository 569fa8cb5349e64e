// Columns that name and time a kernel, and the points of the plane of time and accuracy.
#include "output/speed/trade_files.hpp"

#include <algorithm>
#include <cmath>

#include "output/map/row_names.hpp"

namespace lostbits::output::speed {

table::Table<KernelKey> kernel_columns(const std::string& form) {
    return {{"form", form, &KernelKey::form},
            {"format", "format of the computation", &KernelKey::format},
            {"isa", "bits of the registers that hold rays side by side; scalar: one ray at a time", &KernelKey::isa}};
}

table::Table<Timing> time_columns(const std::string& median, const std::string& quartiles_of) {
    return {
        {"time_ns", "ns", median, [](const Timing& t) { return t.median * 1e9; }},
        {"time_ns_q1", "ns", quartiles_of + "first quartile", [](const Timing& t) { return t.low_quartile * 1e9; }},
        {"time_ns_q3", "ns", quartiles_of + "third quartile", [](const Timing& t) { return t.high_quartile * 1e9; }}};
}

std::size_t colour_of(const Format& format) { return format.engine == Format::Engine::native64 ? 1 : 0; }

void add_front(plot::ScatterPlotSpec& spec, const std::vector<FrontPoint>& points) {
    std::vector<ParetoPoint> qualities;
    for (const FrontPoint& p : points) qualities.push_back(p.quality);
    const auto is_dominated = measure::speed::find_dominated(qualities);
    std::vector<std::size_t> front;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const FrontPoint& p = points[k];
        const bool is_named = !is_dominated[k] || p.named;
        spec.points.push_back({.x = p.quality.time_ns,
                               .y = p.quality.kept_bits,
                               .x_low = p.time ? p.time->low_quartile * 1e9 : p.quality.time_ns,
                               .x_high = p.time ? p.time->high_quartile * 1e9 : p.quality.time_ns,
                               .marker = p.marker,
                               .colour = colour_of(p.row.format),
                               .faint = !is_named,
                               .hollow = p.hollow,
                               .label = !is_named         ? std::string()
                                        : p.label.empty() ? map::short_name(*p.row.form->info)
                                                          : p.label,
                               .key = map::row_name(p.row) + " " + std::to_string(k)});
        if (!is_dominated[k] && !std::isnan(p.quality.kept_bits)) front.push_back(k);
    }
    std::ranges::stable_sort(front, {}, [&points](std::size_t k) { return points[k].quality.time_ns; });
    for (const std::size_t k : front)
        spec.front.push_back({points[k].quality.time_ns, points[k].quality.kept_bits, points[k].quality.never_wrong()});
}

}  // namespace lostbits::output::speed
