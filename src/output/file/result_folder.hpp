// Folders of results. A folder belongs to the run that writes it, and the run leaves a manifest of its results there.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lostbits::output::file {

/// The run that made a file. Files that can hold metadata contain it.
struct Provenance {
    std::string command;  ///< the command that makes the file again
    std::string program;  ///< `lostbits 0.1.0`
    /// Name and description of every external intersector: its library, or its shader with the driver and how that
    /// rounds.
    std::vector<std::pair<std::string, std::string>> forms = {};
};

/// Options of a folder of results.
struct ResultFolderRules {
    /// Set by `--force`: the folder may hold results that no manifest lists. They stay and are not replaced.
    bool allows_unlisted = false;
    /// True if others keep files in the folder on purpose. Results that no manifest lists are then allowed. Results of
    /// other commands of this program stay, in the folder and in the manifest.
    bool is_shared = false;
    /// True if this run continues the earlier one. The files that the earlier run listed then stay.
    bool continues_run = false;
    /// True if a stopped run leaves its state, so that `--resume` can continue it.
    bool can_resume = false;
    std::vector<std::string> figures = {};  ///< kinds of pictures: png, svg, pdf; empty: png
};

/// A folder of results that this run owns for the lifetime of the object.
///
/// The object lists each file in `manifest.json` before the file gets its final name. Just before the first result it
/// removes the files that the manifest of an earlier run lists. A folder therefore never holds the results of two runs,
/// and a run that ends without results leaves the earlier results in place.
///
/// Files that no manifest lists belong to somebody else and stay. Half-written files of killed runs
/// (`.NAME.partial-…`) are removed at once; those of a run that is still writing stay.
///
/// From the first result to the last the folder holds `UNFINISHED.txt`, which says that the results are not complete. A
/// run that is killed, or that ends by an exception, leaves that file.
class ResultFolder {
public:
    using Rules = ResultFolderRules;
    /// The files of one run.
    struct ManifestRun {
        Provenance provenance;
        std::set<std::string> files;
    };

    /// Throws InputError if the folder holds results that no manifest lists, or if another run is writing to the
    /// folder; EnvironmentError if the folder cannot be made, or if results of an earlier run cannot be removed.
    ResultFolder(std::filesystem::path folder, Provenance provenance, Rules rules);
    /// Marks the results as complete, unless an exception is propagating. Removes the folder if this object made it and
    /// it is empty.
    ~ResultFolder();
    ResultFolder(const ResultFolder&) = delete;
    ResultFolder& operator=(const ResultFolder&) = delete;

    /// Marks the results as complete, whatever happens to the run afterwards. Call it before printing anything about
    /// the results, because a closed pipe (`| head`) ends the program there. Throws EnvironmentError if
    /// `UNFINISHED.txt` cannot be removed.
    void complete();

    /// The last run in the manifest of a folder; nothing if the folder has no manifest of this program.
    [[nodiscard]] static std::optional<Provenance> last_run(const std::filesystem::path& folder);

    /// A sentence that says that the results of a folder are not complete, and what to do; empty if they are complete.
    [[nodiscard]] static std::string unfinished_sentence(const std::filesystem::path& folder);

private:
    friend void note_result(const std::filesystem::path& path);
    friend void require_own_result(const std::filesystem::path& path);
    friend void remove_result(const std::filesystem::path& path);
    friend bool is_in_own_folder(const std::filesystem::path& path);
    friend std::optional<Provenance> provenance_of(const std::filesystem::path& path);
    friend std::vector<std::string> figure_kinds(const std::filesystem::path& path);
    static ResultFolder* owner_of(const std::filesystem::path& path, std::string& name);
    /// Creates the folder and notes which folders were missing. Messages name the path as it was given.
    void create_folder(const std::filesystem::path& given_path);
    /// Throws InputError if another run has locked the folder.
    void lock_folder(const std::filesystem::path& given_path);
    void require_no_unlisted_results() const;
    void require_own_manifest() const;
    void require_own_file(const std::string& name);
    void add_result(const std::string& name);
    void remove_entry(const std::string& name);
    void write_manifest();
    void begin_results();
    /// Writes `UNFINISHED.txt` and locks it.
    void create_marker();
    [[nodiscard]] int remove_marker() noexcept;
    void require_removable_results() const;
    void remove_earlier_results() const;

    std::filesystem::path folder_;  // absolute, normal
    Provenance provenance_;
    Rules rules_;
    std::vector<std::filesystem::path> created_folders_;  // folders that this object made, deepest first
    std::set<std::string> earlier_files_, files_;
    std::vector<ManifestRun> other_runs_;  // runs of other commands and their files, if the folder is shared
    std::mutex mutex_;
    bool has_begun_ = false;
    int lock_fd_ = -1, marker_fd_ = -1;
    int initial_exceptions_ = 0;  // number of exceptions that were propagating when the object was made
};

/// Name of the manifest that a run leaves in its folder: its files and the command that made them.
inline constexpr const char* manifest_name = "manifest.json";
/// The runs and files in the manifest of a folder, the last run first; nothing if the folder has no manifest of this
/// program.
[[nodiscard]] std::vector<ResultFolder::ManifestRun> manifest_runs(const std::filesystem::path& folder);
/// The text of a manifest.
[[nodiscard]] std::string manifest_text(const ResultFolder::ManifestRun& last_run,
                                        const std::vector<ResultFolder::ManifestRun>& others);

/// Adds a file to the manifest of its folder. AtomicFile calls this just before the file gets its final name.
void note_result(const std::filesystem::path& path);

/// Throws InputError if the path is in the folder of a run and the file there belongs to somebody else: no manifest
/// lists the file, or the file is a link or is reached through one. AtomicFile calls this before it opens a file.
void require_own_result(const std::filesystem::path& path);

/// Removes a file and its entry in the manifest. A run does this at its end with the state that `--resume` reads.
void remove_result(const std::filesystem::path& path);

/// True if the path is in a folder that a run of this process owns now.
[[nodiscard]] bool is_in_own_folder(const std::filesystem::path& path);

/// External intersectors as one text: a line `NAME: description` for each.
[[nodiscard]] std::string external_forms_text(const Provenance& provenance);

/// Adds the attributes `lostbits:command`, `lostbits:program` and `lostbits:forms` of the run that owns the folder of
/// `path`. Skips empty values, and names that `attributes` already has.
void add_provenance(const std::filesystem::path& path, std::vector<std::pair<std::string, std::string>>& attributes);

/// Kinds of pictures that the run that owns the folder of `path` writes, at least one: png unless `--figure` names
/// others. For a path that ends in .svg: svg alone.
[[nodiscard]] std::vector<std::string> figure_kinds(const std::filesystem::path& path);

/// The run that owns the folder of `path`; nothing if no run of this process does.
[[nodiscard]] std::optional<Provenance> provenance_of(const std::filesystem::path& path);

}  // namespace lostbits::output::file
