// The subcommands of the program, and functions that they share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/selection/external.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/selection/ray_file_options.hpp"
#include "analysis/shard/division.hpp"
#include "analysis/shell/command_line.hpp"
#include "analysis/shell/text_table.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/contract/suspect.hpp"
#include "measure/evaluate/bits_needed.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/truth/truth_columns.hpp"
#include "number/error.hpp"
#include "output/file/progress.hpp"
#include "output/file/result_folder.hpp"

namespace lostbits::analysis {

/// Options that every command takes.
struct CommonOptions {
    std::string data;  ///< the data folder, see `data_folder`
    output::file::Progress::Mode progress = output::file::Progress::Mode::automatic;
    bool quiet = false;
    bool verbose = false;
    int threads = 0;  ///< 0: one per core
    std::string isa;  ///< a name of `isa_names`; empty: the widest of the processor
    selection::ExternalOptions external;
    intersect::process::StopToken stop = {};             ///< stops the work of the command
    selection::TypedCommand typed_command;               ///< the command as it was typed
    bool force = false;                                  ///< also write to folders that have files of others
    std::vector<std::string> figures = {};               ///< kinds of pictures: png, svg, pdf; empty: png
    std::shared_ptr<shard::Shards> shards_to_join = {};  ///< finished shards of the command; null: do the work here
};

inline constexpr const char* program_and_version = "lostbits " LOSTBITS_VERSION;

/// Functions that add a command to the program. The command keeps a reference to `common`.
using AddCommand = void(const shell::Command& program, const CommonOptions& common);
AddCommand add_check, add_choose, add_devices, add_diff, add_explain, add_judge, add_list, add_map, add_mend,
    add_plugin, add_report, add_shader, add_sweep, add_trade;

struct NamedCommand {
    std::string name;
    AddCommand* add;
};
/// The commands of all studies, see analysis/study/studies.hpp.
std::vector<NamedCommand> study_commands();

/// Runs `judge` on a file of answers about the whole surface of a mesh: all hits of rays, numbers of crossings, or
/// points inside.
ExitStatus run_mesh_judge(const selection::JudgeOptions& options, const std::optional<scene::file::Scene>& scene,
                          scene::ray_file::RayFile& ray_file, const CommonOptions& common);

/// Adds the examples in the help of each command, once all commands are there.
void add_examples(const shell::Command& program);

/// Returns a descriptor of standard output for a command that answers a pipe. Everything else that is printed goes to
/// standard error from then on. Throws EnvironmentError, which begins with `command`.
int redirect_standard_output(const std::string& command);

// Shared by the commands that write a folder of results (results.cpp).

/// Throws InputError if the value of -o is empty.
void require_folder(const std::string& out);

/// Locks a folder for the results of this run, see `ResultFolder`. The rule `allows_unlisted` is set from `--force`.
/// `subject` is the part of the command line that names what is measured, quoted for a shell.
[[nodiscard]] std::unique_ptr<output::file::ResultFolder> lock_folder(const std::filesystem::path& folder,
                                                                      const CommonOptions& common,
                                                                      const std::string& subject,
                                                                      output::file::ResultFolder::Rules rules = {});

/// The division of a run, and its folders.
struct RunDivision {
    shard::Division division;
    std::unique_ptr<output::file::ResultFolder> folder = {};  ///< folder of a shard; null in other runs
    std::filesystem::path out;                                ///< folder of the results; in a shard, the shard's

    /// The path of a file or folder that a whole run writes; empty in a shard, which writes none.
    [[nodiscard]] std::filesystem::path path_to_write(const std::filesystem::path& path) const {
        return division.is_shard() ? std::filesystem::path() : path;
    }
};

/// Like `lock_folder(folder, …)` for a run that may be a shard. Returns null in a shard, which already has a folder.
[[nodiscard]] std::unique_ptr<output::file::ResultFolder> lock_folder(const RunDivision& run_division,
                                                                      const std::filesystem::path& folder,
                                                                      const CommonOptions& common,
                                                                      const std::string& subject,
                                                                      output::file::ResultFolder::Rules rules = {});

/// Prints the path of each file of a drawing.
void print_figure_paths(const std::filesystem::path& path);

/// Marks the results in the folder as complete, see `ResultFolder::complete`. Does nothing for null.
void complete_folder(const std::unique_ptr<output::file::ResultFolder>& folder);

/// Locks a folder in `out` for each scene, and checks that summary.csv can be written there. A folder belongs to this
/// run until the work on its scene is done; its files are then complete, even if the run fails later.
class SceneFolders {
public:
    /// The folders of the scenes in the results of `run_division`.
    SceneFolders(const std::vector<scene::file::Scene>& scenes, const RunDivision& run_division,
                 const CommonOptions& common);

