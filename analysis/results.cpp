#include "commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/selection/select.hpp"
#include "intersect/external/plugin.hpp"
#include "measure/answer/against.hpp"
#include "measure/choose/candidates.hpp"
#include "measure/truth/truth.hpp"
#include "number/error.hpp"
#include "output/file/atomic_file.hpp"
#include "output/image/figure.hpp"
#include "output/map/form_names.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::analysis {

using text::count_with_noun;

void require_folder(const std::string& out) {
    if (out.empty()) throw InputError("-o: the name of the folder is empty; write -o . for the current folder");
}

std::unique_ptr<output::file::ResultFolder> lock_folder(const std::filesystem::path& folder,
                                                        const CommonOptions& common, const std::string& subject,
                                                        output::file::ResultFolder::Rules rules) {
    rules.allows_unlisted = common.force;
    for (const std::string& kind : common.figures)
        if (std::ranges::find(rules.figures, kind) == rules.figures.end()) rules.figures.push_back(kind);
    output::file::Provenance provenance{common.typed_command.for_subject(subject), program_and_version};
    for (const auto& form : intersect::table::intersectors().subspan(intersect::table::catalogue().size()))
        provenance.forms.emplace_back(form.info->name, form.info->source);
    return std::make_unique<output::file::ResultFolder>(folder, std::move(provenance), rules);
}

void complete_folder(const std::unique_ptr<output::file::ResultFolder>& folder) {
    if (folder) folder->complete();
}

std::unique_ptr<output::file::ResultFolder> lock_folder(const RunDivision& run_division,
                                                        const std::filesystem::path& folder,
                                                        const CommonOptions& common, const std::string& subject,
                                                        output::file::ResultFolder::Rules rules) {
    return run_division.division.is_shard() ? nullptr : lock_folder(folder, common, subject, std::move(rules));
}

SceneFolders::SceneFolders(const std::vector<scene::file::Scene>& scenes, const RunDivision& run_division,
                           const CommonOptions& common) {
    if (run_division.division.is_shard()) return;
    for (const auto& scene : scenes) {
        const auto folder = run_division.out / scene.id;
        folders_.push_back(
            lock_folder(folder, common, selection::scene_arguments(scene, selection::data_folder(common.data))));
        require_writable(folder / "summary.csv");
    }
}

std::uint64_t SceneFolders::for_each(std::size_t scene_count, output::file::Progress& progress,
                                     const std::function<std::uint64_t(std::size_t, const CompleteCallback&)>& work) {
    std::uint64_t unproved = 0;
    for (std::size_t k = 0; k < scene_count; ++k) {
        try {
            unproved += work(k, [&] {
                if (!folders_.empty()) complete_folder(folders_[k]);
            });
        } catch (const Interrupted&) {
            if (k == 0 || folders_.empty()) throw;
            throw Error(ExitStatus::interrupted,
                        fmt::format("interrupted: the files of {} are kept", count_with_noun(k, "finished scene")));
        }
        if (!folders_.empty()) folders_[k].reset();
    }
    progress.finish();
    return unproved;
}

std::vector<scene::file::Scene> load_primitive_scenes(const selection::SharedOptions& shared,
                                                      std::vector<measure::evaluate::TestedForm>& tested_forms,
                                                      const char* command, const CommonOptions& common,
                                                      void (*require_scene)(const scene::file::Scene&)) {
    using scene::file::Scene;
    auto scenes = selection::load_scenes(shared.scenes, selection::data_folder(common.data));
    selection::require_no_generated_rays(scenes, command);
    selection::require_no_generators(tested_forms, command);
    for (const Scene& scene : scenes) require_scene(scene);
    const auto handling_forms = selection::drop_unhandled(
        scenes, {tested_forms, shared.forms, common.quiet},
        [](const Scene& scene, Shapes forms) { return selection::are_primitives(forms) && scene.accepts(forms); },
        [](const Scene& scene) { return scene.id; });
    selection::note_unmeasured(shared.forms, handling_forms, common.quiet);
    return scenes;
}

void add_shard(const shell::Command& command, std::string& shard_value) {
    command.add("--shard", shard_value, "Do only part K of N; `lostbits merge` joins the parts (docs/shards.md)",
                {[](const std::string& option, const std::string& value) {
                     return value.empty() ? option + ": its value is empty; write K/N, as in --shard 3/64" : "";
                 },
                 ""});
}

