#include "output/speed/trade_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "output/map/row_names.hpp"
#include "output/speed/kernel_rows.hpp"
#include "output/speed/trade_files.hpp"

namespace lostbits::output::speed {

using measure::speed::TradeKernel;
using measure::speed::TradeRequest;
using plot::ScatterPlotSpec;

namespace {

/// How a kernel is drawn.
struct KernelMark {
    std::string_view isa, variant;
    int marker;
    const char* label;
};
constexpr KernelMark kernel_marks[] = {{"scalar", "", 0, "one ray at a time"},
                                       {"128", "", 1, "128-bit registers"},
                                       {"256", "", 2, "256-bit"},
                                       {"512", "", 3, "512-bit"},
                                       {"256", "contract", 4, "256-bit, contracted"},
                                       {"256", "fastmath", 5, "256-bit, fast math"}};

bool is_marked_so(const TradeKernel& kernel, const KernelMark& mark) {
    return kernel.isa == mark.isa && kernel.variant == mark.variant;
}

int marker_of(const TradeKernel& kernel) {
    const auto found =
        std::ranges::find_if(kernel_marks, [&kernel](const KernelMark& mark) { return is_marked_so(kernel, mark); });
    return found == std::end(kernel_marks) ? 0 : found->marker;
}

std::vector<ScatterPlotSpec::Key> keys_of(const TradeRequest& request) {
    std::vector<ScatterPlotSpec::Key> keys;
    for (const auto& [engine, name] : {std::pair{Format::Engine::native32, "f32"}, {Format::Engine::native64, "f64"}}) {
        const auto in = [engine = engine](const TradeKernel& k) { return k.measured.format.engine == engine; };
        if (std::ranges::any_of(request.kernels, in))
            keys.push_back({name, 0, colour_of(std::ranges::find_if(request.kernels, in)->measured.format)});
    }
    for (const KernelMark& mark : kernel_marks) {
        if (std::ranges::any_of(request.kernels, [&mark](const TradeKernel& k) { return is_marked_so(k, mark); }))
            keys.push_back({mark.label, mark.marker, plot::ink_colour});
    }
    keys.push_back({"decides some rays wrongly", 0, plot::ink_colour, false, true});
    keys.push_back({"not on the Pareto front", 0, 0, true});
    return keys;
}

/// Whose accuracy and whose time a picture shows.
std::string shown_rays(const TradeRequest& request, const measure::speed::TradeResult& result, std::size_t set) {
    const auto& timed = result.times.front()[measure::speed::standing_load(request.loads)];
    const std::string repeated =
        fmt::format("median of {} interleaved repetitions, bars from quartile to quartile.", request.plan.repetitions);
    const std::uint64_t judged = result.accuracy(set, 0).rays;
    if (request.scene)
        return fmt::format("Accuracy: {} rays of the scene. Time: {} of its rays against {} of its solids; {}", judged,
                           timed.rays, timed.solids, repeated);
    const auto sets = measure::speed::trade_sets(request);
    return fmt::format(
        "Accuracy: {} rays of the set {}. Time{}: rays as those of the set {}, {:.0f} KiB of them and "
        "of answers in the first cache, every other ray a hit; {}",
        judged, sets[set].name, set == 0 ? "" : ", the same in the pictures of all sets", sets.front().name,
        static_cast<double>(timed.bytes) / 1024, repeated);
}

}  // namespace

std::string registers_of(const TradeKernel& kernel) {
    return kernel.isa == "scalar" ? "one ray at a time" : fmt::format("{}-bit registers", kernel.isa);
}

ScatterPlotSpec trade_plot(const TradeRequest& request, const measure::speed::TradeResult& result, std::size_t set) {
    const auto all = pareto_points_of(request, result, set);
    const std::size_t load = measure::speed::standing_load(request.loads);
    ScatterPlotSpec spec;
    spec.title = fmt::format("Time against kept bits: {}", measure::speed::trade_sets(request)[set].title);
    spec.subtitle = {shown_rays(request, result, set),
                     "Named: the Pareto front, and every form that is not of lostbits. Fewer wrong decisions count "
                     "before more bits, so it may step down to a "
                     "form that is never wrong."};
    spec.x = {request.scene ? scene_time_title : time_title, plot::AxisSpec::Scale::log2, {}, {}, false, true};
    spec.y = {kept_title, plot::AxisSpec::Scale::linear, 0.0, {}};
    std::vector<FrontPoint> points;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const TradeKernel& kernel = request.kernels[k];
        points.push_back({.row = kernel.measured,
                          .worth = all[k],
                          .time = result.times[k][load].timing,
                          .marker = marker_of(kernel),
                          // One's own form is looked for wherever it is.
                          .named = !map::is_of_catalogue(*kernel.form),
                          .hollow = !all[k].never_wrong()});
    }
    add_front(spec, points);
    spec.keys = keys_of(request);
    return spec;
}

void write_trade_plot(const std::filesystem::path& path, const TradeRequest& request,
                      const measure::speed::TradeResult& result, std::size_t set) {
    plot::write_scatter_plot(image::image_backend(), path, trade_plot(request, result, set));
}

}  // namespace lostbits::output::speed
