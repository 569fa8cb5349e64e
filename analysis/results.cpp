#include "commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/selection/select.hpp"
#include "intersect/external/plugin.hpp"
#include "measure/answer/against.hpp"
#include "measure/choice/candidates.hpp"
#include "measure/truth/truth.hpp"
#include "number/error.hpp"
#include "output/file/atomic_file.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::analysis {

using scene::toml::counted;

void require_folder(const std::string& out) {
    if (out.empty()) throw InputError("-o: the name of the folder is empty; write -o . for the current folder");
}

std::unique_ptr<output::file::ResultFolder> own_folder(const std::filesystem::path& folder, const Common& common,
                                                       const std::string& subject,
                                                       output::file::ResultFolder::Rules rules) {
    rules.force = common.force;
    rules.figures = common.figures;
    output::file::Provenance by{common.typed.of(subject), program_and_version};
    for (const auto& row : intersect::table::intersectors().subspan(intersect::table::catalogue().size()))
        by.forms.emplace_back(row.info->name, row.info->source);
    return std::make_unique<output::file::ResultFolder>(folder, std::move(by), rules);
}

void complete(const std::unique_ptr<output::file::ResultFolder>& folder) {
    if (folder) folder->complete();
}

SceneFolders::SceneFolders(const std::vector<scene::file::Scene>& scenes, const std::string& out,
                           const Common& common) {
    for (const auto& scene : scenes) {
        const auto folder = std::filesystem::path(out) / scene.id;
        folders_.push_back(
            own_folder(folder, common, selection::name_of_scene(scene, selection::data_folder(common.data))));
        probe(folder / "summary.csv");
    }
}

std::uint64_t SceneFolders::each(std::size_t scenes, output::file::Progress& progress,
                                 const std::function<std::uint64_t(std::size_t, const Complete&)>& work) {
    std::uint64_t unproved = 0;
    for (std::size_t k = 0; k < scenes; ++k) {
        try {
            unproved += work(k, [&] {
                if (!folders_.empty()) complete(folders_[k]);
            });
        } catch (const Interrupted&) {
            if (k == 0 || folders_.empty()) throw;
            throw Error(Exit::interrupted,
                        fmt::format("interrupted: the files of {} are kept", counted(k, "finished scene")));
        }
        if (!folders_.empty()) folders_[k].reset();
    }
    progress.finish();
    return unproved;
}

std::vector<scene::file::Scene> scenes_of_primitives(const selection::SharedOptions& shared,
                                                     std::vector<measure::evaluate::TestedForm>& rows, const char* name,
                                                     const Common& common, void (*require)(const scene::file::Scene&)) {
    using scene::file::Scene;
    auto scenes = selection::load_scenes(shared.scenes, selection::data_folder(common.data));
    selection::refuse_made_rays(scenes, name);
    selection::refuse_generators(rows, name);
    for (const Scene& scene : scenes) require(scene);
    const auto met = selection::drop_unfitting(
        scenes, {rows, shared.forms, common.quiet},
        [](const Scene& s, Shapes forms) { return selection::are_primitives(forms) && s.meets(forms); },
        [](const Scene& s) { return s.id; });
    selection::note_unmeasured(shared.forms, met, common.quiet);
    return scenes;
}

void add_shard(const shell::Command& command, std::string& word) {
    command.add("--shard", word,
                "Do part K of N alone, into shard-K-of-N in the folder of results; `lostbits merge` joins all N",
                {[](const std::string& option, const std::string& given) {
                     return given.empty() ? option + ": its value is empty; write K/N, as in --shard 3/64" : "";
                 },
                 ""});
}

std::uint64_t hash_of_inputs(const std::vector<std::filesystem::path>& files, const Common& common) {
    output::shard::InputHash inputs;
    for (const auto& file : files) inputs.add_file(file);
    for (const std::string& plugin : common.external.plugins) {
        std::error_code ignored;
        const std::string file = plugin.substr(intersect::external::prefix_of_plugin(plugin).size());
        if (std::filesystem::is_regular_file(file, ignored)) inputs.add_file(file);
    }
    return inputs.value();
}

RunDivision divide(const std::string& word, const std::string& out, const std::vector<std::filesystem::path>& files,
                   const Common& common, bool resumed) {
    if (word.empty() && !common.joined) return {.division = {}, .out = out};
    const auto share = word.empty() ? measure::shard::Share{} : shard::share_named(word);
    const output::shard::StateHead head{program_and_version, common.typed.text(), hash_of_inputs(files, common), share};
    if (common.joined) {
        common.joined->check_inputs(head.inputs);
        return {.division = shard::Division(common.joined), .out = out};
    }
    const auto folder = std::filesystem::path(out) / shard::folder_name(share);
    auto owner = std::make_unique<output::file::ResultFolder>(
        folder, output::file::Provenance{fmt::format("{} --shard {}", common.typed.text(), word), program_and_version},
        output::file::ResultFolder::Rules{.force = common.force, .keep = resumed});
    return {.division = shard::Division(folder, head), .folder = std::move(owner), .out = folder};
}

void finish(RunDivision& divided, const Common& common) {
    divided.division.finish();
    complete(divided.folder);
    if (divided.division.is_shard() && !common.quiet)
        fmt::print("{}\n", (divided.out / output::shard::state_file_name).string());
}

void probe(const std::filesystem::path& file) { const output::file::AtomicFile opened(file); }

std::function<void(std::uint64_t)> advancing(output::file::Progress& progress, output::file::Estimate* estimate) {
    return [&progress, estimate](std::uint64_t done) {
        progress.advance(done);
        if (estimate != nullptr) estimate->advance(done);
    };
}

