// The subcommands: each adds itself to the program and runs when it is chosen.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis/selection/doors.hpp"
#include "analysis/selection/options.hpp"
#include "analysis/shard/division.hpp"
#include "analysis/shell/command_line.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/evaluate/needed.hpp"
#include "measure/truth/truth_columns.hpp"
#include "number/error.hpp"
#include "output/file/progress.hpp"
#include "output/file/result_folder.hpp"

namespace lostbits::analysis {

/// Options of every command.
struct Common {
    std::string data;  ///< the data folder, see `data_folder`
    output::file::Progress::Mode progress = output::file::Progress::Mode::automatic;
    bool quiet = false;
    bool verbose = false;
    int threads = 0;  ///< 0: one per core
    std::string isa;  ///< a name of `isa_names`; empty: the best that the processor has
    selection::DoorWords doors;
    intersect::process::StopToken stop = {};     ///< of what the command asks for
    selection::Typed typed;                      ///< the command itself
    bool force = false;                          ///< folders that hold results of someone else are written to as well
    std::shared_ptr<shard::Shards> joined = {};  ///< shards of the command, done; null: it is to be done
};

inline constexpr const char* program_and_version = "lostbits " LOSTBITS_VERSION;

/// Each adds a command to the program, which keeps a reference to the options of every command.
using AddCommand = void(const shell::Command& program, const Common& common);
AddCommand add_check, add_choose, add_consistency, add_devices, add_diff, add_explain, add_judge, add_list, add_map,
    add_mend, add_offsets, add_plugin, add_render, add_report, add_shader, add_sweep, add_trade;

/// The examples in the help of each command; once all commands are there.
void add_examples(const shell::Command& program);

/// Standard output, for a command that answers a pipe; what else is printed goes to standard error from then on.
/// EnvironmentError, which begins with `command`.
int take_standard_output(const std::string& command);

// What the commands that write a folder of results have in common (results.cpp).

/// InputError where -o names no folder.
void require_folder(const std::string& out);

/// The folder is this run's from now on: see `ResultFolder`, whose rule `force` is that of the command line. `subject`
/// is what the command is about, in words of a shell.
[[nodiscard]] std::unique_ptr<output::file::ResultFolder> own_folder(const std::filesystem::path& folder,
                                                                     const Common& common, const std::string& subject,
                                                                     output::file::ResultFolder::Rules rules = {});

/// The results in the folder are whole; nothing where there is none. See `ResultFolder::complete`.
void complete(const std::unique_ptr<output::file::ResultFolder>& folder);

/// A folder in `out` for each scene, in which summary.csv can be written: this run's own until the work on its scene is
/// done. Its files are whole then, whatever becomes of the run.
class SceneFolders {
public:
    SceneFolders(const std::vector<scene::file::Scene>& scenes, const std::string& out, const Common& common);

    /// To be called once the files of a scene are whole, and before anything is printed about them.
    using Complete = std::function<void()>;
    /// `work` on each of so many scenes, by their number, one after the other; the sum of what it returns, rays
    /// without a proved truth. Of a run that is asked to stop, says what is kept.
    [[nodiscard]] std::uint64_t each(std::size_t scenes, output::file::Progress& progress,
                                     const std::function<std::uint64_t(std::size_t, const Complete&)>& work);

private:
    std::vector<std::unique_ptr<output::file::ResultFolder>> folders_ = {};  ///< none in a shard
};

/// The scenes of a command of solids, and of the rows those that can be asked about any of them. InputError for rays
/// that a scene makes, or a form; `name` is the command.
[[nodiscard]] std::vector<scene::file::Scene> scenes_of_solids(const selection::SharedOptions& shared,
                                                               std::vector<measure::evaluate::TestedForm>& rows,
                                                               const char* name, const Common& common);

/// `--shard` of a command.
void add_shard(const shell::Command& command, std::string& word);

/// Of these files and of the libraries: what decides what a run measures.
[[nodiscard]] std::uint64_t hash_of_inputs(const std::vector<std::filesystem::path>& files, const Common& common);

/// Where a run's shard, if it is one, keeps what it found, and what belongs to it while it lives.
struct Divided {
    shard::Division division;
    std::unique_ptr<output::file::ResultFolder> folder = {};  ///< of a shard
    std::filesystem::path out;                                ///< of the results: a shard's own folder
};

/// How a run is divided, by the word of its `--shard`; `out` is the folder of its results and `files` are those that
/// decide what it measures. InputError for a bad word, and where shards that are to be joined read other files.
[[nodiscard]] Divided divide(const std::string& word, const std::string& out,
                             const std::vector<std::filesystem::path>& files, const Common& common,
                             bool resumed = false);

/// The end of such a run: a shard's file gets its name, which is printed.
void finish(Divided& divided, const Common& common);

/// EnvironmentError where this file could not be written. A folder that cannot be written ends the run before the first
/// ray, not after the tenth scene.
void probe(const std::filesystem::path& file);

/// Moves a bar on, and with it an estimate of how long the run takes.
[[nodiscard]] std::function<void(std::uint64_t)> advancing(output::file::Progress& progress,
                                                           output::file::Estimate* estimate = nullptr);

/// `before` and `after` around each of the values: ` -f f32 -f f64`.
[[nodiscard]] std::string each(const char* before, const std::vector<std::string>& values, const char* after = "");

/// The share of the hits that `--at` names: p50, p99 or max. InputError.
[[nodiscard]] double quantile_at(const std::string& text);

/// The end of a run in which the truth of so many rays was not proved: says so on stderr.
[[nodiscard]] Exit end_with_unproved(std::uint64_t rays);

/// A line on stderr for each row from outside whose contract seems to be wrong; `suspicion` of a row is empty where it
/// does not.
void note_suspicions(const std::vector<measure::evaluate::TestedForm>& rows, const Common& common,
                     const std::function<std::string(const measure::evaluate::TestedForm&)>& suspicion);

/// A line on stdout for each row that is held against a form: how often the two are the same.
void print_pairs(const std::vector<measure::evaluate::TestedForm>& rows,
                 const std::vector<const measure::metric::Metric*>& metrics,
                 const std::vector<measure::evaluate::FormSummary>& summaries);

/// A quantile of metric `lost` for a table: `13.57`; `-` where there is none, or where the agreed hits are too few to
/// stand for the form.
[[nodiscard]] std::string lost_or_withheld(const measure::evaluate::FormSummary& summary, std::size_t lost, double q);

/// A table on stdout: a line for each row of a map, and for each form of the bits needed.
void print_table(const measure::evaluate::EvaluationRequest& request,
                 const std::vector<measure::evaluate::FormSummary>& summaries);
void print_table(const measure::evaluate::NeededRequest& request,
                 const std::vector<measure::evaluate::NeededSummary>& summaries);

/// A line on stdout: how many truths, each of a ray and a solid, each stage settled.
void print_stages(const measure::truth::StageCounts& stages);

}  // namespace lostbits::analysis