std::uint64_t hash_inputs(const std::vector<std::filesystem::path>& files, const CommonOptions& common) {
    output::shard::InputHash inputs;
    for (const auto& file : files) inputs.add_file(file);
    for (const std::string& plugin : common.external.plugins) {
        std::error_code ignored;
        const std::string file = plugin.substr(intersect::external::prefix_of_plugin(plugin).size());
        if (std::filesystem::is_regular_file(file, ignored)) inputs.add_file(file);
    }
    return inputs.value();
}

RunDivision divide_run(const std::string& shard_value, const std::string& out,
                       const std::vector<std::filesystem::path>& files, const CommonOptions& common, bool is_resumed) {
    if (shard_value.empty() && !common.shards_to_join) return {.division = {}, .out = out};
    const auto share = shard_value.empty() ? measure::shard::Share{} : shard::parse_share(shard_value);
    const output::shard::StateHead head{program_and_version, common.typed_command.text(), hash_inputs(files, common),
                                        share};
    if (common.shards_to_join) {
        common.shards_to_join->require_same_inputs(head.inputs);
        return {.division = shard::Division(common.shards_to_join), .out = out};
    }
    const auto folder = std::filesystem::path(out) / shard::folder_name(share);
    auto result_folder = std::make_unique<output::file::ResultFolder>(
        folder,
        output::file::Provenance{fmt::format("{} --shard {}", common.typed_command.text(), shard_value),
                                 program_and_version},
        output::file::ResultFolder::Rules{.allows_unlisted = common.force, .continues_run = is_resumed});
    return {.division = shard::Division(folder, head), .folder = std::move(result_folder), .out = folder};
}

bool finish_run(RunDivision& run_division, const CommonOptions& common) {
    run_division.division.finish();
    complete_folder(run_division.folder);
    if (!run_division.division.is_shard()) return true;
    if (!common.quiet) fmt::print("{}\n", (run_division.out / output::shard::state_file_name).string());
    return false;
}

void require_writable(const std::filesystem::path& file) { const output::file::AtomicFile file_to_write(file); }

std::function<void(std::uint64_t)> advance_callback(output::file::Progress& progress,
                                                    output::file::Estimate* estimate) {
    return [&progress, estimate](std::uint64_t done) {
        progress.advance(done);
        if (estimate != nullptr) estimate->advance(done);
    };
}

std::string concatenate(const char* prefix, const std::vector<std::string>& values, const char* suffix) {
    std::string text;
    for (const std::string& value : values) text += prefix + value + suffix;
    return text;
}

double parse_quantile(const std::string& text) {
    try {
        return measure::choose::parse_quantile(text);
    } catch (const InputError& error) {
        throw InputError(std::string("--at ") + error.what());
    }
}

ExitStatus report_unproved(std::uint64_t ray_count, int bits) {
    if (ray_count == 0) return ExitStatus::done;
    fmt::print(stderr, "lostbits: the true answer for {} could not be proved within {} bits; {} as `unresolved`\n",
               count_with_noun(ray_count, "ray"), bits, ray_count == 1 ? "it counts" : "they count");
    return ExitStatus::unproved;
}

void note_suspicions(const std::vector<measure::evaluate::TestedForm>& tested_forms, const CommonOptions& common,
                     const std::function<std::string(const measure::evaluate::TestedForm&)>& suspicion) {
    if (common.quiet) return;
    for (const std::string& line : selection::list_suspicions(tested_forms, suspicion))
        fmt::print(stderr, "lostbits: {}\n", line);
}

void print_figure_paths(const std::filesystem::path& path) {
    for (const auto& file : output::image::figure_paths(path)) fmt::print("{}\n", file.string());
}

void print_comparisons(const std::vector<measure::evaluate::TestedForm>& tested_forms,
                       const std::vector<const measure::metric::Metric*>& metrics,
                       const std::vector<measure::evaluate::FormSummary>& summaries) {
    const std::size_t against = measure::metric::index_of(metrics, "against");
    if (against == metrics.size()) return;
    for (std::size_t r = 0; r < tested_forms.size(); ++r) {
        if (tested_forms[r].against == nullptr) continue;
        std::string counts;
        for (std::size_t c = 0; c < measure::answer::against_names.size(); ++c) {
            const std::uint64_t n = summaries[r].categories[against][c];
            if (n > 0)
                counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", n,
                                      output::map::name_in_words(measure::answer::against_names[c]));
        }
        fmt::print("  {} {} against {}: {}\n", tested_forms[r].form->info->name, tested_forms[r].format.name,
                   tested_forms[r].against->info->name, counts);
    }
}

