// The options of the program as a table, what the parser itself was told, and what is made of it: scripts that complete
// its words, and its manual page.
#pragma once

#include <string>
#include <vector>

#include "analysis/shell/command_line.hpp"

namespace lostbits::analysis::shell {

/// What can stand for a value.
struct Values {
    enum class Kind { anything, words, names, files, folders };
    Kind kind = Kind::anything;
    std::vector<std::string> words;  ///< these; of `names` what `lostbits list` lists: `forms`
};

struct OptionRow {
    std::vector<std::string> names;  ///< `-i`, `--intersector`; of an argument its one name: SCENE
    std::string help;
    std::string heading;  ///< under which the help shows it with others; empty: none of its own
    std::string value;    ///< how its value is written: `auto|bar|none`, `1..1024`, FILE; empty: it takes none
    bool takes_value = false;
    bool several = false;  ///< between commas, or one argument after another
    bool required = false;
    Values values;
};

struct CommandRow {
    std::string name, help;
    std::vector<Example> examples;
    std::vector<OptionRow> options, arguments;  ///< of its own commands, too
    std::vector<CommandRow> commands;           ///< of its own: `plugin check`

    [[nodiscard]] std::vector<std::string> names_of_commands() const;
};

/// Those of every command.
std::vector<OptionRow> common_options(const Command& program);
/// Those of a program, or of a command that has some; its own hidden ones where they are asked for.
std::vector<CommandRow> command_table(const Command& program, bool hidden_too = false);

/// What `--help` prints: of the command that was given, or of the program. `footer` stands below that of the program.
std::string help_page(const Command& program, const std::string& footer);

/// For bash, zsh and fish. Names of forms, scenes and so on are asked of the program when they are needed, so those of
/// one's own data are there too.
std::string bash_completion(const Command& program);
std::string zsh_completion(const Command& program);
std::string fish_completion(const Command& program);

/// The manual page, in the macros of man(7): the words of `--help`, all commands on one page, and `footer`.
std::string manual_page(const Command& program, const std::string& version, const std::string& footer);

}  // namespace lostbits::analysis::shell
