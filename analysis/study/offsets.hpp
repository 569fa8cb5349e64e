// The study of offsets: how far the origins of the next rays must move.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "analysis/selection/select.hpp"
#include "analysis/study/study_values.hpp"
#include "output/offset/offset_files.hpp"

namespace lostbits::analysis::study {

struct OffsetsAdapter {
    using Presentation = output::offset::OffsetPresentation;
    using Study = Presentation::Study;
    using Summaries = std::vector<Study::Summary>;
    static constexpr const char* name = "offsets";
    static constexpr const char* no_form_message =
        "offsets needs forms that return t for a primitive, and none is selected; try -i 'sphere.*'";
    static constexpr const char* title =
        "Measure how far the origin of the next ray must move, point by point, and what published strategies do";
    static constexpr const char* kinds = ", with primitives of any kind";
    static constexpr const char* form_help =
        "Forms that compute the hit points and are then tested for self-intersection (default: sphere.half_b, "
        "box.ieee_minmax, one form for each other shape, and those of --plugin, --pipe and --shader)";
    static constexpr const char* example = "sphere[0].radius=10";

    static std::vector<StudyOption> options() {
        return {{"strategy", "Strategies, by name or glob (default: all); `lostbits list strategies`", {"*"}},
                {"points",
                 "Points to use: computed (as the form computes them), projected (put back onto the surface), or both "
                 "(default)",
                 {"both"},
                 {"computed", "projected", "both"}}};
    }

    static std::vector<shell::Example> examples() {
        return {{"lostbits offsets near-benign --size 16x12", "Tries every strategy on the hits of a scene"},
                {"lostbits offsets box-one --strategy 'offset.ulp*' --points computed --size 16x12",
                 "Tries some strategies, on points as computed"}};
    }

    static std::vector<std::string> usual_forms() {
        const auto& usual = measure::offset::usual_forms();
        return {usual.begin(), usual.end()};
    }

    static bool can_measure(const intersect::table::Intersector& form) {
        return measure::offset::can_measure_offsets(form);
    }

    static void require(const scene::file::Scene& scene) { measure::offset::require_few_primitives(scene); }

    static Study make_study(const scene::file::Scene& scene,
                            const std::vector<measure::evaluate::TestedForm>& tested_forms, const StudyValues& values,
                            intersect::process::StopToken stop) {
        using measure::offset::HitPointKind;
        Study study{.scene = scene,
                    .tested_forms = {},
                    .strategies = selection::select_items(measure::offset::strategies(), values.at("strategy"),
                                                          "strategy", "--strategy"),
                    .limit = {.stop = stop}};

        // Each form has a row for each kind of points.
        const auto is_selected = [&points = values.at("points")](HitPointKind point) {
            return std::ranges::any_of(
                points, [&](const std::string& value) { return value == "both" || value == name_of(point); });
        };
        for (const measure::evaluate::TestedForm& tested_form : tested_forms)
            for (const HitPointKind point : {HitPointKind::computed, HitPointKind::projected})
                if (is_selected(point)) study.tested_forms.push_back({tested_form, point});
        return study;
    }

    static void print_results(const Study& study, const Summaries& summaries, bool) {
        for (std::size_t r = 0; r < study.tested_forms.size(); ++r)
            for (const std::string& line : output::offset::summary_lines(study, r, summaries[r]))
                fmt::print("  {}\n", line);
        if (summaries.front().points == 0)
            fmt::print(
                stderr,
                "lostbits: scene {}: the form finds no correct hit, so no next ray can start anywhere; check the eye, "
                "look_at and width or fov of its camera\n",
                study.scene.id);
    }

    static std::uint64_t unproved_count(const Summaries& summaries) { return summaries.front().unresolved; }
    static std::uint64_t unproved_count(const Presentation::SummaryRow& row) { return row.summary->unresolved; }

    /// Leaves out the search for a quiet offset, which takes as long as all the rest, if no column is about it.
    static void skip_unneeded_work(Study& study, const std::set<std::string>& columns) {
        study.search_quiet_offset = std::ranges::any_of(
            columns, [](const std::string& column) { return column.find("quiet") != std::string::npos; });
    }

    /// A ray with the fault that a column counts or, for any other column, a ray with any fault, self-hits first. It
    /// comes with the primitive that it leaves, in a form that `lostbits explain` accepts.
    static std::optional<measure::evaluate::WorstRay> witness(const Presentation::SummaryRow& row,
                                                              const std::string& column) {
        const auto bad = find_bad_ray(row.summary->side_summary(row.side).strategies[row.strategy_index], column);
        if (!bad) return std::nullopt;
        const auto explained_rays = std::make_shared<scene::rays::RayGroup>(scene::rays::make_group(bad->ray.ray));
        explained_rays->primitives = {bad->primitive};
        return measure::evaluate::WorstRay{.x = bad->x,
                                           .y = bad->y,
                                           .primitive_index = bad->primitive_index,
                                           .size = 0,
                                           .ray = bad->ray.ray,
                                           .primitive = bad->primitive,
                                           .given = explained_rays};
    }

private:
    static std::optional<measure::offset::FaultyRay> find_bad_ray(const measure::offset::StrategySummary& s,
                                                                  const std::string& column) {
        using measure::offset::Fault;
        for (std::size_t f = 0; f < measure::offset::fault_names.size(); ++f)
            if (column == std::string(measure::offset::fault_names[f]) + "_fraction") return s.first_faulty_rays[f];
        for (const Fault f : {Fault::self_hit, Fault::lost_occluder, Fault::lost_exit, Fault::self_hit_by_form})
            if (s.first_with(f)) return s.first_with(f);
        return std::nullopt;
    }
};

}  // namespace lostbits::analysis::study
