// Writes the files of judged answers about the surface of a mesh.
#include "output/judge/mesh_answer_files.hpp"

#include <array>
#include <cmath>

#include "output/attribution/explain_command.hpp"
#include "output/file/number_text.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::judge {

using measure::judge::JudgedAnswer, measure::judge::MeshAnswersResult, measure::judge::MeshOutcome;
using table::Table;

namespace {

constexpr const char *summary_file = "summary.csv", *faults_file = "faults.csv";

const char* record_noun(AnswerKind kind) { return kind == AnswerKind::inside ? "point" : "ray"; }

Table<MeshFaultRow> make_fault_table(AnswerKind kind) {
    Table<MeshFaultRow> table{
        {"outcome", "fault", [](const MeshFaultRow& row) { return std::string(measure::judge::name_of(row.outcome)); }},
        {"count", std::string("number of ") + record_noun(kind) + "s with it", &MeshFaultRow::count},
        {"first_record", "index of the first record of the first of them in the file, from 0",
         [](const MeshFaultRow& row) { return row.first->record; }}};
    if (kind != AnswerKind::inside)
        return table.add(table::make_ray_columns("the first of them"),
                         [](const MeshFaultRow& row) { return &row.first->ray; });
    for (int k = 0; k < 3; ++k)
        table.add({std::string{'p', "xyz"[k]} + "_hex", "the first of them",
                   [k](const MeshFaultRow& row) { return file::hex(row.first->ray.origin[k]); }});
    return table;
}

void add_list_columns(Table<MeshSummaryRow>& table) {
    const auto add = [&table](const char* name, const char* meaning, std::uint64_t MeshAnswersResult::*count) {
        table.add({name, meaning, [count](const MeshSummaryRow& row) { return row.result->*count; }});
    };
    add("listed", "hits in the file", &MeshAnswersResult::listed_hit_count);
    add("missing_hits", "crossings without a hit in the file", &MeshAnswersResult::missing_crossing_count);
    add("false_hits", "hits that belong to no crossing", &MeshAnswersResult::false_hit_count);
    add("double_hits", "hits of a crossing that has an earlier hit", &MeshAnswersResult::double_hit_count);
    add("neighbour_hits", "hits of a triangle beside the triangle that is met",
        &MeshAnswersResult::neighbour_hit_count);

    // Errors of the hits that belong to a crossing.
    const auto add_numbers = [&table](const std::string& name, const char* unit, const std::string& meaning,
                                      measure::metric::Distribution MeshAnswersResult::*distribution) {
        for (const auto& statistic : measure::metric::statistics)
            table.add({name + "_" + std::string(statistic.name), unit, meaning + ": " + std::string(statistic.meaning),
                       [distribution, &statistic](const MeshSummaryRow& row) {
                           return file::number_or_missing(statistic.of(row.result->*distribution));
                       }});
    };
    table.add({"measured", "hits whose triangle the ray meets, and whose t is a number",
               [](const MeshSummaryRow& row) { return row.result->ulp_errors.count(); }});
    add_numbers("ulp_error", "ulp", "|t - t*|/ulp(t*) of these", &MeshAnswersResult::ulp_errors);
    add_numbers("lost_bits", "bits", "bits lost by these", &MeshAnswersResult::lost_bits);
}

}  // namespace

Table<MeshSummaryRow> make_mesh_summary_table(AnswerKind kind) {
    const std::string records = std::string(record_noun(kind)) + "s";
    Table<MeshSummaryRow> table{
        {"form", "the answers of the file", &MeshSummaryRow::name},
        {"format", "format that they were computed in", &MeshSummaryRow::format},
        {"answers", "what the answers are about",
         [](const MeshSummaryRow& row) {
             return std::string(scene::ray_file::answer_kind_names[static_cast<std::size_t>(row.result->kind)]);
         }},
        {records, records + " in the file", [](const MeshSummaryRow& row) { return row.result->answers; }}};

    for (std::size_t o = 0; o < measure::judge::mesh_outcome_rows.size(); ++o) {
        const auto outcome = static_cast<MeshOutcome>(o);
        if (!measure::judge::can_have_outcome(outcome, kind)) continue;
        const auto& [name, meaning] = measure::judge::mesh_outcome_rows[o];
        table.add({std::string(name), records + ": " + std::string(meaning),
                   [outcome](const MeshSummaryRow& row) { return row.result->outcome_count(outcome); }});
    }

    if (kind != AnswerKind::inside)
        table.add({"crossings", "true crossings of the surface by all rays",
                   [](const MeshSummaryRow& row) { return row.result->crossings; }});
    if (kind == AnswerKind::all_hits) add_list_columns(table);
    return table;
}

