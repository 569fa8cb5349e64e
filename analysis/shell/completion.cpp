#include "analysis/shell/option_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "intersect/process/child.hpp"
#include "text/shell_word.hpp"

namespace lostbits::analysis::shell {

using text::shell_word;
using Kind = AllowedValues::Kind;

namespace {

std::string replace_all(std::string text, const std::string& from, const std::string& to) {
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

/// The help of an option up to the first " (", ": " or "; ", for a menu.
std::string short_help(const std::string& help) {
    return help.substr(0, std::min({help.find(" ("), help.find(": "), help.find("; ")}));
}

std::vector<std::string> names_of(const std::vector<OptionRow>& options) {
    std::vector<std::string> names;
    for (const OptionRow& option : options) names.insert(names.end(), option.names.begin(), option.names.end());
    return names;
}

/// A filter for the output of `lostbits list` that prints the names, except names with special characters. A shell
/// would run code in these:
/// `compgen -W` expands its words, and a scene in a user's folder may be called `$(command).toml`.
constexpr const char* awk_plain_names_filter = "awk 'NR > 1 && $1 ~ /^[A-Za-z0-9_.,:@\\/+-]+$/ { print $1 }'";

// bash -----------------------------------------------------------------------------------------------------------

/// Bash code that sets the words or files to offer.
std::string bash_values(const AllowedValues& values) {
    switch (values.kind) {
        case Kind::words: return fmt::format("words=\"{}\"", fmt::join(values.words, " "));
        case Kind::names: return fmt::format("words=$(_lostbits_names {})", fmt::join(values.words, " "));
        case Kind::files: return "files=-f";
        case Kind::folders: return "files=-d";
        case Kind::anything: break;
    }
    return ":";
}

std::string bash_cases(const std::vector<OptionRow>& options, const std::string& indent) {
    std::string text;
    for (const OptionRow& option : options) {
        if (option.takes_value)
            text +=
                fmt::format("{}{}) {}; return ;;\n", indent, fmt::join(option.names, "|"), bash_values(option.values));
    }
    return text;
}

/// The function that asks the program for names.
std::string bash_names_function() {
    return "_lostbits_names() {\n"
           "    local what\n"
           "    for what; do \"${COMP_WORDS[0]/#\\~/$HOME}\" list \"$what\" 2>/dev/null | " +
           std::string(awk_plain_names_filter) +
           "; done\n"
           "}\n\n";
}

/// The function that sets the words or the kind of files to offer, with a case for each command.
std::string bash_offers_function(const Command& program, const std::vector<std::string>& command_names) {
    std::string text =
        "# Sets the words, or the kind of files, that can be typed at the cursor.\n"
        "_lostbits_here() {\n"
        "    local command=$1 previous=$2\n"
        "    case $command in\n";
    for (const CommandRow& command : command_table(program)) {
        // The value of the option before the cursor; else the options, subcommands and arguments of the command.
        text += fmt::format("        {})\n            case $previous in\n{}            esac\n", command.name,
                            bash_cases(command.options, "                "));
        std::string set_offers = fmt::format("options=\"{}\"", fmt::join(names_of(command.options), " "));
        if (!command.commands.empty())
            set_offers += fmt::format("; words=\"{}\"", fmt::join(command.command_names(), " "));
        else if (!command.arguments.empty()) set_offers += "; " + bash_values(command.arguments.front().values);
        // A subject can be given by its name or as a file.
        if (!command.arguments.empty()) set_offers += "; files=-f";
        text += fmt::format("            {} ;;\n", set_offers);
    }

    // The options of every command come last: their values replace what the command offers.
    const auto common = common_options(program);
    return text + fmt::format(
                      "        *) words=\"{}\" ;;\n    esac\n    case $previous in\n{}    esac\n    options+=\" "
                      "{}\"\n}}\n\n",
                      fmt::join(command_names, " "),
                      replace_all(bash_cases(common, "        "), ") ", ") options=; words=; files=; "),
                      fmt::join(names_of(common), " "));
}

/// The function that bash calls at the cursor.
std::string bash_main_function(const std::vector<std::string>& command_names) {
    return fmt::format(
        "_lostbits() {{\n"
        "    local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}}\n"
        "    local command= options= words= files= i\n"
        "    for ((i = 1; i < COMP_CWORD; ++i)); do\n"
        "        case ${{COMP_WORDS[i]}} in {}) command=${{COMP_WORDS[i]}}; break ;; esac\n"
        "    done\n"
        "    _lostbits_here \"$command\" \"$previous\"\n"
        "    if [[ $current == -* ]]; then\n"
        "        COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
        "        return\n"
        "    fi\n"
        "    # Completes the last of several values between commas.\n"
        "    local last=${{current##*,}}\n"
        "    COMPREPLY=($(compgen -P \"${{current%\"$last\"}}\" -W \"$words\" -- \"$last\"))\n"
        "    if [[ -n $files ]]; then\n"
        "        compopt -o filenames 2>/dev/null\n"
        "        COMPREPLY+=($(compgen $files -- \"$current\"))\n"
        "    fi\n"
        "}}\n"
        "complete -F _lostbits lostbits\n",
        fmt::join(command_names, "|"));
}

// zsh ------------------------------------------------------------------------------------------------------------

std::string zsh_action(const OptionRow& option) {
    const std::string sequence_prefix = option.takes_several && option.names.front().front() == '-' ? "_sequence " : "";
    switch (option.values.kind) {
        case Kind::words: return fmt::format("({})", fmt::join(option.values.words, " "));
        case Kind::names:
            return fmt::format("{}_lostbits_names {}", sequence_prefix, fmt::join(option.values.words, " "));
        case Kind::files: return "_files";
        case Kind::folders: return "_files -/";
        case Kind::anything: break;
    }
    return "";
}

/// `'*'{-i,--form}'[help]:forms:_lostbits_names forms'`
std::string zsh_spec(const OptionRow& option) {
    std::string help = short_help(option.help);
    for (const char* special : {"\\", "[", "]", ":"}) help = replace_all(help, special, std::string("\\") + special);
    const std::string names =
        option.names.size() == 1 ? option.names.front() : fmt::format("'{{{}}}'", fmt::join(option.names, ","));
    const std::string body = replace_all(help, "'", "'\\''");
    const std::string value = option.takes_value ? fmt::format(":value:{}", zsh_action(option)) : "";
    return fmt::format("'*{}[{}]{}'", names, body, value);
}

std::string zsh_specs(const std::vector<OptionRow>& options) {
    std::string text;
    for (const OptionRow& option : options) text += " \\\n            " + zsh_spec(option);
    return text;
}

/// The function that asks the program for names.
std::string zsh_names_function() {
    return "_lostbits_names() {\n"
           "    local -a names\n"
           "    local what\n"
           "    while [[ $1 == -* ]]; do shift; done\n"
           "    for what; do names+=(${(f)\"$($words[1] list $what 2>/dev/null | " +
           std::string(awk_plain_names_filter) +
           ")\"}); done\n"
           "    compadd -a names\n"
           "    [[ $what == (scenes|sweeps) ]] && _files -g '*.toml'\n"
           "}\n\n";
}

/// The case of a command: its options, the common ones, its subcommands and its arguments.
std::string zsh_case(const CommandRow& command, const std::string& common_specs) {
    std::string text = fmt::format("        {})\n        _arguments{}{} \\\n            '1:command:({})'", command.name,
                                   zsh_specs(command.options), common_specs, command.name);
    if (!command.commands.empty())
        text += fmt::format(" \\\n            '2:command:({})'", fmt::join(command.command_names(), " "));
    for (const OptionRow& argument : command.arguments)
        text += fmt::format(" \\\n            '{}:{}:{}'", argument.takes_several ? "*" : "", argument.names.front(),
                            zsh_action(argument));
    return text + " ;;\n";
}

// fish -----------------------------------------------------------------------------------------------------------

std::string fish_values(const AllowedValues& values) {
    switch (values.kind) {
        case Kind::words: return fmt::format(" -x -a '{}'", fmt::join(values.words, " "));
        case Kind::names: return fmt::format(" -x -a '(__lostbits_names {})'", fmt::join(values.words, " "));
        case Kind::files: return " -r -F";
        case Kind::folders: return " -x -a '(__fish_complete_directories)'";
        case Kind::anything: break;
    }
    return " -x";
}

std::string fish_option(const std::string& condition, const OptionRow& option) {
    std::string text = "complete -c lostbits" + condition;
    for (const std::string& name : option.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    return text + " -d " + replace_all(shell_word(short_help(option.help)), "'\\''", "\\'") +
           (option.takes_value ? fish_values(option.values) : "") + "\n";
}

/// The lines of a command: its name, its options, its subcommands and the values of its arguments.
std::string fish_command(const CommandRow& command) {
    std::string text = fmt::format("complete -c lostbits -f -n __fish_use_subcommand -a {} -d {}\n", command.name,
                                   replace_all(shell_word(short_help(command.help)), "'\\''", "\\'"));
    const std::string condition = fmt::format(" -n '__fish_seen_subcommand_from {}'", command.name);
    for (const OptionRow& option : command.options) text += fish_option(condition, option);
    if (!command.commands.empty())
        text += fmt::format("complete -c lostbits{} -f -a '{}'\n", condition, fmt::join(command.command_names(), " "));
    for (const OptionRow& argument : command.arguments) {
        const std::string values = fmt::format("{}", fmt::join(argument.values.words, " "));
        if (argument.values.kind == Kind::names)
            text += fmt::format("complete -c lostbits{} -a '(__lostbits_names {})'\n", condition, values);
        if (argument.values.kind == Kind::words)
            text += fmt::format("complete -c lostbits{} -f -a '{}'\n", condition, values);
    }
    return text;
}

}  // namespace

std::string bash_completion(const Command& program) {
    std::vector<std::string> names;
    for (const CommandRow& command : command_table(program)) names.push_back(command.name);
    return "# Completion for bash, made by `lostbits completion bash`.\n" + bash_names_function() +
           bash_offers_function(program, names) + bash_main_function(names);
}

std::string zsh_completion(const Command& program) {
    const auto commands = command_table(program);
    std::string text =
        "#compdef lostbits\n"
        "# Completion for zsh, made by `lostbits completion zsh`.\n" +
        zsh_names_function() +
        "_lostbits() {\n"
        "    local command\n"
        "    local -a commands=(\n";
    for (const CommandRow& command : commands)
        text += "        " + shell_word(command.name + ":" + replace_all(short_help(command.help), ":", "\\:")) + "\n";

    // The command is the first word that names one.
    text += "    )\n    command=${words[(r)(";
    for (const CommandRow& command : commands) text += (&command == &commands.front() ? "" : "|") + command.name;
    text += ")]}\n    case $command in\n";
    const std::string common = zsh_specs(common_options(program));
    for (const CommandRow& command : commands) text += zsh_case(command, common);
    return text + "        *) _describe command commands ;;\n    esac\n}\n_lostbits \"$@\"\n";
}

std::string fish_completion(const Command& program) {
    std::string text =
        "# Completion for fish, made by `lostbits completion fish`.\n"
        "function __lostbits_names\n"
        "    set -l program (commandline -opc)[1]\n"
        "    for what in $argv\n"
        "        $program list $what 2>/dev/null | " +
        std::string(awk_plain_names_filter) +
        "\n"
        "    end\n"
        "end\n";
    for (const OptionRow& option : common_options(program)) text += fish_option("", option);
    for (const CommandRow& command : command_table(program)) text += fish_command(command);
    return text;
}

}  // namespace lostbits::analysis::shell
