// Studies of one number per pixel. A struct defines such a study and computes the number; everything else is here. The
// struct has
//
//   name, title             its command, and what it does
//   unit, meaning           of the number
//   options()               its options
//   a constructor from StudyValues
//   scale()                 colours of its picture
//   operator()(CorrectHit)  the number of a pixel; NaN if it has none
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/shell/command_line.hpp"
#include "analysis/study/study_values.hpp"
#include "measure/consistency/check.hpp"
#include "measure/metric/statistics.hpp"
#include "measure/study/study.hpp"
#include "number/real.hpp"
#include "output/file/number_text.hpp"
#include "output/map/form_names.hpp"
#include "output/study/study_files.hpp"
#include "output/table/shared_columns.hpp"
#include "shapes/lift.hpp"

namespace lostbits::analysis::study {

/// A pixel on which a form hits the primitive that the ray truly hits first.
struct CorrectHit {
    const measure::consistency::FormOnBand& form_on_band;
    std::size_t pixel;
    measure::truth::Truth truth;

    [[nodiscard]] Ray<Real> ray() const { return lift_ray<Real>(form_on_band.rays()[pixel]); }
    [[nodiscard]] Primitive<Real> primitive() const {
        return lift_primitive<Real>(form_on_band.inputs.primitives[truth.primitive]);
    }
    /// The computed t.
    [[nodiscard]] Real t() const { return Real(form_on_band.closest_hits.t[pixel]); }
    /// t*, the true t.
    [[nodiscard]] Real true_t() const {
        const auto& t = form_on_band.takes_unit_directions() ? truth.distance : truth.t;
        return ldexp(Real(Real(t.hi) + Real(t.lo)), static_cast<int>(t.exponent));
    }
};

/// Numbers of a form on a band; NaN where a pixel has none.
struct NumberBand {
    int y0 = 0, scanlines = 0, width = 0;
    std::vector<double> numbers;
};

struct NumberSummary {
    std::uint64_t unresolved = 0;
    measure::metric::Distribution numbers;
};
LOSTBITS_FIELDS(NumberSummary, unresolved, numbers)

/// A study, see measure/study/study.hpp.
template <class Quantity>
struct NumberStudy {
    using Band = NumberBand;
    using Summary = NumberSummary;
    static constexpr int pixels_per_band = 1;

    const scene::file::Scene& scene;
    std::vector<measure::evaluate::TestedForm> tested_forms;
    Quantity number;
    measure::truth::ProofLimit limit{};
    measure::shard::Share share = {};
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    static void require() {}
    [[nodiscard]] static NumberSummary begin(std::size_t) { return {}; }
    [[nodiscard]] static const measure::truth::Band& prepare(const measure::truth::Band& band) { return band; }
    NumberBand measure(const measure::truth::Band& band, std::size_t form_index, NumberSummary& summary) const {
        const measure::consistency::FormOnBand on_band(scene, tested_forms[form_index], band);
        NumberBand result{band.y0(), band.scanlines(), scene.width,
                          std::vector(on_band.pixel_count(), measure::truth::missing)};
        for (std::size_t i = 0; i < on_band.pixel_count(); ++i) {
            const measure::truth::Truth ray_truth = band.truth(i, tested_forms[form_index].convention());
            if (ray_truth.decision == measure::truth::Truth::Decision::unresolved) ++summary.unresolved;
            if (!ray_truth.is_hit() || on_band.closest_hits.hit[i] == 0 ||
                on_band.closest_hits.primitive[i] != ray_truth.primitive)
                continue;
            result.numbers[i] = number(CorrectHit{on_band, i, ray_truth});
            summary.numbers.add(result.numbers[i]);
        }
        return result;
    }
};

/// A row of the summary of a study of numbers.
struct NumberRow {
    const measure::evaluate::TestedForm* tested_form;
    const NumberSummary* summary;
};

/// An adapter, see analysis/study/studies.hpp, and its presentation, see output/study/study_files.hpp. One sheet has a
/// column for each form and a line for each format. `<form>.<format>.csv` has one row per pixel,
/// `<form>.<format>.exr` one channel.
template <class Quantity>
struct NumberAdapter {
    using Presentation = NumberAdapter;
    using Study = NumberStudy<Quantity>;
    using Band = NumberBand;
    using SummaryRow = NumberRow;
    using Summaries = std::vector<NumberSummary>;
    static constexpr const char* name = Quantity::name;
    static constexpr const char* title = Quantity::title;
    static constexpr const char* no_form_message = "none of the selected forms is for a primitive; try -i 'sphere.*'";
    static constexpr const char* kinds = ", with primitives of any kind";
    static constexpr const char* form_help = "Forms, by name or glob (default: all that fit)";
    static constexpr const char* example = "sphere[0].radius=10";
    static constexpr const char* summary_title = "One row per form and format";
    static constexpr const char* pixel_title = "One row per pixel";