std::vector<MeshFaultRow> mesh_fault_rows(const MeshAnswersResult& result) {
    std::vector<MeshFaultRow> rows;
    for (std::size_t o = 0; o < result.first_faults.size(); ++o)
        if (result.first_faults[o])
            rows.push_back({static_cast<MeshOutcome>(o), result.outcomes[o], &*result.first_faults[o]});
    return rows;
}

std::string answer_arguments(const JudgedAnswer& answer, bool is_point) {
    const Vec<double>& origin = answer.ray.origin;
    if (is_point) return file::number_list(std::array{origin.x, origin.y, origin.z}, file::hex, ",");
    scene::rays::RayGroup group = scene::rays::make_group(answer.ray);
    group.rays.tmin = {answer.range.tmin};
    group.rays.tmax = {answer.range.tmax};
    group.rays.open_ends = answer.range.open_ends;
    return attribution::explain_ray_arguments(&group);
}

Table<JudgedAnswer> make_mesh_answer_table(AnswerKind kind) {
    const bool is_point = kind == AnswerKind::inside;
    using R = JudgedAnswer;
    Table<R> table{{"record", "index of its first record in the file, from 0", &R::record}};

    // The ray or the point.
    constexpr std::array ray_names{"ox", "oy", "oz", "dx", "dy", "dz"}, point_kind_names{"px", "py", "pz", "", "", ""};
    for (int k = 0; k < (is_point ? 3 : 6); ++k)
        table.add({(is_point ? point_kind_names : ray_names).at(k), "number of it, as judged",
                   [k](const R& r) { return k < 3 ? r.ray.origin[k] : r.ray.direction[k - 3]; }});

    // The judgement and the answer.
    table.add({"outcome", "the last of its faults in the order of summary.csv",
               [](const R& r) { return std::string(measure::judge::name_of(r.judgement.outcome)); }});
    table.add({kind == AnswerKind::all_hits
                   ? "listed"
                   : std::string(scene::ray_file::answer_kind_names.at(static_cast<std::size_t>(kind))),
               kind == AnswerKind::all_hits ? "hits in the file" : "answer of the file", &R::answer_count});
    if (is_point) return table.add({"winding", "layers of the surface that enclose the point", &R::winding});

    // Counts of crossings and hits.
    const auto count_in_judgement = [](std::size_t measure::judge::ListJudgement::*count) {
        return [count](const R& r) { return r.judgement.*count; };
    };
    using J = measure::judge::ListJudgement;
    table.add({"true_crossings", "crossings of the surface", count_in_judgement(&J::crossings)});
    if (kind != AnswerKind::all_hits) return table;
    table.add({"missing_hits", "crossings without a hit in the file", count_in_judgement(&J::missing_crossing_count)});
    table.add({"false_hits", "hits that belong to no crossing", count_in_judgement(&J::false_hit_count)});
    table.add({"double_hits", "hits of a crossing that has an earlier hit", count_in_judgement(&J::double_hit_count)});
    table.add({"neighbour_hits", "hits of a triangle beside the triangle that is met",
               count_in_judgement(&J::neighbour_hit_count)});

    return table.add({"ulp_error", "ulp", "largest |t - t*|/ulp(t*) of its hits", [](const R& r) {
                          double largest = measure::truth::missing;
                          for (const double ulps : r.ulp_errors) largest = std::fmax(largest, std::fabs(ulps));
                          return file::number_or_missing(largest);
                      }});
}

MeshAnswerWriter::MeshAnswerWriter(MeshAnswerWriterOptions options)
    : options_(std::move(options)),
      summary_(options_.folder, summary_file, "The answers of the file", make_mesh_summary_table(options_.kind)),
      faults_(options_.folder, faults_file,
              std::string("One row per fault, with the first ") + record_noun(options_.kind),
              make_fault_table(options_.kind)) {
    if (options_.writes_rows)
        rows_.emplace(options_.folder, options_.name + "." + options_.format + ".csv",
                      std::string("One row per ") + record_noun(options_.kind), make_mesh_answer_table(options_.kind));
}

void MeshAnswerWriter::add(std::span<const JudgedAnswer> answers) {
    if (!rows_) return;
    for (const JudgedAnswer& answer : answers) rows_->add(answer);
}

void MeshAnswerWriter::finish(const MeshAnswersResult& result) {
    faults_.add_all(mesh_fault_rows(result));
    summary_.add({options_.name, options_.format, &result});
    table::close_tables(options_.folder, options_.title, summary_, faults_, rows_);
}

}  // namespace lostbits::output::judge
