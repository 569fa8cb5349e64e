// What was typed, names by globs, and the ends of a colour bar.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/selection/scenes.hpp"
#include "analysis/shell/command_line.hpp"
#include "output/map/map_colour.hpp"

namespace lostbits::analysis::selection {

/// Whether a name is, or fits, one of the patterns (fnmatch).
bool matches_any(const std::vector<std::string>& patterns, const std::string& name);

/// Options of the commands that ask forms about scenes.
struct SharedOptions {
    SceneChoice scenes = {};
    std::vector<std::string> forms = {}, formats = {};
    std::string pixels = "none", pictures = "sheets", out = {};
};
/// SCENE; `kinds` says which scenes, where that is not any.
void add_scenes(const shell::Command& command, SharedOptions& shared, const std::string& kinds = "");
/// -i, with what stands in its place in words.
void add_forms(const shell::Command& command, std::vector<std::string>& forms, const std::string& usual = "all");
/// -f, with the same.
void add_formats(const shell::Command& command, std::vector<std::string>& formats, const std::string& usual);
/// --pixels csv.
void add_pixels(const shell::Command& command, SharedOptions& shared);
/// --pictures all: what a contact sheet shows is drawn alone only where that is asked for.
void add_pictures(const shell::Command& command, std::string& pictures);
/// -o, by default out/COMMAND.
void add_out(const shell::Command& command, std::string& out, const std::string& what = "the results");
/// --size, --variant and --set of a command that takes scenes; `example` is an assignment for the help.
void add_changes(const shell::Command& command, SceneChoice& scenes, const std::string& example);

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
Typed typed(const shell::Command& program);

/// Arguments that begin with `data/`, as those of the documents do, where nothing here is called so and in the data
/// folder (`data` is `--data`) something is: replaced by that. `*`, `?` and `[…]` stand for characters, as in a shell.
void find_in_data(const shell::Command& command, const std::string& data);

/// `LO:HI`, in the unit of the metrics that are drawn; nothing where the text is empty. InputError for what is not a
/// range, where the metrics have several units or no bar, and for an end that a logarithm cannot have.
std::optional<output::map::BarRange> parse_range(const std::string& text,
                                                 const std::vector<const measure::metric::Metric*>& drawn);

/// The words of a command as `shell_word` wrote them.
std::vector<std::string> words_in(const std::string& command);

}  // namespace lostbits::analysis::selection
