#include "output/file/result_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <exception>
#include <fstream>
#include <iterator>
#include <system_error>

#include "number/error.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/csv.hpp"
#include "scene/toml/files_of_run.hpp"

namespace lostbits::output::file {

namespace fs = std::filesystem;

namespace {

constexpr const char* marker_name = "UNFINISHED.txt";
constexpr const char* marker_words = "The results in this folder are not complete.";

/// The folders that runs of this process own now.
struct OwnedFolders {
    std::mutex mutex;
    std::vector<ResultFolder*> folders;
};
OwnedFolders& owned() {
    static OwnedFolders all;
    return all;
}

fs::path plain(const fs::path& path) {
    fs::path whole = fs::absolute(path).lexically_normal();
    return whole.has_filename() ? whole : whole.parent_path();
}

/// Name of a path inside the folder; empty if the path is elsewhere.
std::string name_in(const fs::path& folder, const fs::path& path) {
    const fs::path inside = plain(path).lexically_relative(folder);
    return inside.empty() || *inside.begin() == ".." ? "" : inside.generic_string();
}

/// True for files that people take for results of this program.
bool looks_like_a_result(const fs::path& path) {
    constexpr std::array<std::string_view, 6> endings{".png", ".svg", ".pdf", ".csv", ".exr", ".html"};
    return std::ranges::find(endings, path.extension().string()) != endings.end() ||
           path.filename() == "datapackage.json";
}

bool is_half_written(const fs::path& path) {
    const std::string name = path.filename().string();
    return name.starts_with('.') && name.find(".partial-") != std::string::npos;
}

void remove_abandoned(const fs::path& folder) {
    std::error_code ignored;
    for (auto at = fs::recursive_directory_iterator(folder, ignored); at != fs::end(at); at.increment(ignored)) {
        if (is_half_written(at->path()) && fs::is_regular_file(at->symlink_status(ignored)))
            remove_if_abandoned(at->path());
    }
}

std::string text_in(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// True if a live run is writing the folder that holds this marker.
bool is_held(const fs::path& marker) {
    const int fd = ::open(marker.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return false;
    const bool held = ::flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    ::close(fd);
    return held;
}

InputError another_run(const fs::path& folder) {
    return InputError(folder.string() +
                      ": another run is writing to this folder; wait until it ends, or choose another -o");
}

/// The program and its command without arguments: `lostbits check`.
std::string kind_of(const std::string& command) {
    const auto name = command.find(' ');
    return name == std::string::npos ? command : command.substr(0, command.find(' ', name + 1));
}

}  // namespace

std::optional<Provenance> ResultFolder::last_run_in(const fs::path& folder) {
    const auto all = manifest_runs(folder);
    if (all.empty()) return {};
    return all.front().by;
}

std::string ResultFolder::unfinished_in(const fs::path& folder) {
    const fs::path marker = folder / marker_name;
    if (!text_in(marker).starts_with(marker_words)) return "";
    if (is_held(marker))
        return fmt::format("{}: is not finished: a run is writing to it now; wait until it ends", folder.string());
    return fmt::format("{}: is not finished: the run that wrote it was stopped; run the command in its {} again",
                       folder.string(), marker_name);
}

ResultFolder::ResultFolder(fs::path folder, Provenance made_by, Rules rules)
    : folder_(plain(folder)), made_by_(std::move(made_by)), rules_(rules), exceptions_(std::uncaught_exceptions()) {
    std::error_code error, ignored;
    for (auto part = folder_; part != part.parent_path() && !fs::exists(fs::symlink_status(part, ignored));
         part = part.parent_path())
        created_.push_back(part);
    fs::create_directories(folder_, error);
    if (!fs::is_directory(folder_, ignored))
        throw EnvironmentError(fmt::format("{}: cannot create the folder: {}; choose another -o", folder.string(),
                                           error ? error.message() : "a file has that name"));
    for (ManifestRun& run : manifest_runs(folder_)) {
        if (rules_.shared && kind_of(run.by.command) != kind_of(made_by_.command)) others_.push_back(std::move(run));
        else earlier_.merge(run.files);
    }
    refuse_strange_manifest();
    if (!rules_.keep) refuse_lasting_results();
    if (!rules_.force && !rules_.shared) refuse_strange_results();
    if (!rules_.keep) {
        for (const std::string& name : earlier_) scene::toml::note_written(folder_ / name);
    }
    lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    // A file system without locks gives another error. Then another run cannot be detected.
    if (lock_ >= 0 && ::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        ::close(lock_);
        throw another_run(folder);
    }
    remove_abandoned(folder_);
    if (rules_.keep) files_ = earlier_;
    const std::lock_guard lock(owned().mutex);
    owned().folders.push_back(this);
}

ResultFolder::~ResultFolder() {
    {
        const std::lock_guard lock(owned().mutex);
        std::erase(owned().folders, this);
    }
    if (std::uncaught_exceptions() <= exceptions_) static_cast<void>(remove_marker());
    if (marker_ >= 0) ::close(marker_);
    if (lock_ >= 0) ::close(lock_);
    std::error_code ignored;
    for (const auto& part : created_) fs::remove(part, ignored);  // folders that are not empty stay
}

void ResultFolder::refuse_strange_results() const {
    std::vector<std::string> strange;
    std::error_code ignored;
    for (auto at = fs::recursive_directory_iterator(folder_, ignored); at != fs::end(at); at.increment(ignored)) {
        if (at->is_directory(ignored) && fs::exists(at->path() / manifest_name, ignored))
            at.disable_recursion_pending();
        if (!at->is_regular_file(ignored) || !looks_like_a_result(at->path())) continue;
        const std::string name = name_in(folder_, at->path());
        if (!earlier_.contains(name)) strange.push_back(name);
    }
    if (strange.empty()) return;
    std::ranges::sort(strange);
    const std::string more = strange.size() == 1 ? "" : fmt::format(" and {} more", strange.size() - 1);
    throw InputError(fmt::format(
        "{}: holds results that are not in its {}: {}{}; they would be mixed with the results of this run; choose "
        "another -o, move them away, or add --force to leave them there",
        folder_.string(), manifest_name, strange.front(), more));
}

/// Throws InputError if a file that is not our list has its name: without a list the owner of a file is unknown.
void ResultFolder::refuse_strange_manifest() const {
    std::error_code ignored;
    const fs::path list = folder_ / manifest_name;
    const auto status = fs::symlink_status(list, ignored);
    if (!fs::exists(status) || (fs::is_regular_file(status) && !manifest_runs(folder_).empty())) return;
    throw InputError(
        list.string() +
        ": is not a list of results, and this run would replace it with its own; move it away, or choose another "
        "-o");
}

void ResultFolder::refuse_strange(const std::string& name) {
    std::error_code ignored;
    const fs::path path = folder_ / name;
    const auto status = fs::symlink_status(path, ignored);
    if (!fs::exists(status)) return;
    const bool elsewhere =
        name_in(fs::canonical(folder_, ignored), fs::weakly_canonical(path.parent_path(), ignored) / "x").empty();
    const auto lists = [&name](const ManifestRun& run) { return run.files.contains(name); };
    const std::lock_guard lock(mutex_);
    const bool own = earlier_.contains(name) || files_.contains(name) || std::ranges::any_of(others_, lists);
    if (own && !elsewhere && !fs::is_symlink(status)) return;
    throw InputError(fmt::format(
        "{}: {}, and a result of this run would replace it; move it away, or choose another -o", path.string(),
        elsewhere || fs::is_symlink(status) ? "is a link, or is reached through one"
                                            : fmt::format("is not in the {} of its folder", manifest_name)));
}

namespace {

EnvironmentError lasting(const fs::path& path, const std::string& why) {
    return EnvironmentError(fmt::format(
        "{}: is a result of an earlier run and cannot be removed: {}; it would be mixed with the results of this run; "
        "remove it, or choose another -o",
        path.string(), why));
}

}  // namespace

/// Throws EnvironmentError before the work starts, if the permissions of folders show that earlier results cannot be
/// removed.
void ResultFolder::refuse_lasting_results() const {
    std::error_code ignored;
    for (const std::string& name : earlier_) {
        const fs::path path = folder_ / name;
        if (fs::is_regular_file(fs::symlink_status(path, ignored)) &&
            ::access(path.parent_path().c_str(), W_OK | X_OK) != 0)
            throw lasting(path, std::generic_category().message(errno));
    }
}

void ResultFolder::clear_earlier() const {
    std::error_code ignored, error;
    const fs::path real = fs::canonical(folder_, ignored);
    for (const std::string& name : earlier_) {
        const fs::path path = folder_ / name;
        // A listed name that leads through a link to another folder would be somebody else's file.
        const fs::path parent = fs::canonical(path.parent_path(), ignored);
        if (ignored || name_in(real, parent / "x").empty() || !fs::is_regular_file(fs::symlink_status(path, ignored)))
            continue;
        fs::remove(path, error);
        if (error) throw lasting(path, error.message());
        for (auto empty = path.parent_path(); empty != folder_ && fs::is_empty(empty, ignored);
             empty = empty.parent_path())
            fs::remove(empty, ignored);
    }
}

void ResultFolder::begin() {
    const fs::path marker = folder_ / marker_name;
    const std::string old = text_in(marker);
    if (!old.empty() && !old.starts_with(marker_words))
        throw InputError(marker.string() +
                         ": has the name of the file in which a run says that it is not finished; rename that file");
    marker_ = ::open(marker.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (marker_ < 0)
        throw EnvironmentError(fmt::format("{}: cannot create: {}; choose another -o", marker.string(),
                                           std::generic_category().message(errno)));
    // If the folder itself cannot be locked (NFS), this detects the other run, although later.
    if (::flock(marker_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) throw another_run(folder_);
    const std::string text = fmt::format(
        "{}\nA run is writing them now, or was stopped:\n\n    {}\n\nRun that command again{}. It replaces the results "
        "and removes this file.\n",
        marker_words, to_valid_utf8(made_by_.command),
        rules_.resumes ? " with --resume to continue where it stopped (without --resume it starts over)" : "");
    // Writes the text before it cuts the file, so that nobody ever reads an empty marker of a run that has results.
    if (::pwrite(marker_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()) ||
        ::ftruncate(marker_, static_cast<off_t>(text.size())) != 0)
        throw EnvironmentError(fmt::format("{}: cannot write: {}; free space or choose another -o", marker.string(),
                                           std::generic_category().message(errno)));
    if (!rules_.keep) clear_earlier();
}

/// Removes the marker. Returns 0, or the error number if it could not be removed.
int ResultFolder::remove_marker() noexcept {
    if (marker_ < 0) return 0;
    const int error_number = ::unlink((folder_ / marker_name).c_str()) == 0 ? 0 : errno;
    ::close(marker_);
    marker_ = -1;
    return error_number;
}

void ResultFolder::complete() {
    const std::lock_guard lock(mutex_);
    if (const int error_number = remove_marker(); error_number != 0)
        throw EnvironmentError(
            fmt::format("{}: cannot be removed: {}; the results in the folder are complete, so remove this file",
                        (folder_ / marker_name).string(), std::generic_category().message(error_number)));
}

void ResultFolder::note(const std::string& name) {
    const std::lock_guard lock(mutex_);
    if (!begun_) begin();
    begun_ = true;
    if (files_.insert(name).second) write_manifest();
}

void ResultFolder::forget(const std::string& name) {
    const std::lock_guard lock(mutex_);
    if (files_.erase(name) > 0) write_manifest();
}

void ResultFolder::write_manifest() {
    for (ManifestRun& other : others_) {
        for (const std::string& name : files_) other.files.erase(name);
    }
    write_file(folder_ / manifest_name, manifest_text({made_by_, files_}, others_));
}

ResultFolder* ResultFolder::owner_of(const fs::path& path, std::string& name) {
    const std::lock_guard lock(owned().mutex);
    for (ResultFolder* folder : owned().folders) {
        name = name_in(folder->folder_, path);
        if (!name.empty() && name != manifest_name) return folder;
    }
    return nullptr;
}

bool is_in_own_folder(const fs::path& path) {
    const std::lock_guard lock(owned().mutex);
    return std::ranges::any_of(owned().folders,
                               [&path](const ResultFolder* folder) { return !name_in(folder->folder_, path).empty(); });
}

void note_result(const fs::path& path) {
    std::string name;
    if (ResultFolder* const owner = ResultFolder::owner_of(path, name)) owner->note(name);
}

void require_own(const fs::path& path) {
    std::string name;
    if (ResultFolder* const owner = ResultFolder::owner_of(path, name)) owner->refuse_strange(name);
}

std::string external_forms_text(const Provenance& by) {
    std::string words;
    for (const auto& [name, what] : by.forms) words += (words.empty() ? "" : "\n") + name + ": " + what;
    return words;
}

void forget_result(const fs::path& path) {
    std::error_code error;
    fs::remove(path, error);
    if (error)
        throw EnvironmentError(fmt::format("{}: is no longer needed and cannot be removed: {}; remove it",
                                           path.string(), error.message()));
    std::string name;
    if (ResultFolder* const owner = ResultFolder::owner_of(path, name)) owner->forget(name);
}

void add_generator(const fs::path& path, std::vector<std::pair<std::string, std::string>>& attributes) {
    const auto provenance = provenance_of(path);
    if (!provenance) return;
    for (const auto& [name, value] : {std::pair("lostbits:command", provenance->command),
                                      {"lostbits:program", provenance->program},
                                      {"lostbits:forms", external_forms_text(*provenance)}}) {
        if (value.empty()) continue;
        const auto is_it = [name = name](const auto& entry) { return entry.first == name; };
        if (std::ranges::none_of(attributes, is_it)) attributes.emplace_back(name, value);
    }
}

std::vector<std::string> figures_in(const fs::path& path) {
    if (path.extension() == ".svg") return {"svg"};
    std::string name;
    const ResultFolder* const owner = ResultFolder::owner_of(path, name);
    return owner == nullptr || owner->rules_.figures.empty() ? std::vector<std::string>{"png"} : owner->rules_.figures;
}

std::optional<Provenance> provenance_of(const fs::path& path) {
    std::string name;
    if (const ResultFolder* const owner = ResultFolder::owner_of(path, name)) return owner->made_by_;
    return {};
}

}  // namespace lostbits::output::file
