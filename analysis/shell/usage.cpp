#include "analysis/shell/usage.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "output/file/escape.hpp"
#include "output/file/number_text.hpp"
#include "scene/toml/did_you_mean.hpp"

namespace lostbits::analysis::shell {

using scene::toml::closest;
using scene::toml::did_you_mean;

namespace {

std::vector<std::string> split(const std::string& list) {
    std::vector<std::string> words = CLI::detail::split(list, ',');
    for (std::string& word : words) CLI::detail::trim(word);
    return words;
}

/// The option of that name, as the command or the program has it; null where neither does.
const CLI::Option* find_option(const CLI::App& program, const std::string& name) {
    for (const CLI::App* app : {&command_named(program), &program}) {
        for (const CLI::Option* option : app->get_options()) {
            if (option->check_name(name) || option->get_name() == name) return option;
        }
    }
    return nullptr;
}

/// `--metrik`: an option that there is not.
std::string unknown_option(const CLI::App& program, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::App* app : {&command_named(program), &program}) {
        for (const CLI::Option* option : app->get_options())
            std::ranges::copy(option->get_lnames(), std::back_inserter(names));
    }
    const std::string bare = word.substr(word.find_first_not_of('-'), word.find('=') - word.find_first_not_of('-'));
    const auto near = closest(bare, names);
    return fmt::format("{}: is not an option of `{}`{}", word, command_named(program).get_display_name(),
                       near ? "; did you mean --" + *near + "?" : "");
}

/// Words that nothing takes.
std::string leftover(const CLI::App& program, const std::string& fallback) {
    const CLI::App& command = command_named(program);
    const std::vector<std::string> words = program.remaining(true);
    if (words.empty()) return fallback;
    const std::string& word = words.front();
    if (word.size() > 1 && word.front() == '-' && word.find_first_not_of('-') != std::string::npos)
        return unknown_option(program, word);
    if (word == "help")
        return fmt::format("help is not a command; write `lostbits {}--help`",
                           &command == &program ? "" : command.get_name() + " ");
    if (&command == &program && word == "version") return "version is not a command; write `lostbits --version`";
    if (&command == &program)
        return fmt::format("\"{}\" is not a command; {}", word, did_you_mean(word, commands_of(program)));
    if (const auto inner = commands_of(command); !inner.empty())
        return fmt::format("{} {}: is not one of {}", command.get_name(), word, fmt::join(inner, ", "));
    return fmt::format(
        "{}: `lostbits {}` takes no such word; an option takes one value where it stands: repeat it, or "
        "write commas (-i A,B)",
        word, command.get_name());
}

/// What an option or an argument is for, from its help.
std::string help_of(const CLI::App& program, const std::string& name) {
    const CLI::Option* const option = find_option(program, name);
    return option == nullptr ? "" : option->get_description();
}

std::string missing(const CLI::App& program, const std::string& text) {
    std::smatch part;
    if (text.starts_with("A subcommand"))
        return fmt::format("name a command: {}", fmt::join(commands_of(command_named(program)), ", "));
    if (std::regex_search(text, part, std::regex(R"(at most 1 options be given from \[(.*)\])")))
        return fmt::format("{}: only one of them can be given", fmt::join(split(part[1]), ", "));
    if (!std::regex_match(text, part, std::regex("(.*) is required"))) return text;
    return fmt::format("{} is missing: {}", part[1].str(), help_of(program, part[1]));
}

std::string not_one_of(const std::string& option, const std::string& value, const std::string& list) {
    const std::vector<std::string> known = split(list);
    const auto near = closest(value, known);
    return fmt::format("{} {}: is not one of {}{}", option, value, fmt::join(known, ", "),
                       near ? "; did you mean " + *near + "?" : "");
}

std::string without_zeros(const std::string& number) {
    return fmt::format("{:g}", output::file::number_in(number).value_or(NAN));
}

std::string unfit_value(const std::string& text) {
    std::smatch part;
    // Where words are mapped, CLI11 shows the map: `Check often value in {auto->0,bar->1} OR {0,1} FAILED`.
    static const std::regex of_set(R"((.*?): (.*) not in \{([^}]*)\}.*)"), arrow("->[^,}]*"),
        of_map(R"((.*?): Check (.*) value in \{([^}]*)\}.*)");
    if (std::regex_match(text, part, of_set) || std::regex_match(text, part, of_map))
        return not_one_of(part[1], part[2], std::regex_replace(part[3].str(), arrow, ""));
    if (std::regex_match(text, part, std::regex("(.*?): Value (.*) not in range (.*) to (.*)")))
        return fmt::format("{} {}: is not a number from {} to {}", part[1].str(), part[2].str(), without_zeros(part[3]),
                           without_zeros(part[4]));
    return text;
}

std::string unread_value(const CLI::App& program, const std::string& text) {
    std::smatch part;
    if (!std::regex_match(text, part, std::regex("Could not convert: (.*) = (.*)"))) return text;
    const CLI::Option* const option = find_option(program, part[1]);
    const bool whole = option != nullptr && option->get_type_name().find("INT") != std::string::npos;
    return fmt::format("{} {}: is not a {}number that it can be", part[1].str(), part[2].str(), whole ? "whole " : "");
}

template <class Kind>
bool is(const CLI::ParseError& error) {
    return dynamic_cast<const Kind*>(&error) != nullptr;
}

std::string wrong_count(const CLI::App& program, const std::string& text) {
    std::smatch part;
    if (std::regex_match(text, part, std::regex("(.*?): [0-9]+ required .* missing")))
        return fmt::format("{}: its value is missing: {}", part[1].str(), help_of(program, part[1]));
    if (std::regex_match(text, part, std::regex("(.*?): At Most 1 required but received ([0-9]+)")))
        return fmt::format("{}: is given {} times, and takes one value", part[1].str(), part[2].str());
    return text;
}

}  // namespace

