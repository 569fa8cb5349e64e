// Reads the bytes of a file or a pipe, a piece at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "intersect/process/stop_token.hpp"

namespace lostbits::scene::toml {

/// The kinds of files that may be opened: `files` have a size and an end; `any` adds pipes and devices.
enum class AllowedFiles { any, files };

/// A file that is open as long as the object lives. Throws InputError if the file does not exist or is of another
/// kind, EnvironmentError if the machine cannot read it, and Interrupted if it is stopped, also while a pipe has no
/// bytes yet.
class ByteSource {
public:
    ByteSource(const std::filesystem::path& path, intersect::process::StopToken stop,
               AllowedFiles allowed_files = AllowedFiles::any);
    ~ByteSource();
    ByteSource(const ByteSource&) = delete;
    ByteSource& operator=(const ByteSource&) = delete;

    [[nodiscard]] const std::string& name() const { return name_; }
    /// Size of a regular file; nothing for a pipe.
    [[nodiscard]] std::optional<std::uint64_t> size() const { return size_; }
    /// Appends up to `max_bytes` of the next bytes to `buffer`. Returns the number of bytes, which is less than
    /// `max_bytes` only at the end.
    std::size_t read(std::string& buffer, std::size_t max_bytes);
    /// Appends up to `max_bytes` bytes from an offset in a regular file. Returns the number of bytes, as `read` does.
    std::size_t read_at(std::uint64_t offset, std::string& buffer, std::size_t max_bytes) const;

private:
    void open(AllowedFiles allowed_files);
    [[noreturn]] void fail(const std::string& what) const;
    /// Appends up to `max_bytes` bytes to `buffer`. Calls `read_some(destination, size, bytes_read)` until it returns
    /// 0.
    template <class ReadSome>
    std::size_t fill(std::string& buffer, std::size_t max_bytes, const ReadSome& read_some) const;

    std::string name_;
    intersect::process::StopToken stop_;
    int fd_ = -1;
    std::optional<std::uint64_t> size_;
};

}  // namespace lostbits::scene::toml
