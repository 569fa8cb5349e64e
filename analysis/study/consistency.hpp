// The study that asks a form one question in two ways.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/selection/select.hpp"
#include "analysis/study/study_values.hpp"
#include "measure/offset/offsets.hpp"
#include "number/error.hpp"
#include "output/consistency/consistency_files.hpp"

namespace lostbits::analysis::study {

struct ConsistencyAdapter {
    using Presentation = output::consistency::ConsistencyPresentation;
    using Study = Presentation::Study;
    using Summaries = std::vector<Study::Summary>;
    static constexpr const char* name = "consistency";
    static constexpr const char* no_form_message =
        "consistency needs forms that test a primitive, and none is selected; try -i 'sphere.*'";
    static constexpr const char* title =
        "Check whether a form gives the same answer to a question asked in two ways: closest and any hit, one ray and "
        "packs, a segment from either end";
    static constexpr const char* kinds = ", with primitives of any kind";
    static constexpr const char* form_help = "Forms, by name or glob (default: all that fit)";
    static constexpr const char* example = "sphere[0].radius=10";

    static std::vector<StudyOption> options() {
        return {{"check", "Checks, by name or glob (default: all); `lostbits list checks`", {"*"}}};
    }

    static std::vector<shell::Example> examples() {
        return {
            {"lostbits consistency near-benign --size 32x32", "Asks every form for spheres each question in two ways"},
            {"lostbits consistency box-one -i box.signs --check reverse --size 32x32",
             "Asks one form about a segment from either end"}};
    }

    static std::vector<std::string> usual_forms() { return {"*"}; }

    static bool can_measure(const intersect::table::Intersector& form) {
        return measure::consistency::can_be_compared(form);
    }

    static void require(const scene::file::Scene& scene) { measure::offset::require_few_primitives(scene); }

    static Study make_study(const scene::file::Scene& scene, std::vector<measure::evaluate::TestedForm> tested_forms,
                            const StudyValues& values, intersect::process::StopToken stop) {
        auto checks = measure::consistency::select_checks(
            scene, tested_forms,
            selection::select_items(measure::consistency::checks(), values.at("check"), "check", "--check"));
        if (checks.empty())
            throw InputError(fmt::format(
                "--check: none of these checks applies to the selected forms on scene {}; light needs a [light], and "
                "segment, short and light need a form that takes directions of any length; try --check reverse",
                scene.id));
        return {.scene = scene,
                .tested_forms = std::move(tested_forms),
                .checks = std::move(checks),
                .limit = {.stop = stop}};
    }

    static void print_results(const Study& study, const Summaries& summaries, bool) {
        for (std::size_t r = 0; r < summaries.size(); ++r) print_row(study, study.tested_forms[r], summaries[r]);
        fmt::print("  Each check asks one question in two ways; `lostbits list checks` shows both questions\n");
    }

    /// The number of questions whose exact answer is not proved.
    static std::uint64_t unproved_count(const Summaries& summaries) {
        std::uint64_t count = 0;
        for (const measure::consistency::FormChecks& form_checks : summaries)
            for (const measure::consistency::CheckSummary& s : form_checks)
                count += s.count_of(measure::consistency::CheckResult::unresolved);
        return count;
    }

    static std::uint64_t unproved_count(const Presentation::SummaryRow& row) {
        return row.summary->count_of(measure::consistency::CheckResult::unresolved);
    }

    /// The ray of the first question with its primitives, in a form that `lostbits explain` accepts.
    static std::optional<measure::evaluate::WorstRay> witness(const Presentation::SummaryRow& row, const std::string&) {
        const auto& shown = row.summary->first_disagreement;
        if (!shown || shown->rays.first.primitives.empty()) return std::nullopt;
        const scene::rays::RayGroup& first = shown->rays.first;
        return measure::evaluate::WorstRay{.x = shown->x,
                                           .y = shown->y,
                                           .primitive_index = 0,
                                           .size = 0,
                                           .ray = first.rays[0],
                                           .primitive = first.primitives.front(),
                                           .given = std::make_shared<const scene::rays::RayGroup>(first)};
    }

private:
    /// `12 of 3072 (0.39%)`
    static std::string part_text(std::uint64_t part, std::uint64_t whole) {
        return fmt::format("{} of {} ({:.3g}%)", part, whole, 100 * measure::truth::fraction(part, whole));
    }

    /// The result of one check of a form in words; empty if there is nothing to say.
    static std::string check_text(const measure::consistency::Check& check,
                                  const measure::consistency::CheckSummary& summary) {
        std::string text;
        const auto add = [&text](const std::string& sentence) { text += (text.empty() ? "" : "; ") + sentence; };

        // A hit exactly at the end may count or not; only a form that does both is worth a sentence.
        if (check.name == "end") {
            const auto counted_hits = summary.count_of(measure::consistency::CheckResult::second_alone);
            if (summary.question_count() > 0 && counted_hits > 0 && counted_hits < summary.question_count())
                add("a hit exactly at the end of the ray counts for " +
                    part_text(counted_hits, summary.question_count()));
            return text;
        }

        if (summary.decisions() > 0)
            add("decisions differ for " + part_text(summary.decisions(), summary.question_count()));
        const double excess_ulps = summary.excess.quantile(1);  // NaN if no numbers are compared
        if (summary.count_of(measure::consistency::CheckResult::other_number) > 0 && !(excess_ulps > 0))
            add("numbers differ for " +
                part_text(summary.count_of(measure::consistency::CheckResult::other_number), summary.question_count()));
        if (summary.count_of(measure::consistency::CheckResult::by_inputs) > 0 && !check.compares_numbers)
            add("decisions differ because of rounded inputs, not the form, for " +
                part_text(summary.count_of(measure::consistency::CheckResult::by_inputs), summary.question_count()));
        if (excess_ulps > 0)
            add(fmt::format("{} are up to {:.3g} ulps further apart than the exact ones",
                            check.name == "placed" ? "both t" : "both ends", excess_ulps));
        return text;
    }

    static void print_row(const Study& study, const measure::evaluate::TestedForm& tested_form,
                          const measure::consistency::FormChecks& checks) {
        const std::string prefix = fmt::format("{} {}", tested_form.form->info->name, tested_form.format.name);
        std::string same_checks;
        for (std::size_t c = 0; c < checks.size(); ++c) {
            if (checks[c].question_count() == 0) continue;
            const std::string text = check_text(*study.checks[c], checks[c]);
            if (text.empty())
                same_checks += fmt::format("{}{}", same_checks.empty() ? "" : ", ", study.checks[c]->name);
            else fmt::print("  {} {}: {}\n", prefix, study.checks[c]->name, text);
        }
        if (!same_checks.empty()) fmt::print("  {} gives the same answers: {}\n", prefix, same_checks);
    }
};

}  // namespace lostbits::analysis::study
