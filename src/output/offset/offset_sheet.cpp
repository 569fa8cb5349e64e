#include "output/offset/offset_sheet.hpp"

#include <fmt/format.h>

#include <cmath>

#include "output/map/row_names.hpp"

namespace lostbits::output::offset {

using measure::offset::both_sides;
using measure::offset::OffsetBand;
using measure::offset::OffsetRequest;
using measure::offset::OffsetRow;
using measure::offset::OffsetSummary;
using measure::offset::Side;
using measure::offset::Strategy;

namespace {

/// The smallest safe offset and the strategies across; form, format, points and side down.
image::SheetSpec sheet_spec(const OffsetRequest& request, const image::ColourScale& scale) {
    image::SheetSpec spec{
        .title = request.scene->title,
        .subtitle = {fmt::format("{}, {} x {} pixels: what becomes of rays that leave the points that a form finds",
                                 request.scene->id, request.scene->width, request.scene->height),
                     "first the smallest safe offset, in ulps of the largest coordinate; then each strategy, with its "
                     "share of rays that go wrong"},
        .forms = {"smallest safe"},
        .formats = {},
        .field_width = request.scene->width,
        .field_height = request.scene->height,
        .scales = {scale},
        .unit = safe_unit,
        .legend = widest_shown_legend(request.scene->pixels()),
        .categories = true};
    const auto needed = widest_needed_legend(request.scene->pixels());
    spec.legend.insert(spec.legend.end(), needed.begin() + 1, needed.end());
    for (const Strategy* s : request.strategies) spec.forms.push_back(short_name(*s));
    for (const OffsetRow& row : request.rows) {
        for (const Side side : both_sides)
            spec.formats.push_back(fmt::format("{} {} {} {}", map::short_name(*row.row.form->info), row.row.format.name,
                                               name_of(row.point), name_of(side)));
    }
    return spec;
}

std::string percent(double share) {
    if (std::isnan(share)) return "-";
    return share > 0 && share < 0.001 ? "<0.1%" : fmt::format("{:.1f}%", 100 * share);
}

}  // namespace

std::string short_name(const Strategy& strategy) {
    return std::string(strategy.name.substr(strategy.name.find('.') + 1));
}

OffsetSheet::OffsetSheet(image::ImageBackend& backend, const std::filesystem::path& path, const OffsetRequest& request)
    : request_(request), scale_(safe_scale(backend)) {
    sheet_.emplace(backend, path, sheet_spec(request, scale_));
}

void OffsetSheet::band(std::size_t row, const OffsetBand& band) {
    std::vector<image::Rgb8> field(band.is_point.size());
    for (const Side side : both_sides) {
        const std::size_t line = 2 * row + static_cast<std::size_t>(side);
        for (std::size_t i = 0; i < field.size(); ++i) {
            field[i] = safe_colour(scale_, band, i, side);
            needed_[static_cast<std::size_t>(needed_of(band, i, side))] = true;
        }
        sheet_->add_rows(0, line, band.y0, field);
        for (std::size_t k = 0; k < band.strategies; ++k) {
            for (std::size_t i = 0; i < field.size(); ++i) {
                const Shown shown = shown_of(band, i, side, k);
                field[i] = colour_of(shown);
                shown_[static_cast<std::size_t>(shown)] = true;
            }
            sheet_->add_rows(k + 1, line, band.y0, field);
        }
    }
}

void OffsetSheet::add_notes(std::size_t line, const measure::offset::SideSummary& side) {
    if (side.safe.count() > 0)
        sheet_->set_note(
            0, line,
            fmt::format("p50 {:.3g}, max {:.3g}\n(world units)", side.safe.quantile(0.5), side.safe.quantile(1)));
    for (std::size_t k = 0; k < request_.strategies.size(); ++k) {
        const auto& of = side.strategies[k];
        const double bad = measure::truth::fraction(of.bad, side.rays), much = of.oversize.quantile(0.5);
        std::string note = bad == 0 ? "every ray right" : percent(bad) + " of rays wrong";
        if (much > 0) note += fmt::format("\n{:.3g} x needed", much);
        sheet_->set_note(k + 1, line, note);
    }
}

void OffsetSheet::finish(const std::vector<OffsetSummary>& summaries) {
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        for (const Side side : both_sides) add_notes(2 * r + static_cast<std::size_t>(side), summaries[r].on(side));
    }
    std::vector<image::LegendEntry> legend;
    const auto shown = widest_shown_legend(0), needed = widest_needed_legend(0);
    for (std::size_t k = 0; k < shown.size(); ++k) {
        if (shown_[k]) legend.push_back({shown[k].label, shown[k].colour, ""});
    }
    for (std::size_t k = 1; k < needed.size(); ++k) {
        if (needed_[k]) legend.push_back({needed[k].label, needed[k].colour, ""});
    }
    sheet_->finish(legend);
}

}  // namespace lostbits::output::offset
