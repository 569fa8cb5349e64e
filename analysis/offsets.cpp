#include "measure/offset/offsets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "analysis/selection/doors.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/selection/select.hpp"
#include "commands.hpp"
#include "measure/offset/along.hpp"
#include "output/offset/offset_files.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::analysis {

using measure::offset::Along;
using measure::offset::HitPoint;
using measure::offset::OffsetRequest;
using scene::file::Scene;

namespace {

struct OffsetOptions : selection::SharedOptions {
    std::vector<std::string> strategies{"*"};
    std::vector<std::string> along;
    std::string points = "both";

    /// The axes of --along, each once.
    [[nodiscard]] std::vector<Along> axes() const {
        std::vector<Along> axes;
        for (std::size_t k = 0; k < measure::offset::along_names.size(); ++k) {
            if (std::ranges::find(along, measure::offset::along_names[k]) != along.end())
                axes.push_back(static_cast<Along>(k));
        }
        return axes;
    }
};

/// The rows that can test a scene: each form and format, with each kind of hit point that --points names.
std::vector<measure::offset::OffsetRow> rows_for(const Scene& scene,
                                                 const std::vector<measure::evaluate::TestedForm>& all,
                                                 const OffsetOptions& o) {
    std::vector<measure::offset::OffsetRow> rows;
    for (const auto& row : selection::fitting(all, [&](Shapes forms) { return scene.meets(forms); })) {
        if (o.points != "projected") rows.push_back({row, HitPoint::computed});
        if (o.points != "computed") rows.push_back({row, HitPoint::projected});
    }
    return rows;
}

/// Measures the scene at every position along an axis.
void sweep_offsets(const OffsetRequest& request, Along along, output::offset::AlongFiles& files) {
    for (const double k : measure::offset::steps_along(along)) {
        const Scene there = measure::offset::moved_along(request.scene, along, k);
        files.add(k, measure::offset::run_offsets({.scene = there,
                                                   .rows = request.rows,
                                                   .strategies = request.strategies,
                                                   .limit = request.limit,
                                                   .quiet = request.quiet,
                                                   .progress = request.progress}));
    }
    files.finish();
}

/// The number of pixels of all rows, in the scene itself and at every position to which it is moved.
std::uint64_t units_of(const OffsetRequest& request, const OffsetOptions& o) {
    std::uint64_t pixels = request.scene.pixels();
    for (const Along along : o.axes()) {
        for (const double k : measure::offset::steps_along(along))
            pixels += measure::offset::moved_along(request.scene, along, k).pixels();
    }
    return pixels * request.rows.size();
}

/// Measures offsets on one scene. Returns the number of its rays without a proved truth.
std::uint64_t offset_scene(const OffsetRequest& request, const OffsetOptions& o, const Common& common,
                           output::file::Progress& progress, const SceneFolders::Complete& complete) {
    const auto folder = std::filesystem::path(o.out) / request.scene.id;
    std::vector<std::unique_ptr<output::offset::AlongFiles>> along;
    std::vector<output::file::DataResource> also;
    for (const Along axis : o.axes()) {
        along.push_back(std::make_unique<output::offset::AlongFiles>(folder, request, axis));
        also.push_back(along.back()->resource());
    }
    output::offset::OffsetFiles files(
        request,
        {.folder = folder, .pixels_csv = o.pixels == "csv", .singles = o.pictures == "all", .also = std::move(also)});
    const auto summaries =
        measure::offset::run_offsets(request, [&files](std::size_t row, const auto& band) { files.band(row, band); });
    for (std::size_t k = 0; k < along.size(); ++k) sweep_offsets(request, o.axes()[k], *along[k]);
    files.finish(summaries);
    complete();
    if (!common.quiet) {
        progress.aside([&] {
            fmt::print("{}\n", (folder / "contact.png").string());
            for (std::size_t r = 0; r < request.rows.size(); ++r) {
                for (const std::string& line : output::offset::row_in_words(request, r, summaries[r]))
                    fmt::print("  {}\n", line);
            }
            if (summaries.front().points == 0)
                fmt::print(stderr,
                           "lostbits: scene {}: the form finds no correct hit, so there is no point that a next ray "
                           "could leave; check the eye, look_at and width or fov of its camera\n",
                           request.scene.id);
        });
    }
    return summaries.front().unresolved;
}

Exit run(const OffsetOptions& o, const Common& common) {
    require_folder(o.out);
    const auto& usual = measure::offset::usual_forms();
    auto rows =
        selection::cross(selection::select_forms(selection::form_words_or(o.forms, {usual.begin(), usual.end()})),
                         selection::select_formats(o.formats));
    std::erase_if(rows, [](const auto& row) { return !measure::offset::can_be_asked(*row.form); });
    if (rows.empty())
        throw NothingSelected(
            "offsets needs forms that return t for a primitive, and none is selected; try -i 'sphere.*'");
    const auto strategies =
        selection::select_rows(measure::offset::strategies(), o.strategies, "strategy", "--strategy");
    auto scenes = scenes_of_solids(o, rows, "offsets", common);
    const selection::ThreadLimit limit(common.threads);

    std::vector<OffsetRequest> requests;
    std::uint64_t units = 0;
    for (const Scene& scene : scenes) {
        measure::offset::require_few_solids(scene);
        requests.push_back({.scene = scene,
                            .rows = rows_for(scene, rows, o),
                            .strategies = strategies,
                            .limit = {.stop = common.stop}});
        units += units_of(requests.back(), o);
    }
    SceneFolders folders(scenes, o.out, common);
    for (const auto& scene : scenes) selection::note_numbers(scene, o.scenes.set, rows, common.quiet);

    output::file::Progress progress(units, "offsets", common.progress, common.quiet);
    output::file::Estimate estimate(progress, "offsets", units, common.quiet);
    return end_with_unproved(folders.each(requests.size(), progress, [&](std::size_t k, const auto& complete) {
        requests[k].progress = advancing(progress, &estimate);
        return offset_scene(requests[k], o, common, progress, complete);
    }));
}

}  // namespace

void add_offsets(const shell::Command& program, const Common& common) {
    auto command = program.add_command(
        "offsets", "How far the origin of the next ray must move, point by point, and what published strategies do");
    const auto o = std::make_shared<OffsetOptions>();
    o->formats = {std::string(measure::offset::usual_format)};
    o->scenes.stop = common.stop;
    o->scenes.all_ahead = true;
    selection::add_scenes(command, *o, "; primitives of any kind");
    command.add_list("-i,--intersector", o->forms,
                     "Forms that find the points and are asked for self-hits (default: sphere.half_b, "
                     "box.ieee_minmax, one of each other shape, and those of --plugin, --pipe and --shader)");
    selection::add_formats(command, o->formats, "f32");
    command.add_list("--strategy", o->strategies,
                     "Strategies, by name or glob (default: all); `lostbits list strategies`");
    command.add("--points", o->points, "Points as computed, put back onto the surface, or both (default)",
                shell::one_of({"computed", "projected", "both"}));
    selection::add_changes(command, o->scenes, "sphere[0].radius=10");
    selection::add_pixels(command, *o);
    selection::add_pictures(command, o->pictures);
    command.add_list("--along", o->along,
                     "Also with the scene moved along an axis: distance of the eye, radius (every length), world "
                     "(offset from the origin); pictures of 48 columns",
                     shell::one_of({measure::offset::along_names.begin(), measure::offset::along_names.end()}));
    selection::add_out(command, o->out);
    command.runs([o, &common] { return run(*o, common); });
}

}  // namespace lostbits::analysis
