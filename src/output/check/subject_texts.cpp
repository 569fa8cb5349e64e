// Texts that name the subjects of claims: the scene, sweep, table or study that a claim is measured on.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "measure/check/claim_columns.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/check/claim_files.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/parse_number.hpp"
#include "text/shell_word.hpp"

namespace lostbits::output::check {

using text::shell_word;

namespace {

using namespace scene::check;

/// Texts that differ from kind to kind of subject.
struct KindTexts {
    std::string command;
    std::string heading_suffix = {};  ///< follows the subject's name in a heading
    std::string name_suffix = {};     ///< follows the subject's name in other texts
    std::string position = {};
    /// Numbers of a position on axes, which stand after the convention; `position` is then empty.
    std::string axis_values = {};
};

/// Option for a metric that a run measures only on request: ` --metric contribution:c` for a claim about
/// contribution_c_p50.
std::string metric_option(const Claim& claim) {
    if (!claim.operations.empty()) return " --metric culprit";
    if (!measure::check::asks_for_attribution(claim)) {
        const Metric* const metric = metric_of_column(claim.metric);
        return metric != nullptr && !metric->is_default ? fmt::format(" --metric {}", metric->name) : "";
    }
    const std::string metric = claim.metric.substr(0, claim.metric.rfind('_'));
    const auto label = metric.find('_');
    return label == std::string::npos
               ? " --metric " + metric
               : " --metric " + shell_word(fmt::format("{}:{}", metric.substr(0, label), metric.substr(label + 1)));
}

/// Returns a command that measures the claim again. `options` precede the options of the form, and `more_options`
/// follow them.
std::string measuring_command(const Claim& claim, const char* command, const std::string& options,
                              const std::string& more_options = "") {
    return fmt::format("lostbits {} {}{} -i {} -f {}{} -o out", command, shell_word(claim.subject_name()), options,
                       claim.form, claim.format, more_options);
}

std::string checking_command(const Claim& claim, const char* options, const char* more_options) {
    // Always in quotes, because --filter takes a glob.
    const std::string id = claim.id.find('\'') == std::string::npos ? "'" + claim.id + "'" : shell_word(claim.id);
    return fmt::format("lostbits check{}{} --filter {}{}", claim.named ? " " + shell_word(claim.where.source) : "",
                       options, id, more_options);
}

KindTexts kind_texts(const Claim& claim, const SceneSubject& subject) {
    if (subject.pixel)
        return {.command = fmt::format("lostbits explain {} --pixel {},{} -i {} -f {}", shell_word(subject.name),
                                       subject.pixel->first, subject.pixel->second, claim.form, claim.format),
                .position = fmt::format("pixel {}, {}", subject.pixel->first, subject.pixel->second)};
    if (!subject.step) return {measuring_command(claim, "map", "", metric_option(claim))};
    return {.command = fmt::format("lostbits explain {} --pixel 0,0 -i {} -f {}", shell_word(subject.name), claim.form,
                                   claim.format),
            .position = fmt::format("sample {}", *subject.step)};
}

KindTexts kind_texts(const Claim& claim, const SweepSubject& subject) {
    KindTexts texts{measuring_command(claim, "sweep", "", metric_option(claim))};
    if (const auto* const at_values = subject.part_if<SweepSubject::SweepPosition>())
        texts.axis_values = file::number_list(at_values->values, file::decimal, ", ");
    if (const auto* const tested_case = subject.part_if<SweepSubject::Case>())
        texts.name_suffix = ": " + (texts.position = tested_case->name);

    if (const auto* const every_float = subject.part_if<SweepSubject::EveryFloat>()) {
        texts.command = checking_command(claim, "", " --measure");
        if (!every_float->ray.empty()) texts.name_suffix = ": " + (texts.position = every_float->ray);
        if (!every_float->from) return texts;
        const std::string range = fmt::format("{} to {}", scene::toml::exact_text(*every_float->from),
                                              scene::toml::exact_text(*every_float->to));
        texts.name_suffix += ", " + range;
        texts.position += (texts.position.empty() ? "" : ", ") + range;
    }
    return texts;
}

KindTexts kind_texts(const Claim& claim, const StudySubject& subject) {
    std::string options, position;
    std::vector<std::string_view> named_values;
    const auto add = [&](const auto& name_and_value) {
        const auto& [name, value] = name_and_value;
        if (std::ranges::find(named_values, value) != named_values.end()) return;  // a column often repeats an option
        named_values.push_back(value);
        position += fmt::format("{}{} {}", position.empty() ? "" : ", ", name, value);
    };

    for (const auto& option : subject.options) {
        options += fmt::format(" --{} {}", option.first, shell_word(option.second));
        add(option);
    }
    for (const auto& value : subject.where) add(value);

    return {.command = measuring_command(claim, subject.study.c_str(), options),
            .heading_suffix = ", " + subject.study,
            .name_suffix = fmt::format(", {}{}{}", subject.study, position.empty() ? "" : ", ", position),
            .position = position};
}

KindTexts kind_texts(const Claim& claim, const SearchSubject& /*on*/) {
    return {.command = measuring_command(claim, "sweep", " --worst"), .heading_suffix = ", searched"};
}

KindTexts kind_texts(const Claim& claim, const MendSubject& subject) {
    std::string options = fmt::format(" --bits {:.12g}", subject.requirement.bits);
    if (subject.requirement.max_wrong_fraction != 0)
        options += fmt::format(" --wrong {:.12g}", subject.requirement.max_wrong_fraction);
    if (subject.requirement.quantile != "max") options += " --at " + subject.requirement.quantile;
    if (subject.size) options += fmt::format(" --size {}x{}", subject.size->first, subject.size->second);
    const std::string position = "mended:" + options;
    return {.command = measuring_command(claim, "mend", "", options),
            .heading_suffix = ", mended",
            .name_suffix = ", " + position,
            .position = position};
}

KindTexts kind_texts(const Claim& claim, const TableSubject& subject) {
    return {.command = checking_command(claim, "", " --measure"),
            .name_suffix = " " + subject.row,
            .axis_values = file::decimal(subject.argument)};
}

KindTexts kind_texts(const Claim& claim, const TimingSubject& /*on*/) {
    return {checking_command(claim, " --profile timing", "")};
}

KindTexts kind_texts(const Claim& claim, const ChoiceSubject& /*on*/) {
    return {checking_command(claim, " --profile timing", "")};
}

}  // namespace

SubjectTexts subject_texts(const Claim& claim) {
    const KindTexts texts =
        std::visit([&claim](const auto& subject) { return kind_texts(claim, subject); }, claim.subject);
    const std::string& name = claim.subject_name();
    return {.heading = name + texts.heading_suffix,
            .subject =
                fmt::format("{}{}{}{}{}", name, texts.name_suffix,
                            claim.convention ? fmt::format(" ({})", intersect::convention_name(claim.convention)) : "",
                            texts.axis_values.empty() ? "" : ", ", texts.axis_values),
            .position = texts.axis_values.empty() ? texts.position : "at " + texts.axis_values,
            .command = texts.command + attribution::plugin_options_for(claim.form)};
}

}  // namespace lostbits::output::check
