// Texts that name the subjects of claims: the scene, sweep, table or study that a claim is measured on.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "measure/claim/claim_columns.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/claim/claim_files.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/parse_number.hpp"

namespace lostbits::output::claim {

using attribution::shell_word;

namespace {

using namespace scene::claim;

/// Texts that differ from kind to kind of subject. `kind` follows the subject's name in a heading, and `part` follows
/// it in a text.
struct KindTexts {
    std::string command, kind = {}, part = {}, position = {};
    std::string axis_values =
        {};  ///< numbers of a position on axes, which stand after the convention; `position` is then empty
};

/// ` --metric contribution:c` for a claim about contribution_c_p50: the option for a metric that a run measures only on
/// request.
std::string metric_option(const Claim& c) {
    if (!c.operations.empty()) return " --metric culprit";
    if (!measure::claim::asks_for_attribution(c)) {
        const Metric* const metric = metric_of_column(c.metric);
        return metric != nullptr && !metric->by_default ? fmt::format(" --metric {}", metric->name) : "";
    }
    const std::string metric = c.metric.substr(0, c.metric.rfind('_'));
    const auto label = metric.find('_');
    return label == std::string::npos
               ? " --metric " + metric
               : " --metric " + shell_word(fmt::format("{}:{}", metric.substr(0, label), metric.substr(label + 1)));
}

/// Returns a command that measures the claim again. `options` precede the options of the form, and `more_options`
/// follow them.
std::string measuring_command(const Claim& c, const char* command, const std::string& options,
                              const std::string& more_options = "") {
    return fmt::format("lostbits {} {}{} -i {} -f {}{} -o out", command, shell_word(c.subject_name()), options, c.form,
                       c.format, more_options);
}

std::string checking_command(const Claim& c, const char* options, const char* more_options) {
    // Always in quotes, because --filter takes a glob.
    const std::string id = c.id.find('\'') == std::string::npos ? "'" + c.id + "'" : shell_word(c.id);
    return fmt::format("lostbits check{}{} --filter {}{}", c.named ? " " + shell_word(c.where.source) : "", options, id,
                       more_options);
}

KindTexts kind_texts(const Claim& c, const SceneSubject& subject) {
    if (subject.pixel)
        return {.command = fmt::format("lostbits explain {} --pixel {},{} -i {} -f {}", shell_word(subject.name),
                                       subject.pixel->first, subject.pixel->second, c.form, c.format),
                .position = fmt::format("pixel {}, {}", subject.pixel->first, subject.pixel->second)};
    if (!subject.step) return {measuring_command(c, "map", "", metric_option(c))};
    return {.command =
                fmt::format("lostbits explain {} --pixel 0,0 -i {} -f {}", shell_word(subject.name), c.form, c.format),
            .position = fmt::format("sample {}", *subject.step)};
}

KindTexts kind_texts(const Claim& c, const SweepSubject& subject) {
    KindTexts w{measuring_command(c, "sweep", "", metric_option(c))};
    if (const auto* const at_values = subject.part_if<SweepSubject::At>())
        w.axis_values = file::number_list(at_values->values, file::decimal, ", ");
    if (const auto* const tested_case = subject.part_if<SweepSubject::Case>())
        w.part = ": " + (w.position = tested_case->name);
    if (const auto* const every_float = subject.part_if<SweepSubject::EveryFloat>()) {
        w.command = checking_command(c, "", " --measure");
        if (!every_float->ray.empty()) w.part = ": " + (w.position = every_float->ray);
        if (!every_float->from) return w;
        const std::string range = fmt::format("{} to {}", scene::toml::exact_text(*every_float->from),
                                              scene::toml::exact_text(*every_float->to));
        w.part += ", " + range;
        w.position += (w.position.empty() ? "" : ", ") + range;
    }
    return w;
}

KindTexts kind_texts(const Claim& c, const StudySubject& subject) {
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
    return {.command = measuring_command(c, subject.study.c_str(), options),
            .kind = ", " + subject.study,
            .part = fmt::format(", {}{}{}", subject.study, position.empty() ? "" : ", ", position),
            .position = position};
}

KindTexts kind_texts(const Claim& c, const SearchSubject& /*on*/) {
    return {.command = measuring_command(c, "sweep", " --worst"), .kind = ", searched"};
}

KindTexts kind_texts(const Claim& c, const MendSubject& subject) {
    std::string options = fmt::format(" --bits {:.12g}", subject.requirement.bits);
    if (subject.requirement.wrong != 0) options += fmt::format(" --wrong {:.12g}", subject.requirement.wrong);
    if (subject.requirement.at != "max") options += " --at " + subject.requirement.at;
    if (subject.size) options += fmt::format(" --size {}x{}", subject.size->first, subject.size->second);
    const std::string position = "mended:" + options;
    return {.command = measuring_command(c, "mend", "", options),
            .kind = ", mended",
            .part = ", " + position,
            .position = position};
}

KindTexts kind_texts(const Claim& c, const TableSubject& subject) {
    return {.command = checking_command(c, "", " --measure"),
            .part = " " + subject.row,
            .axis_values = file::decimal(subject.at)};
}

KindTexts kind_texts(const Claim& c, const TimingSubject& /*on*/) {
    return {checking_command(c, " --profile timing", "")};
}

KindTexts kind_texts(const Claim& c, const ChoiceSubject& /*on*/) {
    return {checking_command(c, " --profile timing", "")};
}

}  // namespace

SubjectTexts words_of(const Claim& c) {
    const KindTexts w = std::visit([&c](const auto& subject) { return kind_texts(c, subject); }, c.subject);
    const std::string& name = c.subject_name();
    return {.heading = name + w.kind,
            .where = fmt::format("{}{}{}{}{}", name, w.part,
                                 c.convention ? fmt::format(" ({})", intersect::convention_name(c.convention)) : "",
                                 w.axis_values.empty() ? "" : ", ", w.axis_values),
            .place = w.axis_values.empty() ? w.position : "at " + w.axis_values,
            .command = w.command + attribution::plugin_options_for(c.form)};
}

}  // namespace lostbits::output::claim
