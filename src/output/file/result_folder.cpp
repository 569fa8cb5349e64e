// Folders of results: their manifest, their lock and the marker of unfinished results.
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
constexpr const char* marker_sentence = "The results in this folder are not complete.";

/// The folders that runs of this process own now.
struct OwnedFolders {
    std::mutex mutex;
    std::vector<ResultFolder*> folders;
};
OwnedFolders& owned_folders() {
    static OwnedFolders instance;
    return instance;
}

fs::path absolute_path(const fs::path& path) {
    fs::path absolute = fs::absolute(path).lexically_normal();
    return absolute.has_filename() ? absolute : absolute.parent_path();
}

/// Path relative to the folder; empty if the path is not inside the folder.
std::string relative_name(const fs::path& folder, const fs::path& path) {
    const fs::path relative = absolute_path(path).lexically_relative(folder);
    return relative.empty() || *relative.begin() == ".." ? "" : relative.generic_string();
}

/// True for files that people would take for results of this program.
bool looks_like_a_result(const fs::path& path) {
    constexpr std::array<std::string_view, 6> endings{".png", ".svg", ".pdf", ".csv", ".exr", ".html"};
    return std::ranges::find(endings, path.extension().string()) != endings.end() ||
           path.filename() == "datapackage.json";
}

bool is_half_written(const fs::path& path) {
    const std::string name = path.filename().string();
    return name.starts_with('.') && name.find(".partial-") != std::string::npos;
}

void remove_abandoned_files(const fs::path& folder) {
    std::error_code ignored;
    for (auto entry = fs::recursive_directory_iterator(folder, ignored); entry != fs::end(entry);
         entry.increment(ignored)) {
        if (is_half_written(entry->path()) && fs::is_regular_file(entry->symlink_status(ignored)))
            remove_abandoned_file(entry->path());
    }
}

