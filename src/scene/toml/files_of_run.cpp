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

std::mutex noted_mutex;
std::vector<RunFiles> noted_by_run;  ///< one for each object that lives, the youngest last

void note(const std::filesystem::path& path, bool written) {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return;
    const std::pair file(info.st_dev, info.st_ino);
    const std::lock_guard lock(noted_mutex);
    if (noted_by_run.empty()) return;
    RunFiles& all = noted_by_run.back();
    // Insert before the check: a reader's error may end as the error of a claim, and the writer must still know of the
    // file.
    (written ? all.written : all.read).insert(file);
    if ((written ? all.read : all.written).contains(file))
        throw InputError(path.string() +
                         ": is read by this run, and its results would overwrite it; choose another path for them");
}

}  // namespace

FilesOfRun::FilesOfRun() {
    const std::lock_guard lock(noted_mutex);
    noted_by_run.emplace_back();
}

FilesOfRun::~FilesOfRun() {
    const std::lock_guard lock(noted_mutex);
    noted_by_run.pop_back();
}

void note_read(const std::filesystem::path& path) { note(path, false); }
void note_written(const std::filesystem::path& path) { note(path, true); }

}  // namespace lostbits::scene::toml
