// Tables and matrices of named cases.
#include "output/sweep/case_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/attribution/explain_command.hpp"
#include "output/file/number_text.hpp"
#include "output/image/figure.hpp"
#include "output/map/form_names.hpp"
#include "output/map/map_colour.hpp"
#include "output/plot/cell_plots.hpp"
#include "text/shell_word.hpp"

namespace lostbits::output::sweep {

using measure::answer::Outcome;
using measure::sweep::Verdict;

std::string right_meaning(const scene::sweep::CaseFile& file) {
    return fmt::format("every decision is right, and no answer loses more than {} bits",
                       file::decimal(file.right_within_bits));
}

std::string within_meaning(const scene::sweep::CaseFile& file) {
    return fmt::format("within {} bits of what the inputs allow", file::decimal(file.right_within_bits));
}

namespace {

table::Table<CaseRow> make_case_table(const CaseRequest& request) {
    using R = CaseRow;
    auto summary = map::make_summary_table(request.metrics, request.file.shapes());
    summary.set_meaning("rays", "number of rays in the case");
    summary.set_meaning("worst_x", "ray with the largest |ulp_error| in its group, from 0");
    summary.set_meaning("worst_y", "0");

    table::Table<R> table{
        {"case", "name of the case", &R::name},
        {"convention",
         "convention by which touching and t = 0 are judged: the form's own (own); touching is a hit (closed) or a "
         "miss (open); t = 0 is a hit in both",
         [](const R& r) { return intersect::convention_name(r.summary.tested_form.touching); }},
        {"verdict",
         fmt::format(
             "right ({}), within_inputs (every decision is right, and every answer is {}: half an ulp in each input "
             "would cost the remaining bits), wrong_value, or the most frequent wrong decision",
             right_meaning(request.file), within_meaning(request.file)),
         [](const R& r) { return measure::sweep::verdict_names[static_cast<std::size_t>(r.verdict)]; }}};
    return table.add(summary, &R::summary);
}

/// Colours and texts of cells.
struct CellLook {
    const std::vector<const measure::metric::Metric*>& metrics;
    const map::LostBitsScale& scale;
    const FloatFormat& format;

    [[nodiscard]] plot::MatrixCell cell(const FormSummary& summary, Verdict verdict) const {
        switch (verdict) {
            case Verdict::right: return {case_right_colour, {}};
            case Verdict::within_inputs: return within_inputs_cell(summary);
            case Verdict::wrong_value: return lost_bits_cell(summary);
            case Verdict::false_hit: return wrong_cell(summary, Outcome::false_hit);
            case Verdict::false_miss: return wrong_cell(summary, Outcome::false_miss);
            case Verdict::not_a_number: return wrong_cell(summary, Outcome::not_a_number);
            case Verdict::wrong_primitive: return wrong_cell(summary, Outcome::wrong_primitive);
            case Verdict::unresolved: break;
        }
        return wrong_cell(summary, Outcome::unresolved);
    }

private:
    /// A cell in the colour of a wrong outcome. If only some of the rays have the outcome, the cell gives their number.
    [[nodiscard]] static plot::MatrixCell wrong_cell(const FormSummary& summary, Outcome o) {
        const std::uint64_t n = summary.count(o);
        return {image::outcome_colours[static_cast<std::size_t>(o)],
                n < summary.ray_count ? fmt::format("{}/{}", n, summary.ray_count) : std::string()};
    }

    [[nodiscard]] double max_lost_bits(const FormSummary& summary) const {
        return summary.metrics[measure::metric::index_of(metrics, "lost_bits")].quantile(1);
    }

    [[nodiscard]] plot::MatrixCell lost_bits_cell(const FormSummary& summary) const {
        const double lost_bits = max_lost_bits(summary);
        return {scale.colour(lost_bits, format), fmt::format("{:.0f} b", lost_bits)};
    }

