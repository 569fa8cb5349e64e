// A table of the program's options, read from the parser, and what is made from it: completion scripts for shells, and
// the manual page.
#pragma once

#include <string>
#include <vector>

#include "analysis/shell/command_line.hpp"

namespace lostbits::analysis::shell {

/// The values that an option or argument takes.
struct AllowedValues {
    enum class Kind { anything, words, names, files, folders };
    Kind kind = Kind::anything;
    std::vector<std::string> words;  ///< the values; for `names`, the lists of `lostbits list`: `forms`
};

struct OptionRow {
    std::vector<std::string> names;  ///< `-i`, `--form`; an argument has one: SCENE
    std::string help;
    std::string heading;  ///< under which the help shows it with others; empty: none of its own
    std::string value;    ///< how its value is written: `auto|bar|none`, `1..1024`, FILE; empty: it takes none
    bool takes_value = false;
    bool takes_several = false;  ///< it takes several values, between commas or one argument after another
    bool is_required = false;
    AllowedValues values;
};

struct CommandRow {
    std::string name, help;
    std::vector<Example> examples;
    std::vector<OptionRow> options, arguments;  ///< with those of its subcommands
    std::vector<CommandRow> commands;           ///< subcommands: `plugin check`

    [[nodiscard]] std::vector<std::string> command_names() const;
};

/// The headings of the options: the empty one, then the others in the order in which they first occur.
std::vector<std::string> headings_of(const std::vector<OptionRow>& options);

/// The options that every command takes.
std::vector<OptionRow> common_options(const Command& program);
/// The commands of the program, or the subcommands of a command; with hidden ones if `includes_hidden`.
std::vector<CommandRow> command_table(const Command& program, bool includes_hidden = false);

/// Text that `--help` prints for the command that was given, or for the program. `footer` is printed below the text of
/// the program.
std::string help_page(const Command& program, const std::string& footer);

/// Completion scripts for bash, zsh and fish. They ask the program for names of forms, scenes and so on when they need
/// them, so names in the user's own data are offered too.
std::string bash_completion(const Command& program);
std::string zsh_completion(const Command& program);
std::string fish_completion(const Command& program);

/// The manual page, in the macros of man(7): the help of all commands on one page, and `footer`.
std::string manual_page(const Command& program, const std::string& version, const std::string& footer);

}  // namespace lostbits::analysis::shell
