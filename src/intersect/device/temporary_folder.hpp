// A new folder for temporary files of a run, and the message if none can be made.
#pragma once

#include <sys/resource.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "number/error.hpp"

namespace lostbits::intersect::device {

/// Makes `NAME-` and six letters in the system's folder for temporary files; the caller removes it. EnvironmentError,
/// which names TMPDIR.
[[nodiscard]] inline std::filesystem::path make_temporary_folder(std::string_view name) {
    const char* const wanted = std::getenv("TMPDIR");
    const std::filesystem::path place = wanted != nullptr ? wanted : "/tmp";
    const std::string where = wanted != nullptr ? "TMPDIR=" + std::string(wanted) : "TMPDIR is not set, and /tmp";
    std::string path = (place / name).string() + "-XXXXXX";
    if (mkdtemp(path.data()) == nullptr)
        throw EnvironmentError(where + ": no folder can be made there: " + std::strerror(errno) +
                               "; set TMPDIR to a folder that you may write to");
    return path;
}

/// A temporary folder that is removed with its contents at the end.
class TemporaryFolder {
public:
    explicit TemporaryFolder(std::string_view name) : path(make_temporary_folder(name)) {}
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path path;
};

/// True if the library loader failed for lack of memory. It does not say why it could not map a file: under a limit of
/// the address space (`ulimit -v`) that limit is the reason.
[[nodiscard]] inline bool lacks_memory(std::string_view loader_words) {
    const auto says = [&](const char* words) { return loader_words.find(words) != std::string_view::npos; };
    rlimit limit{};
    const bool limited = ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
    return says("annot allocate memory") || (limited && (says("failed to map segment") || says("zero-fill pages")));
}

}  // namespace lostbits::intersect::device
