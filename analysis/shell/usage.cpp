#include "analysis/shell/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <regex>

#include "analysis/shell/option_table.hpp"
#include "output/file/escape.hpp"
#include "shapes/number_names.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::analysis::shell {

namespace {

/// Usage of an option that only one command has: `lostbits explain --pixel X,Y`; empty if several commands have it, or
/// none.
std::string usage_elsewhere(const Command& program, const std::string& bare_name) {
    std::vector<std::string> lines;
    for (const CommandRow& command : command_table(program)) {
        for (const OptionRow& option : command.options) {
            if (option.names.back() != "--" + bare_name) continue;
            lines.push_back(fmt::format("lostbits {} --{}{}{}", command.name, bare_name, option.takes_value ? " " : "",
                                        option.value));
        }
    }
    return lines.size() == 1 ? lines.front() : "";
}

/// A message about an unknown option such as `--metrik`.
std::string unknown_option(const Command& program, const std::string& word) {
    const Command command = program.given_commands().back();
    std::vector<std::string> names;
    std::vector<Command> searched = command.option_groups();
    searched.insert(searched.end(), {command, program});
    for (const Command& owner : searched) {
        for (const Option& option : owner.options()) std::ranges::copy(option.long_names(), std::back_inserter(names));
    }
    const std::string bare_name =
        word.substr(word.find_first_not_of('-'), word.find('=') - word.find_first_not_of('-'));
    const auto suggestion = text::closest(bare_name, names);
    const std::string hint = usage_elsewhere(program, bare_name);
    return fmt::format("{}: is not an option of `{}`{}", word, program.command_path(),
                       !hint.empty() ? "; try `" + hint + "`"
                       : suggestion  ? "; did you mean --" + *suggestion + "?"
                                     : "");
}

/// A message about an argument or an option that the command needs. The help of each begins with a noun.
std::string missing_text(const Option& option) {
    std::string noun = option.help();
    if (noun.size() > 1 && std::islower(static_cast<unsigned char>(noun[1])) != 0)
        noun[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(noun[0])));
    else if (noun.starts_with("A ")) noun[0] = 'a';
    if (option.is_argument()) return fmt::format("{}: is missing; give {}", option.name(), noun);
    if (std::ranges::count(option.short_names(), "i") != 0)
        return fmt::format("-i: is missing; give {}; `lostbits list forms` lists all", noun);
    return fmt::format("--{}: is missing; give {}", option.long_names().front(), noun);
}

/// A message about a command line without a command, such as `lostbits plugin`.
std::string missing_command_text(const CommandLine& program) {
    const std::vector<Command> given = program.given_commands();
    if (given.size() == 1) return "a command is missing; start with map, explain or judge";
    const std::vector<std::string> names = given.back().command_names();
    if (names.size() == 1)
        return fmt::format("{}: a command is missing; the only one is {}", given.back().name(), names.front());
    return fmt::format("{}: a command is missing; name one of {}", given.back().name(), fmt::join(names, ", "));
}

/// A message about an option without its value.
std::string value_missing_text(const std::string& name, std::string help) {
    for (const ShapeRow& shape_row : shape_rows)
        if (name == "--" + std::string(shape_row.name)) help = option_placeholder(shape_row.shape);
    constexpr std::string_view heading = "Formats: ";
    if (help.starts_with(heading)) help.erase(0, heading.size());
    return fmt::format("{}: needs a value: {}", name, help);
}

/// The arguments of a command as they were given: `no argument`, `one SCENE, here near`, `only A and B, here x and y`.
std::string arguments_text(const Command& command) {
    std::vector<std::string> names, given;
    for (const Option& option : command.options()) {
        if (!option.is_argument()) continue;
        names.push_back(option.name());
        std::ranges::copy(option.given_values(), std::back_inserter(given));
    }
    if (names.empty()) return "no argument";
    return fmt::format("{} {}, here {}", names.size() == 1 ? "one" : "only", fmt::join(names, " and "),
                       fmt::join(given, " and "));
}

