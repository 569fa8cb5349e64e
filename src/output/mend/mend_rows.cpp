#include "output/mend/mend_rows.hpp"

#include <fmt/format.h>

#include <cmath>

#include "output/choice/choice_text.hpp"
#include "output/map/row_names.hpp"
#include "output/speed/kernel_rows.hpp"

namespace lostbits::output::mend {

using measure::mend::Worth;
using measure::speed::ParetoPoint;

namespace {

/// A row in the plane of bits and time, or of bits and wider operations.
ParetoPoint point_of(const FormRow& row) {
    return {row.price ? row.price->packed.median * 1e9 : static_cast<double>(row.wide), row.worth->wrong_fraction(),
            row.worth->kept_bits};
}

std::string bits_of(const Worth& worth, const measure::choice::Wish& wish) {
    return std::isnan(worth.kept_bits) ? "no" : choice::bits_beside(worth.kept_bits, wish);
}

int marker_of(const FormRow& row) {
    return row.kind == "catalogue" ? 0 : row.kind == "own" ? 3 : row.kind == "rewritten" ? 2 : 1;
}

}  // namespace

std::vector<FormRow> rows_of(const MendResult& r) {
    const auto& m = r.mended;
    const auto& own = r.request.row;
    const std::string wider = name_of_wider(m.wider);
    std::vector<FormRow> rows{{"own", std::string(own.form->info->name), own, m.operations, 0, &m.own, &m.own_apart}};
    if (r.has_set()) {
        const std::size_t wide = m.set->operations.size();
        const std::string name = fmt::format("{} of {} in {}", wide, m.operations, wider);
        rows.push_back({"wider", name, own, m.operations, wide, &m.set->worth, &m.apart_worth});
    }
    rows.push_back({"all_wider", fmt::format("all {} in {}", m.operations, wider), own, m.operations, m.operations,
                    &m.all, m.set ? nullptr : &m.apart_worth});
    for (const auto& one : m.rewriting.found) {
        const std::string rules = rules_of(one);
        rows.push_back({"rewritten", rules, own, one.operations, one.set ? one.set->operations.size() : 0, &one.worth,
                        &one.apart, rules});
    }
    for (FormRow& row : rows) row.wider = row.wide == 0 ? "" : wider;
    const std::size_t first = rows.size();
    for (std::size_t k = 0; k < r.catalogue.size(); ++k)
        rows.push_back({.kind = "catalogue",
                        .name = std::string(r.catalogue[k].form->info->name),
                        .row = r.catalogue[k],
                        .worth = &r.catalogue_worth[k]});
    for (FormRow& row : rows) row.meets = row.worth->meets(r.request.wish);
    std::vector<FormRow*> timed;
    std::vector<ParetoPoint> points;
    for (FormRow& row : rows) {
        if (timed.size() == r.prices.size() || row.kind == "all_wider") continue;
        row.price = &r.prices[timed.size()];
        timed.push_back(&row);
        points.push_back(point_of(row));
    }
    const auto beaten = dominated(points);
    for (std::size_t k = 0; k < timed.size(); ++k) timed[k]->front = !beaten[k];
    for (std::size_t k = first; k < rows.size(); ++k)
        rows[k].told = (rows[k].front || k == first) && rows[k].row.form != own.form;
    return rows;
}

std::string change_in_words(const MendResult& r, const FormRow& row) {
    const Worth &was = r.mended.own, &now = *row.worth;
    const auto& wish = r.request.wish;
    std::string text = fmt::format(
        "{}: {} → {} bits, {}",
        row.kind == "wider" ? fmt::format("{} in {}", names_of_set(r), name_of_wider(r.mended.wider)) : row.name,
        bits_of(was, wish), bits_of(now, wish),
        now.wrong == 0 ? "no wrong decision" : fmt::format("{} wrong decisions", now.wrong));
    if (was.wrong != now.wrong) text += fmt::format(" in place of {}", was.wrong);
    if (row.price)
        text += fmt::format(", {:+.2g} ns a ray", (row.price->packed.median - r.prices.front().packed.median) * 1e9);
    return text;
}

void write_front_plot(const std::filesystem::path& path, const MendResult& r) {
    const auto& wish = r.request.wish;
    const bool timed = !r.prices.empty();
    plot::ScatterPlotSpec spec;
    spec.title = fmt::format("{} against kept bits: {} on {}", timed ? "Time" : "Wider operations",
                             r.request.row.form->info->name, r.request.id());
    spec.subtitle = {
        fmt::format("Wished: {}.", choice::in_words(wish)),
        "Named: the form, what came of it, and the Pareto front, where fewer wrong decisions count before "
        "more bits." +
            (timed ? std::string() : " Of the catalogue: forms in " + r.request.row.format.name + " alone.")};
    if (timed) spec.x = {"time per ray and solid in packs, ns", plot::AxisSpec::Scale::log2, {}, {}, false, true};
    else spec.x = {"operations in " + name_of_wider(r.mended.wider), plot::AxisSpec::Scale::linear, 0.0, {}};
    spec.y = {"bits kept", plot::AxisSpec::Scale::linear, {}, {}};
    const std::vector<FormRow> rows = rows_of(r);
    std::vector<speed::FrontPoint> points;
    for (const FormRow& row : rows) {
        const bool is_own = row.kind != "catalogue";
        // How many operations a form of the catalogue does wider by itself is not counted.
        const bool has_place =
            timed ? row.price != nullptr : is_own || measure::choice::computes_in(row.row).name == row.row.format.name;
        if (!has_place || (!is_own && row.row.form == r.request.row.form)) continue;
        points.push_back({.row = row.row,
                          .worth = point_of(row),
                          .time = row.price ? std::optional(row.price->packed) : std::nullopt,
                          .marker = marker_of(row),
                          .named = is_own,
                          .hollow = !row.worth->decides(wish),
                          .label = is_own ? row.name : map::short_name(*row.row.form->info)});
    }
    speed::add_front(spec, points);
    spec.keys = {{"the form", 3, plot::ink_colour},
                 {"operations in " + name_of_wider(r.mended.wider), 1, plot::ink_colour},
                 {"written another way", 2, plot::ink_colour},
                 {"catalogue", 0, plot::ink_colour},
                 {"decides more rays wrongly than wished", 0, plot::ink_colour, false, true},
                 {"not on the Pareto front", 0, 0, true}};
    plot::write_scatter_plot(image::image_backend(), path, spec);
}

}  // namespace lostbits::output::mend
