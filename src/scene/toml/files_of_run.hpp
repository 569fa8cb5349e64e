// What a run reads it does not write: no scene, sweep, claim, file of rays or library ends as somebody's results.
#pragma once

#include <filesystem>

namespace lostbits::scene::toml {

/// While one lives, the readers note what is read and the writers what is written; without one nothing is noted. Of
/// several the youngest counts.
///
/// Files are told apart by device and number, so a link or another way to write a path leads to the same file. Devices,
/// pipes and what does not exist yet are nobody's.
class FilesOfRun {
public:
    FilesOfRun();
    ~FilesOfRun();
    FilesOfRun(const FilesOfRun&) = delete;
    FilesOfRun& operator=(const FilesOfRun&) = delete;
};

/// Of a reader, before it reads. InputError where the run writes that file.
void note_read(const std::filesystem::path& path);

/// Of a writer, before it replaces or removes what is there. InputError where the run reads that file.
void note_written(const std::filesystem::path& path);

}  // namespace lostbits::scene::toml