/// A message about the first word that no option or argument takes.
std::string leftover_text(const CommandLine& program, const std::string& fallback) {
    const Command command = program.given_commands().back();
    const bool is_program = program.given_commands().size() == 1;
    const std::vector<std::string> words = program.leftover_words();
    if (words.empty()) return fallback;
    const std::string& word = words.front();
    if (word.size() > 1 && word.front() == '-' && word.find_first_not_of('-') != std::string::npos)
        return unknown_option(program, word);
    if (word == "help") return fmt::format("help is not a command; write `{} --help`", program.command_path());
    if (is_program && word == "version") return "version is not a command; write `lostbits --version`";

    // The word is in the place of a command, or of an argument.
    const std::vector<std::string> subcommands = command.command_names();
    const auto suggestion = text::closest(word, subcommands);
    if (is_program)
        return fmt::format("\"{}\" is not a command; {}", word,
                           suggestion ? text::did_you_mean(word, subcommands)
                                      : "start with map, explain or judge; `lostbits --help` lists all commands");
    if (!subcommands.empty())
        return fmt::format("\"{}\" is not a command of `{}`; {}", word, program.command_path(),
                           text::did_you_mean(word, subcommands));
    return fmt::format(
        "{}: `{}` takes {}; an option takes one value at a time: repeat the option, or write commas (-i A,B)", word,
        program.command_path(), arguments_text(command));
}

}  // namespace

std::string describe_error(const CommandLine& program, const CommandLineError& error) {
    const std::string text = output::file::terminal_line(error.what());
    // A misspelt name makes something else seem to be missing, so the name is reported.
    if (error.kind == CommandLineError::unknown_word ||
        (error.kind == CommandLineError::missing && !program.leftover_words().empty()))
        return leftover_text(program, text);

    const Command command = program.given_commands().back();
    std::smatch part;
    const auto matches = [&](CommandLineError::Kind kind, const char* pattern) {
        return error.kind == kind && std::regex_match(text, part, std::regex(pattern));
    };
    /// The option that the first part of the match names: an option of the command, or else of the program.
    const auto option = [&] {
        const Option command_option = command.option(part[1]);
        return command_option ? command_option : program.option(part[1]);
    };

    // The texts of the parser, each with the message that replaces it.
    if (matches(CommandLineError::missing, "A subcommand.*")) return missing_command_text(program);
    if (matches(CommandLineError::missing, R"(.*at most 1 options be given from \[(.*)\])"))
        return std::regex_replace(part[1].str(), std::regex(","), ", ") + ": give only one of them";
    if (matches(CommandLineError::missing, "(.*) is required")) return missing_text(option());
    if (matches(CommandLineError::unreadable_value, "Could not convert: (.*) = (.*)"))
        return fmt::format("{} {}: is not a {}number, or is too large", part[1].str(), part[2].str(),
                           option().type().find("INT") == std::string::npos ? "" : "whole ");
    if (matches(CommandLineError::wrong_count, "(.*?): [0-9]+ required .* missing"))
        return value_missing_text(part[1].str(), option().help());
    if (matches(CommandLineError::wrong_count, "(.*?): At Most 1 required but received ([0-9]+)"))
        return fmt::format("{}: is given {} times but takes one value{}", part[1].str(), part[2].str(),
                           part[1] == "--answer-format" && command.option("-f")
                               ? "; for the formats of the forms of -i write -f"
                               : "");
    constexpr const char* names = R"((--?[a-z-]+|[A-Z]+) (requires|excludes) (--?[a-z-]+|[A-Z]+))";
    if (matches(CommandLineError::finished_text, names))
        return fmt::format(fmt::runtime(part[2] == "requires" ? "{0}: needs {1}; add {1}, or leave out {0}"
                                                              : "{0}: cannot be combined with {1}; leave out one of "
                                                                "them"),
                           part[1].str(), part[3].str());
    return text;
}

std::string escape_line_breaks(const std::string& message, const std::vector<std::string>& words) {
    std::string escaped;
    for (std::size_t position = 0; position < message.size(); ++position) {
        // A line break comes from a word if the characters around it are the same in the word, which also holds for a
        // part cut out of the word.
        const auto comes_from = [&](const std::string& word) {
            for (std::size_t i = 0; (i = word.find('\n', i)) != std::string::npos; ++i) {
                const bool is_same_before = i == 0 || (position > 0 && message[position - 1] == word[i - 1]);
                const bool is_same_after =
                    i + 1 == word.size() || message.substr(position + 1, 1) == word.substr(i + 1, 1);
                if (is_same_before && is_same_after) return true;
            }
            return false;
        };
        if (message[position] == '\n' && std::ranges::any_of(words, comes_from)) escaped += "\\n";
        else escaped += message[position];
    }
    return escaped;
}

}  // namespace lostbits::analysis::shell
