#include <fmt/format.h>
#include <fmt/ranges.h>

#include <sstream>

#include "analysis/shell/option_table.hpp"

namespace lostbits::analysis::shell {

namespace {

/// The text escaped for roff: hyphens that can be copied, backslashes, and no line that looks like a request.
std::string escape_roff(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '\\') escaped += "\\e";
        else if (c == '-') escaped += "\\-";
        else if ((c == '.' || c == '\'') && (escaped.empty() || escaped.back() == '\n'))
            escaped += std::string("\\&") + c;
        else escaped += c;
    }
    return escaped;
}

/// `-i, --form VALUE`
std::string heading_text(const OptionRow& option) {
    std::string text;
    for (const std::string& name : option.names)
        text += (text.empty() ? "" : ", ") + ("\\fB" + escape_roff(name) + "\\fR");
    const bool is_option = option.names.front().front() == '-';
    if (is_option && option.takes_value) text += " \\fI" + escape_roff(option.value) + "\\fR";
    return text;
}

std::string paragraphs(const std::vector<OptionRow>& options) {
    std::string text;
    for (const std::string& heading : headings_of(options)) {
        if (!heading.empty()) text += ".PP\n" + escape_roff(heading) + ":\n";
        for (const OptionRow& option : options)
            if (option.heading == heading)
                text += ".TP\n" + heading_text(option) + "\n" + escape_roff(option.help) + "\n";
    }
    return text;
}

/// `SCENE... -i NAME [OPTION]...`
std::string arguments_text(const CommandRow& command) {
    std::string text;
    for (const OptionRow& argument : command.arguments) {
        const std::string name = "\\fI" + argument.names.front() + "\\fR";
        text += " " + (argument.is_required ? name : "[" + name + "]") + (argument.takes_several ? "..." : "");
    }
    for (const OptionRow& option : command.options)
        if (option.is_required)
            text += " " + escape_roff(option.names.front()) + " \\fI" + escape_roff(option.value) + "\\fR";
    return text + " [\\fIOPTION\\fR]...";
}

/// The lines of the synopsis of a command. There is one per subcommand if the subcommands take arguments.
std::vector<std::string> synopsis(const CommandRow& command) {
    const std::string name = "\\fBlostbits " + command.name;
    if (command.commands.empty()) return {name + "\\fR" + arguments_text(command)};
    if (command.arguments.empty())
        return {name + fmt::format("\\fR {} [\\fIOPTION\\fR]...", fmt::join(command.command_names(), "|"))};
    std::vector<std::string> lines;
    for (const CommandRow& inner : command.commands)
        lines.push_back(name + " " + inner.name + "\\fR" + arguments_text(inner));
    return lines;
}

/// The footer in sections; their headings end with a colon.
std::string footer_sections(const std::string& footer) {
    std::string text;
    std::istringstream lines(footer);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty()) continue;
        if (line.back() == ':' && line.front() != ' ') {
            std::string section = line.substr(0, line.size() - 1);
            for (char& c : section) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
            text += ".SH " + section + "\n";
            continue;
        }

        // Two blanks separate a term from its explanation.
        const auto begin = line.find_first_not_of(' '), end = line.find("  ", begin);
        if (end == std::string::npos) text += escape_roff(line.substr(begin)) + "\n";
        else
            text += ".TP\n\\fB" + escape_roff(line.substr(begin, end - begin)) + "\\fR\n" +
                    escape_roff(line.substr(line.find_first_not_of(' ', end))) + "\n";
    }
    return text;
}

}  // namespace

std::string manual_page(const Command& program, const std::string& version, const std::string& footer) {
    const auto commands = command_table(program);
    std::string text = fmt::format(".TH LOSTBITS 1 \"\" \"lostbits {}\" \"User Commands\"\n", version);
    text += ".SH NAME\nlostbits \\- a precision laboratory for ray intersectors\n.SH SYNOPSIS\n";
    for (const CommandRow& command : commands)
        text += fmt::format("{}\n.br\n", fmt::join(synopsis(command), "\n.br\n"));

    text += ".SH DESCRIPTION\n" + escape_roff(program.help()) + "\n.SH COMMANDS\n";
    for (const CommandRow& command : commands) {
        text += fmt::format(".SS {}\n{}.\n", fmt::join(synopsis(command), "\n.SS "), escape_roff(command.help));
        for (const CommandRow& inner : command.commands)
            text += ".TP\n\\fB" + inner.name + "\\fR\n" + escape_roff(inner.help) + "\n";
        text += paragraphs(command.arguments) + paragraphs(command.options);
        if (!command.examples.empty()) text += ".PP\nExamples:\n";
        for (const Example& example : command.examples)
            text += ".TP\n\\fB" + escape_roff(example.line) + "\\fR\n" + escape_roff(example.description) + "\n";
    }
    return text + ".SH OPTIONS OF EVERY COMMAND\n" + paragraphs(common_options(program)) + footer_sections(footer);
}

}  // namespace lostbits::analysis::shell
