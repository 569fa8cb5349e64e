// The command line as the commands see it: the options they declare, and the words that were given. Only
// command_line.cpp includes the parser: when every command included its templates, compiling the commands took 80 s of
// processor time instead of 66 s.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "number/error.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lostbits::analysis::shell {

/// The check of a value.
struct ValueRule {
    /// Says in a sentence what is wrong with a value of an option; empty if the value is allowed.
    std::function<std::string(const std::string& option, const std::string& value)> problem_of;
    std::string description;  ///< for the help: `{none,csv}`
};
ValueRule one_of(const std::vector<std::string>& known);
/// A number from `low` to `high`, both included. NaN is refused.
ValueRule whole_number_between(int low, int high);
ValueRule number_between(double low, double high);

/// The items between the commas of a list, without the blanks around them. Throws InputError, which names the `option`,
/// for an empty item.
std::vector<std::string> split_items(const std::string& value, const std::string& option);
/// The assignments in a value: `a=1,b=[2,3]` has two.
std::vector<std::string> split_assignments(const std::string& value);

/// An option of a command, or an argument if its name has no hyphen. A copy of this object refers to the same option.
class Option {
public:
    explicit Option(CLI::Option* option = nullptr) : option_(option) {}
    explicit operator bool() const { return option_ != nullptr; }
    friend bool operator==(const Option&, const Option&) = default;

    Option required() const;
    Option excludes(Option other) const;
    Option needs(Option other) const;
    /// Shows the option in the help below this heading, together with the other options of that heading.
    Option under_heading(const std::string& heading) const;

    [[nodiscard]] std::string name() const;
    [[nodiscard]] const std::vector<std::string>& short_names() const;  ///< without hyphens
    [[nodiscard]] const std::vector<std::string>& long_names() const;
    [[nodiscard]] const std::string& help() const;
    [[nodiscard]] std::string heading() const;  ///< of its group in the help; empty: none of its own
    [[nodiscard]] std::string type() const;     ///< with its allowed values: `TEXT:{none,csv}`
    [[nodiscard]] bool is_argument() const;
    [[nodiscard]] bool is_required() const;
    [[nodiscard]] bool takes_value() const;
    [[nodiscard]] bool takes_several() const;                            ///< one occurrence takes several values
    [[nodiscard]] const std::vector<std::string>& given_values() const;  ///< the texts as they were given

    /// Replaces the values that were given.
    void replace(const std::vector<std::string>& values) const;

private:
    CLI::Option* option_;
};

/// An example in a help: a command line, and a sentence that says what it does.
struct Example {
    std::string line, description;
};

/// A command, the program, or a group of options. A copy of this object refers to the same command.
class Command {
public:
    /// Adds an option or an argument. T is std::string, its vector, double, int, std::optional<int> or std::size_t. An
    /// option takes one value each time; with a vector it may be repeated. An argument with a vector takes all words
    /// that follow.
    template <class T>
    Option add(const std::string& names, T& target, const std::string& help, const ValueRule& check = {}) const;
    Option add(const std::string& names, bool& target, const std::string& help) const;  ///< takes no value
    /// Adds an option that may be repeated and takes several values between commas: `-f f32 -f f64` is `-f f32,f64`.
    /// Each value is checked.
    Option add_list(const std::string& names, std::vector<std::string>& target, const std::string& help,
                    const ValueRule& check = {}) const;
    /// Adds `--set`, which takes assignments, repeated or between commas.
    Option add_set(std::vector<std::string>& target, const std::string& help) const;
    /// Adds an option whose value is one of these names, by default the first. `set_index` gets the index of the name.
    Option add_named(const std::string& option, const std::vector<std::string>& names,
                     const std::function<void(int)>& set_index, const std::string& help) const;

    /// Adds a subcommand. A command that has subcommands needs one of them.
    Command add_command(const std::string& name, const std::string& help) const;
    /// Adds a group of options of which at most one can be given.
    Command add_group(const std::string& name, const std::string& help) const;
    /// Makes a function to call after parsing. The function returns, for each value of these options in the order in
    /// which they were given, the index of its option in the list.
    [[nodiscard]] std::function<std::vector<std::size_t>()> make_value_order(const std::vector<Option>& options) const;

    /// Adds the examples that the help shows.
    void set_examples(const std::vector<Example>& examples) const;
    /// Leaves the command out of every help and list: the program starts it by itself.
    void hide_from_help() const;

    /// Sets the function that runs if this command is given.
    void set_action(const std::function<ExitStatus()>& run) const;

    [[nodiscard]] const std::string& name() const;  ///< empty: a group
    [[nodiscard]] std::string help() const;
    [[nodiscard]] std::vector<Example> examples() const;
    [[nodiscard]] bool is_hidden() const;
    [[nodiscard]] std::vector<Option> options() const;           ///< without those of groups
    [[nodiscard]] Option option(const std::string& name) const;  ///< empty if the command has no such option
    [[nodiscard]] std::vector<Command> subcommands() const;
    [[nodiscard]] std::vector<Command> option_groups() const;
    [[nodiscard]] std::vector<std::string> command_names() const;  ///< without hidden ones
    [[nodiscard]] std::vector<Command> given_commands() const;     ///< itself, its subcommand that was given, and so on
    [[nodiscard]] std::string command_path() const;                ///< their names: `lostbits plugin check`

protected:
    Command(CLI::App* app, std::function<ExitStatus()>* action) : app_(app), action_(action) {}
    CLI::App* app_;
    std::function<ExitStatus()>* action_;  ///< runs the command that was given

private:
    [[nodiscard]] std::vector<Command> to_commands(const std::vector<CLI::App*>& apps) const;
};

/// An error in the words of a command line, with the text of the parser.
struct CommandLineError : std::runtime_error {
    enum Kind { unknown_word, missing, unreadable_value, wrong_count, finished_text };
    CommandLineError(Kind kind_of_error, const std::string& text) : std::runtime_error(text), kind(kind_of_error) {}
    Kind kind;  ///< `finished_text`: the text is already a finished message
};

/// The whole program: its parser, and the command that was given.
class CommandLine : public Command {
public:
    CommandLine(const std::string& name, const std::string& version, const std::string& help);
    ~CommandLine();

    enum class ParseOutcome { command, help, version };
    /// Parses the words; the first is the name of the program. If they asked for the version, it is printed. Throws
    /// CommandLineError, or what a check throws.
    [[nodiscard]] ParseOutcome parse(const std::vector<std::string>& words);
    /// Runs the command that was given.
    [[nodiscard]] ExitStatus run() const { return run_(); }

    [[nodiscard]] std::vector<std::string> leftover_words() const;  ///< words that no option or argument takes

private:
    std::unique_ptr<CLI::App> parser_;
    std::function<ExitStatus()> run_;
};

/// Turns an error of the parser into a message that says what is wrong, why, and what to try.
std::string describe_error(const CommandLine& program, const CommandLineError& error);

/// The message, with line breaks that come from one of the words written as `\n`. The line breaks of the message itself
/// stay.
std::string escape_line_breaks(const std::string& message, const std::vector<std::string>& words);

/// An option and the file that it names, empty if the option was not given.
struct NamedFile {
    const char* option;
    std::string file;
};

/// Throws InputError if two options name the same file, since the later would overwrite the earlier, or if a file is
/// directly in `folder`, since a result there may get the same name.
void require_different_files(const std::vector<NamedFile>& files, const NamedFile& folder);

}  // namespace lostbits::analysis::shell
