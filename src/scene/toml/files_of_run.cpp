#include "scene/toml/files_of_run.hpp"

#include <sys/stat.h>

#include <mutex>
#include <set>
#include <utility>

#include "number/error.hpp"

namespace lostbits::scene::toml {

struct FilesOfRun::Noted {
    using File = std::pair<dev_t, ino_t>;
    std::set<File> read, written;
};

namespace {

std::mutex noted_mutex;

}  // namespace

FilesOfRun*& FilesOfRun::living() {
    static FilesOfRun* youngest = nullptr;
    return youngest;
}

FilesOfRun::FilesOfRun() : noted_(new Noted) {
    const std::lock_guard lock(noted_mutex);
    outer_ = std::exchange(living(), this);
}

FilesOfRun::~FilesOfRun() {
    const std::lock_guard lock(noted_mutex);
    living() = outer_;
    delete noted_;
}

void FilesOfRun::note(const std::filesystem::path& path, bool written) {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return;
    const Noted::File file{info.st_dev, info.st_ino};
    const std::lock_guard lock(noted_mutex);
    if (living() == nullptr) return;
    Noted& all = *living()->noted_;
    // Before the check: a reader's error may end as a claim's, and the writer is to know of it.
    (written ? all.written : all.read).insert(file);
    if ((written ? all.read : all.written).contains(file))
        throw InputError(path.string() +
                         ": is read by this run, whose results would take its place; choose another place for them");
}

void note_read(const std::filesystem::path& path) { FilesOfRun::note(path, false); }
void note_written(const std::filesystem::path& path) { FilesOfRun::note(path, true); }

}  // namespace lostbits::scene::toml
