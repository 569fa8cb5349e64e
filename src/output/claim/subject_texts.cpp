// Names of the things that claims are measured on.
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

/// Words that differ from kind to kind of subject. `kind` follows the subject's name in a heading, and `part` in a
/// text.
struct KindTexts {
    std::string command, kind = {}, part = {}, place = {};
    std::string at = {};  ///< numbers of a position on axes, which stand after the convention; `place` is empty
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

/// A command that measures the claim again. `options` precede those of the form, and `more` follows them.
std::string asked(const Claim& c, const char* command, const std::string& options, const std::string& more = "") {
    return fmt::format("lostbits {} {}{} -i {} -f {}{} -o out", command, shell_word(c.subject_name()), options, c.form,
                       c.format, more);
}

std::string checked(const Claim& c, const char* options, const char* more) {
    // Always in quotes, because --filter takes a glob.
    const std::string id = c.id.find('\'') == std::string::npos ? "'" + c.id + "'" : shell_word(c.id);
    return fmt::format("lostbits check{}{} --filter {}{}", c.named ? " " + shell_word(c.where.source) : "", options, id,
                       more);
}

KindTexts words(const Claim& c, const SceneSubject& on) {
    if (on.pixel)
        return {.command = fmt::format("lostbits explain {} --pixel {},{} -i {} -f {}", shell_word(on.name),
                                       on.pixel->first, on.pixel->second, c.form, c.format),
                .place = fmt::format("pixel {}, {}", on.pixel->first, on.pixel->second)};
    if (!on.step) return {asked(c, "map", "", metric_option(c))};
    return {
        .command = fmt::format("lostbits explain {} --pixel 0,0 -i {} -f {}", shell_word(on.name), c.form, c.format),
        .place = fmt::format("sample {}", *on.step)};
}

KindTexts words(const Claim& c, const SweepSubject& on) {
    KindTexts w{asked(c, "sweep", "", metric_option(c))};
    if (const auto* const at = on.part_if<SweepSubject::At>()) w.at = file::listed(at->values, file::decimal, ", ");
    if (const auto* const one = on.part_if<SweepSubject::Case>()) w.part = ": " + (w.place = one->name);
    if (const auto* const every = on.part_if<SweepSubject::EveryFloat>()) {
        w.command = checked(c, "", " --measure");
        if (!every->ray.empty()) w.part = ": " + (w.place = every->ray);
        if (!every->from) return w;
        const std::string range =
            fmt::format("{} to {}", scene::toml::exact_text(*every->from), scene::toml::exact_text(*every->to));
        w.part += ", " + range;
        w.place += (w.place.empty() ? "" : ", ") + range;
    }
    return w;
}

KindTexts words(const Claim& c, const StudySubject& on) {
    std::string options, place;
    std::vector<std::string_view> said;
    const auto add = [&](const auto& name_and_word) {
        const auto& [name, word] = name_and_word;
        if (std::ranges::find(said, word) != said.end()) return;  // a column often repeats an option
        said.push_back(word);
        place += fmt::format("{}{} {}", place.empty() ? "" : ", ", name, word);
    };
    for (const auto& option : on.options) {
        options += fmt::format(" --{} {}", option.first, shell_word(option.second));
        add(option);
    }
    for (const auto& word : on.where) add(word);
    return {.command = asked(c, on.study.c_str(), options),
            .kind = ", " + on.study,
            .part = fmt::format(", {}{}{}", on.study, place.empty() ? "" : ", ", place),
            .place = place};
}

KindTexts words(const Claim& c, const SearchSubject& /*on*/) {
    return {.command = asked(c, "sweep", " --worst"), .kind = ", searched"};
}

KindTexts words(const Claim& c, const MendSubject& on) {
    std::string options = fmt::format(" --bits {:.12g}", on.requirement.bits);
    if (on.requirement.wrong != 0) options += fmt::format(" --wrong {:.12g}", on.requirement.wrong);
    if (on.requirement.at != "max") options += " --at " + on.requirement.at;
    if (on.size) options += fmt::format(" --size {}x{}", on.size->first, on.size->second);
    const std::string place = "mended:" + options;
    return {.command = asked(c, "mend", "", options), .kind = ", mended", .part = ", " + place, .place = place};
}

KindTexts words(const Claim& c, const TableSubject& on) {
    return {.command = checked(c, "", " --measure"), .part = " " + on.row, .at = file::decimal(on.at)};
}

KindTexts words(const Claim& c, const TimingSubject& /*on*/) { return {checked(c, " --profile timing", "")}; }

KindTexts words(const Claim& c, const ChoiceSubject& /*on*/) { return {checked(c, " --profile timing", "")}; }

}  // namespace

SubjectTexts words_of(const Claim& c) {
    const KindTexts w = std::visit([&c](const auto& on) { return words(c, on); }, c.subject);
    const std::string& name = c.subject_name();
    return {.heading = name + w.kind,
            .where = fmt::format("{}{}{}{}{}", name, w.part,
                                 c.convention ? fmt::format(" ({})", intersect::convention_name(c.convention)) : "",
                                 w.at.empty() ? "" : ", ", w.at),
            .place = w.at.empty() ? w.place : "at " + w.at,
            .command = w.command + attribution::plugin_options_for(c.form)};
}

}  // namespace lostbits::output::claim
