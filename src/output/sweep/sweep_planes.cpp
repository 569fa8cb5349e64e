#include "output/sweep/sweep_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ranges>

#include "output/file/number_text.hpp"
#include "output/image/exr_book.hpp"
#include "output/map/map_colour.hpp"
#include "output/map/row_names.hpp"
#include "output/plot/cell_plots.hpp"

namespace lostbits::output::sweep {

using measure::answer::Outcome;
using measure::evaluate::FormSummary;
using measure::evaluate::TestedForm;
using measure::sweep::SweepRequest;
using measure::sweep::SweepStep;

namespace {

struct Layer {
    const char* name;
    std::function<float(const FormSummary&)> value;
};

std::vector<Layer> layers_of(const SweepRequest& request) {
    const auto quantile = [&](const char* metric, double q) {
        return [i = measure::metric::place_of(request.metrics, metric), q](const FormSummary& s) {
            return static_cast<float>(s.metrics[i].quantile(q));
        };
    };
    const auto share = [](Outcome o) {
        return [o](const FormSummary& s) {
            return static_cast<float>(static_cast<double>(s.count(o)) / static_cast<double>(s.rays));
        };
    };
    return {{"bits.lost_p50", quantile("lost_bits", 0.5)},
            {"bits.lost_p99", quantile("lost_bits", 0.99)},
            {"bits.lost_max", quantile("lost_bits", 1)},
            {"condition.inherent_p99", quantile("inherent_bits", 0.99)},
            {"condition.excess_p99", quantile("excess_bits", 0.99)},
            {"class.false_hit", share(Outcome::false_hit)},
            {"class.false_miss", share(Outcome::false_miss)},
            {"class.not_a_number", share(Outcome::not_a_number)}};
}

void write_exr(const std::filesystem::path& path, const SweepRequest& request, const SweepGrid& plane, std::size_t r) {
    const TestedForm& row = request.rows[r];
    image::ExrSpec spec;
    spec.width = static_cast<int>(plane.x.size());
    spec.height = static_cast<int>(plane.y.size());
    const auto layers = layers_of(request);
    for (const Layer& layer : layers) spec.channels.push_back({layer.name, image::Channel::Type::f32});
    const auto& axes = request.sweep.axes;
    spec.attributes = {{"lostbits:schema", "lostbits-plane/1"},
                       {"lostbits:sweep", request.sweep.id},
                       {"lostbits:form", std::string(row.form->info->name)},
                       {"lostbits:format", row.format.name},
                       {"lostbits:x", axes[0].name},
                       {"lostbits:x_values", file::listed(plane.x, file::decimal, " ")},
                       {"lostbits:y", axes[1].name},
                       {"lostbits:y_values", file::listed(std::views::reverse(plane.y), file::decimal, " ")}};
    std::vector<float> samples;
    for (std::size_t line = plane.y.size(); line-- > 0;) {
        for (std::size_t column = 0; column < plane.x.size(); ++column) {
            for (const Layer& layer : layers) samples.push_back(layer.value(plane.at(r, column, line)));
        }
    }
    image::ExrBook exr(path, {{"", spec}});
    exr.write_rows(0, 0, spec.height, std::as_bytes(std::span(samples)));
    exr.close();
}

}  // namespace

SweepGrid::SweepGrid(const SweepRequest& request, const std::vector<SweepStep>& steps)
    : x(request.sweep.axes[0].values),
      y(request.sweep.axes[1].values),
      steps_(steps),
      x_falls_(x.front() > x.back()),
      y_falls_(y.front() > y.back()) {
    if (x_falls_) std::ranges::reverse(x);
    if (y_falls_) std::ranges::reverse(y);
}

const FormSummary& SweepGrid::at(std::size_t row, std::size_t column, std::size_t line) const {
    const std::size_t i = x_falls_ ? x.size() - 1 - column : column, j = y_falls_ ? y.size() - 1 - line : line;
    return steps_[i * y.size() + j].rows[row];
}

void write_plane_picture(const std::filesystem::path& path, const SweepRequest& request,
                         const std::vector<SweepStep>& steps, std::size_t row) {
    const auto& axes = request.sweep.axes;
    const TestedForm& what = request.rows[row];
    const std::size_t lost = measure::metric::place_of(request.metrics, "lost_bits"),
                      excess = measure::metric::place_of(request.metrics, "excess_bits");
    const SweepGrid plane(request, steps);
    plot::PlanePlotSpec spec{
        .title = fmt::format("{} in {}: lost bits, p99", what.form->info->name, what.format.name),
        .subtitle = {request.sweep.title},
        .x_axis = plot_axis(axes[0]),
        .y_axis = plot_axis(axes[1]),
        .x = plane.x,
        .y = plane.y,
        .cells = {},
        .scale = map::metric_scale(*measure::metric::find_metric("lost_bits"), what.format.parameters),
        .unit = "lost bits",
        .legend = {}};
    FormSummary drawn;
    bool any_outlined = false, few = false;
    for (std::size_t line = 0; line < plane.y.size(); ++line) {
        for (std::size_t column = 0; column < plane.x.size(); ++column) {
            const FormSummary& s = plane.at(row, column, line);
            plot::PlaneCell cell;
            ++drawn.rays;
            if (wrong_share(s) <= 0.5) {
                cell.value = drawn_quantile(s, lost, 0.99);
                few |= s.true_hits > 0 && !s.agreement().is_enough();
                cell.outlined = cell.value >= 1 && s.metrics[excess].quantile(0.99) >= 1;
                any_outlined |= cell.outlined;
            } else {
                const Outcome worst = s.wrong().value();
                cell.colour = image::outcome_colours[static_cast<std::size_t>(worst)];
                ++drawn.outcomes[static_cast<std::size_t>(worst)];
            }
            spec.cells.push_back(cell);
        }
    }
    spec.legend = map::outcome_legend(drawn);
    spec.subtitle.push_back(std::string(any_outlined ? outlined_means : nowhere_outlined) + ".");
    if (few) spec.none_means = gap_means();
    plot::write_plane_plot(path, spec);
}

void write_plane(const std::filesystem::path& folder, const SweepRequest& request, const std::vector<SweepStep>& steps,
                 std::size_t row) {
    const std::string stem = map::row_name(request.rows[row]);
    write_plane_picture(folder / (stem + ".png"), request, steps, row);
    write_exr(folder / (stem + ".exr"), request, SweepGrid(request, steps), row);
}

}  // namespace lostbits::output::sweep
