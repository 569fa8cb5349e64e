// The bytes of a file or a pipe, a piece at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "intersect/process/stop_token.hpp"

namespace lostbits::scene::toml {

/// The kinds of files that are opened: `files` alone, which have a size and an end, or `any`, pipes and devices too.
enum class Opens { any, files };

/// Open while it lives. Throws InputError where there is no such file, or one of another kind, EnvironmentError where
/// the machine does not let us read it, Interrupted where the work is asked to end, also while a pipe has no bytes yet.
class ByteSource {
public:
    ByteSource(const std::filesystem::path& path, intersect::process::StopToken stop, Opens opens = Opens::any);
    ~ByteSource();
    ByteSource(const ByteSource&) = delete;
    ByteSource& operator=(const ByteSource&) = delete;

    [[nodiscard]] const std::string& name() const { return name_; }
    /// Of a regular file; nothing of a pipe.
    [[nodiscard]] std::optional<std::uint64_t> size() const { return size_; }
    /// Appends up to so many of the next bytes; the number of them, less at the end alone.
    std::size_t read(std::string& to, std::size_t most);
    /// Appends so many bytes from a place in a regular file; as above.
    std::size_t read_at(std::uint64_t place, std::string& to, std::size_t most) const;

private:
    void open(Opens opens);
    [[noreturn]] void fail(const std::string& what) const;
    /// Appends up to so many bytes; `read_some(buffer, size, got)` is asked for them until it has none.
    template <class ReadSome>
    std::size_t fill(std::string& to, std::size_t most, const ReadSome& read_some) const;

    std::string name_;
    intersect::process::StopToken stop_;
    int fd_ = -1;
    std::optional<std::uint64_t> size_;
};

}  // namespace lostbits::scene::toml
