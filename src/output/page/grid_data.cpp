#include "output/page/grid_data.hpp"

#include "output/map/map_colour.hpp"
#include "output/page/sweep_data.hpp"
#include "output/sweep/case_files.hpp"
#include "output/sweep/sweep_plots.hpp"

namespace lostbits::output::page {

using measure::evaluate::FormSummary;

namespace {

/// What all grids need to be painted as the PNGs are: the scale of lost bits in each format, and the paper that paler
/// colours are mixed with.
void add_paint(Json& json, const std::vector<measure::evaluate::TestedForm>& rows) {
    for (const measure::evaluate::TestedForm& row : rows)
        json["scales"][row.format.name] = scale_json(
            map::metric_scale(*measure::metric::find_metric("lost_bits"), row.format.shape, image::image_backend()));
    json["paper"] = colour_json(image::style::page);
    json["gap_means"] = sweep::gap_means();
    json["statistics"] = sweep_statistics;
}

Json axis_json(const scene::sweep::Axis& axis, const std::vector<double>& values) {
    return {{"name", axis.name}, {"label", axis.label}, {"values", array_of(values, number_json)}};
}

}  // namespace

Json plane_json(const measure::sweep::SweepRequest& request, const std::vector<measure::sweep::SweepStep>& steps) {
    const sweep::SweepGrid plane(request, steps);
    const std::size_t columns = plane.x.size();
    const auto& axes = request.sweep->axes;
    Json json{{"id", request.sweep->id},
              {"title", request.sweep->title},
              {"kind", "plane"},
              {"is_drawn", request.sweep->is_drawn()},
              {"outlined_means", sweep::outlined_means},
              {"nowhere_outlined", sweep::nowhere_outlined},
              {"axes", Json::array({axis_json(axes[0], plane.x), axis_json(axes[1], plane.y)})}};
    add_paint(json, request.rows);
    Json& rows = json["rows"] = Json::array();
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        const auto at = [&](std::size_t cell) -> const FormSummary& {
            return plane.at(r, cell % columns, cell / columns);
        };
        rows.push_back(row_json(request.rows[r], request.metrics, columns * plane.y.size(), at));
    }
    return json;
}

Json case_json(const measure::sweep::CaseRequest& request, const std::vector<std::vector<FormSummary>>& cases) {
    const scene::sweep::CaseFile& file = *request.file;
    Json names = Json::array();
    for (std::size_t i = 0; i < file.size(); ++i) names.push_back(Json::array({file.name(i), file.note_of(i)}));
    Json json{{"id", file.id},
              {"title", file.title},
              {"kind", "cases"},
              {"cases", names},
              {"right_means", sweep::right_means(file)},
              {"within_means", sweep::within_means(file)},
              {"numbers_mean", sweep::numbers_mean},
              {"right", colour_json(sweep::case_right_colour)},
              {"conventions", array_of(file.conventions, intersect::convention_name)}};
    add_paint(json, request.rows);
    Json& rows = json["rows"] = Json::array();
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        const auto at = [&](std::size_t cell) -> const FormSummary& { return cases[cell][r]; };
        Json row = row_json(request.rows[r], request.metrics, cases.size(), at);
        const std::size_t inherent = measure::metric::place_of(request.metrics, "inherent_bits");
        row["inherent"] = array_of(cases, [&](const std::vector<FormSummary>& each) {
            return number_json(inherent < request.metrics.size() ? each[r].metrics[inherent].quantile(1)
                                                                 : measure::truth::missing);
        });
        row["judged"] = intersect::convention_name(request.rows[r].judged);
        row["verdicts"] = array_of(cases, [&](const std::vector<FormSummary>& each) {
            return measure::sweep::verdict_names[static_cast<std::size_t>(
                measure::sweep::verdict_of(each[r], request.metrics, file.right_within_bits))];
        });
        rows.push_back(std::move(row));
    }
    return json;
}

}  // namespace lostbits::output::page