    static std::vector<StudyOption> options() { return Quantity::options(); }
    static std::vector<shell::Example> examples() {
        return {
            {fmt::format("lostbits {} near-benign --size 32x32", name), "Measures every form for spheres"},
            {fmt::format("lostbits {} box-one -i box.signs -f f64 --size 32x32", name), "Measures a form in double"}};
    }
    static std::vector<std::string> usual_forms() { return {"*"}; }
    static bool can_measure(const intersect::table::Intersector& form) { return is_primitive(form.shape); }
    static void require(const scene::file::Scene&) {}
    static Study make_study(const scene::file::Scene& scene, std::vector<measure::evaluate::TestedForm> tested_forms,
                            const StudyValues& values, intersect::process::StopToken stop) {
        return {.scene = scene,
                .tested_forms = std::move(tested_forms),
                .number = Quantity(values),
                .limit = {.stop = stop}};
    }
    static void print_results(const Study& study, const Summaries& summaries, bool) {
        for (std::size_t r = 0; r < summaries.size(); ++r)
            fmt::print("  {} {}: {}\n", study.tested_forms[r].form->info->name, study.tested_forms[r].format.name,
                       in_words(summaries[r]));
    }
    static std::uint64_t unproved_count(const Summaries& summaries) {
        std::uint64_t max_unproved = 0;
        for (const NumberSummary& summary : summaries) max_unproved = std::max(max_unproved, summary.unresolved);
        return max_unproved;
    }
    static std::uint64_t unproved_count(const NumberRow& row) { return row.summary->unresolved; }

    static output::table::Table<NumberRow> make_summary_table() {
        output::table::Table<NumberRow> table;
        table.add(output::table::make_subject_columns(), &NumberRow::tested_form);
        table.add({"hits", "pixels with a number: the form hits the primitive that the ray truly hits first",
                   [](const NumberRow& row) { return row.summary->numbers.count(); }});
        for (const auto& [end, q] : {std::pair{"p50", 0.5}, std::pair{"p99", 0.99}, std::pair{"max", 1.0}})
            table.add({fmt::format("{}_{}", name, end), Quantity::unit, fmt::format("{}: {}", Quantity::meaning, end),
                       [q](const NumberRow& row) {
                           return output::file::number_or_missing(row.summary->numbers.quantile(q));
                       }});
        return table;
    }
    static std::vector<NumberRow> make_summary_rows(const Study& study, const Summaries& summaries) {
        std::vector<NumberRow> rows;
        for (std::size_t r = 0; r < summaries.size(); ++r) rows.push_back({&study.tested_forms[r], &summaries[r]});
        return rows;
    }
    static output::table::Table<output::study::PixelInBand<NumberBand>> make_pixel_table(const Study&) {
        using R = output::study::PixelInBand<NumberBand>;
        return output::study::position_columns<NumberBand>().add(
            {name, Quantity::unit, Quantity::meaning,
             [](const R& r) { return output::file::number_or_missing(r.band->numbers[r.i]); }});
    }

    /// One channel with the numbers, rounded to binary32.
    static output::pixel::ExrLayers<NumberBand> layers(const Study&) {
        output::pixel::ExrLayers<NumberBand> layers;
        layers.add_number(name, [](const NumberBand& band, std::size_t i) { return band.numbers[i]; });
        return layers;
    }
    static output::image::ExrSpec make_exr_spec(const Study& study, std::size_t form_index,
                                                const std::vector<output::image::Channel>& channels,
                                                const std::string& command) {
        return {.width = study.scene.width,
                .height = study.scene.height,
                .channels = channels,
                .attributes = {{"lostbits:command", command},
                               {"lostbits:schema", fmt::format("lostbits-{}/1", name)},
                               {"lostbits:scene", study.scene.id},
                               {"lostbits:form", std::string(study.tested_forms[form_index].form->info->name)},
                               {"lostbits:format", study.tested_forms[form_index].format.name},
                               output::image::compiler_attribute()}};
    }

