#include "analysis/shell/option_table.hpp"

#include <algorithm>
#include <map>

#include "analysis/choice/options.hpp"
#include "analysis/shell/usage.hpp"

namespace lostbits::analysis::shell {

namespace {

/// Options and arguments whose values `lostbits list` knows, and those that are files.
Values known_values(const std::string& name) {
    using Kind = Values::Kind;
    static const std::map<std::string, Values> known{{"intersector", {Kind::names, {"forms"}}},
                                                     {"against", {Kind::names, {"forms"}}},
                                                     {"format", {Kind::names, {"formats"}}},
                                                     {"f", {Kind::names, {"formats"}}},
                                                     {"as", {Kind::names, {"formats"}}},
                                                     {"metric", {Kind::names, {"metrics"}}},
                                                     {"strategy", {Kind::names, {"strategies"}}},
                                                     {"check", {Kind::names, {"checks"}}},
                                                     {"filter", {Kind::names, {"claims"}}},
                                                     {"claims", {Kind::names, {"claims"}}},
                                                     {"scene", {Kind::names, {"scenes"}}},
                                                     {"SCENE", {Kind::names, {"scenes"}}},
                                                     {"SWEEP", {Kind::names, {"sweeps"}}},
                                                     {"SUBJECT", {Kind::names, {"scenes", "sweeps"}}},
                                                     {"out", {Kind::folders, {}}},
                                                     {"data", {Kind::folders, {}}},
                                                     {"report", {Kind::folders, {}}},
                                                     {"plugin", {Kind::files, {}}},
                                                     {"junit", {Kind::files, {}}},
                                                     {"export-csv", {Kind::files, {}}},
                                                     {"export-json", {Kind::files, {}}},
                                                     {"FILE", {Kind::files, {}}},
                                                     {"CLAIMS", {Kind::files, {}}},
                                                     {"LIBRARY", {Kind::files, {}}},
                                                     {"A", {Kind::files, {}}},
                                                     {"B", {Kind::files, {}}}};
    const auto found = known.find(name);
    return found == known.end() ? Values{} : found->second;
}

/// The words of a set that the option is checked against: CLI11 shows `TEXT:{none,csv}` for its type, and
/// `ENUM:value in {bar->1,none->2} OR {1,2}` where words are mapped.
std::vector<std::string> set_of(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const auto open = type.find('{'), close = type.find('}');
    if (open == std::string::npos || close == std::string::npos) return {};
    std::vector<std::string> words = CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
    for (std::string& word : words) word.erase(std::min(word.find("->"), word.size()));
    return words;
}

OptionRow row_of(const CLI::Option& option) {
    OptionRow row;
    row.help = option.get_description();
    row.takes_value = option.get_expected_max() > 0;
    row.several = option.get_expected_max() > 1 && (option.get_positional() || choice::is_list(option));
    row.required = option.get_required();
    std::vector<std::string> bare;
    if (option.get_positional()) row.names = bare = {option.get_name()};
    for (const std::string& name : option.get_snames()) row.names.push_back("-" + name), bare.push_back(name);
    for (const std::string& name : option.get_lnames()) row.names.push_back("--" + name), bare.push_back(name);
    if (!row.takes_value) return row;
    row.values.words = set_of(option);
    if (!row.values.words.empty()) row.values.kind = Values::Kind::words;
    for (const std::string& name : bare) {
        if (row.values.kind == Values::Kind::anything) row.values = known_values(name);
    }
    return row;
}

void add_options(const CLI::App& app, std::vector<OptionRow>& options, std::vector<OptionRow>& arguments) {
    for (const CLI::Option* option : app.get_options()) {
        if (option->get_group().empty()) continue;
        (option->get_positional() ? arguments : options).push_back(row_of(*option));
    }
    // A group of options is a command without a name.
    for (const CLI::App* group : app.get_subcommands([](const CLI::App* inner) { return inner->get_name().empty(); }))
        add_options(*group, options, arguments);
}

/// Those that are not there yet.
void add_new(const std::vector<OptionRow>& more, std::vector<OptionRow>& options) {
    for (const OptionRow& row : more) {
        if (std::ranges::find(options, row.names, &OptionRow::names) == options.end()) options.push_back(row);
    }
}

}  // namespace

std::vector<std::string> CommandRow::names_of_commands() const {
    std::vector<std::string> names;
    for (const CommandRow& command : commands) names.push_back(command.name);
    return names;
}

std::vector<OptionRow> common_options(const CLI::App& program) {
    std::vector<OptionRow> options, none;
    add_options(program, options, none);
    return options;
}

std::vector<CommandRow> command_table(const CLI::App& program) {
    std::vector<CommandRow> rows;
    for (const std::string& name : commands_of(program)) {
        const CLI::App& command = *program.get_subcommand(name);
        CommandRow row{name, command.get_description(), {}, {}, command_table(command)};
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
