#include "analysis/shell/option_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <regex>
#include <string_view>
#include <utility>

#include "shapes/number_names.hpp"

namespace lostbits::analysis::shell {

namespace {

/// The values of an option or argument that names files or rows of `lostbits list`.
AllowedValues known_values(const std::string& name) {
    using Kind = AllowedValues::Kind;
    struct KnownValues {
        AllowedValues values;
        std::vector<std::string_view> options;
    };
    static const KnownValues known[] = {
        // Rows of `lostbits list`.
        {{Kind::names, {"forms"}}, {"form", "against"}},
        {{Kind::names, {"formats"}}, {"format", "answer-format", "f", "as"}},
        {{Kind::names, {"metrics"}}, {"metric"}},
        {{Kind::names, {"strategies"}}, {"strategy"}},
        {{Kind::names, {"checks"}}, {"check"}},
        {{Kind::names, {"claims"}}, {"filter", "claims"}},
        {{Kind::names, {"scenes"}}, {"scene", "SCENE"}},
        {{Kind::names, {"sweeps"}}, {"SWEEP"}},
        {{Kind::names, {"scenes", "sweeps"}}, {"SUBJECT"}},

        // Paths.
        {{Kind::folders, {}}, {"out", "data", "report"}},
        {{Kind::files, {}},
         {"plugin", "shader", "junit", "export-csv", "export-json", "FILE", "CLAIMS", "LIBRARY", "A", "B"}}};
    const auto found = std::ranges::find_if(
        known, [&name](const KnownValues& k) { return std::ranges::find(k.options, name) != k.options.end(); });
    return found == std::end(known) ? AllowedValues{} : found->values;
}

/// The values that an option allows. The type of the option shows them as `TEXT:{none,csv}` or, if they are mapped to
/// numbers, as `ENUM:value in {bar->1,none->2} OR {1,2}`.
std::vector<std::string> allowed_values(const Option& option) {
    const std::string type = option.type();
    const auto open = type.find('{'), close = type.find('}');
    if (open == std::string::npos || close == std::string::npos) return {};
    std::vector<std::string> values = split_items(type.substr(open + 1, close - open - 1), option.name());
    for (std::string& value : values) value.erase(std::min(value.find("->"), value.size()));
    return values;
}

std::string join_words(const std::vector<std::string>& words, const char* between) {
    return fmt::format("{}", fmt::join(words, between));
}

/// The values of options whose kind says too little.
constexpr std::pair<std::string_view, const char*> placeholders[] = {
    {"--size", "WxH"},
    {"--pipe", "COMMAND"},
    {"--set", "KEY=VALUE"},
    {"--shard", "K/N"},
    {"--pixel", "X,Y"},
    {"--range", "LO:HI"},
    {"--by", "COLUMN"},
    {"--device", "DRIVER,..."},
    {"--miss", "T|negative|never"},
    {"--ray", "OX,OY,OZ,DX,DY,DZ"},
    {"--at", "pN|max"},
    {"--beside", "NAME,..."},
    {"--ignore", "NAME"},
    {"--offsets", "SCENE,..."},
    {"--unit", "UNIT"},
    {"--function", "FILE:NAME"},
    {"--case", "NAME[:K]"},
    {"--variant", "NAME"},
    {"--tolerance", "LENGTH"},
    {"--steps", "N[,N]"},
    {"--compiler", "COMMAND"},
    {"--tmin", "T"},
    {"--tmax", "T"},
    {"--columns", "NAMES"},
    {"--at-step", "STEP"},
    {"--input-range", "NAME=LOW..HIGH"},
    {"--allow", "COLUMN=ABS[,REL]"},
    {"--emit", "FILE"},
    {"--draw", "FOLDER"},
    {"--study", "STUDY:SCENE"},
    {"--choose", "SCENE:BITS"},
    {"--mend", "SCENE:FORM:BITS"},
};

/// How the help writes the value of an option. The type of the option may have the limits of the value: `INT:INT in [1
/// - 1024]`.
std::string value_text(const OptionRow& option_row, const std::string& type) {
    using Kind = AllowedValues::Kind;
    const char* const suffix = option_row.takes_several ? ",..." : "";
    if (option_row.values.kind == Kind::words) return join_words(option_row.values.words, "|") + suffix;
    const auto* const placeholder =
        std::ranges::find(placeholders, option_row.names.back(), [](const auto& row) { return row.first; });
    if (placeholder != std::end(placeholders)) return placeholder->second;
    for (const ShapeRow& shape_row : shape_rows)
        if (option_row.names.back() == "--" + std::string(shape_row.name)) return option_placeholder(shape_row.shape);

    static const std::regex limits(R"(.* in \[(.*) - (.*)\])");
    std::smatch part;
    if (std::regex_match(type, part, limits)) return part[1].str() + ".." + part[2].str();

    const std::string noun = option_row.values.kind == Kind::names     ? "NAME"
                             : option_row.values.kind == Kind::files   ? "FILE"
                             : option_row.values.kind == Kind::folders ? "FOLDER"
                             : type == "UINT"                          ? "COUNT"
                                                                       : "VALUE";
    return noun + suffix;
}

OptionRow make_option_row(const Option& option) {
    OptionRow option_row;
    option_row.help = option.help();
    option_row.takes_value = option.takes_value();
    option_row.heading = option.heading();
    option_row.takes_several = option.takes_several();
    option_row.is_required = option.is_required();

    std::vector<std::string> bare_names;
    const auto add_name = [&](const char* hyphens, const std::string& name) {
        option_row.names.push_back(hyphens + name);
        bare_names.push_back(name);
    };
    if (option.is_argument()) add_name("", option.name());
    for (const std::string& name : option.short_names()) add_name("-", name);
    for (const std::string& name : option.long_names()) add_name("--", name);
    if (!option_row.takes_value) return option_row;

    // The values that the option checks; without a check, those that its name implies.
    option_row.values.words = allowed_values(option);
    if (!option_row.values.words.empty()) option_row.values.kind = AllowedValues::Kind::words;
    for (const std::string& name : bare_names) {
        if (option_row.values.kind == AllowedValues::Kind::anything) option_row.values = known_values(name);
    }
    if (!option.is_argument()) option_row.value = value_text(option_row, option.type());
    else if (option_row.values.kind == AllowedValues::Kind::words)
        option_row.value = join_words(option_row.values.words, ", ");
    return option_row;
}

void add_options(const Command& command, std::vector<OptionRow>& options, std::vector<OptionRow>& arguments) {
    for (const Option& option : command.options())
        (option.is_argument() ? arguments : options).push_back(make_option_row(option));
    for (const Command& group : command.option_groups()) {
        const std::size_t first = options.size();
        add_options(group, options, arguments);
        options.erase(std::remove_if(options.begin() + static_cast<std::ptrdiff_t>(first), options.end(),
                                     [](const OptionRow& option_row) { return option_row.names.back() == "--help"; }),
                      options.end());
        for (std::size_t i = first; i < options.size(); ++i) options[i].heading = group.help() + ", one of these";
    }
}

/// Adds the options that are not in the list yet.
void add_new(const std::vector<OptionRow>& added_options, std::vector<OptionRow>& options) {
    for (const OptionRow& option_row : added_options) {
        if (std::ranges::find(options, option_row.names, &OptionRow::names) == options.end())
            options.push_back(option_row);
    }
}

}  // namespace

std::vector<std::string> CommandRow::command_names() const {
    std::vector<std::string> names;
    for (const CommandRow& command : commands) names.push_back(command.name);
    return names;
}

std::vector<std::string> headings_of(const std::vector<OptionRow>& options) {
    std::vector<std::string> headings{""};
    for (const OptionRow& option : options)
        if (std::ranges::find(headings, option.heading) == headings.end()) headings.push_back(option.heading);
    return headings;
}

std::vector<OptionRow> common_options(const Command& program) {
    std::vector<OptionRow> options, arguments;
    add_options(program, options, arguments);
    return options;
}

std::vector<CommandRow> command_table(const Command& program, bool includes_hidden) {
    std::vector<CommandRow> rows;
    for (const Command& command : program.subcommands()) {
        if (command.is_hidden() && !includes_hidden) continue;
        CommandRow row{command.name(), command.help(), command.examples(), {}, {}, command_table(command)};
        add_options(command, row.options, row.arguments);
        for (const CommandRow& inner : row.commands) {
            add_new(inner.options, row.options);
            add_new(inner.arguments, row.arguments);
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace lostbits::analysis::shell
