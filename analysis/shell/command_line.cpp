#include "analysis/shell/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>
#include <type_traits>

#include "output/attribution/explain_command.hpp"
#include "text/did_you_mean.hpp"
#include "text/shell_word.hpp"

namespace lostbits::analysis::shell {

namespace {

constexpr const char* list_type = "TEXT,TEXT";  ///< in the help of an option

std::string not_one_of_text(const std::string& option, const std::string& value,
                            const std::vector<std::string>& known) {
    const auto suggestion = text::closest(value, known);
    // The name of a positional argument, such as WHAT, means nothing to a user.
    const std::string subject = option.starts_with('-') ? option + " " + value + ":" : "\"" + value + "\"";
    return fmt::format("{} is not one of {}{}", subject, fmt::join(known, ", "),
                       suggestion ? "; did you mean \"" + *suggestion + "\"?" : "");
}

template <class T>
ValueRule range_rule(T low, T high) {
    const auto text = [](T end) { return fmt::format("{:.10g}", static_cast<double>(end)); };  // every int in full
    const auto problem_of = [=](const std::string& option, const std::string& value) {
        T number{};
        const bool fits = CLI::detail::lexical_cast(value, number) && low <= number && number <= high;
        return fits ? "" : fmt::format("{} {}: is not a number from {} to {}", option, value, text(low), text(high));
    };
    return {problem_of, fmt::format("{} in [{} - {}]", CLI::detail::type_name<T>(), text(low), text(high))};
}

std::string trim(const std::string& word) {
    const char* const blanks = " \t\n\v\f\r";
    const std::size_t begin = std::min(word.find_first_not_of(blanks), word.size());
    return word.substr(begin, word.find_last_not_of(blanks) + 1 - begin);
}

template <class Split>
CLI::Option* add_splitting_option(CLI::App& app, const std::string& names, std::vector<std::string>& target,
                                  const Split& split, const std::string& help) {
    const auto store = [&target, split](const std::vector<std::string>& values) {
        target.clear();
        for (const std::string& value : values) std::ranges::move(split(value), std::back_inserter(target));
    };
    return app.add_option_function<std::vector<std::string>>(names, store, help)->allow_extra_args(false);
}

/// Sets the option to take one value each time and to check it. Returns the option.
Option set_check(CLI::Option* option, const ValueRule& check) {
    if (!option->get_positional() && option->get_expected_max() > 1) option->allow_extra_args(false);
    const auto check_value = [problem_of = check.problem_of, option](const std::string& value) {
        // Throw: the parser would put the option's name in front of a returned text.
        if (std::string problem = problem_of(option->get_name(), value); !problem.empty())
            throw CommandLineError(CommandLineError::finished_text, problem);
        return std::string();
    };
    if (check.problem_of) option->check(check_value, check.description);
    return Option(option);
}

CommandLineError::Kind kind_of(const CLI::ParseError& error) {
    using Code = CLI::ExitCodes;
    switch (static_cast<Code>(error.get_exit_code())) {
        case Code::ExtrasError: return CommandLineError::unknown_word;
        case Code::RequiredError: return CommandLineError::missing;
        case Code::ConversionError: return CommandLineError::unreadable_value;
        case Code::ArgumentMismatch: return CommandLineError::wrong_count;
        default: return CommandLineError::finished_text;
    }
}

}  // namespace

ValueRule one_of(const std::vector<std::string>& known) {
    const auto problem_of = [known](const std::string& option, const std::string& value) {
        return std::ranges::find(known, value) == known.end() ? not_one_of_text(option, value, known) : "";
    };
    return {problem_of, fmt::format("{{{}}}", fmt::join(known, ","))};
}

ValueRule whole_number_between(int low, int high) { return range_rule(low, high); }
ValueRule number_between(double low, double high) { return range_rule(low, high); }

std::vector<std::string> split_items(const std::string& value, const std::string& option) {
    std::vector<std::string> all;
    for (std::size_t begin = 0; begin <= value.size();) {
        const std::size_t end = std::min(value.find(',', begin), value.size());
        all.push_back(trim(value.substr(begin, end - begin)));
        if (all.back().empty())
            throw InputError(
                value.find(',') == std::string::npos
                    ? option + ": its value is empty"
                    : option + " " + text::shell_word(value) +
                          ": has an empty value before, between or after its commas; remove the extra comma");
        begin = end + 1;
    }
    return all;
}

std::vector<std::string> split_assignments(const std::string& value) {
    std::vector<std::string> all;
    std::size_t begin = 0;
    int depth = 0;
    for (std::size_t i = 0; i < value.size(); ++i) {
        depth += (value[i] == '[' || value[i] == '(') - (value[i] == ']' || value[i] == ')');
        if (value[i] != ',' || depth > 0) continue;
        // A comma separates assignments only if another `=` follows before the next comma. So `box[0].lo=9,9,9` is
        // refused below.
        const std::size_t next = value.find(',', i + 1), equals = value.find('=', i + 1);
        if (begin < i && value.find('=', begin) < i && equals > next)
            throw InputError(
                fmt::format("--set {}: the text after the comma is not an assignment; write several numbers in "
                            "brackets, as in {}",
                            value, "'box[0].lo=[9, 9, 9]'"));
        all.push_back(trim(value.substr(begin, i - begin)));
        begin = i + 1;
    }
    all.push_back(trim(value.substr(begin)));
    return all;
}

Option Option::required() const { return Option(option_->required()); }
Option Option::excludes(Option other) const { return Option(option_->excludes(other.option_)); }
Option Option::needs(Option other) const { return Option(option_->needs(other.option_)); }
Option Option::under_heading(const std::string& heading) const { return Option(option_->group(heading)); }

std::string Option::name() const { return option_->get_name(); }
const std::vector<std::string>& Option::short_names() const { return option_->get_snames(); }
const std::vector<std::string>& Option::long_names() const { return option_->get_lnames(); }
const std::string& Option::help() const { return option_->get_description(); }
std::string Option::heading() const {
    return option_->get_group() == "Options" ? "" : option_->get_group();  // the parser's own
}
std::string Option::type() const { return option_->get_type_name(); }
bool Option::is_argument() const { return option_->get_positional(); }
bool Option::is_required() const { return option_->get_required(); }
bool Option::takes_value() const { return option_->get_expected_max() > 0; }
bool Option::takes_several() const {
    return option_->get_expected_max() > 1 && (is_argument() || type().starts_with(list_type));
}
const std::vector<std::string>& Option::given_values() const { return option_->results(); }

void Option::replace(const std::vector<std::string>& values) const {
    option_->clear();
    for (const std::string& value : values) option_->add_result(value);
    option_->run_callback();
}

template <class T>
Option Command::add(const std::string& names, T& target, const std::string& help, const ValueRule& check) const {
    if constexpr (std::is_unsigned_v<T>) {  // the parser reads -1 as the largest number
        const auto refuse_minus = [](const std::string& option, const std::string& value) {
            return value.starts_with('-') ? fmt::format("{} {}: is not a whole number of at least 0", option, value)
                                          : "";
        };
        return set_check(app_->add_option(names, target, help), check.problem_of ? check : ValueRule{refuse_minus, ""});
    }
    return set_check(app_->add_option(names, target, help), check);
}
template Option Command::add(const std::string&, std::string&, const std::string&, const ValueRule&) const;
template Option Command::add(const std::string&, std::vector<std::string>&, const std::string&, const ValueRule&) const;
template Option Command::add(const std::string&, double&, const std::string&, const ValueRule&) const;
template Option Command::add(const std::string&, int&, const std::string&, const ValueRule&) const;
template Option Command::add(const std::string&, std::optional<int>&, const std::string&, const ValueRule&) const;
template Option Command::add(const std::string&, std::size_t&, const std::string&, const ValueRule&) const;

Option Command::add(const std::string& names, bool& target, const std::string& help) const {
    return Option(app_->add_flag(names, target, help));
}

Option Command::add_list(const std::string& names, std::vector<std::string>& target, const std::string& help,
                         const ValueRule& check) const {
    const auto items = [option = names.substr(0, names.find(','))](const std::string& value) {
        return split_items(value, option);
    };
    // The parser's own delimiter would drop empty items and keep blanks.
    auto* const list = add_splitting_option(*app_, names, target, items, help)->type_name(list_type);
    if (!check.problem_of) return Option(list);
    const auto check_items = [check](const std::string& option, const std::string& value) {
        for (const std::string& item : split_items(value, option)) {
            if (std::string problem = check.problem_of(option, item); !problem.empty()) return problem;
        }
        return std::string();
    };
    return set_check(list, {check_items, check.description});
}

Option Command::add_set(std::vector<std::string>& target, const std::string& help) const {
    return set_check(add_splitting_option(*app_, "--set", target, split_assignments, help), {});
}

Option Command::add_named(const std::string& option, const std::vector<std::string>& names,
                          const std::function<void(int)>& set_index, const std::string& help) const {
    std::map<std::string, int> indices;
    for (const std::string& name : names) indices.emplace(name, indices.size());
    const CLI::CheckedTransformer to_index(indices);
    const auto validate = [=](std::string& value) {
        if (!to_index(value).empty())
            throw CommandLineError(CommandLineError::finished_text, not_one_of_text(option, value, names));
        return std::string();
    };
    return Option(app_->add_option_function<int>(option, set_index, help)
                      ->type_name("ENUM")
                      ->default_str(names.front())
                      ->transform(CLI::Validator(validate, to_index.get_description())));
}

Command Command::add_command(const std::string& name, const std::string& help) const {
    app_->require_subcommand(1);
    CLI::App* const added = app_->add_subcommand(name, help);
    added->footer("")->group("Subcommands");  // inherit neither the examples of the command above nor that it is hidden
    return {added, action_};
}

Command Command::add_group(const std::string& name, const std::string& help) const {
    auto* const group = app_->add_option_group(name, help);
    group->require_option(0, 1);
    return {group, action_};
}

std::function<std::vector<std::size_t>()> Command::make_value_order(const std::vector<Option>& options) const {
    return [app = app_, options] {
        std::vector<std::size_t> indices;
        for (CLI::Option* const given : app->parse_order()) {
            const auto found = std::ranges::find(options, Option(given));
            if (found != options.end()) indices.push_back(static_cast<std::size_t>(found - options.begin()));
        }
        return indices;
    };
}

void Command::set_action(const std::function<ExitStatus()>& run) const {
    app_->callback([run, action = action_] { *action = run; });
}

const std::string& Command::name() const { return app_->get_name(); }
std::string Command::help() const { return app_->get_description(); }

void Command::set_examples(const std::vector<Example>& examples) const {
    std::string text;
    for (const Example& example : examples) text += example.line + "\n" + example.description + "\n";
    app_->footer(text);
}

std::vector<Example> Command::examples() const {
    std::vector<Example> all;
    std::istringstream text(app_->get_footer());
    for (Example example; std::getline(text, example.line) && std::getline(text, example.description);)
        all.push_back(example);
    return all;
}

void Command::hide_from_help() const { app_->group(""); }
bool Command::is_hidden() const { return app_->get_group().empty(); }

std::vector<Option> Command::options() const {
    std::vector<Option> all;
    for (CLI::Option* option : app_->get_options()) all.emplace_back(option);
    return all;
}

Option Command::option(const std::string& name) const { return Option(app_->get_option_no_throw(name)); }

std::vector<Command> Command::to_commands(const std::vector<CLI::App*>& apps) const {
    std::vector<Command> all;
    for (CLI::App* const app : apps) all.push_back({app, action_});
    return all;
}

std::vector<Command> Command::subcommands() const {
    return to_commands(app_->get_subcommands([](CLI::App* app) { return !app->get_name().empty(); }));
}

// For the parser, a group is a subcommand without a name.
std::vector<Command> Command::option_groups() const {
    return to_commands(app_->get_subcommands([](CLI::App* app) { return app->get_name().empty(); }));
}

std::vector<std::string> Command::command_names() const {
    std::vector<std::string> names;
    for (const Command& command : subcommands())
        if (!command.is_hidden()) names.push_back(command.name());
    return names;
}

std::vector<Command> Command::given_commands() const {
    std::vector<Command> all{*this};
    while (!all.back().app_->get_subcommands().empty())
        all.push_back({all.back().app_->get_subcommands().front(), action_});
    return all;
}

std::string Command::command_path() const {
    std::string path;
    for (const Command& command : given_commands()) path += (path.empty() ? "" : " ") + command.name();
    return path;
}

CommandLine::CommandLine(const std::string& name, const std::string& version, const std::string& help)
    : Command(nullptr, &run_), parser_(std::make_unique<CLI::App>(help, name)) {
    app_ = parser_.get();
    app_->fallthrough();
    app_->set_version_flag("--version", version);
}

CommandLine::~CommandLine() = default;

CommandLine::ParseOutcome CommandLine::parse(const std::vector<std::string>& words) {
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    try {
        app_->parse(static_cast<int>(argv.size()), argv.data());
        return ParseOutcome::command;
    } catch (const CLI::CallForHelp& request) {
        // A word that should name a command, but does not, has no help.
        const std::vector<std::string> unused_words = leftover_words();
        if (!unused_words.empty() && !unused_words.front().starts_with('-') &&
            !given_commands().back().command_names().empty())
            throw CommandLineError(CommandLineError::unknown_word, request.what());
        return ParseOutcome::help;
    } catch (const CLI::Success& request) {  // --version
        app_->exit(request);
        return ParseOutcome::version;
    } catch (const CLI::ParseError& error) {
        throw CommandLineError(kind_of(error), error.what());
    }
}

std::vector<std::string> CommandLine::leftover_words() const { return app_->remaining(true); }

/// The absolute path of a file, which need not exist. (weakly_canonical alone leaves a relative path as it is if none
/// of its folders exists.)
static std::filesystem::path absolute_path(const std::string& file) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file));
}

void require_different_files(const std::vector<NamedFile>& files, const NamedFile& folder) {
    const auto folder_path = folder.file.empty() ? std::filesystem::path() : absolute_path(folder.file);
    std::map<std::filesystem::path, const char*> option_of_path;
    for (const auto& [option, file] : files) {
        if (file.empty()) continue;
        const auto path = absolute_path(file);
        if (!folder_path.empty() && path.parent_path() == folder_path)
            throw InputError(fmt::format("{} {}: is in the folder of {} {}; choose another folder", option, file,
                                         folder.option, folder.file));
        const auto [entry, is_new] = option_of_path.emplace(path, option);
        if (!is_new)
            throw InputError(
                fmt::format("{} {}: {} names the same file; give each its own file", option, file, entry->second));
    }
}

}  // namespace lostbits::analysis::shell
