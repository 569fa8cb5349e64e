// Draws the pictures of a map.
#include "output/map/map_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "output/attribution/explain_command.hpp"
#include "output/file/number_text.hpp"
#include "output/map/finding.hpp"
#include "output/map/form_names.hpp"
#include "output/map/map_files.hpp"

namespace lostbits::output::map {
namespace {

/// Largest number of pixels that are kept for a cell of a sheet that zooms in on its worst pixel.
constexpr std::uint64_t max_kept_pixels = std::uint64_t{512} * 512;

std::size_t index_of(const std::vector<const Metric*>& metrics, const Metric* metric) {
    return static_cast<std::size_t>(std::ranges::find(metrics, metric) - metrics.begin());
}

/// `contribution.c`: name of a metric for a file, without colons.
std::string file_name_part(const Metric& metric) {
    std::string name(metric.name);
    std::ranges::replace(name, ':', '.');
    return name;
}

/// Groups the drawn metrics into sheets: metrics that can share a colour bar share a sheet.
std::vector<MapSheet> group_into_sheets(const MapStudy& study, const MapFilesOptions& options) {
    std::vector<MapSheet> sheets;
    for (const Metric* m : options.drawn_metrics) {
        const auto applies = [m](const TestedForm& tested_form) {
            return MetricPaint(*m, tested_form.format.parameters).applies_to(tested_form);
        };
        const auto first = std::ranges::find_if(study.tested_forms, applies);
        if (first == study.tested_forms.end()) continue;
        const auto sheet =
            std::ranges::find_if(sheets, [m](const MapSheet& sheet) { return sheet.paint.shares_bar_with(*m); });
        if (sheet != sheets.end()) sheet->metrics.push_back(m);
        else sheets.push_back({MetricPaint(*m, first->format.parameters, options.range), {m}});
    }
    return sheets;
}

}  // namespace

MapPictures::MapPictures(const MapStudy& study, const MapFilesOptions& options)
    : study_(study),
      options_(options),
      lost_bits_index_(index_of(study.metrics, measure::metric::find_metric("lost_bits"))),
      excess_index_(index_of(study.metrics, measure::metric::find_metric("excess_bits"))),
      sheets_(group_into_sheets(study, options)),
      files_{describe_files(), make_columns()} {}

pixel::PictureFiles MapPictures::describe_files() {
    std::vector<pixel::SheetFile> files;
    for (MapSheet& sheet : sheets_) files.push_back(describe_sheet(sheet));
    return {.scene = *study_.scene,
            .sheets = std::move(files),
            .single_picture_folder = options_.draws_single_pictures ? options_.folder : "",
            .stop = study_.limit.stop,
            .opens_files = !options_.keep_piece};
}

pixel::SheetFile MapPictures::describe_sheet(MapSheet& sheet) const {
    // Find the forms and lines that have pictures, and the scale of each line.
    std::vector<image::ColourScale> scales;
    for (const TestedForm& tested_form : study_.tested_forms) {
        if (!sheet.paint.applies_to(tested_form)) continue;
        static_cast<void>(find_or_add(sheet.forms, short_name(*tested_form.form->info)));
        for (const Metric* m : sheet.metrics) {
            if (find_or_add(sheet.lines, sheet.line_name(tested_form, *m)) < scales.size() || !sheet.paint.scale())
                continue;
            scales.push_back(metric_scale(*m, tested_form.format.parameters, options_.range));
        }
    }

    // Lines with equal scales share a bar. The sheet of a claim shows a bar for each line.
    const auto differs = [&scales](const image::ColourScale& s) { return !s.is_same_scale(scales.front()); };
    const bool is_only_file = !options_.sheet_only_file.empty();
    const bool has_several_bars = is_only_file ? scales.size() > 1 : std::ranges::any_of(scales, differs);
    if (!scales.empty() && !has_several_bars) scales.resize(1, scales.front());

    // The first sheet is contact.png; the others are named after their first metric.
    const std::string name = &sheet == sheets_.data()
                                 ? "contact.png"
                                 : fmt::format("contact.{}.png", file_name_part(*sheet.metrics.front()));
    const scene::file::Scene& scene = *study_.scene;
    const auto described_rows = options_.is_list ? std::span<const TestedForm>() : study_.tested_forms;
    return {is_only_file ? options_.sheet_only_file : options_.folder / name,
            {.title = scene.title,
             .subtitle = sheet_subtitle({scene, options_.scene_arguments, described_rows, sheet.paint, has_several_bars,
                                         zooms(sheet.paint),
                                         &sheet == sheets_.data() ? options_.sheet_with_explanations : "contact"}),
             .column_labels = sheet.forms,
             .row_labels = sheet.lines,
             .scales = std::move(scales),
             .bar_label = is_only_file ? "lost bits" : std::string(sheet.paint.metric().unit),
             .shows_categories = !sheet.paint.scale(),
             .note_lines = cell_note_lines,
             .collapses = !is_only_file,
             .zooms = zooms(sheet.paint)}};
}

bool MapPictures::zooms(const MetricPaint& paint) const {
    return study_.scene->mesh != nullptr && paint.names_worst_ray() && options_.sheet_only_file.empty() &&
           !options_.is_list && study_.scene->pixel_count() <= max_kept_pixels;
}

/// Makes the columns form by form, in the order in which they are drawn.
std::vector<MapPictures::Column> MapPictures::make_columns() {
    std::vector<Column> columns;
    for (std::size_t r = 0; r < study_.tested_forms.size(); ++r) {
        const TestedForm& tested_form = study_.tested_forms[r];
        for (const Metric* m : options_.drawn_metrics) {
            const auto paint = std::make_shared<const MetricPaint>(*m, tested_form.format.parameters, options_.range);
            if (!paint->applies_to(tested_form)) continue;

            const auto sheet = std::ranges::find_if(sheets_, [m](const MapSheet& sheet) {
                return std::ranges::find(sheet.metrics, m) != sheet.metrics.end();
            });
            const pixel::SheetPosition position{find_or_add(sheet->forms, short_name(*tested_form.form->info)),
                                                find_or_add(sheet->lines, sheet->line_name(tested_form, *m)),
                                                static_cast<std::size_t>(sheet - sheets_.begin())};
            drawings_.push_back({r, index_of(study_.metrics, m), paint, position});
            columns.push_back(make_column(drawings_.back()));
        }
    }
    return columns;
}

MapPictures::Column MapPictures::make_column(const Drawing& drawing) const {
    const scene::file::Scene& scene = *study_.scene;
    const TestedForm& tested_form = study_.tested_forms[drawing.form_index];
    const Metric& m = drawing.paint->metric();
    pixel::ColumnSpec spec{
        .file = tested_form_name(tested_form) + (options_.drawn_metrics.size() == 1 ? "" : "." + file_name_part(m)) +
                ".png",
        .title = fmt::format("{} in {}: {}{}", tested_form.form->info->name, tested_form.format.name, m.name,
                             m.domain == measure::metric::MetricDomain::pairs
                                 ? fmt::format(" {}", tested_form.against->info->name)
                                 : ""),
        .subtitle = {title_of(*tested_form.form->info), drawing.paint->note()},
        .look = std::make_shared<const pixel::Look>(make_look(drawing)),
        .sheet_positions = {drawing.position},
        .widest_caption = drawing.paint->widest_caption(scene.pixel_count()) +
                          worst_pixel_text(drawing, {.x = scene.width, .y = scene.height})};
    if (std::string note = input_note(scene, std::span(&tested_form, 1)); !note.empty() && !options_.is_list)
        spec.subtitle.push_back(std::move(note));

    const auto pixel_of = [paint = drawing.paint, metric = drawing.metric_index](const BandResult& band,
                                                                                 std::size_t i) {
        return paint->pixel(band.outcomes[i], band.metrics[metric][i]);
    };
    if (!draws_envelope_of(m))
        return {std::move(spec), drawing.form_index, pixel::make_draw_function<BandResult>(pixel_of)};

    // Pixels that the problem explains are paler.
    const auto paler_pixel_of = [pixel_of, look = spec.look, lost = lost_bits_index_, excess = excess_index_](
                                    const BandResult& band, std::size_t i) {
        const pixel::PixelValue pixel = pixel_of(band, i);
        // A NaN, which is an undefined metric, is never inside the envelope.
        if (!is_inside_envelope(band.metrics[lost][i], band.metrics[excess][i])) return pixel;
        return pixel::PixelValue{.category = look->categories.size() - 1, .colour = make_paler(look->colour(pixel))};
    };
    return {std::move(spec), drawing.form_index, pixel::make_draw_function<BandResult>(paler_pixel_of)};
}

pixel::Look MapPictures::make_look(const Drawing& drawing) const {
    pixel::Look look = drawing.paint->look(study_.scene->mesh != nullptr);
    look.unit = drawing.paint->metric().unit;
    if (!options_.sheet_only_file.empty()) look.categories[drawing.paint->index_of(Outcome::agree_hit)].name.clear();
    if (draws_envelope_of(drawing.paint->metric()))
        look.categories.push_back(
            {paler_colour_meaning, make_paler(look.scale->colour_of_value(look.scale->hi() / 2))});
    return look;
}

bool MapPictures::draws_envelope_of(const Metric& metric) const {
    return options_.draws_envelope && &metric == measure::metric::find_metric("lost_bits");
}

/// Names the worst pixel, as in `; worst pixel 100,90: lostbits explain near-benign --pixel 100,90 -i sphere.press -f
/// f32`. Leaves the command out for a compiled form, which cannot be explained, and for rays of a file, which have no
/// scene.
std::string MapPictures::worst_pixel_text(const Drawing& drawing, const measure::evaluate::WorstRay& worst) const {
    if (!drawing.paint->names_worst_ray()) return "";
    const TestedForm& tested_form = study_.tested_forms[drawing.form_index];
    const std::string text = fmt::format("; worst pixel {},{}", worst.x, worst.y);
    if (!tested_form.form->record || options_.scene_arguments.empty()) return text;
    return text + ": " +
           attribution::explain_command(
               attribution::explain_pixel_arguments(options_.scene_arguments, static_cast<int>(worst.x), worst.y),
               tested_form);
}

pixel::FinishedSheet MapPictures::describe_finished_sheet(std::size_t sheet,
                                                          const std::vector<FormSummary>& summaries) const {
    std::vector<SheetCell> cells;
    bool nothing_hit = options_.sheet_only_file.empty();
    for (const Drawing& drawing : drawings_) {
        if (drawing.position.sheet != sheet) continue;
        const FormSummary& summary = summaries[drawing.form_index];
        cells.push_back({drawing.position.across, &summary});
        nothing_hit &= summary.count(Outcome::agree_miss) == summary.ray_count;
    }

    // The sheet of a claim needs no headline, because it stands below the claim's sentence.
    const bool has_headline = options_.sheet_only_file.empty() && sheets_[sheet].paint.metric().name == "lost_bits";
    return {best_first(sheets_[sheet].forms.size(), cells, lost_bits_index_),
            nothing_hit ? ": no ray hits anything" : "", has_headline ? finding_text(study_, summaries) : ""};
}

void MapPictures::finish(const std::vector<FormSummary>& summaries) {
    // Texts and zooms of the cells.
    for (std::size_t c = 0; c < drawings_.size(); ++c) {
        const Drawing& drawing = drawings_[c];
        const measure::evaluate::WorstRay* const worst = summaries[drawing.form_index].worst_ray();
        files_.writer().set_caption(c, drawing.paint->caption(summaries[drawing.form_index], drawing.metric_index) +
                                           (worst ? worst_pixel_text(drawing, *worst) : ""));
        files_.writer().set_note(drawing.position,
                                 cell_note(*drawing.paint, summaries[drawing.form_index], drawing.metric_index));
        if (worst && zooms(*drawing.paint))
            files_.writer().set_zoom(drawing.position, static_cast<int>(worst->x), worst->y);
    }

    std::vector<pixel::FinishedSheet> ends;
    for (std::size_t s = 0; s < sheets_.size(); ++s) ends.push_back(describe_finished_sheet(s, summaries));
    files_.writer().finish(ends);
}

std::string input_note(const scene::file::Scene& scene, std::span<const TestedForm> tested_forms) {
    if (scene.inputs == scene::file::InputRounding::own)
        return "each format rounds the ideal scene itself, and errors include that rounding (metric input_error)";
    std::vector<std::string> narrow_formats;
    for (const TestedForm& tested_form : tested_forms) {
        if (!holds_shared_inputs(tested_form.format.parameters))
            static_cast<void>(find_or_add(narrow_formats, tested_form.format.name));
    }
    if (narrow_formats.empty()) return "";
    return fmt::format("in {} the inputs are rounded too, and errors include that rounding (metric input_error)",
                       file::word_list(narrow_formats));
}

namespace {

/// Lines that explain the order of the forms and the worst pixels of a sheet.
std::vector<std::string> explanations(const SheetSubject& sheet) {
    std::vector<std::string> lines;
    if (!sheet.tested_forms.empty())
        lines.push_back(
            fmt::format("order of forms: fewest wrong decisions in {} first, then the smallest p99 of lost bits",
                        sheet.tested_forms.front().format.name));
    if (sheet.paint.names_worst_ray())
        lines.push_back(
            sheet.scene_arguments.empty()
                ? "worst pixel: summary.csv has the command that explains its ray, in the column worst_explain"
                : fmt::format("worst pixel X,Y: lostbits explain {} --pixel X,Y -i FORM -f FORMAT{} shows how its "
                              "answer came about{}",
                              sheet.scene_arguments, attribution::plugin_options(),
                              sheet.zooms ? "; the inset enlarges its surroundings" : ""));
    return lines;
}

}  // namespace

std::vector<std::string> sheet_subtitle(const SheetSubject& sheet) {
    const auto& [scene, scene_arguments, rows, paint, has_several_bars, zooms, sheet_with_explanations] = sheet;
    std::vector<std::string> lines{fmt::format("{}, {} x {} rays{}", scene.id, scene.width, scene.height,
                                               paint.metric().depends_on_forms ? "" : "; percentages are of all rays"),
                                   paint.note(has_several_bars),
                                   sheet_with_explanations.empty() ? paint.quantile_note() : "",
                                   rows.empty() ? "" : input_note(scene, rows)};

    // Only one sheet of a run explains its texts; the others refer to it.
    if (!sheet_with_explanations.empty())
        lines.push_back(
            fmt::format("p99, the order of forms and worst pixels: as explained in {}", sheet_with_explanations));
    else
        for (std::string& line : explanations(sheet)) lines.push_back(std::move(line));
    std::erase(lines, "");
    return lines;
}

std::string cell_note(const MetricPaint& paint, const FormSummary& summary, std::size_t metric_index) {
    const measure::evaluate::WorstRay* const worst = paint.names_worst_ray() ? summary.worst_ray() : nullptr;
    return paint.short_summary(summary, metric_index) +
           (worst ? fmt::format("\nworst pixel {},{}", worst->x, worst->y) : "");
}

std::vector<std::size_t> best_first(std::size_t form_count, std::span<const SheetCell> cells,
                                    std::size_t lost_bits_index) {
    constexpr double worst_p99 = std::numeric_limits<double>::infinity();  // with too few hits: after all others
    std::vector<std::optional<std::pair<std::uint64_t, double>>> quality(form_count);
    for (const auto& [form, summary] : cells) {
        if (quality[form]) continue;
        const double p99 = lost_bits_index < summary->metrics.size() && summary->agreement().is_enough()
                               ? summary->metrics[lost_bits_index].quantile(0.99)
                               : worst_p99;
        quality[form].emplace(summary->wrong_count(), std::isnan(p99) ? worst_p99 : p99);
    }

    // Forms without a cell come last.
    std::vector<std::size_t> order(form_count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t form) {
        return quality[form].value_or(std::pair{std::numeric_limits<std::uint64_t>::max(), worst_p99});
    });
    return order;
}

}  // namespace lostbits::output::map
