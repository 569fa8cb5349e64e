// A folder of results belongs to the run that wrote them, which leaves a list of them.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lostbits::output::file {

/// What made a file, as the files that can hold it say.
struct MadeBy {
    std::string command;  ///< what to type to make it again
    std::string program;  ///< `lostbits 0.1.0`
    /// Of every form from outside its name and what it is: the library, or the shader with its driver and how that
    /// rounds.
    std::vector<std::pair<std::string, std::string>> forms = {};
};

struct ResultFolderRules {
    bool force = false;  ///< results that no list names may lie there; they stay, and no result takes their place
    /// Others keep files there on purpose, so results that no list names are no offence; and what another command of
    /// this program made there stays, and stays on the list.
    bool shared = false;
    bool keep = false;     ///< what the earlier run listed stays: this run goes on with it
    bool resumes = false;  ///< a run that is stopped leaves how far it came, and `--resume` goes on from there
};

/// A folder that is a run's own while this lives.
///
/// Every file that gets its final name in it is listed in `manifest.json` before it is there. In front of the first of
/// them goes what the list of an earlier run names, so a folder never holds the results of two runs, and a run that
/// ends before it has results leaves those that were there. What no list names is somebody's own and stays. What
/// killed runs left half written (`.NAME.partial-…`) goes at once, unless its run is alive. From the first result to
/// the last the folder holds `UNFINISHED.txt`, which says so: a run that is killed, or ends by an exception, leaves it.
class ResultFolder {
public:
    using Rules = ResultFolderRules;
    /// The files of one run.
    struct Made {
        MadeBy by;
        std::set<std::string> files;
    };

    /// InputError where the folder holds results that no list names, and where another run writes there;
    /// EnvironmentError where it cannot be made, and where results of an earlier run cannot be removed.
    ResultFolder(std::filesystem::path folder, MadeBy made_by, Rules rules);
    /// The results are complete, unless an exception is on its way. A folder that was made for it and is empty goes
    /// again.
    ~ResultFolder();
    ResultFolder(const ResultFolder&) = delete;
    ResultFolder& operator=(const ResultFolder&) = delete;

    /// The results are whole, and the folder says so from here on, whatever becomes of the run: whoever prints
    /// something about them calls it before, since a reader that is gone (`| head`) ends the program there.
    /// EnvironmentError where the folder would go on to say that it is not finished.
    void complete();

    /// What the folder's list says made it; nothing where there is no list, or none of ours.
    [[nodiscard]] static std::optional<MadeBy> made_by_in(const std::filesystem::path& folder);

    /// Of a folder whose results are not complete, a sentence that says so and what to do; empty otherwise.
    [[nodiscard]] static std::string unfinished_in(const std::filesystem::path& folder);

private:
    friend void note_result(const std::filesystem::path& path);
    friend void require_own(const std::filesystem::path& path);
    friend void forget_result(const std::filesystem::path& path);
    friend bool is_in_own_folder(const std::filesystem::path& path);
    friend std::optional<MadeBy> maker_of(const std::filesystem::path& path);
    static ResultFolder* owner_of(const std::filesystem::path& path, std::string& name);
    void refuse_strange_results() const;
    void refuse_strange_list() const;
    void refuse_strange(const std::string& name);
    void note(const std::string& name);
    void forget(const std::string& name);
    void write_list();
    void begin();
    [[nodiscard]] int remove_marker() noexcept;
    void refuse_lasting_results() const;
    void clear_earlier() const;

    std::filesystem::path folder_;  // absolute, normal
    MadeBy made_by_;
    Rules rules_;
    std::vector<std::filesystem::path> made_;  // folders that were not there, deepest first
    std::set<std::string> earlier_, files_;
    std::vector<Made> others_;  // of other commands, where the folder is shared
    std::mutex mutex_;
    bool begun_ = false;
    int lock_ = -1, marker_ = -1;
    int exceptions_ = 0;  // on their way when it was made
};

/// The list that a run leaves in its folder: what made which files.
inline constexpr const char* list_name = "manifest.json";
/// What the list of a folder names, the last run first; nothing where there is no list, or none of ours.
[[nodiscard]] std::vector<ResultFolder::Made> made_in(const std::filesystem::path& folder);
/// The contents of a list.
[[nodiscard]] std::string list_text(const ResultFolder::Made& last, const std::vector<ResultFolder::Made>& others);

/// Of AtomicFile: this file is about to get its final name.
void note_result(const std::filesystem::path& path);

/// Of AtomicFile: InputError where what stands under this name in a folder that is a run's own is somebody else's: no
/// list names it, or it is a link or lies behind one.
void require_own(const std::filesystem::path& path);

/// Removes a file that is no result any more, and takes it from the list: how far an unfinished run came.
void forget_result(const std::filesystem::path& path);

/// Whether the path lies in a folder that is a run's own now.
[[nodiscard]] bool is_in_own_folder(const std::filesystem::path& path);

/// Forms from outside as one text: `NAME: what it is`, a line each.
[[nodiscard]] std::string words_of_forms(const MadeBy& by);

/// Adds `lostbits:command`, `lostbits:program` and, where there are any, `lostbits:forms` of the run whose folder the
/// path lies in, where they are missing.
void add_maker(const std::filesystem::path& path, std::vector<std::pair<std::string, std::string>>& attributes);

/// The run whose folder the path lies in; nothing outside of all.
[[nodiscard]] std::optional<MadeBy> maker_of(const std::filesystem::path& path);

}  // namespace lostbits::output::file
