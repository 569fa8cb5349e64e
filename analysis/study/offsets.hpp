// Offsets of next rays, as a study.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "analysis/selection/select.hpp"
#include "analysis/study/study_values.hpp"
#include "output/offset/offset_files.hpp"

namespace lostbits::analysis::study {

struct OffsetsAdapter {
    using View = output::offset::OffsetView;
    using Study = View::Study;
    using Summaries = std::vector<Study::Summary>;
    static constexpr const char* name = "offsets";
    static constexpr const char* none_taken =
        "offsets needs forms that return t for a primitive, and none is selected; try -i 'sphere.*'";
    static constexpr const char* title =
        "Measure how far the origin of the next ray must move, point by point, and what published strategies do";
    static constexpr const char* kinds = "; primitives of any kind";
    static constexpr const char* form_help =
        "Forms that find the points and are asked for self-hits (default: sphere.half_b, box.ieee_minmax, one of each "
        "other shape, and those of --plugin, --pipe and --shader)";
    static constexpr const char* example = "sphere[0].radius=10";

    static std::vector<StudyOption> options() {
        return {{"strategy", "Strategies, by name or glob (default: all); `lostbits list strategies`", {"*"}},
                {"points",
                 "Points as computed, put back onto the surface, or both (default)",
                 {"both"},
                 {"computed", "projected", "both"}}};
    }

    static std::vector<std::string> usual_forms() {
        const auto& usual = measure::offset::usual_forms();
        return {usual.begin(), usual.end()};
    }

    static bool takes(const intersect::table::Intersector& form) { return measure::offset::can_measure_offsets(form); }

    static void require(const scene::file::Scene& scene) { measure::offset::require_few_primitives(scene); }

    static Study on(const scene::file::Scene& scene, const std::vector<measure::evaluate::TestedForm>& rows,
                    const StudyValues& values, intersect::process::StopToken stop) {
        using measure::offset::HitPoint;
        Study study{.scene = scene,
                    .rows = {},
                    .strategies = selection::select_rows(measure::offset::strategies(), values.at("strategy"),
                                                         "strategy", "--strategy"),
                    .limit = {.stop = stop}};
        const auto is_asked = [&points = values.at("points")](HitPoint point) {
            return std::ranges::any_of(
                points, [&](const std::string& word) { return word == "both" || word == name_of(point); });
        };
        for (const measure::evaluate::TestedForm& row : rows)
            for (const HitPoint point : {HitPoint::computed, HitPoint::projected})
                if (is_asked(point)) study.rows.push_back({row, point});
        return study;
    }

    static void say(const Study& study, const Summaries& summaries, bool) {
        for (std::size_t r = 0; r < study.rows.size(); ++r)
            for (const std::string& line : output::offset::summary_lines(study, r, summaries[r]))
                fmt::print("  {}\n", line);
        if (summaries.front().points == 0)
            fmt::print(
                stderr,
                "lostbits: scene {}: the form finds no correct hit, so no next ray can start anywhere; check the eye, "
                "look_at and width or fov of its camera\n",
                study.scene.id);
    }

    static std::uint64_t unproved(const Summaries& summaries) { return summaries.front().unresolved; }
};

}  // namespace lostbits::analysis::study
