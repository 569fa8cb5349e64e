// The sections of a report that answer a requirement: a choice, and a repaired form.
#include <charconv>

#include <fmt/format.h>

#include "analysis/report/report_sections.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/selection/select.hpp"
#include "measure/choose/margin.hpp"
#include "output/choose/choice_files.hpp"
#include "output/image/figure.hpp"
#include "output/repair/repair_files.hpp"
#include "output/report/page.hpp"

namespace lostbits::analysis::report {

namespace {

/// Parses the value `REST:BITS` or `REST:BITS:AT` of an option.
class RequirementText {
public:
    /// `default_requirement` is the requirement of a text without AT. Throws InputError if the bits, or the section
    /// before them, are missing.
    RequirementText(std::string option, std::string parts, std::string example, const std::string& text,
                    measure::choose::Requirement default_requirement)
        : requirement(default_requirement),
          rest(text),
          option_(std::move(option)),
          parts_(std::move(parts)),
          example_(std::move(example)),
          text_(text) {
        // The last part may be the fraction of the hits, such as p99.
        std::string bits = remove_last_part();
        if (bits.starts_with('p') || bits == "max") {
            try {
                requirement.quantile = measure::choose::parse_quantile(bits);
            } catch (const InputError& error) {
                refuse(error.what());
            }
            bits = remove_last_part();
        }

        if (rest.empty())
            refuse(text.find(':') == std::string::npos ? "the bits are missing" : "the scene or the bits are missing");
        const auto [end, error] = std::from_chars(bits.data(), bits.data() + bits.size(), requirement.bits);
        if (error != std::errc{} || end != bits.data() + bits.size() ||
            !(requirement.bits >= 0 && requirement.bits <= 53))
            refuse("\"" + bits + "\" is not a number of bits from 0 to 53");
    }
    /// Removes the part after the last colon and returns it.
    std::string remove_last_part() {
        const auto colon = rest.rfind(':');
        std::string part = colon == std::string::npos ? "" : rest.substr(colon + 1);
        rest.resize(colon == std::string::npos ? 0 : colon);
        return part;
    }
    [[noreturn]] void refuse(const std::string& why) const {
        throw InputError(
            fmt::format("{} {}: {}; write {} and the number of correct bits, as in {}:18, or also the share of the "
                        "hits that must keep them, as in {}:18:max",
                        option_, text_, why, parts_, example_, example_));
    }

    measure::choose::Requirement requirement;
    std::string rest;

private:
    std::string option_, parts_, example_, text_;
};

}  // namespace

PlannedChoice parse_choice(const std::string& text, const std::string& size, const selection::SelectedForms& selected,
                           const std::filesystem::path& data, StopToken stop) {
    const RequirementText parsed("--choose", "a scene", "near-benign", text, {});
    auto scene = selection::load_one_scene({{parsed.rest}, size, "", {}, stop}, data);
    auto timed_forms = selection::select_timed_forms(scene, selected);
    return {std::move(scene), parsed.requirement, std::move(timed_forms)};
}

PlannedMend parse_mend(const std::string& text, const std::string& size, const std::filesystem::path& data,
                       StopToken stop) {
    RequirementText parsed("--mend", "a scene, a form", "near-benign:sphere.half_b", text, {.quantile = 1});
    const std::string form = parsed.remove_last_part();
    if (parsed.rest.empty()) parsed.refuse("the scene or the form is missing");
    auto scene = selection::load_one_scene({{parsed.rest}, size, "", {}, stop}, data);
    auto candidates =
        selection::pair_forms_with_formats(selection::select_forms({form}), selection::select_formats({"f32"}));
    const auto tested_forms = selection::tested_forms_handling(
        {candidates, {form}, true}, scene.id,
        [&scene](Shapes shapes) { return selection::are_primitives(shapes) && scene.accepts(shapes); });
    if (tested_forms.size() != 1) parsed.refuse(form + " is not one form for the primitives of that scene");
    selection::require_no_generators({tested_forms.front().form}, "mend");
    selection::require_no_generated_rays({scene}, "mend");
    PlannedMend planned{std::move(scene), parsed.requirement, tested_forms.front()};
    // Refuses a form that filters here, before anything is measured.
    static_cast<void>(measure::repair::record_tape({.scene = &planned.scene, .tested_form = planned.tested_form}));
    return planned;
}

output::report::ChoiceSection measure_choice_section(const PlannedChoice& planned, StopToken stop) {
    measure::choose::ChoiceRequest request{
        .scene = &planned.scene, .tested_forms = planned.tested_forms, .requirement = planned.requirement};
    request.plan.repetitions = 5;  // as `lostbits choose --quick`
    request.plan.min_seconds = 1e-4;
    request.limit.stop = request.plan.stop = stop;
    measure::choose::TimedRays timed_rays;
    const auto candidates = measure_candidates(request, timed_rays);
    const auto chosen = output::choose::choose_among(request, candidates, timed_rays);
    return {.scene = planned.scene.id,
            .requirement = output::choose::requirement_text(planned.requirement),
            .text = output::choose::choice_text(chosen),
            .table = output::report::choice_table(chosen),
            .front_chart = {fmt::format("Time against kept bits on {}", planned.scene.id),
                            svg_text(draw_pareto_plot(chosen))}};
}

output::report::MendSection measure_mend_section(const PlannedMend& planned, StopToken stop) {
    measure::repair::RepairRequest request{
        .scene = &planned.scene, .tested_form = planned.tested_form, .requirement = planned.requirement};
    request.limit.stop = stop;
    const auto repair = measure::repair::repair_form(request);
    return make_mend_section(output::repair::summarise_repair(request, repair));
}

output::report::MendSection make_mend_section(const output::repair::RepairSummary& result) {
    const auto& tested_form = result.request.tested_form;
    output::report::MendSection section{
        .form = fmt::format("{} in {}", tested_form.form->info->name, tested_form.format.name),
        .scene = result.request.id(),
        .requirement = output::choose::requirement_text(result.request.requirement),
        .changes = {},
        .text = repair_text(result),
        .table = output::report::mend_table(result),
        .front_chart = {fmt::format("Kept bits on {}", result.request.id()), svg_text(draw_pareto_plot(result))},
        .has_times = !result.prices.empty()};
    for (const output::repair::FormRow& form_row : make_form_rows(result))
        if (form_row.is_proposal()) section.changes.push_back(change_text(result, form_row));
    return section;
}

}  // namespace lostbits::analysis::report