std::string each(const char* before, const std::vector<std::string>& values, const char* after) {
    std::string text;
    for (const std::string& value : values) text += before + value + after;
    return text;
}

double quantile_at(const std::string& text) {
    try {
        return measure::choice::quantile_named(text);
    } catch (const InputError& error) {
        throw InputError(std::string("--at ") + error.what());
    }
}

Exit end_with_unproved(std::uint64_t rays, int bits) {
    if (rays == 0) return Exit::done;
    fmt::print(stderr, "lostbits: the true answer for {} could not be proved within {} bits; {} as `unresolved`\n",
               counted(rays, "ray"), bits, rays == 1 ? "it counts" : "they count");
    return Exit::internal;
}

void note_suspicions(const std::vector<measure::evaluate::TestedForm>& rows, const Common& common,
                     const std::function<std::string(const measure::evaluate::TestedForm&)>& suspicion) {
    if (common.quiet) return;
    for (const std::string& line : selection::suspicions_of(rows, suspicion))
        fmt::print(stderr, "lostbits: {}\n", line);
}

void print_pairs(const std::vector<measure::evaluate::TestedForm>& rows,
                 const std::vector<const measure::metric::Metric*>& metrics,
                 const std::vector<measure::evaluate::FormSummary>& summaries) {
    const std::size_t against = measure::metric::index_of(metrics, "against");
    if (against == metrics.size()) return;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        if (rows[r].against == nullptr) continue;
        std::string words;
        for (std::size_t c = 0; c < measure::answer::against_names.size(); ++c) {
            const std::uint64_t n = summaries[r].categories[against][c];
            if (n > 0) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", n, measure::answer::against_names[c]);
        }
        std::ranges::replace(words, '_', ' ');
        fmt::print("  {} {} against {}: {}\n", rows[r].form->info->name, rows[r].format.name,
                   rows[r].against->info->name, words);
    }
}

std::string lost_or_withheld(const measure::evaluate::FormSummary& summary, std::size_t lost, double q) {
    const double bits = summary.metrics[lost].quantile(q);
    return std::isnan(bits) || !summary.agreement().is_enough() ? std::string("-") : fmt::format("{:.2f}", bits);
}

void print_table(const measure::evaluate::EvaluationRequest& request,
                 const std::vector<measure::evaluate::FormSummary>& summaries) {
    const std::size_t lost = measure::metric::index_of(request.metrics, "lost_bits");
    const bool mesh = request.scene != nullptr && request.scene->mesh;
    const auto of_mesh = [mesh](const auto& crack, const auto& twice, const auto& beside, const auto& order) {
        return mesh ? fmt::format("{:>7} {:>10} {:>15} {:>12} ", crack, twice, beside, order) : std::string();
    };
    std::size_t width = 28;
    for (const auto& row : request.rows) width = std::max(width, std::string_view(row.form->info->name).size());
    fmt::print("  {:<{}} {:<5} {}{:>15} {:>9} {:>10} {:>6} {:>8} {:>15} {:>6}\n", "form", width, "fmt",
               of_mesh("crack", "double hit", "wrong neighbour", "out of order"), "wrong primitive", "false hit",
               "false miss", "NaN", "hits", "bits lost: p50", "p99");
    bool withheld = false;
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        const measure::evaluate::FormSummary& s = summaries[r];
        using measure::answer::Outcome;
        fmt::print("  {:<{}} {:<5} {}{:>15} {:>9} {:>10} {:>6} {:>8} {:>15} {:>6}\n", request.rows[r].form->info->name,
                   width, request.rows[r].format.name,
                   of_mesh(s.count(Outcome::crack), s.count(Outcome::double_hit), s.count(Outcome::wrong_neighbour),
                           s.count(Outcome::out_of_order)),
                   s.count(measure::answer::Outcome::wrong_primitive), s.count(measure::answer::Outcome::false_hit),
                   s.count(measure::answer::Outcome::false_miss), s.count(measure::answer::Outcome::not_a_number),
                   s.count(measure::answer::Outcome::agree_hit), lost_or_withheld(s, lost, 0.5),
                   lost_or_withheld(s, lost, 0.99));
        withheld |= s.agreement().agreed > 0 && !s.agreement().is_enough();
    }
    if (withheld)
        fmt::print("  -: form and truth agree on less than a tenth of the true hits, too few to represent the form\n");
}

void print_table(const measure::evaluate::NeededRequest& request,
                 const std::vector<measure::evaluate::NeededSummary>& summaries) {
    fmt::print("  {:<28} {:>3} bits need: {:>6} {:>6} {:>6} {:>10} {:>10}\n", "form", request.bits, "p50", "p99", "max",
               "hit > 53", "miss > 53");
    for (std::size_t f = 0; f < summaries.size(); ++f) {
        const auto all = summaries[f].all();
        fmt::print("  {:<28} {:>14} {:>6} {:>6} {:>6} {:>10} {:>10}\n", request.forms[f]->info->name, "",
                   all.quantile(0.5), all.quantile(0.99), all.quantile(1), summaries[f].hits_beyond,
                   summaries[f].misses_beyond);
    }
}

void print_stages(const measure::truth::StageCounts& stages) {
    fmt::print(
        "  {} truths: {} settled in packs of doubles, {} in packs of double-doubles, {} by themselves in "
        "double-double, "
        "{} in wider intervals\n",
        stages.rays(), stages.binary64, stages.double_double, stages.ball, stages.interval);
}

}  // namespace lostbits::analysis
