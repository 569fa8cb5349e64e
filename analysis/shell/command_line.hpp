// The command line as the commands see it: what they declare, and what was given. The parser behind it is seen by
// command_line.cpp alone: compiling the commands took 80 s of processor, not 66, while each saw its templates.
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

/// What a value is held to.
struct ValueRule {
    /// What is wrong with a word of an option, in a sentence; empty where it fits.
    std::function<std::string(const std::string& option, const std::string& word)> wrong;
    std::string description;  ///< for the help: `{none,csv}`
};
ValueRule one_of(const std::vector<std::string>& known);
/// Both ends included; NaN is in no range.
ValueRule whole_from(int low, int high);
ValueRule number_from(double low, double high);

/// The items of a list between commas, without the blanks around them. InputError, of the `option`, for an empty one.
std::vector<std::string> items_in(const std::string& word, const std::string& option);
/// The assignments of a word: `a=1,b=[2,3]` are two.
std::vector<std::string> assignments_in(const std::string& word);

/// An option or, where its name has no hyphen, an argument of a command. A copy is the same option.
class Option {
public:
    explicit Option(CLI::Option* option = nullptr) : option_(option) {}
    explicit operator bool() const { return option_ != nullptr; }
    friend bool operator==(const Option&, const Option&) = default;

    Option required() const;
    Option excludes(Option other) const;
    Option needs(Option other) const;
    /// Shown in the help below a heading of its own, with the others that are.
    Option below(const std::string& heading) const;

    [[nodiscard]] std::string name() const;
    [[nodiscard]] const std::vector<std::string>& short_names() const;  ///< without hyphens
    [[nodiscard]] const std::vector<std::string>& long_names() const;
    [[nodiscard]] const std::string& help() const;
    [[nodiscard]] std::string heading() const;  ///< empty: none of its own
    [[nodiscard]] std::string type() const;     ///< with what it is checked against: `TEXT:{none,csv}`
    [[nodiscard]] bool is_argument() const;
    [[nodiscard]] bool is_required() const;
    [[nodiscard]] bool takes_value() const;
    [[nodiscard]] bool takes_several() const;                     ///< where it stands
    [[nodiscard]] const std::vector<std::string>& words() const;  ///< as they were given

    /// As if these words had been given.
    void replace(const std::vector<std::string>& words) const;

private:
    CLI::Option* option_;
};

/// A command line, and what it does: the text of a help.
struct Example {
    std::string line, does;
};

/// A command, the program, or a group of options. A copy is the same command.
class Command {
public:
    /// T: std::string, its vector, double, int, std::optional<int>, std::size_t. An option takes one value where it
    /// stands, and of a vector it may be repeated; an argument takes all that follow.
    template <class T>
    Option add(const std::string& names, T& into, const std::string& help, const ValueRule& check = {}) const;
    Option add(const std::string& names, bool& into, const std::string& help) const;  ///< takes no value
    /// An option that may be repeated and takes several values between commas: `-f f32 -f f64` is `-f f32,f64`. The
    /// check is of each.
    Option add_list(const std::string& names, std::vector<std::string>& into, const std::string& help,
                    const ValueRule& check = {}) const;
    /// `--set`: assignments, repeated or between commas.
    Option add_set(std::vector<std::string>& into, const std::string& help) const;
    /// An option whose value is one of these names, the first by default; `take` gets its place among them.
    Option add_named(const std::string& option, const std::vector<std::string>& names,
                     const std::function<void(int)>& take, const std::string& help) const;

    /// A command of its own, of which one must be given from then on.
    Command add_command(const std::string& name, const std::string& help) const;
    /// Options of which at most one can be given.
    Command add_group(const std::string& name, const std::string& help) const;
    /// For once the words are read: which of these options each of their values was given to, as places in the list,
    /// in the order in which they were given.
    [[nodiscard]] std::function<std::vector<std::size_t>()> order_of(const std::vector<Option>& options) const;

    /// Shown by the help: a command line each, and what it does.
    void shows(const std::vector<Example>& examples) const;
    /// Shown nowhere: a command that the program starts by itself.
    void hide() const;

    /// What is done where this command is given.
    void runs(const std::function<Exit()>& run) const;

    [[nodiscard]] const std::string& name() const;  ///< empty: a group
    [[nodiscard]] std::string help() const;
    [[nodiscard]] std::vector<Example> examples() const;
    [[nodiscard]] bool is_hidden() const;
    [[nodiscard]] std::vector<Option> options() const;                           ///< without those of groups
    [[nodiscard]] Option option(const std::string& name) const;                  ///< false where there is none
    [[nodiscard]] std::vector<Command> commands() const { return inner(true); }  ///< its own
    [[nodiscard]] std::vector<Command> groups() const { return inner(false); }
    [[nodiscard]] std::vector<std::string> names_of_commands() const;  ///< without hidden ones
    [[nodiscard]] std::vector<Command> given() const;  ///< itself, the command of it that was given, and so on
    [[nodiscard]] std::string given_words() const;     ///< the names of these: `lostbits plugin check`

protected:
    Command(CLI::App* app, std::function<Exit()>* chosen) : app_(app), chosen_(chosen) {}
    CLI::App* app_;
    std::function<Exit()>* chosen_;  ///< of the program

private:
    [[nodiscard]] std::vector<Command> inner(bool named) const;
};

/// Words that are not understood, as the parser says it.
struct Misread : std::runtime_error {
    enum Kind { nothing_takes_it, missing, unread, wrong_count, said };
    Misread(Kind which, const std::string& text) : std::runtime_error(text), kind(which) {}
    Kind kind;  ///< `said`: the text is a sentence of ours
};

class CommandLine : public Command {
public:
    CommandLine(const std::string& name, const std::string& version, const std::string& help);
    ~CommandLine();

    enum class Parsed { command, help, version };
    /// Reads the words, the first of which is the program's own. The version is printed where they asked for it.
    /// Misread; what a check throws.
    [[nodiscard]] Parsed parse(const std::vector<std::string>& words);
    /// Does what was chosen.
    [[nodiscard]] Exit run() const { return run_(); }

    [[nodiscard]] std::vector<std::string> leftover() const;  ///< words that nothing takes

private:
    std::unique_ptr<CLI::App> parser_;
    std::function<Exit()> run_;
};

/// What is wrong, why, and what to try: a sentence for what the parser threw.
std::string describe_misread(const CommandLine& program, const Misread& error);

/// The message, with the line breaks that somebody typed into one of the words as `\n`: its own stay.
std::string with_words_on_one_line(const std::string& message, const std::vector<std::string>& words);

/// The path of a file, whether it is there or not. (Where none of its folders is, weakly_canonical alone leaves a
/// relative path as it is.)
[[nodiscard]] std::filesystem::path place_of(const std::string& file);

/// An option, and what it names; empty where it was not given.
struct NamedFile {
    const char* option;
    std::string file;
};

/// InputError where two options name one file, of which the later would overwrite the earlier, or one lies in `folder`,
/// among whose files it may come to be.
void require_different_files(const std::vector<NamedFile>& files, const NamedFile& folder);

}  // namespace lostbits::analysis::shell
