// The study of rendered pictures.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "analysis/selection/select.hpp"
#include "analysis/study/study_values.hpp"
#include "number/error.hpp"
#include "output/render/render_files.hpp"

namespace lostbits::analysis::study {

struct RenderAdapter {
    using Presentation = output::render::RenderPresentation;
    using Study = Presentation::Study;
    using Summaries = std::vector<Study::Summary>;
    static constexpr const char* name = "render";
    static constexpr const char* no_form_message =
        "render draws spheres, and none of the selected forms is for a sphere; try -i 'sphere.*'";
    static constexpr const char* title =
        "Draw a scene, stage by stage, with a form in a format, and compare with the picture drawn from proved "
        "answers";
    static constexpr const char* kinds = ", of spheres";
    static constexpr const char* form_help =
        "Forms that find hits and shadows, by name or glob (default: sphere.expanded, and those of --plugin, --pipe "
        "and --shader)";
    static constexpr const char* example = "light.position=[9,9,9]";

    static std::vector<StudyOption> options() {
        return {{"stage",
                 "Stages to draw; may be repeated (default: the last that the scene has)",
                 {},
                 {scene::file::stage_names.begin(), scene::file::stage_names.end()}}};
    }

    static std::vector<shell::Example> examples() {
        return {{"lostbits render raycast-acne --stage shadows --size 32x32", "Draws a scene with its shadows"},
                {"lostbits render raycast-acne -i sphere.press -f fp16 --size 32x32",
                 "Draws it with a form in half precision"}};
    }

    /// The form of the source.
    static std::vector<std::string> usual_forms() { return {"sphere.expanded"}; }

    static bool can_measure(const intersect::table::Intersector& form) {
        return form.shape == scene::file::rendered_shape;
    }

    /// Refuses scenes that do not consist of spheres with colours.
    static void require(const scene::file::Scene& scene) {
        if (scene.flake)
            throw InputError(
                fmt::format("{}: the spheres of [sphereflake] have no colours, so render cannot draw them; use "
                            "`lostbits map`",
                            scene.path.string()));
        if (!scene.accepts(Shapes(scene::file::rendered_shape).with_transform(scene.has_transform())))
            throw InputError(
                fmt::format("{}: render draws {}, but scene \"{}\" has {}; use `lostbits map`", scene.path.string(),
                            row_of(scene::file::rendered_shape).plural, scene.id,
                            Shapes(scene.shapes()).has(scene::file::rendered_shape) ? "other primitives too" : "none"));
    }

    /// Draws a stage that the scene does not have as the last one before it that the scene has.
    static Study make_study(const scene::file::Scene& scene, std::vector<measure::evaluate::TestedForm> tested_forms,
                            const StudyValues& values, intersect::process::StopToken stop) {
        std::set<scene::file::Stage> stages;
        for (const std::string& stage_name : values.at("stage"))
            stages.insert(scene.appearance.last_stage_up_to(parse_stage(stage_name)));
        if (stages.empty()) stages.insert(scene.appearance.last_stage());
        return {.scene = scene,
                .stages = {stages.begin(), stages.end()},
                .tested_forms = std::move(tested_forms),
                .limit = {.stop = stop}};
    }

    /// Prints which stages a scene does not have.
    static void print_missing_stages(const scene::file::Scene& scene, const StudyValues& values) {
        for (const std::string& stage_name : values.at("stage")) {
            const auto requested = parse_stage(stage_name), drawn = scene.appearance.last_stage_up_to(requested);
            if (drawn != requested)
                fmt::print(stderr, "lostbits: scene {} has no stage {}; drawing stage {} instead\n", scene.id,
                           stage_name, name_of(drawn));
        }
    }

    static void print_results(const Study& study, const Summaries& summaries, bool verbose) {
        if (verbose) print_rendered(study, summaries);
    }

    /// The number of pixels with something that is not proved.
    static std::uint64_t unproved_count(const Summaries& summaries) {
        std::uint64_t max_unproved = 0;
        for (const Study::Summary& row : summaries)
            for (const measure::render::RenderSummary& summary : row)
                max_unproved = std::max(max_unproved, summary.unresolved_count());
        return max_unproved;
    }

    static std::uint64_t unproved_count(const Presentation::SummaryRow& row) { return row.summary->unresolved_count(); }

private:
    /// The stage of this name, which must be known.
    static scene::file::Stage parse_stage(const std::string& stage_name) {
        const auto& names = scene::file::stage_names;
        return static_cast<scene::file::Stage>(std::ranges::find(names, stage_name) - names.begin());
    }

    static void print_rendered(const Study& study, const Summaries& summaries) {
        fmt::print("  {:<8} {:<28} {:<5} {:>12} {:>12} {:>9} {:>9} {:>10} {:>9}\n", "stage", "form", "fmt",
                   "wrong colour", "wrong sphere", "acne", "flips", "p99 steps", "unproved");
        for (std::size_t r = 0; r < summaries.size(); ++r) {
            const measure::evaluate::TestedForm& tested_form = study.tested_forms[r];
            for (const measure::render::RenderSummary& summary : summaries[r])
                fmt::print("  {:<8} {:<28} {:<5} {:>12} {:>12} {:>9} {:>9} {:>10.3g} {:>9}\n", name_of(summary.stage),
                           tested_form.form->info->name, tested_form.format.name, summary.changed_pixel_count,
                           summary.wrong_pixel_count(),
                           summary.count(measure::render::Receiver::sphere, measure::render::Shadow::own_shadow),
                           summary.flipped_shadow_count(), summary.colour_error.quantile(0.99),
                           summary.unresolved_count());
        }
    }
};

}  // namespace lostbits::analysis::study
