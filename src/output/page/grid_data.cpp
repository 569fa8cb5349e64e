#include "output/page/grid_data.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "output/map/map_colour.hpp"
#include "output/page/sweep_data.hpp"
#include "output/page/text.hpp"
#include "output/sweep/case_files.hpp"
#include "output/sweep/sweep_planes.hpp"

namespace lostbits::output::page {

using measure::map::MapSummary;

namespace {

std::string rgb(const image::Rgb8& c) { return fmt::format("[{},{},{}]", c.r, c.g, c.b); }

/// What all grids need to be painted as the PNGs are: the scale of lost bits, and the paper that paler colours are
/// mixed with.
std::string paint_fields(const std::vector<measure::map::MapRow>& rows) {
    const image::ColourScale scale =
        map::metric_scale(*measure::metric::find_metric("lost_bits"), rows, image::image_backend());
    std::vector<std::string> ticks, names;
    for (const auto& tick : scale.ticks(7))
        ticks.push_back(fmt::format("[{},{}]", number(tick.position), json_text(tick.label)));
    for (const std::string_view s : sweep_statistics) names.push_back(json_text(s));
    return fmt::format(R"("scale":{{"lo":{},"hi":{},"log2":{},"ticks":[{}]}},"paper":{},"statistics":[{}])",
                       number(scale.lo()), number(scale.hi()), scale.is_log2(), fmt::join(ticks, ","),
                       rgb(image::style::page), fmt::join(names, ","));
}

std::string axis_json(const scene::sweep::Axis& axis, const std::vector<double>& values) {
    std::vector<std::string> all;
    for (const double v : values) all.push_back(number(v));
    return fmt::format(R"({{"name":{},"unit":{},"values":[{}]}})", json_text(axis.name), json_text(axis.unit),
                       fmt::join(all, ","));
}

}  // namespace

std::string plane_json(const measure::sweep::SweepRequest& request,
                       const std::vector<measure::sweep::SweepStep>& steps) {
    const sweep::Plane plane(request, steps);
    const std::size_t columns = plane.x.size();
    std::vector<std::string> rows;
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        const auto at = [&](std::size_t cell) -> const MapSummary& {
            return plane.at(r, cell % columns, cell / columns);
        };
        rows.push_back(
            fmt::format("{{{}}}", row_fields(request.rows[r], request.metrics, columns * plane.y.size(), at)));
    }
    const auto& axes = request.sweep->axes;
    return fmt::format(R"({{"id":{},"title":{},"kind":"plane","axes":[{},{}],{},"rows":[{}]}})",
                       json_text(request.sweep->id), json_text(request.sweep->title), axis_json(axes[0], plane.x),
                       axis_json(axes[1], plane.y), paint_fields(request.rows), fmt::join(rows, ","));
}

std::string case_json(const measure::sweep::CaseRequest& request, const std::vector<std::vector<MapSummary>>& cases) {
    const scene::sweep::CaseFile& file = *request.file;
    std::vector<std::string> names, conventions, rows;
    for (std::size_t i = 0; i < file.size(); ++i)
        names.push_back(fmt::format("[{},{}]", json_text(file.name(i)), json_text(file.note_of(i))));
    for (const auto& judged : file.conventions) conventions.push_back(json_text(intersect::convention_name(judged)));
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        std::vector<std::string> verdicts;
        for (const auto& each : cases)
            verdicts.push_back(json_text(measure::sweep::verdict_names[static_cast<std::size_t>(
                measure::sweep::verdict_of(each[r], request.metrics, file.right_within_bits))]));
        const auto at = [&](std::size_t cell) -> const MapSummary& { return cases[cell][r]; };
        rows.push_back(fmt::format(
            R"({{{},"judged":{},"verdicts":[{}]}})", row_fields(request.rows[r], request.metrics, cases.size(), at),
            json_text(intersect::convention_name(request.rows[r].judged)), fmt::join(verdicts, ",")));
    }
    return fmt::format(
        R"({{"id":{},"title":{},"kind":"cases","cases":[{}],"within":{},"right":{},"conventions":[{}],{},"rows":[{}]}})",
        json_text(file.id), json_text(file.title), fmt::join(names, ","), number(file.right_within_bits),
        rgb(sweep::case_right_colour), fmt::join(conventions, ","), paint_fields(request.rows), fmt::join(rows, ","));
}

}  // namespace lostbits::output::page
