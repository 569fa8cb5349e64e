#include "analysis/choice/options.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "number/error.hpp"
#include "output/blame/explain_command.hpp"

namespace lostbits::analysis::choice {

namespace {

/// Options that change no result.
constexpr std::array<std::string_view, 19> of_no_result{
    "out",    "progress",    "quiet",   "verbose",    "threads",    "isa",        "force",
    "resume", "junit",       "isolate", "in-process", "time-limit", "export-csv", "export-json",
    "report", "annotations", "shard",   "save",       "moves"};

constexpr const char* list_type = "TEXT,TEXT";  ///< in the help of an option

bool of_result(const CLI::Option& option) {
    return std::ranges::none_of(option.get_lnames(), [](const std::string& name) {
        return std::ranges::find(of_no_result, name) != of_no_result.end();
    });
}

/// ` -f f32 -f f64`, or ` --exr` of a flag.
std::string words_of(const CLI::Option& option) {
    const std::string name =
        option.get_snames().empty() ? "--" + option.get_lnames().front() : "-" + option.get_snames().front();
    if (option.get_expected_max() == 0) return " " + name;
    std::string text;
    for (const std::string& value : option.results()) text += " " + name + " " + output::blame::shell_word(value);
    return text;
}

/// Of the options that were given.
void add_words(const CLI::App& app, Typed& words) {
    for (const CLI::Option* option : app.get_options()) {
        if (option->count() == 0 || !of_result(*option)) continue;
        if (option->get_positional()) {
            for (const std::string& value : option->results()) words.subjects += " " + output::blame::shell_word(value);
        } else words.after += words_of(*option);
    }
}

}  // namespace

std::vector<std::string> items_in(const std::string& word, const std::string& option) {
    std::vector<std::string> all;
    for (std::size_t begin = 0; begin <= word.size();) {
        const std::size_t end = std::min(word.find(',', begin), word.size());
        all.push_back(CLI::detail::trim_copy(word.substr(begin, end - begin)));
        if (all.back().empty())
            throw InputError(word.find(',') == std::string::npos
                                 ? option + ": its value is empty"
                                 : option + " " + output::blame::shell_word(word) +
                                       ": has nothing before, between or after its commas; take out the comma");
        begin = end + 1;
    }
    return all;
}

bool matches_any(const std::vector<std::string>& patterns, const std::string& name) {
    return std::ranges::any_of(patterns,
                               [&name](const auto& pattern) { return fnmatch(pattern.c_str(), name.c_str(), 0) == 0; });
}

CLI::Option* add_list(CLI::App& command, const std::string& names, std::vector<std::string>& into,
                      const std::string& help) {
    const auto take = [&into, option = names.substr(0, names.find(','))](const std::vector<std::string>& words) {
        into.clear();
        for (const std::string& word : words) std::ranges::move(items_in(word, option), std::back_inserter(into));
    };
    // Not by CLI11's delimiter, which drops empty items and keeps blanks.
    return command.add_option_function<std::vector<std::string>>(names, take, help)
        ->allow_extra_args(false)
        ->type_name(list_type);
}

bool is_list(const CLI::Option& option) { return option.get_type_name().starts_with(list_type); }

CLI::Validator each_of(const std::string& option, const std::vector<std::string>& known) {
    const CLI::IsMember one(known);
    const auto check = [one, option](std::string& word) {
        for (const std::string& item : items_in(word, option)) {
            if (std::string wrong = one(item); !wrong.empty()) return wrong;
        }
        return std::string();
    };
    return {check, one.get_description()};
}

std::vector<std::string> assignments_in(const std::string& word) {
    std::vector<std::string> all;
    std::size_t begin = 0;
    int depth = 0;
    for (std::size_t i = 0; i < word.size(); ++i) {
        depth += (word[i] == '[' || word[i] == '(') - (word[i] == ']' || word[i] == ')');
        if (word[i] != ',' || depth > 0) continue;
        all.push_back(CLI::detail::trim_copy(word.substr(begin, i - begin)));
        begin = i + 1;
    }
    all.push_back(CLI::detail::trim_copy(word.substr(begin)));
    return all;
}

CLI::Validator number_from(double low, double high) {
    const CLI::Range range(low, high);
    const auto check = [range, low, high](std::string& word) {
        double value = 0;
        if (CLI::detail::lexical_cast(word, value) && std::isnan(value))
            return fmt::format("Value {} not in range {} to {}", word, low, high);
        return range(word);
    };
    return {check, range.get_description()};
}

CLI::Option* add_set(CLI::App& command, std::vector<std::string>& into, const std::string& help) {
    const auto take = [&into](const std::vector<std::string>& words) {
        into.clear();
        for (const std::string& word : words) std::ranges::move(assignments_in(word), std::back_inserter(into));
    };
    return command.add_option_function<std::vector<std::string>>("--set", take, help)->allow_extra_args(false);
}

void one_value_each(CLI::App& program) {
    for (CLI::Option* option : program.get_options()) {
        if (!option->get_positional() && option->get_expected_max() > 1) option->allow_extra_args(false);
    }
    for (CLI::App* command : program.get_subcommands({})) one_value_each(*command);
}

std::vector<std::string> words_in(const std::string& command) {
    std::vector<std::string> words;
    bool quoted = false, open = false;
    for (std::size_t i = 0; i < command.size(); ++i) {
        const char c = command[i];
        if (c == ' ' && !quoted) {
            open = false;
            continue;
        }
        if (!open) words.emplace_back();
        open = true;
        if (c == '\'') quoted = !quoted;
        else if (c == '\\' && !quoted && i + 1 < command.size()) words.back() += command[++i];
        else words.back() += c;
    }
    return words;
}

Typed typed(const CLI::App& program) {
    Typed words{program.get_name(), "", ""};
    add_words(program, words);
    for (const CLI::App* app = &program; !app->get_subcommands().empty();) {
        app = app->get_subcommands().front();
        words.before += " " + app->get_name();
        add_words(*app, words);
    }
    return words;
}

}  // namespace lostbits::analysis::choice