std::string read_text(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// True if a live run is writing the folder that holds this marker.
bool is_locked_by_run(const fs::path& marker) {
    const int fd = ::open(marker.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return false;
    const bool is_locked = ::flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    ::close(fd);
    return is_locked;
}

InputError another_run_error(const fs::path& folder) {
    return InputError(folder.string() +
                      ": another run is writing to this folder; wait until it ends, or choose another -o");
}

/// The program and its command without arguments: `lostbits check`.
std::string command_name(const std::string& command) {
    const auto first_space = command.find(' ');
    return first_space == std::string::npos ? command : command.substr(0, command.find(' ', first_space + 1));
}

}  // namespace

std::optional<Provenance> ResultFolder::last_run(const fs::path& folder) {
    const auto runs = manifest_runs(folder);
    if (runs.empty()) return {};
    return runs.front().provenance;
}

std::string ResultFolder::unfinished_sentence(const fs::path& folder) {
    const fs::path marker = folder / marker_name;
    if (!read_text(marker).starts_with(marker_sentence)) return "";
    if (is_locked_by_run(marker))
        return fmt::format("{}: is not finished: a run is writing to it now; wait until it ends", folder.string());
    return fmt::format("{}: is not finished: the run that wrote it was stopped; run the command in its {} again",
                       folder.string(), marker_name);
}

ResultFolder::ResultFolder(fs::path folder, Provenance provenance, Rules rules)
    : folder_(absolute_path(folder)),
      provenance_(std::move(provenance)),
      rules_(rules),
      initial_exceptions_(std::uncaught_exceptions()) {
    create_folder(folder);
    for (ManifestRun& run : manifest_runs(folder_)) {
        if (rules_.is_shared && command_name(run.provenance.command) != command_name(provenance_.command))
            other_runs_.push_back(std::move(run));
        else earlier_files_.merge(run.files);
    }

    // Whatever would make the run fail is found before it begins.
    require_own_manifest();
    if (!rules_.continues_run) require_removable_results();
    if (!rules_.allows_unlisted && !rules_.is_shared) require_no_unlisted_results();
    if (!rules_.continues_run) {
        for (const std::string& name : earlier_files_) scene::toml::reserve_for_writing(folder_ / name);
    }

    lock_folder(folder);
    remove_abandoned_files(folder_);
    if (rules_.continues_run) files_ = earlier_files_;
    const std::lock_guard lock(owned_folders().mutex);
    owned_folders().folders.push_back(this);
}

void ResultFolder::create_folder(const fs::path& given_path) {
    std::error_code error, ignored;
    for (auto missing_folder = folder_;
         missing_folder != missing_folder.parent_path() && !fs::exists(fs::symlink_status(missing_folder, ignored));
         missing_folder = missing_folder.parent_path())
        created_folders_.push_back(missing_folder);
    fs::create_directories(folder_, error);
    if (fs::is_directory(folder_, ignored)) return;

    fs::path nearest = folder_;  // the folder, or the deepest parent that exists
    while (!fs::exists(nearest, ignored) && nearest.has_relative_path()) nearest = nearest.parent_path();
    if (!fs::is_directory(nearest, ignored))
        throw EnvironmentError(nearest.string() + ": is a file, so it cannot hold results; choose another -o");
    throw EnvironmentError(fmt::format("{}: cannot create the folder: {}; choose another -o", given_path.string(),
                                       error ? error.message() : "a file has that name"));
}

void ResultFolder::lock_folder(const fs::path& given_path) {
    lock_fd_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    // A file system without locks gives another error; another run cannot be detected there.
    if (lock_fd_ >= 0 && ::flock(lock_fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        ::close(lock_fd_);
        throw another_run_error(given_path);
    }
}

ResultFolder::~ResultFolder() {
    {
        const std::lock_guard lock(owned_folders().mutex);
        std::erase(owned_folders().folders, this);
    }
    if (std::uncaught_exceptions() <= initial_exceptions_) static_cast<void>(remove_marker());
    if (marker_fd_ >= 0) ::close(marker_fd_);
    if (lock_fd_ >= 0) ::close(lock_fd_);
    std::error_code ignored;
    for (const auto& created_folder : created_folders_)
        fs::remove(created_folder, ignored);  // folders that are not empty stay
}

void ResultFolder::require_no_unlisted_results() const {
    std::vector<std::string> unlisted;
    std::error_code ignored;
    for (auto entry = fs::recursive_directory_iterator(folder_, ignored); entry != fs::end(entry);
         entry.increment(ignored)) {
        if (entry->is_directory(ignored) && fs::exists(entry->path() / manifest_name, ignored))
            entry.disable_recursion_pending();
        if (!entry->is_regular_file(ignored) || !looks_like_a_result(entry->path())) continue;
        const std::string name = relative_name(folder_, entry->path());
        if (!earlier_files_.contains(name)) unlisted.push_back(name);
    }

    if (unlisted.empty()) return;
    std::ranges::sort(unlisted);
    const std::string others_text = unlisted.size() == 1 ? "" : fmt::format(" and {} more", unlisted.size() - 1);
    throw InputError(fmt::format(
        "{}: holds results that are not in its {}: {}{}; they would be mixed with the results of this run; choose "
        "another -o, move them away, or add --force, which keeps them and refuses only results of the same name",
        folder_.string(), manifest_name, unlisted.front(), others_text));
}

/// Throws InputError if another file has the name of the manifest: without a manifest the owner of a file is unknown.
void ResultFolder::require_own_manifest() const {
    std::error_code ignored;
    const fs::path manifest = folder_ / manifest_name;
    const auto status = fs::symlink_status(manifest, ignored);
    if (!fs::exists(status) || (fs::is_regular_file(status) && !manifest_runs(folder_).empty())) return;
    throw InputError(
        manifest.string() +
        ": is not a list of results, and this run would replace it with its own; move it away, or choose another "
        "-o");
}

void ResultFolder::require_own_file(const std::string& name) {
    std::error_code ignored;
    const fs::path path = folder_ / name;
    const auto status = fs::symlink_status(path, ignored);
    if (!fs::exists(status)) return;

    const bool is_elsewhere =
        relative_name(fs::canonical(folder_, ignored), fs::weakly_canonical(path.parent_path(), ignored) / "x").empty();
    const auto lists_file = [&name](const ManifestRun& run) { return run.files.contains(name); };
    const std::lock_guard lock(mutex_);
    const bool is_listed =
        earlier_files_.contains(name) || files_.contains(name) || std::ranges::any_of(other_runs_, lists_file);
    if (is_listed && !is_elsewhere && !fs::is_symlink(status)) return;

    throw InputError(fmt::format(
        "{}: {}, and a result of this run would replace it; move it away, or choose another -o", path.string(),
        is_elsewhere || fs::is_symlink(status) ? "is a link, or is reached through one"
                                               : fmt::format("is not in the {} of its folder", manifest_name)));
}

namespace {

EnvironmentError cannot_remove_error(const fs::path& path, const std::string& reason) {
    return EnvironmentError(fmt::format(
        "{}: is a result of an earlier run and cannot be removed: {}; it would be mixed with the results of this run; "
        "remove it, or choose another -o",
        path.string(), reason));
}

}  // namespace

/// Throws EnvironmentError before the work starts if the permissions of folders show that earlier results cannot be
/// removed.
void ResultFolder::require_removable_results() const {
    std::error_code ignored;
    for (const std::string& name : earlier_files_) {
        const fs::path path = folder_ / name;
        if (fs::is_regular_file(fs::symlink_status(path, ignored)) &&
            ::access(path.parent_path().c_str(), W_OK | X_OK) != 0)
            throw cannot_remove_error(path, std::generic_category().message(errno));
    }
}

void ResultFolder::remove_earlier_results() const {
    std::error_code ignored, error;
    const fs::path real_folder = fs::canonical(folder_, ignored);
    for (const std::string& name : earlier_files_) {
        const fs::path path = folder_ / name;
        // A listed name that leads through a link to another folder is somebody else's file.
        const fs::path parent = fs::canonical(path.parent_path(), ignored);
        if (ignored || relative_name(real_folder, parent / "x").empty() ||
            !fs::is_regular_file(fs::symlink_status(path, ignored)))
            continue;

        fs::remove(path, error);
        if (error) throw cannot_remove_error(path, error.message());
        for (auto folder = path.parent_path(); folder != folder_ && fs::is_empty(folder, ignored);
             folder = folder.parent_path())
            fs::remove(folder, ignored);
    }
}

void ResultFolder::begin_results() {
    create_marker();
    if (!rules_.continues_run) remove_earlier_results();
}

void ResultFolder::create_marker() {
    const fs::path marker = folder_ / marker_name;
    const std::string old_text = read_text(marker);
    if (!old_text.empty() && !old_text.starts_with(marker_sentence))
        throw InputError(marker.string() +
                         ": has the name of the file in which a run says that it is not finished; rename that file");

    marker_fd_ = ::open(marker.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (marker_fd_ < 0)
        throw EnvironmentError(fmt::format("{}: cannot create: {}; choose another -o", marker.string(),
                                           std::generic_category().message(errno)));
    // If the folder itself cannot be locked (NFS), this detects the other run, although later.
    if (::flock(marker_fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) throw another_run_error(folder_);

    const std::string text = fmt::format(
        "{}\nA run is writing them now, or was stopped:\n\n    {}\n\nRun that command again{}. It replaces the results "
        "and removes this file.\n",
        marker_sentence, to_valid_utf8(provenance_.command),
        rules_.can_resume ? " with --resume to continue where it stopped (without --resume it starts over)" : "");
    // The text is written before the file is cut to size, so that no process reads an empty marker of a run that has
    // results.
    if (::pwrite(marker_fd_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()) ||
        ::ftruncate(marker_fd_, static_cast<off_t>(text.size())) != 0)
        throw EnvironmentError(fmt::format("{}: cannot write: {}; free space or choose another -o", marker.string(),
                                           std::generic_category().message(errno)));
}

/// Removes the marker. Returns 0, or the error number if it could not be removed.
int ResultFolder::remove_marker() noexcept {
    if (marker_fd_ < 0) return 0;
    const int error_number = ::unlink((folder_ / marker_name).c_str()) == 0 ? 0 : errno;
    ::close(marker_fd_);
    marker_fd_ = -1;
    return error_number;
}

void ResultFolder::complete() {
    const std::lock_guard lock(mutex_);
    if (const int error_number = remove_marker(); error_number != 0)
        throw EnvironmentError(
            fmt::format("{}: cannot be removed: {}; the results in the folder are complete, so remove this file",
                        (folder_ / marker_name).string(), std::generic_category().message(error_number)));
}

void ResultFolder::add_result(const std::string& name) {
    const std::lock_guard lock(mutex_);
    if (!has_begun_) begin_results();
    has_begun_ = true;
    if (files_.insert(name).second) write_manifest();
}

void ResultFolder::remove_entry(const std::string& name) {
    const std::lock_guard lock(mutex_);
    if (files_.erase(name) > 0) write_manifest();
}

void ResultFolder::write_manifest() {
    for (ManifestRun& other : other_runs_) {
        for (const std::string& name : files_) other.files.erase(name);
    }
    write_file(folder_ / manifest_name, manifest_text({provenance_, files_}, other_runs_));
}

ResultFolder* ResultFolder::owner_of(const fs::path& path, std::string& name) {
    const std::lock_guard lock(owned_folders().mutex);
    for (ResultFolder* folder : owned_folders().folders) {
        name = relative_name(folder->folder_, path);
        if (!name.empty() && name != manifest_name) return folder;
    }
    return nullptr;
}

bool is_in_own_folder(const fs::path& path) {
    const std::lock_guard lock(owned_folders().mutex);
    return std::ranges::any_of(owned_folders().folders, [&path](const ResultFolder* folder) {
        return !relative_name(folder->folder_, path).empty();
    });
}

void note_result(const fs::path& path) {
    std::string name;
    if (ResultFolder* const owner = ResultFolder::owner_of(path, name)) owner->add_result(name);
}

void require_own_result(const fs::path& path) {
    std::string name;
    if (ResultFolder* const owner = ResultFolder::owner_of(path, name)) owner->require_own_file(name);
}

std::string external_forms_text(const Provenance& provenance) {
    std::string text;
    for (const auto& [name, description] : provenance.forms)
        text += (text.empty() ? "" : "\n") + name + ": " + description;
    return text;
}

void remove_result(const fs::path& path) {
    std::error_code error;
    fs::remove(path, error);
    if (error)
        throw EnvironmentError(fmt::format("{}: is no longer needed and cannot be removed: {}; remove it",
                                           path.string(), error.message()));
    std::string name;
    if (ResultFolder* const owner = ResultFolder::owner_of(path, name)) owner->remove_entry(name);
}

void add_provenance(const fs::path& path, std::vector<std::pair<std::string, std::string>>& attributes) {
    const auto provenance = provenance_of(path);
    if (!provenance) return;
    for (const auto& [name, value] : {std::pair("lostbits:command", provenance->command),
                                      {"lostbits:program", provenance->program},
                                      {"lostbits:forms", external_forms_text(*provenance)}}) {
        if (value.empty()) continue;
        const auto has_name = [name = name](const auto& entry) { return entry.first == name; };
        if (std::ranges::none_of(attributes, has_name)) attributes.emplace_back(name, value);
    }
}

std::vector<std::string> figure_kinds(const fs::path& path) {
    if (path.extension() == ".svg") return {"svg"};
    std::string name;
    const ResultFolder* const owner = ResultFolder::owner_of(path, name);
    return owner == nullptr || owner->rules_.figures.empty() ? std::vector<std::string>{"png"} : owner->rules_.figures;
}

std::optional<Provenance> provenance_of(const fs::path& path) {
    std::string name;
    if (const ResultFolder* const owner = ResultFolder::owner_of(path, name)) return owner->provenance_;
    return {};
}

}  // namespace lostbits::output::file