    /// A paler cell, which also gives the bits that the inputs cost if they were measured.
    [[nodiscard]] plot::MatrixCell within_inputs_cell(const FormSummary& summary) const {
        const double lost_bits = max_lost_bits(summary);
        const std::size_t inherent_index = measure::metric::index_of(metrics, "inherent_bits");
        return {map::make_paler(scale.colour(lost_bits, format)),
                inherent_index < metrics.size()
                    ? fmt::format("{:.0f}/{:.0f} b", lost_bits, summary.metrics[inherent_index].quantile(1))
                    : fmt::format("{:.0f} b", lost_bits)};
    }
};

/// Adds a column for each row of the request that is judged by the convention, grouped by format. Returns the indices
/// of these rows in the order of the columns.
std::vector<std::size_t> add_case_columns(plot::MatrixPlotSpec& spec, const CaseRequest& request,
                                          std::optional<intersect::Touching> touching) {
    for (const measure::evaluate::TestedForm& tested_form : request.tested_forms) {
        const std::string& format = tested_form.format.name;
        if (std::ranges::find(spec.groups, format, &plot::MatrixPlotSpec::Group::label) == spec.groups.end())
            spec.groups.push_back({format, {}});
    }

    std::vector<std::size_t> row_order;
    for (auto& group : spec.groups) {
        for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
            if (request.tested_forms[r].format.name != group.label || request.tested_forms[r].touching != touching)
                continue;
            group.columns.push_back(map::short_name(*request.tested_forms[r].form->info));
            row_order.push_back(r);
            spec.keys += (spec.keys.empty() ? "" : " ") + map::tested_form_name(request.tested_forms[r]);
        }
    }
    return row_order;
}

/// Adds the wrong outcomes that occur in the columns to the legend.
void add_outcomes_to_legend(plot::MatrixPlotSpec& spec, const std::vector<std::vector<FormSummary>>& cases,
                            const std::vector<std::size_t>& row_order) {
    for (const Outcome o : {Outcome::false_hit, Outcome::false_miss, Outcome::not_a_number, Outcome::wrong_primitive,
                            Outcome::unresolved}) {
        const bool occurs = std::ranges::any_of(cases, [&](const auto& rows) {
            return std::ranges::any_of(row_order, [&](std::size_t r) { return rows[r].count(o) > 0; });
        });
        if (occurs)
            spec.legend.push_back({map::outcome_in_words(o), image::outcome_colours[static_cast<std::size_t>(o)], {}});
    }
}

}  // namespace

image::Canvas draw_case_matrix(const CaseRequest& request, const std::vector<std::vector<FormSummary>>& cases,
                               std::optional<intersect::Touching> touching) {
    const map::LostBitsScale scale(request.tested_forms);
    plot::MatrixPlotSpec spec{
        .title = touching ? fmt::format("{}: judged by the {} primitive", request.file.title,
                                        intersect::convention_name(touching))
                          : request.file.title,
        .subtitle = {fmt::format("Right: {}. {}.", right_meaning(request.file), cell_numbers_meaning)},
        .legend = {{"right", case_right_colour, {}}},
        .scale = scale.bar(),
        .bar_label = scale.unit()};
    const std::vector<std::size_t> row_order = add_case_columns(spec, request, touching);
    add_outcomes_to_legend(spec, cases, row_order);

    // A line of cells for each case.
    const auto cell_of = [&](const FormSummary& summary, Verdict verdict, const FloatFormat& format) {
        return CellLook{request.metrics, scale, format}.cell(summary, verdict);
    };
    bool has_wrong_value = false;
    bool has_within_inputs = false;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        spec.rows.push_back(request.file.name(i));
        for (const std::size_t r : row_order) {
            const Verdict verdict =
                measure::sweep::verdict_of(cases[i][r], request.metrics, request.file.right_within_bits);
            has_wrong_value |= verdict == Verdict::wrong_value;
            has_within_inputs |= verdict == Verdict::within_inputs;
            spec.cells.push_back(cell_of(cases[i][r], verdict, request.tested_forms[r].format.parameters));
        }
    }

    // The colour bar and the paler colour are explained only if a cell has them.
    if (has_within_inputs) {
        spec.legend.insert(spec.legend.begin() + 1,
                           {within_meaning(request.file), map::make_paler(scale.bar().colour_at_position(0.5)), {}});
    }
    if (!has_wrong_value && !has_within_inputs) spec.scale.reset();
    return plot::draw_matrix_plot(spec);
}

CaseWriter::CaseWriter(const CaseRequest& request, const std::filesystem::path& folder, std::string file_argument)
    : request_(request),
      folder_(folder),
      file_argument_(std::move(file_argument)),
      csv_(folder, "cases.csv", "One row per case, form and format", make_case_table(request)) {}

void CaseWriter::finish(const std::vector<std::vector<FormSummary>>& cases) {
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const std::string name = request_.file.name(i);
        const auto ray_arguments = [&](const measure::evaluate::WorstRay& ray) {
            const std::int64_t ray_index = std::int64_t{ray.group} * request_.file.ray_count(i) + ray.x;
            return file_argument_ + " --case " + text::shell_word(fmt::format("{}:{}", name, ray_index));
        };

        for (std::size_t r = 0; r < request_.tested_forms.size(); ++r)
            csv_.add({name,
                      measure::sweep::verdict_of(cases[i][r], request_.metrics, request_.file.right_within_bits),
                      {request_.tested_forms[r], &cases[i][r], ray_arguments}});
    }

    for (const auto& touching : request_.file.conventions) {
        image::save_figure(
            folder_ / (touching ? fmt::format("matrix.{}.png", intersect::convention_name(touching)) : "matrix.png"),
            draw_case_matrix(request_, cases, touching));
    }
    table::close_tables(folder_, request_.file.title, csv_);
}

}  // namespace lostbits::output::sweep
