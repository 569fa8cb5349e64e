// Memory and open files that this machine has left for a run. All in a header, because the image module does not link
// the program.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "number/error.hpp"

namespace lostbits::output::file {

/// The number after a word such as `MemAvailable:` in a file of /proc or /sys; `otherwise` if there is none.
inline std::uint64_t number_behind(const char* path, const std::string& word, std::uint64_t otherwise) {
    std::ifstream in(path);
    for (std::string read; in >> read;) {
        std::uint64_t number = 0;
        if (read == word && in >> number) return number;
    }
    return otherwise;
}

/// Bytes of memory that this process may still take: the least of the free memory, the limit of the control group and
/// that of RLIMIT_AS (`ulimit -v`), as far as the system reports them.
inline std::uint64_t free_memory() {
    constexpr auto all = std::numeric_limits<std::uint64_t>::max();
    const auto kib = number_behind("/proc/meminfo", "MemAvailable:", all / 1024);
    std::uint64_t left = kib * 1024;
    std::ifstream group("/sys/fs/cgroup/memory.max"), taken("/sys/fs/cgroup/memory.current");
    std::uint64_t most = 0, now = 0;
    if (group >> most && taken >> now) left = std::min(left, most > now ? most - now : 0);
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
        std::uint64_t pages = 0;
        std::ifstream("/proc/self/statm") >> pages;
        const auto used = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
        left = std::min<std::uint64_t>(left, limit.rlim_cur > used ? limit.rlim_cur - used : 0);
    }
    return left;
}

/// Number of bytes as text: `1.5 GB`.
inline std::string bytes_text(std::uint64_t bytes) {
    constexpr std::array<const char*, 6> units{" bytes", " kB", " MB", " GB", " TB", " PB"};
    std::size_t unit = 0;
    auto value = static_cast<double>(bytes);
    for (; value >= 1000 && unit + 1 < units.size(); ++unit) value /= 1000;
    const auto tenths = static_cast<std::uint64_t>(value * 10);
    return std::to_string(tenths / 10) + (unit > 0 && tenths < 100 ? "." + std::to_string(tenths % 10) : "") +
           units[unit];
}

/// Throws EnvironmentError if this machine has less memory left.
inline void require_memory(std::uint64_t bytes, const std::string& what, const std::string& remedy) {
    const std::uint64_t left = free_memory();
    if (bytes <= left) return;
    throw EnvironmentError(what + ": needs " + bytes_text(bytes) + " of memory, but only " + bytes_text(left) +
                           " is free; " + remedy);
}

/// Throws EnvironmentError if this process may not open this number of further files, or lacks the memory for their
/// buffers: 256 KiB each, and a little more. A few files are reserved for libraries.
inline void require_open_files(std::uint64_t files, const std::string& what, const std::string& remedy) {
    constexpr std::uint64_t spare = 16, bytes_each = 288 * 1024;
    std::error_code unknown;
    std::uint64_t open = 0;
    for (auto at = std::filesystem::directory_iterator("/proc/self/fd", unknown);
         at != std::filesystem::directory_iterator(); at.increment(unknown))
        ++open;
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
        files + open + spare > limit.rlim_cur)
        throw EnvironmentError(what + ": writes " + std::to_string(files) +
                               " files at once, but this machine allows a process only " +
                               std::to_string(limit.rlim_cur) + " open files (`ulimit -n`); " + remedy);
    require_memory(files * bytes_each, what + ": writes " + std::to_string(files) + " files at once", remedy);
}

}  // namespace lostbits::output::file
