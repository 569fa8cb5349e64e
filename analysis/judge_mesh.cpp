#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/selection/judge_options.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/selection/select.hpp"
#include "commands.hpp"
#include "measure/judge/judge.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/judge/mesh_answer_files.hpp"
#include "output/map/row_names.hpp"
#include "scene/rays/stored_mesh.hpp"
#include "scene/toml/counted.hpp"
#include "scene/toml/file_names.hpp"

namespace lostbits::analysis {

using measure::judge::MeshAnswersResult, measure::judge::MeshOutcome;
using scene::dump::AnswerKind;
using selection::JudgeOptions;

namespace {

/// Throws InputError for an option of `judge` that answers of this kind do not have.
void refuse_options(const JudgeOptions& o, AnswerKind kind, const std::string& column) {
    const selection::RayFileOptions usual;
    const std::pair<const char*, bool> first_hit_options[] = {{"-i", !o.forms.empty()},
                                                              {"-f", !o.formats.empty()},
                                                              {"--against", !o.against.empty()},
                                                              {"--metric", !o.metrics.empty()},
                                                              {"--by", !o.by.empty()},
                                                              {"--bits", o.bits >= 0},
                                                              {"--tolerance", !o.tolerance.empty()},
                                                              {"--unit", !o.unit.empty()},
                                                              {"--size", !o.size.empty()},
                                                              {"--shard", !o.shard.empty()},
                                                              {"--pictures", o.pictures != JudgeOptions().pictures},
                                                              {"--miss", !o.miss.empty()},
                                                              {"--at-origin", o.at_origin != usual.at_origin},
                                                              {"--inside", o.inside != usual.inside}};
    for (const auto& [name, given] : first_hit_options)
        if (given)
            throw InputError(fmt::format(
                "{0} is for files of first hits, but the column {1} of {2} says {3}; leave out {0} or the column", name,
                column, o.file,
                kind == AnswerKind::all_hits ? "that it lists all hits"
                : kind == AnswerKind::inside ? "that its records are points"
                                             : "how often rays cross the surface"));
    if (kind == AnswerKind::inside)
        for (const auto& [name, given] : {std::pair("--direction", o.direction != usual.direction),
                                          {"--touching", o.touching != usual.touching},
                                          {"--facing", o.facing != usual.facing},
                                          {"--open-ends", o.open_ends != usual.open_ends}})
            if (given)
                throw InputError(fmt::format("{0} is about rays, but {1} has points; leave out {0}", name, o.file));
}

std::shared_ptr<const scene::rays::MeshColumns> mesh_given(const std::optional<scene::file::Scene>& scene,
                                                           const JudgeOptions& o, const Format& format) {
    auto mesh = scene ? scene::rays::stored_mesh(*scene, format.parameters) : nullptr;
    if (mesh && mesh->size() == scene->primitive_count()) return mesh;
    throw InputError(
        fmt::format("{}: its answers are about the surface of a mesh; give --scene with a scene of [[mesh]] "
                    "tables and no other primitives",
                    o.file));
}

void print_answers(const std::string& name, const Format& format, const MeshAnswersResult& result) {
    std::vector<shell::TextColumn> columns{{"form", 28, true}, {"fmt", 5, true}};
    std::vector<std::string> cells{name, std::string(format.name)};
    for (std::size_t k = 0; k < measure::judge::mesh_outcome_rows.size(); ++k) {
        const auto outcome = static_cast<MeshOutcome>(k);
        if (!can_be(outcome, result.kind)) continue;
        const std::string title = output::map::in_words(name_of(outcome));
        columns.push_back({title, std::max<std::size_t>(title.size(), 7)});
        cells.push_back(std::to_string(result.count(outcome)));
    }
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
    const bool points = result.kind == AnswerKind::inside;
    for (const auto& [outcome, count, first] : output::judge::mesh_fault_rows(result)) {
        const std::string title = output::map::in_words(name_of(outcome));
        fmt::print("  first {}: {} {}, {}\n", title, points ? "point" : "record", first->record,
                   output::judge::words_of(*first, points));
    }
}

}  // namespace

Exit run_mesh_judge(const JudgeOptions& o, const std::optional<scene::file::Scene>& scene, scene::dump::Dump& dump,
                    const Common& common) {
    const scene::dump::Layout& layout = dump.layout();
    const AnswerKind kind = layout.answers();
    refuse_options(o, kind, layout.columns()[layout.index_of(scene::dump::slot_of(kind))].name);
    measure::judge::MeshAnswersRequest request{.mesh = mesh_given(scene, o, dump.format()),
                                               .contract = {.has_t = layout.has(scene::dump::slot::t),
                                                            .unit = o.direction == "unit",
                                                            .touching_may_miss = o.touching == "miss",
                                                            .facing = selection::contract_of(o, dump).facing},
                                               .limit = {.stop = common.stop}};
    if (kind == AnswerKind::inside) measure::judge::require_inside(request.mesh->mesh(), o.file);
    const selection::ThreadLimit threads(common.threads);
    const bool by_bytes = dump.bytes() > 0;
    output::file::Progress progress(by_bytes ? dump.bytes() : 1, "judge", common.progress, common.quiet);
    request.progress = [&](std::uint64_t bytes) { progress.advance(by_bytes ? bytes : 0); };
    const std::string stem = scene::toml::result_name(o.file), name = measure::judge::name_of_answers(stem);
    const auto folder = std::filesystem::path(o.out) / stem;
    const auto result_folder = take_folder(folder, common, output::attribution::shell_word(o.file));
    output::judge::MeshAnswerFiles files({.folder = folder,
                                          .name = name,
                                          .format = std::string(dump.format().name),
                                          .title = "answers of " + std::filesystem::path(o.file).filename().string(),
                                          .kind = kind,
                                          .rows = o.rows});
    const MeshAnswersResult result =
        measure::judge::judge_mesh_answers(dump, request, [&](const auto& answers) { files.add(answers); });
    files.finish(result);
    complete_folder(result_folder);
    progress.finish();
    if (!common.quiet) {
        selection::note_rounded(o.file, result.rounded, dump.format());
        fmt::print("{} of {}, read as {}\n",
                   scene::toml::count_with_noun(result.rays, kind == AnswerKind::inside ? "point" : "ray"), o.file,
                   dump.format().name);
        print_answers(name, dump.format(), result);
        print_faults(result);
        fmt::print("{}\n", (folder / "summary.csv").string());
    }
    return report_unproved(result.count(MeshOutcome::unresolved));
}

}  // namespace lostbits::analysis
