// Folders of results. A folder belongs to the run that writes it, and the run leaves a list of its results there.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lostbits::output::file {

/// The run that made a file. Files that can hold it have it as metadata.
struct Provenance {
    std::string command;  ///< the command that makes the file again
    std::string program;  ///< `lostbits 0.1.0`
    /// Name and description of every external intersector: its library, or its shader with the driver and how that
    /// rounds.
    std::vector<std::pair<std::string, std::string>> forms = {};
};

/// Options of a folder of results.
struct ResultFolderRules {
    bool force = false;  ///< results that no list names are allowed there; they stay and are not replaced
    /// Others keep files there on purpose. Results that no list names are allowed. Results of other commands of this
    /// program stay, and stay on the list.
    bool shared = false;
    bool keep = false;                      ///< files that the earlier run listed stay: this run continues it
    bool resumes = false;                   ///< a stopped run leaves its state, and `--resume` continues from it
    std::vector<std::string> figures = {};  ///< kinds of pictures: png, svg, pdf; empty: png
};

/// A folder of results that this run owns for the lifetime of the object.
///
/// Every file is listed in `manifest.json` before it gets its final name in the folder. Just before the first result,
/// the files on the list of an earlier run are removed. So a folder never holds the results of two runs, and a run that
/// ends without results leaves the earlier ones. Files that no list names belong to somebody else and stay.
/// Half-written files of killed runs (`.NAME.partial-…`) are removed at once, unless their run is alive. From the first
/// result to the last the folder holds `UNFINISHED.txt`, which says that it is not finished; a run that is killed or
/// ends by an exception leaves that file.
class ResultFolder {
public:
    using Rules = ResultFolderRules;
    /// The files of one run.
    struct ManifestRun {
        Provenance by;
        std::set<std::string> files;
    };

    /// Throws InputError if the folder holds results that no list names, or if another run is writing to it;
    /// EnvironmentError if the folder cannot be made, or if results of an earlier run cannot be removed.
    ResultFolder(std::filesystem::path folder, Provenance made_by, Rules rules);
    /// Marks the results as complete, unless an exception is propagating. Removes the folder if this object made it and
    /// it is empty.
    ~ResultFolder();
    ResultFolder(const ResultFolder&) = delete;
    ResultFolder& operator=(const ResultFolder&) = delete;

    /// Marks the results as complete, whatever happens to the run afterwards. Call it before printing anything about
    /// the results, because a closed pipe (`| head`) ends the program there. EnvironmentError if the file that says
    /// that the folder is not finished cannot be removed.
    void complete();

    /// The run that made the folder, by its list; nothing if there is no list or it is not one of ours.
    [[nodiscard]] static std::optional<Provenance> last_run_in(const std::filesystem::path& folder);

    /// A sentence that says that the results of a folder are not complete, and what to do; empty if they are complete.
    [[nodiscard]] static std::string unfinished_in(const std::filesystem::path& folder);

private:
    friend void note_result(const std::filesystem::path& path);
    friend void require_own(const std::filesystem::path& path);
    friend void forget_result(const std::filesystem::path& path);
    friend bool is_in_own_folder(const std::filesystem::path& path);
    friend std::optional<Provenance> provenance_of(const std::filesystem::path& path);
    friend std::vector<std::string> figures_in(const std::filesystem::path& path);
    static ResultFolder* owner_of(const std::filesystem::path& path, std::string& name);
    void refuse_strange_results() const;
    void refuse_strange_manifest() const;
    void refuse_strange(const std::string& name);
    void note(const std::string& name);
    void forget(const std::string& name);
    void write_manifest();
    void begin();
    [[nodiscard]] int remove_marker() noexcept;
    void refuse_lasting_results() const;
    void clear_earlier() const;

    std::filesystem::path folder_;  // absolute, normal
    Provenance made_by_;
    Rules rules_;
    std::vector<std::filesystem::path> created_;  // folders that were not there, deepest first
    std::set<std::string> earlier_, files_;
    std::vector<ManifestRun> others_;  // files of other commands, if the folder is shared
    std::mutex mutex_;
    bool begun_ = false;
    int lock_ = -1, marker_ = -1;
    int exceptions_ = 0;  // number of exceptions that were propagating when it was made
};

/// Name of the list that a run leaves in its folder: its files and the command that made them.
inline constexpr const char* manifest_name = "manifest.json";
/// The runs and files on the list of a folder, the last run first; nothing if there is no list or it is not one of
/// ours.
[[nodiscard]] std::vector<ResultFolder::ManifestRun> manifest_runs(const std::filesystem::path& folder);
/// The contents of a list.
[[nodiscard]] std::string manifest_text(const ResultFolder::ManifestRun& last,
                                        const std::vector<ResultFolder::ManifestRun>& others);

/// Called by AtomicFile when a file is about to get its final name.
void note_result(const std::filesystem::path& path);

/// Called by AtomicFile. Throws InputError if the path is in the folder of a run and a file there belongs to somebody
/// else: no list names it, or it is a link or is reached through one.
void require_own(const std::filesystem::path& path);

/// Removes a file and takes it from the list, for the state of an unfinished run, which is no longer needed.
void forget_result(const std::filesystem::path& path);

/// True if the path is in a folder that a run of this process owns now.
[[nodiscard]] bool is_in_own_folder(const std::filesystem::path& path);

/// External intersectors as one text: a line `NAME: description` for each.
[[nodiscard]] std::string external_forms_text(const Provenance& by);

/// Adds the attributes `lostbits:command`, `lostbits:program` and `lostbits:forms` of the run whose folder the path is
/// in. Skips empty ones and those that `attributes` already has.
void add_generator(const std::filesystem::path& path, std::vector<std::pair<std::string, std::string>>& attributes);

/// The kinds of pictures that the run writes whose folder the path is in, at least one: png unless `--figure` names
/// others. A path that ends in .svg asks for that kind alone.
[[nodiscard]] std::vector<std::string> figures_in(const std::filesystem::path& path);

/// The run whose folder the path is in; nothing if it is in none.
[[nodiscard]] std::optional<Provenance> provenance_of(const std::filesystem::path& path);

}  // namespace lostbits::output::file