const CLI::App& command_named(const CLI::App& program) {
    const CLI::App* app = &program;
    while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
    return *app;
}

std::vector<std::string> commands_of(const CLI::App& program) {
    std::vector<std::string> names;
    for (const CLI::App* command :
         program.get_subcommands([](const CLI::App* app) { return !app->get_name().empty(); }))
        names.push_back(command->get_name());
    return names;
}

std::string what_is_wrong(const CLI::App& program, const CLI::ParseError& error) {
    const std::string text = output::file::terminal_line(error.what());
    // By type: the name of an ExtrasError is that of the command.
    const bool required = is<CLI::RequiredError>(error);
    if (is<CLI::ExtrasError>(error)) return leftover(program, text);
    // A slip in a name is why something else seems to be missing.
    if (required && !program.remaining(true).empty()) return leftover(program, text);
    if (required) return missing(program, text);
    if (is<CLI::ValidationError>(error)) return unfit_value(text);
    if (is<CLI::ConversionError>(error)) return unread_value(program, text);
    if (is<CLI::ArgumentMismatch>(error)) return wrong_count(program, text);
    return text;
}

std::string with_words_on_one_line(const std::string& message, const std::vector<std::string>& words) {
    std::string out;
    for (std::size_t at = 0; at < message.size(); ++at) {
        // With what stands on either side of it in the word: whatever was cut out of a word keeps that much.
        const auto typed = [&](const std::string& word) {
            for (std::size_t in = 0; (in = word.find('\n', in)) != std::string::npos; ++in) {
                const bool before = in == 0 || (at > 0 && message[at - 1] == word[in - 1]);
                const bool after = in + 1 == word.size() || message.substr(at + 1, 1) == word.substr(in + 1, 1);
                if (before && after) return true;
            }
            return false;
        };
        if (message[at] == '\n' && std::ranges::any_of(words, typed)) out += "\\n";
        else out += message[at];
    }
    return out;
}

}  // namespace lostbits::analysis::shell
