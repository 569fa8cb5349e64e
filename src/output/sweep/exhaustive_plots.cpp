#include "output/sweep/exhaustive_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "measure/truth/lost_bits.hpp"
#include "measure/truth/missing.hpp"
#include "output/map/row_names.hpp"
#include "output/plot/line_plot.hpp"

namespace lostbits::output::sweep {

using measure::sweep::BinadePart;
using measure::sweep::ExhaustiveRequest;
using measure::sweep::ExhaustiveState;
using measure::sweep::FloatTally;

namespace {

/// A value of each binade.
using OfTally = std::function<double(const FloatTally&)>;

bool has_place(const BinadePart& part, bool negative) {
    return part.binade.kind == scene::sweep::Binade::Kind::normal && part.binade.negative == negative;
}

/// The binades of one sign, by rising exponent.
plot::Series series_of(const ExhaustiveRequest& request, const ExhaustiveState& state, std::size_t row, std::size_t ray,
                       bool negative, const OfTally& value) {
    plot::Series series{
        .label = map::short_name(*request.rows[row].form->info), .x = {}, .y = {}, .low = {}, .high = {}};
    if (request.sweep->rays.size() > 1) series.label += " (" + request.sweep->rays[ray].name + ")";
    if (negative) series.label += ", below 0";
    const auto binades = measure::sweep::binades_of(*request.sweep);
    for (std::size_t b = 0; b < binades.size(); ++b) {
        if (!has_place(binades[b], negative)) continue;
        series.x.push_back(std::ldexp(1.0, binades[b].binade.exponent));
        series.y.push_back(value(state.tallies[request.place(b, ray, row)]));
    }
    if (!series.x.empty() && series.x.front() > series.x.back()) {
        std::ranges::reverse(series.x);
        std::ranges::reverse(series.y);
    }
    return series;
}

void write_lines(const std::filesystem::path& path, const ExhaustiveRequest& request, const ExhaustiveState& state,
                 plot::LinePlotSpec spec, const OfTally& value) {
    const scene::sweep::ExhaustiveFile& sweep = *request.sweep;
    const std::string unit = sweep.axis_unit.empty() ? "" : fmt::format(" [{}]", sweep.axis_unit);
    spec.subtitle = {sweep.title, "every float of each binade was tried"};
    spec.x = {sweep.axis_name + unit + ", in size", plot::AxisSpec::Scale::log2, {}, {}};
    for (std::size_t row = 0; row < request.rows.size(); ++row) {
        for (std::size_t ray = 0; ray < sweep.rays.size(); ++ray) {
            for (const bool negative : {false, true}) {
                auto series = series_of(request, state, row, ray, negative, value);
                if (!series.x.empty()) spec.series.push_back(std::move(series));
            }
        }
    }
    plot::write_line_plot(image::image_backend(), path, spec);
}

}  // namespace

void write_exhaustive_plots(const std::filesystem::path& folder, const ExhaustiveRequest& request,
                            const ExhaustiveState& state) {
    const auto binades = measure::sweep::binades_of(*request.sweep);
    const auto most = [&](bool negative) {
        return std::ranges::count_if(binades, [&](const BinadePart& part) { return has_place(part, negative); });
    };
    if (std::max(most(false), most(true)) < 2) return;
    using S = plot::AxisSpec::Scale;
    const auto lost = [](const FloatTally& t) {
        return t.worst ? measure::truth::lost_bits(t.worst->ulps, binary32.precision) : measure::truth::missing;
    };
    write_lines(folder / "lost_bits_max.png", request, state,
                {.title = "Lost bits of the worst float in f32",
                 .subtitle = {},
                 .x = {},
                 .y = {"lost bits", S::linear, 0.0, static_cast<double>(binary32.precision)},
                 .series = {}},
                lost);
    const auto wrong = [](const FloatTally& t) { return measure::truth::fraction(t.wrong(), t.floats()); };
    write_lines(folder / "wrong.png", request, state,
                {.title = "Floats with the wrong answer in f32",
                 .subtitle = {},
                 .x = {},
                 .y = {"share of floats", S::linear, 0.0, 1.0},
                 .series = {}},
                wrong);
}

}  // namespace lostbits::output::sweep
