// The scenes and files of rays of a command, the folders of data and of compiler flags, and the forms that can
// be timed on a scene.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "analysis/selection/ray_file_options.hpp"
#include "analysis/selection/sets.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/choose/file_rays.hpp"
#include "number/format.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::analysis::selection {

/// The options of the command line that name scenes and change them.
struct SceneOptions {
    std::vector<std::string> names;  ///< files, or ids of scenes or of variants
    std::string size, variant;       ///< empty: the scene's own size, all variants
    std::vector<std::string> set;    ///< assignments of --set
    intersect::process::StopToken stop = {};
    /// For a command whose rays go from t = 0 to infinity: scenes whose rays have a range are refused.
    bool refuses_ranges = false;
};

/// Loads the scenes. Throws InputError if a scene is given twice, since its results go to a folder with its name.
std::vector<scene::file::Scene> load_scenes(const SceneOptions& options, const std::filesystem::path& data);

/// Arguments that name a scene in later commands, quoted for a shell: its id if it is in the data folder, else its path
/// and variant.
std::string scene_arguments(const scene::file::Scene& scene, const std::filesystem::path& data);
/// Argument that names a sweep in later commands, quoted for a shell.
std::string sweep_argument(const std::filesystem::path& path, const std::filesystem::path& data);
/// The name of a scene in claims: its id if it is in the data folder, else its path, and `.VARIANT` for a variant.
std::string scene_name_in_claims(const scene::file::Scene& scene, const std::filesystem::path& data);
/// The name of a sweep in claims: its name if it is in the data folder, else its path.
std::string sweep_name_in_claims(const std::filesystem::path& path, const std::filesystem::path& data);

/// The data folder: `--data` or $LOSTBITS_DATA if given, else the first that exists of ./data and the data folder of
/// the program (beside it, in its build tree, or installed with it).
std::filesystem::path data_folder(const std::string& data_option);

/// The folder of the compiler flags for forms: `form.flags` and one file per register width. It is the build folder of
/// this program, or the library folder of an installed one.
std::filesystem::path form_flags_folder();

/// Loads one scene. Throws InputError if its file has several variants and none is named.
scene::file::Scene load_one_scene(const SceneOptions& options, const std::filesystem::path& data);

/// The tested forms that can be timed on the scene: forms for its primitives, or sets of such forms
/// (`tested_forms_handling`), but no forms that march. Throws NothingSelected if no tested form is left.
std::vector<measure::evaluate::TestedForm> select_timed_forms(const scene::file::Scene& scene,
                                                              const SelectedForms& chosen);
/// The same for any subject with primitives; `id` is its name in messages.
std::vector<measure::evaluate::TestedForm> select_timed_forms(const std::string& id, const SelectedForms& chosen,
                                                              const ShapePredicate& can_test);

/// True if the subjects are files of rays: by their extension, or because --container or --columns is given.
bool are_ray_files(const RayFileOptions& options, const std::vector<std::string>& subjects);

/// Throws InputError for an option of files with a scene, for an option of scenes with files, and for several scenes.
/// `scene_options` has the options of scenes, each with true if it was given. `command` names the work in
/// messages, such as `a choice`.
void require_no_misplaced_options(const RayFileOptions& options, const std::vector<std::string>& subjects,
                                  const std::vector<std::pair<const char*, bool>>& scene_options, const char* command);

/// Several files of rays as one, ready to be read.
struct OpenedRays {
    std::string id, quoted_files;  ///< name of the results, and the names of the files, quoted for a shell
    std::unique_ptr<scene::ray_file::RayFile> ray_file;
    measure::choose::FileOptions options;  ///< what the command line says of the files
    Shapes shapes;                         ///< of the primitives of the rays
};
OpenedRays open_rays(const RayFileOptions& options, const std::vector<std::string>& files,
                     const std::filesystem::path& data);

/// Warns on stderr that `count` values of files were rounded to the format. Prints nothing if `count` is 0.
void warn_of_rounded_values(const std::string& files, std::uint64_t count, const Format& format);

}  // namespace lostbits::analysis::selection
