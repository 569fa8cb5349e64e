// A new folder for the temporary files of a run, and the message if no folder can be made.
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

/// Makes a folder named `NAME-` and six letters in the system's folder for temporary files; the caller removes it.
/// Throws EnvironmentError, which names TMPDIR.
[[nodiscard]] inline std::filesystem::path make_temporary_folder(std::string_view name) {
    const char* const tmpdir = std::getenv("TMPDIR");
    const std::filesystem::path parent = tmpdir != nullptr ? tmpdir : "/tmp";
    const std::string parent_text = tmpdir != nullptr ? "TMPDIR=" + std::string(tmpdir) : "TMPDIR is not set, and /tmp";
    std::string path = (parent / name).string() + "-XXXXXX";
    if (mkdtemp(path.data()) == nullptr)
        throw EnvironmentError(parent_text + ": no folder can be made there: " + std::strerror(errno) +
                               "; set TMPDIR to a folder that you may write to");
    return path;
}

/// A temporary folder that is removed with its contents when this object is destroyed.
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

/// True if the library loader failed for lack of memory. The loader does not say why it could not map a file. If the
/// address space has a limit (`ulimit -v`), the limit is the reason.
[[nodiscard]] inline bool lacks_memory(std::string_view loader_error) {
    const auto contains = [&](const char* part) { return loader_error.find(part) != std::string_view::npos; };
    rlimit limit{};
    const bool is_limited = ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
    return contains("annot allocate memory") ||
           (is_limited && (contains("failed to map segment") || contains("zero-fill pages")));
}

}  // namespace lostbits::intersect::device
