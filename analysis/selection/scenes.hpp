// The scenes of a command, the folders that they and what forms are compiled with lie in, and what can be timed on one.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "analysis/selection/judge_words.hpp"
#include "analysis/selection/sets.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/choice/file_rays.hpp"
#include "number/format.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::analysis::selection {

/// Scenes as the command line names them, and what it changes about them.
struct SceneChoice {
    std::vector<std::string> names;  ///< files, or ids of scenes or of variants
    std::string size, variant;       ///< empty: the scene's own, all
    std::vector<std::string> set;
    intersect::process::StopToken stop = {};
    bool all_ahead = false;  ///< of a command that knows no range: a scene whose rays have one is refused
};

/// Every scene chosen. InputError for a scene given twice: results lie in a folder of its name.
std::vector<scene::file::Scene> load_scenes(const SceneChoice& choice, const std::filesystem::path& data);

/// What names a scene to a later command: its id where it lies in the data folder, its path and variant otherwise; as
/// a shell reads it.
std::string name_of_scene(const scene::file::Scene& scene, const std::filesystem::path& data);
/// The same of a sweep.
std::string name_of_sweep(const std::filesystem::path& path, const std::filesystem::path& data);
/// The same as a claim names them: a variant of a file of one's own is `mine.toml.VARIANT`.
std::string scene_in_claims(const scene::file::Scene& scene, const std::filesystem::path& data);
std::string sweep_in_claims(const std::filesystem::path& path, const std::filesystem::path& data);

/// The data folder: `--data`, then $LOSTBITS_DATA, then ./data, then the one of the program: beside it, of the tree it
/// was built in, or installed.
std::filesystem::path data_folder(const std::string& given);

/// Where the flags lie that forms are compiled with, `form.flags` and one a register width: in the build that this
/// program is of, or beside the installed one.
std::filesystem::path form_flags_folder();

/// Whether a format is computed by software here, so that its time says nothing.
[[nodiscard]] bool is_emulated(const Format& format);

/// The one scene that is named. InputError where its file has several variants and none is named.
scene::file::Scene load_one_scene(const SceneChoice& choice, const std::filesystem::path& data);

/// Those of the rows whose time on the scene means something: its solids' forms, or sets of them (`rows_meeting`), but
/// no marches. NothingSelected where that leaves none.
std::vector<measure::evaluate::TestedForm> timed_on(const scene::file::Scene& scene, const ChosenRows& chosen);
/// The same of anything with solids, which is called `id`.
std::vector<measure::evaluate::TestedForm> timed_on(const std::string& id, const ChosenRows& chosen,
                                                    const Meets& meets);

/// Files of rays are told by their ending, or by a word that only they take.
bool are_files(const RayFileWords& words, const std::vector<std::string>& subjects);

/// InputError for an option of files beside a scene, for one of scenes, each with whether it was given, beside files,
/// and for several scenes. `command` is what they are for: `a choice`.
void refuse_others(const RayFileWords& words, const std::vector<std::string>& subjects,
                   const std::vector<std::pair<const char*, bool>>& of_scenes, const char* command);

/// Files of rays as one, ready to be read.
struct OpenedRays {
    std::string id, words;  ///< what results are called, and the files in words of a shell
    std::unique_ptr<scene::dump::Dump> dump;
    measure::choice::FileTerms terms;
    Shapes shapes;  ///< of what the rays are aimed at
};
OpenedRays open_rays(const RayFileWords& words, const std::vector<std::string>& files,
                     const std::filesystem::path& data);

/// Says on stderr that so many numbers of files were rounded to the format.
void note_rounded(const std::string& files, std::uint64_t numbers, const Format& format);

}  // namespace lostbits::analysis::selection
