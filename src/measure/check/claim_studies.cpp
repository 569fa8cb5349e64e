// Measures claims about studies: each is about one number of one row of a summary.
#include "measure/check/claim_studies.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "measure/check/claim_subjects.hpp"

namespace lostbits::measure::check {

using scene::check::Claim;
using scene::check::StudySubject;

namespace {

using StudyClaim = SubjectClaim<StudySubject>;
using Texts = std::map<std::string, std::string>;

bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

/// Values of the options of a claim. `row_options` are also columns of the summary, where they choose a row: one run
/// can measure claims with different values of these. `run_options` are all others.
struct ClaimOptions {
    Texts row_options, run_options;
};
ClaimOptions split_options(const StudyClaim& subject_claim, const StudyNames& names) {
    ClaimOptions options;
    for (const auto& [name, value] : subject_claim.subject.options)
        (contains(names.text_columns, name) ? options.row_options : options.run_options)[name] = value;
    return options;
}

/// Throws InputError if a claim names an option, a column or a metric that the study does not have.
void require_names(const StudyClaim& subject_claim, const StudyNames& names) {
    const auto require_known = [&](const Texts& values, const char* kind, const std::vector<std::string>& known_names) {
        for (const auto& [name, value] : values)
            if (!contains(known_names, name))
                scene::toml::fail(subject_claim.claim.where,
                                  fmt::format("study {} has no {} \"{}\"; {}", subject_claim.subject.study, kind, name,
                                              text::did_you_mean(name, known_names)));
    };
    require_known(subject_claim.subject.options, "option", names.options);
    require_known(subject_claim.subject.where, "text column", names.text_columns);
    if (!contains(names.number_columns, subject_claim.claim.metric))
        scene::toml::fail(subject_claim.claim.where,
                          fmt::format("unknown metric \"{}\" of study {}; {}", subject_claim.claim.metric,
                                      subject_claim.subject.study,
                                      text::did_you_mean(subject_claim.claim.metric, names.number_columns)));
}

/// Texts by which the row of a claim is found in the summary, by column.
Texts row_texts_for(const StudyClaim& subject_claim, const StudyNames& names) {
    Texts texts = split_options(subject_claim, names).row_options;
    texts.insert(subject_claim.subject.where.begin(), subject_claim.subject.where.end());
    texts["form"] = subject_claim.claim.form;
    texts["format"] = subject_claim.claim.format;
    return texts;
}

std::string list_text(const Texts& texts) {
    std::vector<std::string> items;
    for (const auto& [name, value] : texts) items.push_back(fmt::format("{} = \"{}\"", name, value));
    return fmt::format("{}", fmt::join(items, ", "));
}

/// Fails for a claim that no row matches; says which other texts the rows have.
[[noreturn]] void fail_without_row(const StudyClaim& subject_claim, const Texts& row_texts,
                                   const std::vector<StudyRow>& rows) {
    std::set<std::string> other_values;
    for (const auto& [name, value] : row_texts)
        for (const StudyRow& row : rows)
            if (row.texts.at(name) != value) other_values.insert(fmt::format("{} = \"{}\"", name, row.texts.at(name)));
    scene::toml::fail(
        subject_claim.claim.where,
        fmt::format("the summary of {} has no row with {}; {}", subject_claim.subject.study, list_text(row_texts),
                    other_values.empty() ? "it is empty" : fmt::format("there is {}", fmt::join(other_values, ", "))));
}

/// Finds the one row that a claim is about. Throws InputError if no row or several rows match.
const StudyRow& find_row(const StudyClaim& subject_claim, const StudyNames& names, const std::vector<StudyRow>& rows) {
    const Texts row_texts = row_texts_for(subject_claim, names);
    const StudyRow* found = nullptr;
    std::set<std::string> differing_columns;
    for (const StudyRow& row : rows) {
        if (std::ranges::any_of(row_texts,
                                [&](const auto& entry) { return row.texts.at(entry.first) != entry.second; }))
            continue;

        // If several rows match, the message names the columns in which they differ.
        if (found != nullptr)
            for (const std::string& name : names.text_columns) {
                const std::string &text = found->texts.at(name), &other_text = row.texts.at(name);
                if (text != other_text && text.find(' ') == std::string::npos)
                    differing_columns.insert(name);  // texts with spaces are commands
            }
        found = &row;
    }

    if (found == nullptr) fail_without_row(subject_claim, row_texts, rows);
    if (!differing_columns.empty())
        scene::toml::fail(
            subject_claim.claim.where,
            fmt::format("several rows of the summary of {} have {}; say which one is meant, by {}",
                        subject_claim.subject.study, list_text(row_texts), fmt::join(differing_columns, ", ")));
    return *found;
}

void judge_claim(const StudyClaim& subject_claim, const StudyRow& row) {
    ClaimResult& result = subject_claim.result;
    result = judge_measured_value(subject_claim.claim, row.numbers.at(subject_claim.claim.metric), nullptr);
    if (const auto witness = row.witnesses.find(subject_claim.claim.metric); witness != row.witnesses.end())
        result.witness = witness->second;
    mark_if_unproved(result, row.unproved_count, "pixel has no proved truth", "pixels have no proved truth");
}

/// Claims that one run of a study measures.
struct StudyRun {
    SubjectClaims<StudySubject> claims = {};
    std::vector<evaluate::TestedForm> tested_forms = {};
};

/// Puts claims whose rows need the same options into one run. `claims` have the same study and the same `run_options`.
std::map<std::map<std::string, std::set<std::string>>, StudyRun> group_into_runs(
    const SubjectClaims<StudySubject>& claims, const StudyNames& names) {
    std::vector<evaluate::TestedForm> tested_forms;
    std::vector<std::map<std::string, std::set<std::string>>> options;
    for (const StudyClaim& subject_claim : claims) {
        const std::size_t form_index = find_or_add_tested_form(tested_forms, tested_form_of(subject_claim.claim));
        options.resize(tested_forms.size());
        for (const auto& [name, value] : split_options(subject_claim, names).row_options)
            options[form_index][name].insert(value);
    }
    std::map<std::map<std::string, std::set<std::string>>, StudyRun> runs;
    for (const StudyClaim& subject_claim : claims) {
        const evaluate::TestedForm tested_form = tested_form_of(subject_claim.claim);
        StudyRun& run = runs[options[find_or_add_tested_form(tested_forms, tested_form)]];
        run.claims.push_back(subject_claim);
        find_or_add_tested_form(run.tested_forms, tested_form);
    }
    return runs;
}

/// Measures claims about one study whose `run_options` are the same.
void measure_together(const SubjectClaims<StudySubject>& claims, const Texts& run_options, const StudyNames& names,
                      const scene::file::Scene& scene, const ClaimRequest& run) {
    for (auto& [row_options, study_run] : group_into_runs(claims, names)) {
        StudyQuestion question{.scene = scene, .tested_forms = study_run.tested_forms, .stop = run.stop};
        for (const auto& [name, value] : run_options) question.options[name] = {value};
        for (const auto& [name, values] : row_options) question.options[name].assign(values.begin(), values.end());
        for (const StudyClaim& subject_claim : study_run.claims) question.columns.insert(subject_claim.claim.metric);
        const auto rows = find_for_claim(study_run.claims.front().claim, [&] {
            return run.studies->measure(study_run.claims.front().subject.study, question);
        });
        for (const StudyClaim& subject_claim : study_run.claims)
            judge_claim(subject_claim, find_row(subject_claim, names, rows));
    }
}

}  // namespace

void measure(const SubjectClaims<StudySubject>& claims, const ClaimRequest& run) {
    const scene::file::Scene scene = load_single_scene(claims.front().claim, run);
    std::map<std::string, StudyNames> names;
    std::map<std::pair<std::string, Texts>, SubjectClaims<StudySubject>> claims_by_options;
    for (const StudyClaim& subject_claim : claims) {
        const std::string& study = subject_claim.subject.study;
        tested_form_for(subject_claim.claim,
                        scene);  // throws, with the position of this claim, before the measurement starts
        if (!names.contains(study))
            names[study] = find_for_claim(subject_claim.claim, [&] { return run.studies->allowed_names(study); });
        require_names(subject_claim, names.at(study));
        claims_by_options[{study, split_options(subject_claim, names.at(study)).run_options}].push_back(subject_claim);
    }
    for (const auto& [key, group] : claims_by_options)
        measure_together(group, key.second, names.at(key.first), scene, run);
}

}  // namespace lostbits::measure::check
