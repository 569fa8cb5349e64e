// Options that name files to write, of which no two may be one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lostbits::analysis::shell {

/// The path of a file, whether it is there or not. (Where none of its folders is, weakly_canonical alone leaves a
/// relative path as it is.)
[[nodiscard]] std::filesystem::path place_of(const std::string& file);

/// An option, and what it names; empty where it was not given.
struct NamedFile {
    const char* option;
    std::string file;
};

/// InputError where two options name one file, of which the later would overwrite the earlier, or one lies in `folder`,
/// among whose files it may come to be.
void require_different_files(const std::vector<NamedFile>& files, const NamedFile& folder);

}  // namespace lostbits::analysis::shell
