// Options of several values, and what was typed.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace lostbits::analysis::choice {

/// The items of a list between commas, without the blanks around them. InputError, of the `option`, for an empty one.
std::vector<std::string> items_in(const std::string& word, const std::string& option);

/// Whether a name is, or fits, one of the patterns (fnmatch).
bool matches_any(const std::vector<std::string>& patterns, const std::string& name);

/// An option that may be repeated and takes several values between commas: `-f f32 -f f64` is `-f f32,f64`. The word
/// after its value is never its own: that is the scene.
CLI::Option* add_list(CLI::App& command, const std::string& names, std::vector<std::string>& into,
                      const std::string& help);

/// Whether an option was added so.
bool is_list(const CLI::Option& option);
/// Of such an option: every item is one of these.
CLI::Validator each_of(const std::string& option, const std::vector<std::string>& known);

/// A number from low to high, both included. Unlike `CLI::Range`, whose comparisons NaN passes, it refuses NaN.
CLI::Validator number_from(double low, double high);

/// `--set`: assignments, repeated or between commas; a comma inside brackets belongs to the value.
CLI::Option* add_set(CLI::App& command, std::vector<std::string>& into, const std::string& help);

/// The assignments of a word: `a=1,b=[2,3]` are two.
std::vector<std::string> assignments_in(const std::string& word);

/// Every option of the program and of its commands takes one value where it stands.
void one_value_each(CLI::App& program);

/// The command that was typed, as a shell reads it: the arguments, and the options in the order of their help. Without
/// what changes no result: where it goes, how many threads, what is printed.
struct Typed {
    std::string before;    ///< `lostbits map`
    std::string subjects;  ///< ` two_step`, with the blank in front; empty where there are none
    std::string after;     ///< ` -f f32 --size 64x64`

    [[nodiscard]] std::string text() const { return before + subjects + after; }
    /// Without the blank in front.
    [[nodiscard]] std::string all_subjects() const { return subjects.empty() ? "" : subjects.substr(1); }
    /// The same for one of the subjects, in words of a shell.
    [[nodiscard]] std::string of(const std::string& subject) const {
        return before + (subject.empty() ? "" : " ") + subject + after;
    }
};
Typed typed(const CLI::App& program);

/// The words of a command as `shell_word` wrote them.
std::vector<std::string> words_in(const std::string& command);

}  // namespace lostbits::analysis::choice