    /// Called when the files of a scene are complete, before anything is printed about them.
    using CompleteCallback = std::function<void()>;
    /// Calls `work` for each of the scenes in turn, by index. Returns the sum of its results: the number of rays
    /// without a proved truth. The error of an interrupted run says which results are kept.
    [[nodiscard]] std::uint64_t for_each(
        std::size_t scene_count, output::file::Progress& progress,
        const std::function<std::uint64_t(std::size_t, const CompleteCallback&)>& work);

private:
    std::vector<std::unique_ptr<output::file::ResultFolder>> folders_ = {};  ///< none in a shard
};

/// Loads the scenes of a command that tests primitives one by one. Adds the forms that the scenes need to
/// `tested_forms`, and prints which scenes and forms are left out. `command` is the name of the command. Throws
/// InputError if a scene or a form makes its rays anew in each format (a ray generator), and whatever `require_scene`
/// throws for a scene.
[[nodiscard]] std::vector<scene::file::Scene> load_primitive_scenes(
    const selection::SharedOptions& shared, std::vector<measure::evaluate::TestedForm>& tested_forms,
    const char* command, const CommonOptions& common, void (*require_scene)(const scene::file::Scene&));

/// Adds `--shard` to a command.
void add_shard(const shell::Command& command, std::string& shard_value);

/// Hashes these files and the libraries, which decide what a run measures.
[[nodiscard]] std::uint64_t hash_inputs(const std::vector<std::filesystem::path>& files, const CommonOptions& common);

/// Divides a run by the value of its `--shard`. `out` is the folder of its results; `files` are the files that decide
/// what it measures. Throws InputError for a bad value, and if the shards to join read other files.
[[nodiscard]] RunDivision divide_run(const std::string& shard_value, const std::string& out,
                                     const std::vector<std::filesystem::path>& files, const CommonOptions& common,
                                     bool is_resumed = false);

/// Ends a divided run. Gives the file of a shard its final name and prints the name. Returns false for a shard, which
/// has only a part of the results.
bool finish_run(RunDivision& run_division, const CommonOptions& common);

/// Throws EnvironmentError if the file cannot be written, so that a run fails before its first ray and not after the
/// tenth scene.
void require_writable(const std::filesystem::path& file);

/// Returns a function that advances a progress bar and an estimate of the time that the run takes.
[[nodiscard]] std::function<void(std::uint64_t)> advance_callback(output::file::Progress& progress,
                                                                  output::file::Estimate* estimate = nullptr);

/// Joins the values, each with `prefix` in front of it and `suffix` behind it: ` -f f32 -f f64`.
[[nodiscard]] std::string concatenate(const char* prefix, const std::vector<std::string>& values,
                                      const char* suffix = "");

/// Parses the value of `--at`, a fraction of the hits: p50, p99 or max. Throws InputError.
[[nodiscard]] double parse_quantile(const std::string& text);

/// Returns the exit status of a run in which the truth of `rays` rays was not proved within `bits` bits, and prints a
/// message about these rays on stderr.
[[nodiscard]] ExitStatus report_unproved(std::uint64_t ray_count, int bits = measure::truth::ProofLimit{}.max_bits);

/// Prints a line on stderr for each tested form of an external intersector whose contract seems to be wrong.
/// `suspicion` returns the text for a tested form, empty if nothing seems wrong.
void note_suspicions(const std::vector<measure::evaluate::TestedForm>& tested_forms, const CommonOptions& common,
                     const std::function<std::string(const measure::evaluate::TestedForm&)>& suspicion);

/// Prints a line on stdout for each tested form that is compared with another form: how often the two agree.
void print_comparisons(const std::vector<measure::evaluate::TestedForm>& tested_forms,
                       const std::vector<const measure::metric::Metric*>& metrics,
                       const std::vector<measure::evaluate::FormSummary>& summaries);

/// A quantile of the metric `lost_bits` for a table, `13.57`; `-` if the form has no correct hit, or if the correct
/// hits are too few to represent the form.
[[nodiscard]] std::string lost_bits_cell(const measure::evaluate::FormSummary& summary, std::size_t lost_bits,
                                         double quantile);

/// Adds columns to a table on stdout for the outcomes that only meshes have.
void add_mesh_columns(std::vector<shell::TextColumn>& columns);
/// Adds the cells of a summary in these columns. In the answers of a file, cracks and double hits cannot be recognised.
void add_mesh_cells(std::vector<std::string>& cells, const measure::evaluate::FormSummary& summary,
                    measure::contract::AnswerSource source);
/// Adds columns to a table on stdout for the wrong decisions, and the cells of a summary in these columns.
void add_wrong_columns(std::vector<shell::TextColumn>& columns);
void add_wrong_cells(std::vector<std::string>& cells, const measure::evaluate::FormSummary& summary);

/// Prints a table on stdout, with a line per tested form of a map, or per form for the bits needed.
void print_table(const measure::evaluate::MapStudy& study,
                 const std::vector<measure::evaluate::FormSummary>& summaries);
void print_table(const measure::evaluate::BitsNeededStudy& study,
                 const std::vector<measure::evaluate::BitsNeededSummary>& summaries);

/// Prints a line on stdout with the number of truths that each stage settled. Each truth is about one ray and one
/// primitive.
void print_stages(const measure::truth::StageCounts& stages);

}  // namespace lostbits::analysis
