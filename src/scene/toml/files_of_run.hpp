// Prevents a run from writing a file that it reads, so that no scene, sweep, claim, file of rays or library is
// overwritten.
#pragma once

#include <filesystem>

namespace lostbits::scene::toml {

/// Records the files of a run. While a `FilesOfRun` exists, readers record the files that they read, and writers the
/// files that they write. If none exists, no file is recorded. If there are several, files are recorded in the
/// youngest.
///
/// Files are compared by device and inode number, so a link or another spelling of a path is the same file. Devices,
/// pipes and files that do not exist yet are not recorded.
class FilesOfRun {
public:
    FilesOfRun();
    ~FilesOfRun();
    FilesOfRun(const FilesOfRun&) = delete;
    FilesOfRun& operator=(const FilesOfRun&) = delete;
};

/// Called by a reader before it reads. Throws InputError if the run writes the same file.
void reserve_for_reading(const std::filesystem::path& path);

/// Called by a writer before it replaces or removes a file. Throws InputError if the run reads the same file.
void reserve_for_writing(const std::filesystem::path& path);

}  // namespace lostbits::scene::toml
