#include "analysis/study/studies_by_name.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "analysis/selection/select.hpp"
#include "analysis/study/studies.hpp"
#include "number/error.hpp"
#include "output/study/study_files.hpp"

namespace lostbits::analysis::study {

using measure::check::StudyNames;
using measure::check::StudyQuestion;
using measure::check::StudyRow;
using output::report::StudySection;

namespace {

/// The study that a claim asks. Work that no column of the question needs is left out.
template <class Adapter>
typename Adapter::Presentation::Study make_study(const StudyQuestion& question) {
    for (const measure::evaluate::TestedForm& tested_form : question.tested_forms)
        if (!Adapter::can_measure(*tested_form.form))
            throw InputError(fmt::format("{}: is not a form for {}; {}", tested_form.form->info->name, Adapter::name,
                                         Adapter::no_form_message));
    Adapter::require(question.scene);
    std::vector<std::string> option_texts;
    for (const auto& [name, values] : question.options)
        for (const std::string& value : values) option_texts.push_back(name + "=" + value);
    auto study = Adapter::make_study(question.scene, question.tested_forms,
                                     study_values(Adapter::options(), option_texts), question.stop);
    if constexpr (requires { Adapter::skip_unneeded_work(study, question.columns); })
        Adapter::skip_unneeded_work(study, question.columns);
    return study;
}

/// A row of a summary, cell by cell.
template <class Adapter>
StudyRow study_row(const output::table::Table<typename Adapter::Presentation::SummaryRow>& table,
                   const typename Adapter::Presentation::SummaryRow& row, const std::set<std::string>& columns) {
    StudyRow row_values;
    for (const auto& column : table) {
        const output::file::Cell cell = column.value(row);
        if (column.about.type == "string") row_values.texts[column.about.name] = cell.text();
        else row_values.numbers[column.about.name] = cell.number();
    }
    row_values.unproved_count = Adapter::unproved_count(row);
    if constexpr (requires { Adapter::witness(row, ""); }) {
        for (const std::string& column : columns)
            if (auto witness = Adapter::witness(row, column)) row_values.witnesses[column] = std::move(*witness);
    }
    return row_values;
}

/// Draws the sheet of a study, and returns its summaries.
template <class Adapter>
auto draw_sheet(const typename Adapter::Presentation::Study& study, const std::filesystem::path& file) {
    output::study::StudyWriter<typename Adapter::Presentation> sheet(study, {.folder = {}, .sheet_only_file = file});
    auto summaries = measure::study::run_study(study, sheet.show());
    sheet.finish(summaries);
    return summaries;
}

/// Asks for these forms, as far as they fit the study and the scene. Empty lists mean the usual ones.
template <class Adapter>
StudyQuestion ask_about_scene(const scene::file::Scene& scene, std::vector<std::string> forms,
                              std::vector<std::string> formats, intersect::process::StopToken stop) {
    if (forms.empty()) forms = Adapter::usual_forms();
    if (formats.empty()) formats = {usual_format};
    auto tested_forms =
        selection::pair_forms_with_formats(selection::select_forms(forms), selection::select_formats(formats));
    std::erase_if(tested_forms, [](const auto& tested_form) { return !Adapter::can_measure(*tested_form.form); });
    const selection::ShapePredicate can_test = [&scene](Shapes shapes) {
        return selection::are_primitives(shapes) && scene.accepts(shapes);
    };
    return {.scene = scene,
            .tested_forms = selection::tested_forms_handling({tested_forms, {}, true}, scene.id, can_test),
            .stop = stop};
}

/// Measures a study while its sheet is drawn. `add_results(section, study, summaries)` completes the section.
template <class Adapter, class AddResults>
StudySection measure_section(const StudyQuestion& question, const std::string& sheet_text,
                             const AddResults& add_results) {
    const auto study = make_study<Adapter>(question);
    const scene::file::Scene& scene = question.scene;
    std::vector<typename Adapter::Presentation::Study::Summary> summaries;
    StudySection section{
        .study = Adapter::name, .purpose = Adapter::title, .id = scene.id, .title = scene.title, .note = scene.note};
    section.sheet = output::report::picture(fmt::format("{}: {}", scene.title, sheet_text),
                                            [&](const auto& file) { summaries = draw_sheet<Adapter>(study, file); });
    add_results(section, study, summaries);
    return section;
}

}  // namespace

StudyNames StudiesByName::allowed_names(const std::string& study) const {
    return with_study(study, [](auto adapter) {
        using Adapter = decltype(adapter);
        StudyNames names;
        for (const StudyOption& option : Adapter::options()) names.options.push_back(option.name);
        for (const output::file::Column& column : Adapter::Presentation::make_summary_table().columns())
            (column.type == "string" ? names.text_columns : names.number_columns).push_back(column.name);
        return names;
    });
}

std::vector<StudyRow> StudiesByName::measure(const std::string& study, const StudyQuestion& question) const {
    return with_study(study, [&](auto adapter) {
        using Adapter = decltype(adapter);
        const auto study_to_measure = make_study<Adapter>(question);
        const auto summaries = measure::study::run_study(study_to_measure);
        const auto table = Adapter::Presentation::make_summary_table();
        std::vector<StudyRow> rows;
        for (const auto& row : Adapter::Presentation::make_summary_rows(study_to_measure, summaries))
            rows.push_back(study_row<Adapter>(table, row, question.columns));
        return rows;
    });
}

void StudiesByName::draw(const std::string& study, const StudyQuestion& question,
                         const std::filesystem::path& file) const {
    with_study(study, [&](auto adapter) {
        using Adapter = decltype(adapter);
        draw_sheet<Adapter>(make_study<Adapter>(question), file);
        return true;
    });
}

std::vector<std::string> study_names() {
    return std::apply([](auto... adapter) { return std::vector<std::string>{adapter.name...}; }, Studies());
}

std::optional<StudySection> measure_study_section(const std::string& study, const scene::file::Scene& scene,
                                                  std::vector<std::string> forms, std::vector<std::string> formats,
                                                  intersect::process::StopToken stop) {
    return with_study(study, [&](auto adapter) -> std::optional<StudySection> {
        using Adapter = decltype(adapter);
        const auto question = ask_about_scene<Adapter>(scene, std::move(forms), std::move(formats), stop);
        if (question.tested_forms.empty()) return std::nullopt;
        return measure_section<Adapter>(
            question, Adapter::name, [](StudySection& section, const auto& measured, const auto& summaries) {
                const auto table = Adapter::Presentation::make_summary_table();
                std::vector<std::vector<output::file::Cell>> cells;
                for (const auto& row : Adapter::Presentation::make_summary_rows(measured, summaries)) {
                    auto& line = cells.emplace_back();
                    for (const auto& column : table) line.push_back(column.value(row));
                }
                section.table = output::report::study_table(table.columns(), cells);
            });
    });
}

std::optional<StudySection> measure_offset_section(const scene::file::Scene& scene,
                                                   intersect::process::StopToken stop) {
    namespace offset = measure::offset;
    auto question = ask_about_scene<OffsetsAdapter>(scene, {}, {std::string(offset::usual_format)}, stop);
    if (question.tested_forms.empty()) return std::nullopt;
    question.tested_forms.resize(1);
    question.options = {{"points", {"computed"}}};
    return measure_section<OffsetsAdapter>(
        question, "outcomes of the next rays with every offset strategy",
        [&](StudySection& section, const offset::OffsetStudy& study, const auto& summaries) {
            section.purpose.clear();  // the overview says it
            section.source = scene.source;
            section.sentences = output::offset::summary_lines(study, 0, summaries.front());
            section.table = output::report::offset_table(study, summaries);
            auto table = OffsetsAdapter::Presentation::make_summary_table();
            for (const auto& row : OffsetsAdapter::Presentation::make_summary_rows(study, summaries))
                section.wrong_fractions[static_cast<std::size_t>(row.side)].push_back(
                    table.find("bad_fraction")->value(row).number());
        });
}

}  // namespace lostbits::analysis::study
