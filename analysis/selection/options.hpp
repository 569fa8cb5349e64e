// Options that commands share, the command as it was typed, names by patterns, and the ends of a colour bar.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/selection/scenes.hpp"
#include "analysis/shell/command_line.hpp"
#include "output/map/map_colour.hpp"

namespace lostbits::analysis::selection {

/// True if a name matches one of the patterns (fnmatch).
bool matches_any(const std::vector<std::string>& patterns, const std::string& name);

/// The options of the commands that test forms on scenes.
struct SharedOptions {
    SceneOptions scenes = {};
    std::vector<std::string> forms = {}, formats = {};
    std::string pixels = "none", pictures = "sheets", out = {};
};
/// Adds SCENE; `kinds` says in the help which scenes it takes, if not all.
void add_scenes(const shell::Command& command, SharedOptions& shared, const std::string& kinds = "");
/// Adds -i; `default_text` is the text of the help for the default.
void add_forms(const shell::Command& command, std::vector<std::string>& forms, const std::string& default_text = "all");
/// Adds -f; `default_text` is the text of the help for the default.
void add_formats(const shell::Command& command, std::vector<std::string>& formats, const std::string& default_text);
/// Adds --pixels.
void add_pixels(const shell::Command& command, SharedOptions& shared);
/// Adds --pictures. Only `--pictures all` also draws each picture of a contact sheet as its own file.
void add_pictures(const shell::Command& command, std::string& pictures);
/// Adds -o, by default out/COMMAND. `contents` says in the help what the folder is for.
void add_out(const shell::Command& command, std::string& out, const std::string& contents = "the results");
/// Adds --size, --variant and --set for a command that takes scenes; `example` is an assignment for the help.
void add_changes(const shell::Command& command, SceneOptions& scenes, const std::string& example);

/// The command that was typed, quoted for a shell: the arguments, and the options in the order of the help. Options
/// that change no result are left out: the folder, the number of threads, what is printed.
struct TypedCommand {
    std::string command_name;  ///< `lostbits map`
    std::string subjects;      ///< ` two_step`, with the blank in front; empty if the command line names no subject
    std::string options;       ///< ` -f f32 --size 64x64`

    [[nodiscard]] std::string text() const { return command_name + subjects + options; }
    /// The subjects without the blank in front.
    [[nodiscard]] std::string all_subjects() const { return subjects.empty() ? "" : subjects.substr(1); }
    /// The command for one of the subjects, quoted for a shell.
    [[nodiscard]] std::string for_subject(const std::string& subject) const {
        return command_name + (subject.empty() ? "" : " ") + subject + options;
    }
};
TypedCommand typed_command(const shell::Command& program);

/// Finds arguments that begin with `data/`, as in the documentation, in the data folder (`data` is `--data`) if they do
/// not exist here, and replaces them. `*`, `?` and `[…]` stand for characters, as in a shell.
void find_in_data(const shell::Command& command, const std::string& data);

/// Parses `LO:HI`, in the unit of the drawn metrics; nothing for an empty text. Throws InputError for a text that is
/// not a range, for metrics with different units or without a colour bar, and for an end of at most 0 on a logarithmic
/// bar.
std::optional<output::map::BarRange> parse_range(const std::string& text,
                                                 const std::vector<const measure::metric::Metric*>& drawn_metrics);

/// Splits a command whose words were quoted by `shell_word` into these words, without the quotes.
std::vector<std::string> split_shell_words(const std::string& command);

}  // namespace lostbits::analysis::selection
