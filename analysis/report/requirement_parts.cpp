// The parts of a report that answer a requirement: a choice, and a repaired form.
#include <charconv>

#include <fmt/format.h>

#include "analysis/report/report_parts.hpp"
#include "analysis/selection/scenes.hpp"
#include "analysis/selection/select.hpp"
#include "measure/choice/margin.hpp"
#include "output/choice/choice_files.hpp"
#include "output/image/figure.hpp"
#include "output/page/page.hpp"
#include "output/repair/repair_files.hpp"

namespace lostbits::analysis::report {

namespace {

namespace page = output::page;

/// Parses the value `REST:BITS` or `REST:BITS:AT` of an option.
class RequirementText {
public:
    /// `usual` is the requirement of a word without AT. Throws InputError if the bits, or the part before them, are
    /// missing.
    RequirementText(std::string option, std::string what, std::string example, const std::string& word,
                    measure::choice::Requirement usual)
        : requirement(usual),
          rest(word),
          option_(std::move(option)),
          what_(std::move(what)),
          example_(std::move(example)),
          word_(word) {
        std::string bits = last();
        if (bits.starts_with('p') || bits == "max") {
            try {
                requirement.quantile = measure::choice::quantile_named(bits);
            } catch (const InputError& error) {
                refuse(error.what());
            }
            bits = last();
        }
        if (rest.empty())
            refuse(word.find(':') == std::string::npos ? "the bits are missing" : "the scene or the bits are missing");
        const auto [end, trouble] = std::from_chars(bits.data(), bits.data() + bits.size(), requirement.bits);
        if (trouble != std::errc{} || end != bits.data() + bits.size() ||
            !(requirement.bits >= 0 && requirement.bits <= 53))
            refuse("\"" + bits + "\" is not a number of bits from 0 to 53");
    }
    /// Removes the part after the last colon and returns it.
    std::string last() {
        const auto colon = rest.rfind(':');
        std::string part = colon == std::string::npos ? "" : rest.substr(colon + 1);
        rest.resize(colon == std::string::npos ? 0 : colon);
        return part;
    }
    [[noreturn]] void refuse(const std::string& why) const {
        throw InputError(
            fmt::format("{} {}: {}; write {} and the number of correct bits, as in {}:18, or also the share of the "
                        "hits that must keep them, as in {}:18:max",
                        option_, word_, why, what_, example_, example_));
    }

    measure::choice::Requirement requirement;
    std::string rest;

private:
    std::string option_, what_, example_, word_;
};

}  // namespace

ChoiceWork choice_of(const std::string& word, const std::string& size, const selection::SelectedRows& rows,
                     const std::filesystem::path& data, StopToken stop) {
    const RequirementText said("--choose", "a scene", "near-benign", word, {});
    auto scene = selection::load_one_scene({{said.rest}, size, "", {}, stop}, data);
    auto timed = selection::timed_on(scene, rows);
    return {std::move(scene), said.requirement, std::move(timed)};
}

MendWork mend_of(const std::string& word, const std::string& size, const std::filesystem::path& data, StopToken stop) {
    RequirementText said("--mend", "a scene, a form", "near-benign:sphere.half_b", word, {.quantile = 1});
    const std::string form = said.last();
    if (said.rest.empty()) said.refuse("the scene or the form is missing");
    auto scene = selection::load_one_scene({{said.rest}, size, "", {}, stop}, data);
    auto all = selection::cross(selection::select_forms({form}), selection::select_formats({"f32"}));
    const auto rows = selection::rows_meeting({all, {form}, true}, scene.id, [&scene](Shapes of) {
        return selection::are_primitives(of) && scene.meets(of);
    });
    if (rows.size() != 1) said.refuse(form + " is not one form for the primitives of that scene");
    selection::refuse_generators({rows.front().form}, "mend");
    selection::refuse_generated_rays({scene}, "mend");
    MendWork work{std::move(scene), said.requirement, rows.front()};
    // Refuses a form that filters here, before anything is measured.
    static_cast<void>(measure::repair::recorded({.scene = &work.scene, .row = work.row}));
    return work;
}

page::ChoicePart choice_part(const ChoiceWork& work, StopToken stop) {
    measure::choice::ChoiceRequest request{.scene = &work.scene, .rows = work.rows, .requirement = work.requirement};
    request.plan.repetitions = 5;  // as `lostbits choose --quick`
    request.plan.least_seconds = 1e-4;
    request.limit.stop = request.plan.stop = stop;
    measure::choice::TimedRays timed;
    const auto all = measure_candidates(request, timed);
    const auto chosen = output::choice::choose_among(request, all, timed);
    return {.scene = work.scene.id,
            .requirement = output::choice::in_words(work.requirement),
            .words = output::choice::in_words(chosen),
            .table = page::choice_table(chosen),
            .front = {fmt::format("Time against kept bits on {}", work.scene.id), svg_text(front_plot(chosen))}};
}

page::MendPart mend_part(const MendWork& work, StopToken stop) {
    measure::repair::RepairRequest request{.scene = &work.scene, .row = work.row, .requirement = work.requirement};
    request.limit.stop = stop;
    const auto repair = measure::repair::repair_form(request);
    return mend_part(output::repair::result_of(request, repair));
}

page::MendPart mend_part(const output::repair::RepairSummary& result) {
    const auto& row = result.request.row;
    page::MendPart part{.form = fmt::format("{} in {}", row.form->info->name, row.format.name),
                        .scene = result.request.id(),
                        .requirement = output::choice::in_words(result.request.requirement),
                        .changes = {},
                        .words = in_words(result),
                        .table = page::mend_table(result),
                        .front = {fmt::format("Kept bits on {}", result.request.id()), svg_text(front_plot(result))},
                        .timed = !result.prices.empty()};
    for (const output::repair::FormRow& one : rows_of(result))
        if (one.is_proposal()) part.changes.push_back(change_text(result, one));
    return part;
}

}  // namespace lostbits::analysis::report
