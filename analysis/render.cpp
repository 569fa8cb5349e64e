#include "measure/picture/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>

#include "analysis/selection/doors.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/selection/select.hpp"
#include "commands.hpp"
#include "output/picture/render_files.hpp"
#include "scene/file/scene.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::analysis {

using measure::picture::RenderRequest;
using measure::picture::RenderSummary;
using scene::file::Scene;

namespace {

struct RenderOptions : selection::SharedOptions {
    std::vector<std::string> stages;
};

/// Returns the scenes. Throws InputError for a scene that does not consist of spheres with colours.
std::vector<Scene> renderable(std::vector<Scene> scenes) {
    selection::refuse_made_rays(scenes, "render");
    for (const Scene& scene : scenes) {
        if (scene.flake)
            throw InputError(
                fmt::format("{}: the spheres of [sphereflake] have no colours, so there is no picture to render; use "
                            "`lostbits map`",
                            scene.path.string()));
        if (!scene.meets(Shapes(scene::file::rendered_shape).placed(scene.is_placed())))
            throw InputError(
                fmt::format("{}: render draws {}, but scene \"{}\" has {}; use `lostbits map`", scene.path.string(),
                            row_of(scene::file::rendered_shape).plural, scene.id,
                            Shapes(scene.shapes()).has(scene::file::rendered_shape) ? "other primitives too" : "none"));
    }
    return scenes;
}

/// The stages to draw, in rising order. A stage that the scene does not have is replaced by the last one before it that
/// the scene has.
std::vector<scene::file::Stage> stages_of(const Scene& scene, const RenderOptions& o, bool quiet) {
    using scene::file::Stage;
    if (o.stages.empty()) return {scene.appearance.furthest()};
    std::set<Stage> stages;
    for (const std::string& word : o.stages) {
        const auto asked =
            static_cast<Stage>(std::ranges::find(scene::file::stage_names, word) - scene::file::stage_names.begin());
        const Stage drawn = scene.appearance.last_up_to(asked);
        stages.insert(drawn);
        if (drawn != asked && !quiet)
            fmt::print(stderr, "lostbits: scene {} has no stage {}; drawing stage {} instead\n", scene.id, word,
                       name_of(drawn));
    }
    return {stages.begin(), stages.end()};
}

void print_rendered(const RenderRequest& request, const std::vector<RenderSummary>& summaries) {
    fmt::print("  {:<8} {:<28} {:<5} {:>12} {:>12} {:>9} {:>9} {:>10} {:>9}\n", "stage", "form", "fmt", "wrong colour",
               "wrong sphere", "acne", "flips", "p99 steps", "unproved");
    for (std::size_t k = 0; k < summaries.size(); ++k) {
        const RenderSummary& s = summaries[k];
        const measure::evaluate::TestedForm& row = request.rows[k / request.stages.size()];
        fmt::print("  {:<8} {:<28} {:<5} {:>12} {:>12} {:>9} {:>9} {:>10.3g} {:>9}\n", name_of(s.stage),
                   row.form->info->name, row.format.name, s.changed, s.seen_wrong(),
                   s.count(false, measure::picture::Shadow::own_shadow), s.flips(), s.colour_error.quantile(0.99),
                   s.unresolved());
    }
}

/// Renders one scene. Returns the number of pixels with something that is not proved.
std::uint64_t render_scene(const RenderRequest& request, const RenderOptions& o, const Common& common,
                           output::file::Progress& progress, const SceneFolders::Complete& complete) {
    const auto folder = std::filesystem::path(o.out) / request.scene.id;
    output::picture::RenderFiles files(
        request,
        {.folder = folder,
         .command = common.typed.of(selection::name_of_scene(request.scene, selection::data_folder(common.data))),
         .singles = o.pictures == "all"});
    const auto summaries =
        measure::picture::run_render(request, [&files](std::size_t row, const auto& band) { files.band(row, band); });
    files.finish(summaries);
    complete();
    progress.aside([&] {
        if (!common.quiet) fmt::print("{}\n", (folder / "contact.png").string());
        if (common.verbose) print_rendered(request, summaries);
    });
    std::uint64_t unproved = 0;
    for (const RenderSummary& s : summaries) unproved = std::max(unproved, s.unresolved());
    return unproved;
}

Exit run(const RenderOptions& o, const Common& common) {
    require_folder(o.out);
    const auto forms =
        selection::select_forms(selection::form_words_or(o.forms, {"sphere.expanded"}));  // the form of the source
    auto all = selection::cross(forms, selection::select_formats(o.formats));
    std::erase_if(all, [](const auto& row) { return row.form->shape != scene::file::rendered_shape; });
    if (all.empty())
        throw NothingSelected(
            "render draws spheres, and none of the selected forms is for a sphere; try -i 'sphere.*'");
    selection::refuse_makers(all, "render");
    auto scenes = renderable(selection::load_scenes(o.scenes, selection::data_folder(common.data)));
    const auto rows = selection::drop_unfitting(
        scenes, {all, o.forms, common.quiet}, [](const Scene& s, Shapes shapes) { return s.meets(shapes); },
        [](const Scene& s) { return "scene " + s.id; });
    selection::note_unmeasured(o.forms, rows, common.quiet);
    const selection::ThreadLimit limit(common.threads);

    std::vector<RenderRequest> requests;
    std::uint64_t units = 0;
    for (const auto& scene : scenes) {
        requests.push_back({.scene = scene,
                            .stages = stages_of(scene, o, common.quiet),
                            .rows = selection::fitting(rows, [&](Shapes shapes) { return scene.meets(shapes); }),
                            .limit = {.stop = common.stop}});
        units += scene.pixels() * requests.back().rows.size();
    }
    SceneFolders folders(scenes, o.out, common);
    for (const auto& scene : scenes) selection::note_numbers(scene, o.scenes.set, rows, common.quiet);

    output::file::Progress progress(units, "render", common.progress, common.quiet);
    const std::uint64_t unproved = folders.each(requests.size(), progress, [&](std::size_t k, const auto& complete) {
        requests[k].progress = advancing(progress);
        return render_scene(requests[k], o, common, progress, complete);
    });
    if (unproved > 0 && !common.quiet)
        fmt::print(stderr, "lostbits: {} could not be proved within {} bits; {} as `unresolved` and {} drawn as such\n",
                   scene::toml::counted(unproved, "pixel"), measure::picture::PictureLimit{}.bits,
                   unproved == 1 ? "it counts" : "they count", unproved == 1 ? "is" : "are");
    return unproved == 0 ? Exit::done : Exit::internal;
}

}  // namespace

void add_render(const shell::Command& program, const Common& common) {
    auto command = program.add_command(
        "render", "Draw a scene, stage by stage, with a form in a format, and compare with the certified picture");
    const auto o = std::make_shared<RenderOptions>();
    o->formats = {"f32"};
    o->scenes.stop = common.stop;
    o->scenes.all_ahead = true;
    selection::add_scenes(command, *o, "; scenes of spheres");
    command.add_list(
        "-i,--intersector", o->forms,
        "Forms that find hits and shadows, by name or glob (default: sphere.expanded, and those of --plugin, "
        "--pipe and --shader)");
    selection::add_formats(command, o->formats, "f32");
    command.add_list("--stage", o->stages,
                     "visible, diffuse, shadows, phong; may be repeated (default: the last that the scene has)",
                     shell::one_of({scene::file::stage_names.begin(), scene::file::stage_names.end()}));
    selection::add_changes(command, o->scenes, "light.position=[9,9,9]");
    selection::add_pictures(command, o->pictures);
    selection::add_out(command, o->out);
    command.runs([o, &common] { return run(*o, common); });
}

}  // namespace lostbits::analysis
