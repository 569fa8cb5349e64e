#include "measure/map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>

#include "commands.hpp"
#include "output/atomic_file.hpp"
#include "output/map_files.hpp"
#include "scene/scene.hpp"
#include "select.hpp"
#include "signals.hpp"

namespace lostbits::analysis {
namespace {

struct MapOptions {
    std::vector<std::string> scenes;
    std::vector<std::string> forms{"*"};
    std::vector<std::string> formats{"f32", "f64"};
    std::vector<std::string> metrics;
    std::string size, variant, pixels = "none";
    std::vector<std::string> set;
    std::string out;
};

/// What to type to make these files again: everything that decides their bytes, and nothing that does not.
std::string canonical_command(const scene::Scene& scene, const MapOptions& o) {
    std::string text = fmt::format("lostbits map {}", scene.id);
    for (const auto& f : o.forms) text += " -i '" + f + "'";
    for (const auto& f : o.formats) text += " -f " + f;
    for (const auto& m : o.metrics) text += " --metric " + m;
    for (const auto& s : o.set) text += " --set '" + s + "'";
    if (!o.size.empty()) text += " --size " + o.size;
    return text;
}

std::vector<scene::Scene> load(const MapOptions& o, const Common& common) {
    scene::LoadOptions options;
    if (!o.size.empty()) options.size = parse_size(o.size);
    for (const auto& s : o.set) options.overrides.push_back(scene::parse_override(s));
    std::vector<scene::Scene> scenes;
    std::set<std::string> ids;
    for (const std::string& word : o.scenes) {
        const scene::SceneName name = scene::find_scene(word, data_folder(common.data));
        options.variant = name.variant;
        if (!o.variant.empty()) options.variant = o.variant;
        for (auto& scene : scene::load_scene(name.path, options)) {
            if (!ids.insert(scene.id).second) throw InputError(fmt::format("{}: scene \"{}\" is given twice; both would write to the same folder", word, scene.id));
            scenes.push_back(std::move(scene));
        }
    }
    return scenes;
}

void print_table(const MapRequest& request, const std::vector<MapSummary>& summaries) {
    const auto lost = static_cast<std::size_t>(std::ranges::find(request.metrics, find_metric("lost_bits")) - request.metrics.begin());
    fmt::print("  {:<28} {:<5} {:>10} {:>10} {:>9} {:>6} {:>9} {:>9}\n", "form", "fmt", "false hit", "false miss", "NaN", "bits:", "p50", "p99");
    for (std::size_t r = 0; r < summaries.size(); ++r) {
        const MapSummary& s = summaries[r];
        fmt::print("  {:<28} {:<5} {:>10} {:>10} {:>9} {:>6} {:>9.2f} {:>9.2f}\n", request.rows[r].form->info->name, request.rows[r].format.name,
                   s.count(Outcome::false_hit), s.count(Outcome::false_miss), s.count(Outcome::not_a_number), "", s.metrics[lost].quantile(0.5),
                   s.metrics[lost].quantile(0.99));
    }
}

Exit run(const MapOptions& o, const Common& common) {
    if (o.out.empty()) throw InputError("-o: the name of the folder is empty; write -o . for this one");
    const auto rows = cross(select_forms(o.forms), select_formats(o.formats));
    const auto asked = o.metrics.empty() ? std::vector{find_metric("lost_bits")} : select_metrics(o.metrics);
    const auto scenes = load(o, common);
    const ThreadLimit limit(common.threads);

    std::vector<MapRequest> requests;
    std::uint64_t units = 0;
    for (const auto& scene : scenes) {
        requests.push_back({.scene = &scene, .rows = of_shape(rows, scene.shape(), scene.id), .metrics = measured(asked)});
        units += static_cast<std::uint64_t>(scene.width) * static_cast<std::uint64_t>(scene.height) * requests.back().rows.size();
    }
    // A folder that cannot be written ends the run before the first ray, not after the tenth scene.
    const auto folder = [&o](const scene::Scene& scene) { return std::filesystem::path(o.out) / scene.id; };
    for (const auto& scene : scenes) output::AtomicFile probe(folder(scene) / "summary.csv");
    output::Progress progress(units, "map", common.progress, common.quiet);
    std::uint64_t unresolved = 0;
    for (std::size_t i = 0; i < requests.size(); ++i) {
        requests[i].progress = [&progress](std::uint64_t done) {
            progress.advance(done);
            stop_if_interrupted();
        };
        output::MapFiles files(requests[i], {folder(scenes[i]), asked, o.pixels == "csv", canonical_command(scenes[i], o)});
        const auto summaries = run_map(requests[i], files.sinks());
        files.finish(summaries);
        unresolved += summaries.front().count(Outcome::unresolved);
        if (common.quiet) continue;
        fmt::print("{}\n", (folder(scenes[i]) / "contact.png").string());
        if (common.verbose) print_table(requests[i], summaries);
    }
    progress.finish();
    if (unresolved == 0) return Exit::done;
    fmt::print(stderr, "lostbits: the truth of {} rays was not proved within {} bits; they are classed `unresolved`\n", unresolved, TruthLimit{}.bits);
    return Exit::internal;
}

}  // namespace

void add_map(CLI::App& program, const Common& common, Command& chosen) {
    auto* command = program.add_subcommand("map", "Error maps of every selected form and format over the pixels of a scene");
    const auto o = std::make_shared<MapOptions>();
    command->add_option("SCENE", o->scenes, "Scene files, or names in data/scenes")->required();
    command->add_option("-i,--intersector", o->forms, "Forms, by name or glob (default: all)");
    command->add_option("-f,--format", o->formats, "Formats: f32, f64, fp16, bf16, tf32, pN, pA..pB (default: f32 f64)");
    command->add_option("--metric", o->metrics, "Metrics to draw (default: lost_bits); globs");
    command->add_option("--size", o->size, "Picture size, WxH in pixels (default: the scene's)");
    command->add_option("--variant", o->variant, "One variant of a scene that has several (default: all)");
    command->add_option("--set", o->set, "Change a number of the scene first: sphere[0].radius=10");
    command->add_option("--pixels", o->pixels, "csv: also write a row a pixel")->check(CLI::IsMember({"none", "csv"}));
    command->add_option("-o,--out", o->out, "Folder for the results")->required();
    command->callback([o, &common, &chosen] { chosen = [o, &common] { return run(*o, common); }; });
}

}  // namespace lostbits::analysis
