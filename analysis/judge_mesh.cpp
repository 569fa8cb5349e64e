#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/selection/ray_file_options.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/selection/select.hpp"
#include "commands.hpp"
#include "measure/judge/judge.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/judge/mesh_answer_files.hpp"
#include "output/map/form_names.hpp"
#include "scene/rays/stored_mesh.hpp"
#include "scene/toml/file_names.hpp"
#include "text/count_with_noun.hpp"
#include "text/shell_word.hpp"

namespace lostbits::analysis {

using measure::judge::MeshAnswersResult, measure::judge::MeshOutcome;
using scene::ray_file::AnswerKind;
using selection::JudgeOptions;

namespace {

/// Throws InputError for an option of `judge` that answers of this kind do not have.
void require_options_of_kind(const JudgeOptions& options, AnswerKind kind, const std::string& column) {
    const selection::RayFileOptions defaults;

    // Options that are only about first hits.
    const std::pair<const char*, bool> first_hit_options[] = {
        {"-i", !options.forms.empty()},
        {"-f", !options.formats.empty()},
        {"--against", !options.against.empty()},
        {"--metric", !options.metrics.empty()},
        {"--by", !options.by.empty()},
        {"--bits", options.bits >= 0},
        {"--tolerance", !options.tolerance.empty()},
        {"--unit", !options.unit.empty()},
        {"--size", !options.size.empty()},
        {"--shard", !options.shard.empty()},
        {"--pictures", options.pictures != JudgeOptions().pictures},
        {"--miss", !options.miss.empty()},
        {"--at-origin", options.at_origin != defaults.at_origin},
        {"--inside", options.inside != defaults.inside}};
    for (const auto& [name, is_given] : first_hit_options)
        if (is_given)
            throw InputError(fmt::format(
                "{0}: is for files of first hits, but the column {1} of {2} says {3}; leave out {0} or the column",
                name, column, options.file,
                kind == AnswerKind::all_hits ? "that it lists all hits"
                : kind == AnswerKind::inside ? "that its records are points"
                                             : "how often rays cross the surface"));

    // Options that are only about rays.
    if (kind == AnswerKind::inside)
        for (const auto& [name, is_given] : {std::pair("--direction", options.direction != defaults.direction),
                                             {"--touching", options.touching != defaults.touching},
                                             {"--facing", options.facing != defaults.facing},
                                             {"--open-ends", options.open_ends != defaults.open_ends}})
            if (is_given)
                throw InputError(
                    fmt::format("{0}: is about rays, but {1} has points; leave out {0}", name, options.file));
}

std::shared_ptr<const scene::rays::StoredMesh> require_mesh(const std::optional<scene::file::Scene>& scene,
                                                            const JudgeOptions& options, const Format& format) {
    auto mesh = scene ? scene::rays::make_stored_mesh(*scene, format.parameters) : nullptr;
    if (mesh && mesh->size() == scene->primitive_count()) return mesh;
    throw InputError(
        fmt::format("{}: its answers are about the surface of a mesh; give --scene with a scene of [[mesh]] "
                    "tables and no other primitives",
                    options.file));
}

void print_answers(const std::string& name, const Format& format, const MeshAnswersResult& result) {
    std::vector<shell::TextColumn> columns{{"form", 28, true}, {"fmt", 5, true}};
    std::vector<std::string> cells{name, std::string(format.name)};
    for (std::size_t k = 0; k < measure::judge::mesh_outcome_rows.size(); ++k) {
        const auto outcome = static_cast<MeshOutcome>(k);
        if (!can_have_outcome(outcome, result.kind)) continue;
        const std::string title = output::map::name_in_words(name_of(outcome));
        columns.push_back({title, std::max<std::size_t>(title.size(), 7)});
        cells.push_back(std::to_string(result.outcome_count(outcome)));
    }

    // Only the answers that list all hits have t.
    if (result.kind == AnswerKind::all_hits)
        for (const auto& [title, q] : {std::pair("bits lost: p50", 0.5), {"p99", 0.99}, {"max", 1.0}}) {
            const double bits = result.lost_bits.quantile(q);
            columns.push_back({title, std::max<std::size_t>(std::string_view(title).size(), 6)});
            cells.push_back(std::isnan(bits) ? "-" : fmt::format("{:.2f}", bits));
        }

    shell::TextTable table(std::move(columns));
    table.add(std::move(cells));
    table.print();
}

/// Lines that name the first ray or point of each fault.
void print_faults(const MeshAnswersResult& result) {
    const bool are_points = result.kind == AnswerKind::inside;
    for (const auto& [outcome, count, first] : output::judge::mesh_fault_rows(result)) {
        const std::string title = output::map::name_in_words(name_of(outcome));
        fmt::print("  first {}: {} {}, {}\n", title, are_points ? "point" : "record", first->record,
                   output::judge::answer_arguments(*first, are_points));
    }
}

}  // namespace

ExitStatus run_mesh_judge(const JudgeOptions& options, const std::optional<scene::file::Scene>& scene,
                          scene::ray_file::RayFile& ray_file, const CommonOptions& common) {
    const scene::ray_file::Layout& layout = ray_file.layout();
    const AnswerKind kind = layout.answer_kind();
    require_options_of_kind(options, kind, layout.columns()[layout.index_of(scene::ray_file::slot_of(kind))].name);
    measure::judge::MeshAnswersRequest request{
        .mesh = require_mesh(scene, options, ray_file.format()),
        .contract = {.has_t = layout.has(scene::ray_file::slot::t),
                     .unit_direction = options.direction == "unit",
                     .touching_may_miss = options.touching == "miss",
                     .facing = selection::answer_contract(options, ray_file).facing},
        .limit = {.stop = common.stop}};
    if (kind == AnswerKind::inside) measure::judge::require_inside(request.mesh->mesh(), options.file);

    const selection::ThreadLimit threads(common.threads);
    const bool counts_bytes = ray_file.bytes() > 0;
    output::file::Progress progress(counts_bytes ? ray_file.bytes() : 1, "judge", common.progress, common.quiet);
    request.progress = [&](std::uint64_t bytes) { progress.advance(counts_bytes ? bytes : 0); };

    // Opens the files, and judges the answers record by record.
    const std::string stem = scene::toml::result_name(options.file), name = measure::judge::name_of_answers(stem);
    const auto folder = std::filesystem::path(options.out) / stem;
    const auto result_folder = lock_folder(folder, common, text::shell_word(options.file));
    output::judge::MeshAnswerWriter writer(
        {.folder = folder,
         .name = name,
         .format = std::string(ray_file.format().name),
         .title = "answers of " + std::filesystem::path(options.file).filename().string(),
         .kind = kind,
         .writes_rows = options.writes_rows});
    const MeshAnswersResult result =
        measure::judge::judge_mesh_answers(ray_file, request, [&](const auto& answers) { writer.add(answers); });
    writer.finish(result);
    complete_folder(result_folder);
    progress.finish();

    if (!common.quiet) {
        selection::warn_of_rounded_values(options.file, result.rounded_count, ray_file.format());
        fmt::print("{} of {}, read as {}\n",
                   text::count_with_noun(result.answers, kind == AnswerKind::inside ? "point" : "ray"), options.file,
                   ray_file.format().name);
        print_answers(name, ray_file.format(), result);
        print_faults(result);
        fmt::print("{}\n", (folder / "summary.csv").string());
    }
    return report_unproved(result.outcome_count(MeshOutcome::unresolved));
}

}  // namespace lostbits::analysis
