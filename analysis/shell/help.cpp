#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "analysis/shell/option_table.hpp"

namespace lostbits::analysis::shell {

namespace {

constexpr std::size_t help_width = 110, help_column = 30;

/// Wraps the text, with `indent` blanks in front of each line but the first. The first line has `started` characters
/// already.
std::string wrap(const std::string& text, std::size_t indent, std::size_t started) {
    std::string wrapped_text;
    std::size_t column = started;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        if (column > indent && column + 1 + (end - begin) > help_width) {
            wrapped_text += "\n" + std::string(indent, ' ');
            column = indent;
        } else if (column > indent) {
            wrapped_text += ' ';
            ++column;
        }
        wrapped_text += text.substr(begin, end - begin);
        column += end - begin;
        begin = end + 1;
    }
    return wrapped_text;
}

/// `  -f,--format NAME,...       Formats: …`
std::string help_line(const std::string& subject, const std::string& help) {
    std::string line = "  " + subject;
    if (help.empty()) return line + "\n";
    if (line.size() + 2 > help_column) line += "\n" + std::string(help_column, ' ');
    else line.resize(help_column, ' ');
    return line + wrap(help, help_column, help_column) + "\n";
}

std::string option_text(const OptionRow& option) {
    return fmt::format("{}", fmt::join(option.names, ",")) + (option.value.empty() ? "" : " " + option.value);
}

/// `SCENE...`, `[CLAIMS...]`
std::string argument_text(const OptionRow& argument) {
    const std::string text = argument.names.front() + (argument.takes_several ? "..." : "");
    return argument.is_required ? text : "[" + text + "]";
}

/// The options that must be given, in their shortest form: ` -i NAME --bits 0..53`.
std::string required_options_text(const std::vector<OptionRow>& options) {
    std::string text;
    for (const OptionRow& option : options)
        if (option.is_required) text += " " + option.names.front() + " " + option.value;
    return text;
}

/// Lists the options by their headings, in the order of the headings.
std::string option_sections(const std::vector<OptionRow>& options) {
    std::string text;
    for (const std::string& heading : headings_of(options)) {
        text += "\n" + (heading.empty() ? "Options" : heading) + ":\n";
        for (const OptionRow& option : options)
            if (option.heading == heading) text += help_line(option_text(option), option.help);
    }
    return text;
}

std::string example_lines(const std::vector<Example>& examples) {
    std::string text = examples.empty() ? "" : "\nExamples:\n";
    for (const Example& example : examples) text += fmt::format("  {}\n      {}\n", example.line, example.description);
    return text;
}

/// The names of the common options, without their help.
std::string common_lines(const std::vector<OptionRow>& common) {
    std::string names;
    for (const OptionRow& option : common)
        if (option.names.back() != "--help" && option.names.back() != "--version")
            names += (names.empty() ? "" : ", ") + option_text(option);
    return "\nOptions of every command:\n  " + wrap(names, 2, 2) + "\n";
}

std::string command_list(const std::vector<CommandRow>& commands) {
    std::string text = commands.empty() ? "" : "\nCommands:\n";
    for (const CommandRow& command : commands) text += help_line(command.name, command.help);
    return text;
}

/// The row of the command that was given, which may be a subcommand.
CommandRow given_command_row(const Command& program) {
    const std::vector<Command> given = program.given_commands();
    std::vector<CommandRow> rows = command_table(given[given.size() - 2], true);
    return *std::ranges::find(rows, given.back().name(), &CommandRow::name);
}

}  // namespace

std::string help_page(const Command& program, const std::string& footer) {
    const std::vector<OptionRow> common = common_options(program);
    if (program.given_commands().size() == 1)
        return program.help() + "\nUsage: lostbits COMMAND [OPTIONS]\n" + command_list(command_table(program)) +
               option_sections(common) + "\n" + footer;

    const CommandRow row = given_command_row(program);
    std::string text = wrap(row.help, 0, 0) + "\nUsage: " + program.command_path();
    if (!row.commands.empty()) text += " COMMAND";
    else {
        for (const OptionRow& argument : row.arguments) text += " " + argument_text(argument);
        text += required_options_text(row.options);
    }

    // The examples of `plugin check` are stored with `plugin`.
    const std::vector<Command> given = program.given_commands();
    text += " [OPTIONS]\n" + example_lines(given[1].examples()) + command_list(row.commands);
    if (row.commands.empty() && !row.arguments.empty()) {
        text += "\nArguments:\n";
        for (const OptionRow& argument : row.arguments)
            text += help_line(argument_text(argument),
                              argument.value.empty() ? argument.help : argument.help + ": " + argument.value);
    }
    return text + option_sections(row.options) + common_lines(common) +
           "\n`lostbits --help` explains these, the exit status and the environment; `lostbits manual` has "
           "everything.\n";
}

}  // namespace lostbits::analysis::shell