std::string lost_bits_cell(const measure::evaluate::FormSummary& summary, std::size_t lost_bits, double quantile) {
    const double bits = summary.metrics[lost_bits].quantile(quantile);
    return std::isnan(bits) || !summary.agreement().is_enough() ? std::string("-") : fmt::format("{:.2f}", bits);
}

void add_mesh_columns(std::vector<shell::TextColumn>& columns) {
    columns.insert(columns.end(), {{"crack", 7}, {"double hit", 10}, {"wrong neighbour", 15}, {"out of order", 12}});
}

void add_mesh_cells(std::vector<std::string>& cells, const measure::evaluate::FormSummary& summary,
                    measure::contract::AnswerSource source) {
    const bool recognises_cracks = source == measure::contract::AnswerSource::intersector;
    using measure::answer::Outcome;
    for (const Outcome outcome : {Outcome::crack, Outcome::double_hit, Outcome::wrong_neighbour, Outcome::out_of_order})
        cells.push_back(
            recognises_cracks || outcome == Outcome::wrong_neighbour ? std::to_string(summary.count(outcome)) : "-");
}

void add_wrong_columns(std::vector<shell::TextColumn>& columns) {
    columns.insert(columns.end(), {{"wrong primitive", 15}, {"false hit", 9}, {"false miss", 10}, {"NaN", 6}});
}

void add_wrong_cells(std::vector<std::string>& cells, const measure::evaluate::FormSummary& summary) {
    using measure::answer::Outcome;
    for (const Outcome outcome :
         {Outcome::wrong_primitive, Outcome::false_hit, Outcome::false_miss, Outcome::not_a_number})
        cells.push_back(std::to_string(summary.count(outcome)));
}

void print_table(const measure::evaluate::MapStudy& study,
                 const std::vector<measure::evaluate::FormSummary>& summaries) {
    const std::size_t lost_bits = measure::metric::index_of(study.metrics, "lost_bits");
    const bool has_mesh = study.scene != nullptr && study.scene->mesh;
    std::vector<shell::TextColumn> columns{{"form", 28, true}, {"fmt", 5, true}, {"hits", 8}};
    if (has_mesh) add_mesh_columns(columns);
    add_wrong_columns(columns);
    columns.insert(columns.end(), {{"bits lost: p50", 15}, {"p99", 6}});
    shell::TextTable table(std::move(columns));

    bool is_withheld = false;  // a row has hits, but too few for its quantiles
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        const measure::evaluate::FormSummary& summary = summaries[r];
        std::vector<std::string> cells{std::string(study.tested_forms[r].form->info->name),
                                       std::string(study.tested_forms[r].format.name),
                                       std::to_string(summary.count(measure::answer::Outcome::agree_hit))};
        if (has_mesh) add_mesh_cells(cells, summary, measure::contract::AnswerSource::intersector);
        add_wrong_cells(cells, summary);
        cells.insert(cells.end(), {lost_bits_cell(summary, lost_bits, 0.5), lost_bits_cell(summary, lost_bits, 0.99)});
        table.add(std::move(cells));
        is_withheld |= summary.agreement().agreed_count > 0 && !summary.agreement().is_enough();
    }
    table.print();
    if (is_withheld)
        fmt::print("  -: form and truth agree on less than a tenth of the true hits, too few to represent the form\n");
}

void print_table(const measure::evaluate::BitsNeededStudy& study,
                 const std::vector<measure::evaluate::BitsNeededSummary>& summaries) {
    shell::TextTable table({{"form", 28, true},
                            {fmt::format("bits for {} correct: p50", study.correct_bits), 24},
                            {"p99", 6},
                            {"max", 6},
                            {"hits beyond 53", 16},
                            {"misses beyond 53", 18}});
    for (std::size_t f = 0; f < summaries.size(); ++f) {
        const auto all = summaries[f].all();
        const auto bits = [&all](double q) { return fmt::format("{}", all.quantile(q)); };
        table.add({std::string(study.tested_forms[f]->info->name), bits(0.5), bits(0.99), bits(1),
                   std::to_string(summaries[f].hits_beyond), std::to_string(summaries[f].misses_beyond)});
    }
    table.print();
}

void print_stages(const measure::truth::StageCounts& stages) {
    fmt::print(
        "  {} truths: {} settled in packs of doubles, {} in packs of double-doubles, {} one by one in double-double, "
        "{} in wider intervals\n",
        stages.ray_count(), stages.binary64, stages.double_double, stages.ball, stages.interval);
}

}  // namespace lostbits::analysis
