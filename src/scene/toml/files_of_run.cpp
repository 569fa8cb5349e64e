#include "scene/toml/files_of_run.hpp"

#include <sys/stat.h>

#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "number/error.hpp"

namespace lostbits::scene::toml {

namespace {

struct RunFiles {
    std::set<std::pair<dev_t, ino_t>> read, written;
};

std::mutex files_mutex;
std::vector<RunFiles> files_by_run;  ///< one entry for each `FilesOfRun` that exists, the youngest last

void reserve(const std::filesystem::path& path, bool is_written) {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return;
    const std::pair file(info.st_dev, info.st_ino);
    const std::lock_guard lock(files_mutex);
    if (files_by_run.empty()) return;
    RunFiles& files = files_by_run.back();
    // Insert before the check: a reader's error may end as the error of a claim, and the writer must still know of the
    // file.
    (is_written ? files.written : files.read).insert(file);
    if ((is_written ? files.read : files.written).contains(file))
        throw InputError(path.string() +
                         ": is read by this run, and its results would overwrite it; choose another path for them");
}

}  // namespace

FilesOfRun::FilesOfRun() {
    const std::lock_guard lock(files_mutex);
    files_by_run.emplace_back();
}

FilesOfRun::~FilesOfRun() {
    const std::lock_guard lock(files_mutex);
    files_by_run.pop_back();
}

void reserve_for_reading(const std::filesystem::path& path) { reserve(path, false); }
void reserve_for_writing(const std::filesystem::path& path) { reserve(path, true); }

}  // namespace lostbits::scene::toml
