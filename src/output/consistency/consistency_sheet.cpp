#include "output/consistency/consistency_sheet.hpp"

#include <fmt/format.h>

#include "output/map/row_names.hpp"

namespace lostbits::output::consistency {

using measure::consistency::Accord;
using measure::consistency::Check;
using measure::consistency::CheckSummary;
using measure::consistency::ConsistencyBand;
using measure::consistency::ConsistencyRequest;
using measure::consistency::RowChecks;

namespace {

AccordCounts every_class() {
    AccordCounts all;
    all.fill(1);
    return all;
}

image::SheetSpec sheet_spec(const ConsistencyRequest& request, const image::ColourScale& scale) {
    image::SheetSpec spec{
        .title = request.scene->title,
        .subtitle =
            {fmt::format("{}, {} x {} pixels: one question put in two ways, and whether a form answers both "
                         "alike",
                         request.scene->id, request.scene->width, request.scene->height),
             "shares are of the pixels of which both are asked; reverse and placed have on the ramp by how much "
             "more than the exact answers both chords, or both t, differ"},
        .forms = {},
        .formats = {},
        .field_width = request.scene->width,
        .field_height = request.scene->height,
        .scales = {scale},
        .unit = excess_unit,
        .legend = sheet_legend(every_class()),
        .categories = true};
    for (const Check* check : request.checks) spec.forms.emplace_back(check->name);
    for (const auto& row : request.rows)
        spec.formats.push_back(fmt::format("{} {}", map::short_name(*row.form->info), row.format.name));
    return spec;
}

std::string percent_of(std::uint64_t part, std::uint64_t whole) {
    const double share = 100 * measure::truth::fraction(part, whole);
    return share < 0.1 ? "<0.1%" : fmt::format("{:.1f}%", share);
}

std::string note_of(const Check& check, const CheckSummary& s) {
    if (s.asked() == 0) return "not asked";
    // Whether an end at the hit counts is a convention: yes everywhere is no difference.
    if (check.measure == measure::consistency::check_end) {
        const auto yes = s.of(Accord::second_alone);
        return yes == 0 ? "always no" : yes == s.asked() ? "always yes" : percent_of(yes, s.asked()) + " yes";
    }
    const char* const alike = s.excess.count() > 0 ? "decisions alike" : "all alike";
    std::string note = s.decisions() == 0 ? alike : percent_of(s.decisions(), s.asked()) + " differ";
    if (const auto inputs = s.of(Accord::by_inputs); inputs > 0 && !check.numbers)
        note += fmt::format("\n{} by inputs", percent_of(inputs, s.asked()));
    if (s.excess.count() > 0)
        note += fmt::format("\np99 {:.3g}, max {:.3g} ulps", s.excess.quantile(0.99), s.excess.quantile(1));
    else if (s.of(Accord::other_number) > 0)
        note += fmt::format("\n{} other bits", percent_of(s.of(Accord::other_number), s.asked()));
    return note;
}

}  // namespace

ConsistencySheet::ConsistencySheet(image::ImageBackend& backend, const std::filesystem::path& path,
                                   const ConsistencyRequest& request)
    : request_(request), scale_(excess_scale(backend)), shown_(request.rows.size()) {
    sheet_.emplace(backend, path, sheet_spec(request, scale_));
}

void ConsistencySheet::band(std::size_t row, const ConsistencyBand& band) {
    for (std::size_t c = 0; c < band.checks.size(); ++c) {
        const auto& pixels = band.checks[c];
        std::vector<image::Rgb8> field(pixels.accord.size());
        for (std::size_t i = 0; i < field.size(); ++i) {
            field[i] = colour_at(scale_, pixels, i);
            if (is_category(pixels, i)) ++shown_[row][static_cast<std::size_t>(pixels.accord[i])];
        }
        sheet_->add_rows(c, row, band.y0, field);
    }
}

void ConsistencySheet::finish(const std::vector<RowChecks>& rows) {
    AccordCounts shown{};
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t k = 0; k < shown.size(); ++k) shown[k] += shown_[r][k];
        for (std::size_t c = 0; c < rows[r].size(); ++c)
            sheet_->set_note(c, r, note_of(*request_.checks[c], rows[r][c]));
    }
    sheet_->finish(sheet_legend(shown));
}

}  // namespace lostbits::output::consistency
