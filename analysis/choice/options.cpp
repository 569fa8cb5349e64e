#include "analysis/choice/options.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "output/blame/explain_command.hpp"

namespace lostbits::analysis::choice {

namespace {

/// Options that change no result.
constexpr std::array<std::string_view, 15> of_no_result{
    "out",   "progress", "quiet",      "verbose",    "threads",     "isa",    "force",      "resume",
    "junit", "isolate",  "time-limit", "export-csv", "export-json", "report", "annotations"};

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

CLI::Option* add_list(CLI::App& command, const std::string& names, std::vector<std::string>& into,
                      const std::string& help) {
    return command.add_option(names, into, help)->allow_extra_args(false)->delimiter(',');
}

std::vector<std::string> assignments_in(const std::string& word) {
    std::vector<std::string> all;
    std::size_t begin = 0;
    int depth = 0;
    for (std::size_t i = 0; i < word.size(); ++i) {
        depth += (word[i] == '[' || word[i] == '(') - (word[i] == ']' || word[i] == ')');
        if (word[i] != ',' || depth > 0) continue;
        all.push_back(word.substr(begin, i - begin));
        begin = i + 1;
    }
    all.push_back(word.substr(begin));
    return all;
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
