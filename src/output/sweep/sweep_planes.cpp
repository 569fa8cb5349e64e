// Pictures, sheets and EXR files of sweeps over two axes.
#include "output/sweep/sweep_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <ranges>

#include "output/file/number_text.hpp"
#include "output/image/contact_sheet.hpp"
#include "output/image/exr_book.hpp"
#include "output/map/form_names.hpp"
#include "output/map/map_colour.hpp"
#include "output/pixel/look.hpp"
#include "output/plot/cell_plots.hpp"

namespace lostbits::output::sweep {

using measure::evaluate::TestedForm;

namespace {

struct Layer {
    const char* name;
    std::function<float(const FormSummary&)> value;
};

std::vector<Layer> make_layers(const SweepRequest& request) {
    const auto quantile = [&](const char* metric, double q) {
        return [i = measure::metric::index_of(request.metrics, metric), q](const FormSummary& summary) {
            return static_cast<float>(summary.metrics[i].quantile(q));
        };
    };
    const auto fraction = [](Outcome o) {
        return [o](const FormSummary& summary) {
            return static_cast<float>(static_cast<double>(summary.count(o)) / static_cast<double>(summary.ray_count));
        };
    };

    return {{"bits.lost_p50", quantile("lost_bits", 0.5)},
            {"bits.lost_p99", quantile("lost_bits", 0.99)},
            {"bits.lost_max", quantile("lost_bits", 1)},
            {"condition.inherent_p99", quantile("inherent_bits", 0.99)},
            {"condition.excess_p99", quantile("excess_bits", 0.99)},
            {"class.false_hit", fraction(Outcome::false_hit)},
            {"class.false_miss", fraction(Outcome::false_miss)},
            {"class.not_a_number", fraction(Outcome::not_a_number)}};
}

void write_exr(const std::filesystem::path& path, const SweepRequest& request, const SweepGrid& plane,
               std::size_t form_index) {
    const TestedForm& tested_form = request.tested_forms[form_index];
    image::ExrSpec spec;
    spec.width = static_cast<int>(plane.x.size());
    spec.height = static_cast<int>(plane.y.size());

    const auto layers = make_layers(request);
    for (const Layer& layer : layers) spec.channels.push_back({layer.name, image::Channel::Type::f32});
    const auto& axes = request.sweep.axes;
    spec.attributes = {{"lostbits:schema", "lostbits-plane/1"},
                       {"lostbits:sweep", request.sweep.id},
                       {"lostbits:form", std::string(tested_form.form->info->name)},
                       {"lostbits:format", tested_form.format.name},
                       {"lostbits:x", axes[0].name},
                       {"lostbits:x_values", file::number_list(plane.x, file::decimal, " ")},
                       {"lostbits:y", axes[1].name},
                       {"lostbits:y_values", file::number_list(std::views::reverse(plane.y), file::decimal, " ")}};

    // The rows of an EXR run from top to bottom, and y rises upwards.
    std::vector<float> samples;
    for (std::size_t line = plane.y.size(); line-- > 0;) {
        for (std::size_t column = 0; column < plane.x.size(); ++column) {
            for (const Layer& layer : layers) samples.push_back(layer.value(plane.at(form_index, column, line)));
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

const FormSummary& SweepGrid::at(std::size_t form_index, std::size_t x_index, std::size_t y_index) const {
    const std::size_t i = x_falls_ ? x.size() - 1 - x_index : x_index, j = y_falls_ ? y.size() - 1 - y_index : y_index;
    return steps_[i * y.size() + j].summaries[form_index];
}

namespace {

/// Counts of the cells that have the colour of an outcome because most of their rays are wrong.
struct CellCounts {
    std::array<std::uint64_t, measure::answer::outcome_names.size()> outcomes{};  ///< only wrong outcomes are counted
    std::uint64_t cells = 0;                                                      ///< number of all cells

    [[nodiscard]] std::uint64_t wrong_count() const {
        return std::accumulate(outcomes.begin(), outcomes.end(), std::uint64_t{0});
    }
};

/// The picture of a tested form (a form in a format) on a plane.
struct DrawnPlane {
    std::vector<plot::PlaneCell> cells = {};  ///< in the order of `PlanePlotSpec`
    std::vector<bool> is_explained = {};      ///< for each cell, see `map::is_inside_envelope`
    CellCounts counts = {};
    bool has_outlined_cells = false, has_withheld_cells = false;
};

DrawnPlane draw_plane(const SweepRequest& request, const SweepGrid& plane, std::size_t form_index) {
    const std::size_t lost_index = measure::metric::index_of(request.metrics, "lost_bits"),
                      excess_index = measure::metric::index_of(request.metrics, "excess_bits");
    DrawnPlane drawn;
    for (std::size_t line = 0; line < plane.y.size(); ++line) {
        for (std::size_t column = 0; column < plane.x.size(); ++column) {
            const FormSummary& s = plane.at(form_index, column, line);
            plot::PlaneCell cell;
            bool is_explained = false;
            ++drawn.counts.cells;

            // If most rays are wrong, the cell has the colour of the outcome; otherwise it shows the lost bits.
            if (wrong_fraction(s) <= 0.5) {
                cell.value = drawn_quantile(s, lost_index, 0.99);
                drawn.has_withheld_cells |= s.true_hit_count > 0 && !s.agreement().is_enough();
                const double excess_bits = s.metrics[excess_index].quantile(0.99);
                cell.is_outlined = cell.value >= 1 && excess_bits >= 1;
                is_explained = map::is_inside_envelope(cell.value, excess_bits);
                drawn.has_outlined_cells |= cell.is_outlined;
            } else {
                const Outcome worst_outcome = s.most_frequent_wrong_decision().value();
                cell.colour = pixel::colour_of(worst_outcome);
                ++drawn.counts.outcomes[static_cast<std::size_t>(worst_outcome)];
            }

            drawn.cells.push_back(cell);
            drawn.is_explained.push_back(is_explained);
        }
    }
    return drawn;
}

/// Colour of a cell without a value, the same as on other sheets for a correct hit without a value.
constexpr image::Rgb8 no_value_colour = image::outcome_colours[0];

/// Colours of the cells for a sheet, the top line first. Cells of a sheet are too small for outlines.
std::vector<image::Rgb8> sheet_colours(const DrawnPlane& drawn, std::size_t width, const map::LostBitsScale& scale,
                                       const FloatFormat& format) {
    std::vector<image::Rgb8> colours;
    for (std::size_t line = drawn.cells.size() / width; line-- > 0;) {
        for (std::size_t k = line * width; k < (line + 1) * width; ++k) {
            const plot::PlaneCell& cell = drawn.cells[k];
            const image::Rgb8 colour = cell.colour              ? *cell.colour
                                       : std::isnan(cell.value) ? no_value_colour
                                                                : scale.colour(cell.value, format);
            colours.push_back(drawn.is_explained[k] ? map::make_paler(colour) : colour);
        }
    }
    return colours;
}

/// Legend of a sheet of planes: the outcomes that any plane shows, and the colours that not every sheet has.
std::vector<image::LegendEntry> make_plane_sheet_legend(const std::vector<DrawnPlane>& planes,
                                                        const map::LostBitsScale& scale) {
    CellCounts total;
    bool has_gap = false;
    bool has_explained = false;
    for (const DrawnPlane& drawn : planes) {
        for (std::size_t o = 0; o < total.outcomes.size(); ++o) total.outcomes[o] += drawn.counts.outcomes[o];
        total.cells += drawn.counts.cells;
        has_gap |= std::ranges::any_of(drawn.cells, [](const auto& c) { return !c.colour && std::isnan(c.value); });
        has_explained |= std::ranges::find(drawn.is_explained, true) != drawn.is_explained.end();
    }

    std::vector<image::LegendEntry> legend = map::make_outcome_legend(total.outcomes, total.cells);
    for (image::LegendEntry& entry : legend) entry.count.clear();
    if (has_gap) legend.push_back({gap_text(), no_value_colour, ""});
    if (has_explained)
        legend.push_back({map::paler_colour_meaning, map::make_paler(scale.bar().colour_at_position(0.5)), ""});
    return legend;
}

/// `p99 3.2 to 11.7 bits`, and the number of steps that are mostly wrong.
std::string plane_note(const DrawnPlane& drawn) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const plot::PlaneCell& cell : drawn.cells) {
        if (cell.colour || std::isnan(cell.value)) continue;
        low = std::min(low, cell.value);
        high = std::max(high, cell.value);
    }
    std::string note = low <= high ? fmt::format("p99 {:.1f} to {:.1f} bits", low, high) : "no p99";
    if (const std::uint64_t wrong = drawn.counts.wrong_count())
        note += fmt::format("\n{} of {} steps mostly wrong", wrong, drawn.cells.size());
    return note;
}

}  // namespace

image::Canvas draw_plane_picture(const SweepRequest& request, const std::vector<SweepStep>& steps,
                                 std::size_t form_index) {
    const auto& axes = request.sweep.axes;
    const TestedForm& tested = request.tested_forms[form_index];
    const SweepGrid plane(request, steps);
    const DrawnPlane drawn = draw_plane(request, plane, form_index);
    return plot::draw_plane_plot(
        {.title = fmt::format("{} in {}: lost bits, p99", tested.form->info->name, tested.format.name),
         .subtitle = {request.sweep.title,
                      std::string(drawn.has_outlined_cells ? outline_meaning : no_outline_text) + "."},
         .x_axis = plot_axis(axes[0]),
         .y_axis = plot_axis(axes[1]),
         .x = plane.x,
         .y = plane.y,
         .cells = drawn.cells,
         .scale = map::metric_scale(*measure::metric::find_metric("lost_bits"), tested.format.parameters),
         .bar_label = "lost bits",
         .legend = map::make_outcome_legend(drawn.counts.outcomes, drawn.counts.cells),
         .hatching_meaning = drawn.has_withheld_cells ? gap_text() : "no value"});
}

void write_plane_sheet(const std::filesystem::path& path, const SweepRequest& request,
                       const std::vector<SweepStep>& steps) {
    const SweepGrid plane(request, steps);
    const map::LostBitsScale scale(request.tested_forms);
    const map::FormGrid grid(request.tested_forms);
    std::vector<DrawnPlane> planes;
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) planes.push_back(draw_plane(request, plane, r));

    // Open the sheet. Its subtitle names the axes and explains the colours.
    const auto axis_text = [](const scene::sweep::Axis& axis, const std::vector<double>& values) {
        return fmt::format("{}, from {} to {}", plot_axis(axis).title, file::short_decimal(values.front(), 3),
                           file::short_decimal(values.back(), 3));
    };
    const auto& axes = request.sweep.axes;
    image::ContactSheet sheet(
        path, {.title = request.sweep.title,
               .subtitle = {fmt::format("to the right: {}; upwards: {}", axis_text(axes[0], plane.x),
                                        axis_text(axes[1], plane.y)),
                            "colour: the most that 99 of 100 agreed hits lose; or, if most rays are wrong, the "
                            "most frequent wrong outcome"},
               .column_labels = grid.forms,
               .row_labels = grid.formats,
               .field_width = static_cast<int>(plane.x.size()),
               .field_height = static_cast<int>(plane.y.size()),
               .scales = {scale.bar()},
               .bar_label = scale.unit(),
               .note_lines = 2});

    for (std::size_t r = 0; r < planes.size(); ++r) {
        const auto& [form, format] = grid.cells[r];
        sheet.add_rows(form, format, 0,
                       sheet_colours(planes[r], plane.x.size(), scale, request.tested_forms[r].format.parameters));
        sheet.set_note(form, format, plane_note(planes[r]));
    }
    sheet.finish(make_plane_sheet_legend(planes, scale));
}

void write_planes(const std::filesystem::path& folder, const SweepRequest& request, const std::vector<SweepStep>& steps,
                  bool draws_single_pictures) {
    const SweepGrid plane(request, steps);
    write_plane_sheet(folder / "contact.png", request, steps);
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        const std::string file_stem = map::tested_form_name(request.tested_forms[r]);
        if (draws_single_pictures)
            image::save_figure(folder / (file_stem + ".png"), draw_plane_picture(request, steps, r));
        write_exr(folder / (file_stem + ".exr"), request, plane, r);
    }
}

}  // namespace lostbits::output::sweep
