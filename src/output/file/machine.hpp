// Memory and open files that this machine has left for a run. Everything is in this header, because the image module
// does not link the program.
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

/// Returns the number after a key such as `MemAvailable:` in a file of /proc or /sys; `fallback` if the file lacks the
/// key.
inline std::uint64_t number_after(const char* path, const std::string& key, std::uint64_t fallback) {
    std::ifstream in(path);
    for (std::string word; in >> word;) {
        std::uint64_t number = 0;
        if (word == key && in >> number) return number;
    }
    return fallback;
}

/// Bytes of memory that this process may still take: the least of the free memory, the limit of the control group and
/// the limit of RLIMIT_AS (`ulimit -v`), as far as the system reports them.
inline std::uint64_t free_memory() {
    constexpr auto unlimited = std::numeric_limits<std::uint64_t>::max();
    const auto kib = number_after("/proc/meminfo", "MemAvailable:", unlimited / 1024);
    std::uint64_t available = kib * 1024;

    std::ifstream group_limit("/sys/fs/cgroup/memory.max"), group_usage("/sys/fs/cgroup/memory.current");
    std::uint64_t limit_bytes = 0, used_bytes = 0;
    if (group_limit >> limit_bytes && group_usage >> used_bytes)
        available = std::min(available, limit_bytes > used_bytes ? limit_bytes - used_bytes : 0);

    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
        std::uint64_t pages = 0;
        std::ifstream("/proc/self/statm") >> pages;
        const auto used = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
        available = std::min<std::uint64_t>(available, limit.rlim_cur > used ? limit.rlim_cur - used : 0);
    }
    return available;
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

/// Throws EnvironmentError if this machine has less than `bytes` of memory left. The message begins with `subject` and
/// ends with `remedy`.
inline void require_memory(std::uint64_t bytes, const std::string& subject, const std::string& remedy) {
    const std::uint64_t available = free_memory();
    if (bytes <= available) return;
    throw EnvironmentError(subject + ": needs " + bytes_text(bytes) + " of memory, but only " + bytes_text(available) +
                           " is free; " + remedy);
}

/// Throws EnvironmentError if this process may not open `files` more files, or lacks the memory for their buffers: 256
/// KiB each, and a little more. A few files are reserved for libraries.
inline void require_open_files(std::uint64_t file_count, const std::string& subject, const std::string& remedy) {
    constexpr std::uint64_t reserved_file_count = 16, bytes_per_file = 288 * 1024;
    std::error_code error;
    std::uint64_t open_file_count = 0;
    for (auto entry = std::filesystem::directory_iterator("/proc/self/fd", error);
         entry != std::filesystem::directory_iterator(); entry.increment(error))
        ++open_file_count;

    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
        file_count + open_file_count + reserved_file_count > limit.rlim_cur)
        throw EnvironmentError(subject + ": writes " + std::to_string(file_count) +
                               " files at once, but this machine allows a process only " +
                               std::to_string(limit.rlim_cur) + " open files (`ulimit -n`); " + remedy);
    require_memory(file_count * bytes_per_file, subject + ": writes " + std::to_string(file_count) + " files at once",
                   remedy);
}

}  // namespace lostbits::output::file