    static std::string file_stem(const Study& study, std::size_t form_index) {
        return output::map::tested_form_name(study.tested_forms[form_index]);
    }
    static std::size_t pixels(const NumberBand& band) { return band.numbers.size(); }
    static std::vector<output::pixel::DrawnColumn<NumberBand>> columns(const Study& study) {
        const auto look = std::make_shared<const output::pixel::Look>(
            output::pixel::Look{{{"no number", output::pixel::colour_of(measure::answer::Outcome::agree_miss)}, {""}},
                                Quantity::scale(),
                                Quantity::unit});

        std::vector<output::pixel::DrawnColumn<NumberBand>> all;
        for (std::size_t r = 0; r < study.tested_forms.size(); ++r) {
            const measure::evaluate::TestedForm& tested_form = study.tested_forms[r];
            all.push_back(
                {{.file = file_stem(study, r) + ".png",
                  .title = Quantity::meaning,
                  .subtitle = {fmt::format("{} in {}", tested_form.form->info->name, tested_form.format.name)},
                  .look = look,
                  .sheet_positions = {place_of(study, r)}},
                 r,
                 output::pixel::make_draw_function<NumberBand>([](const NumberBand& band, std::size_t i) {
                     const double number = band.numbers[i];
                     return std::isnan(number) ? output::pixel::PixelValue{0} : output::pixel::PixelValue{1, number};
                 })});
        }
        return all;
    }
    static output::pixel::SheetFile sheet(const Study& study, const std::filesystem::path& file) {
        output::image::SheetSpec spec{
            .title = study.scene.title,
            .subtitle = {fmt::format("{}, {} x {} pixels: {}", study.scene.id, study.scene.width, study.scene.height,
                                     Quantity::meaning)},
            .scales = {Quantity::scale()},
            .bar_label = Quantity::unit};
        for (const auto* const form : forms_of(study))
            spec.column_labels.push_back(output::map::short_name(*form->info));
        for (const std::string& format : formats_of(study)) spec.row_labels.push_back(format);
        return {file, std::move(spec)};
    }
    static std::vector<output::study::Note> notes(const Study& study, const Summaries& summaries) {
        std::vector<output::study::Note> notes;
        for (std::size_t r = 0; r < summaries.size(); ++r)
            notes.push_back({place_of(study, r), in_words(summaries[r])});
        return notes;
    }

private:
    static std::string in_words(const NumberSummary& summary) {
        if (summary.numbers.count() == 0) return "no number";
        return fmt::format("p50 {}, p99 {}, max {}", output::file::short_decimal(summary.numbers.quantile(0.5), 3),
                           output::file::short_decimal(summary.numbers.quantile(0.99), 3),
                           output::file::short_decimal(summary.numbers.quantile(1), 3));
    }
    static std::vector<const intersect::table::Intersector*> forms_of(const Study& study) {
        std::vector<const intersect::table::Intersector*> forms;
        for (const auto& tested_form : study.tested_forms)
            if (std::ranges::find(forms, tested_form.form) == forms.end()) forms.push_back(tested_form.form);
        return forms;
    }
    static std::vector<std::string> formats_of(const Study& study) {
        std::vector<std::string> formats;
        for (const auto& tested_form : study.tested_forms)
            if (std::ranges::find(formats, tested_form.format.name) == formats.end())
                formats.emplace_back(tested_form.format.name);
        return formats;
    }
    static output::pixel::SheetPosition place_of(const Study& study, std::size_t form_index) {
        const auto forms = forms_of(study);
        const auto formats = formats_of(study);
        return {static_cast<std::size_t>(std::ranges::find(forms, study.tested_forms[form_index].form) - forms.begin()),
                static_cast<std::size_t>(std::ranges::find(formats, study.tested_forms[form_index].format.name) -
                                         formats.begin())};
    }
};

}  // namespace lostbits::analysis::study
