// The bytes of a mesh file, as lines or as pieces of a given size, with their position. Files may be of any size: one
// block at a time is in memory.
#pragma once

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "number/error.hpp"
#include "scene/toml/byte_source.hpp"

namespace lostbits::scene::triangle {

/// Reads the file, and checks the stop token before each block. Views that it returns are valid until the next call.
class MeshBytes {
public:
    /// Throws InputError if the path is not a file: a folder, a pipe, a device.
    MeshBytes(const std::filesystem::path& path, intersect::process::StopToken stop)
        : source_(path, stop, toml::Opens::files) {}

    [[nodiscard]] const std::string& name() const { return source_.name(); }
    [[nodiscard]] std::uint64_t size() const { return *source_.size(); }
    /// Position of the next byte, from 0.
    [[nodiscard]] std::uint64_t place() const { return passed_ + begin_; }
    /// Number of bytes that are still to be read.
    [[nodiscard]] std::uint64_t left() const { return size() - std::min(size(), place()); }

    /// Returns the next `count` bytes; fewer only at the end.
    std::string_view take(std::size_t count) {
        while (buffer_.size() - begin_ < count && read_more()) {}
        const std::string_view taken = std::string_view(buffer_).substr(begin_, count);
        begin_ += taken.size();
        return taken;
    }
    /// Returns the next bytes without consuming them.
    std::string_view look(std::size_t count) {
        const std::string_view seen = take(count);
        begin_ -= seen.size();
        return seen;
    }
    /// Reads the next line without its break, cut after `longest` + 1 bytes. Returns false after the last line.
    bool take_line(std::string_view& line, std::size_t longest) {
        std::size_t looked = 0;
        while (true) {
            const char* const from = buffer_.data() + begin_;
            const std::size_t there = buffer_.size() - begin_;
            const void* const found = std::memchr(from + looked, '\n', there - looked);
            const std::size_t end = found ? static_cast<std::size_t>(static_cast<const char*>(found) - from) : there;
            if (found || end > longest) {
                line = std::string_view(from, std::min(end, longest + 1));
                begin_ += line.size() + (found && line.size() == end ? 1 : 0);
                return true;
            }
            looked = there;
            if (read_more()) continue;
            line = std::string_view(buffer_).substr(begin_);
            begin_ = buffer_.size();
            return !line.empty();
        }
    }

private:
    /// Returns false at the end of the file.
    bool read_more() {
        constexpr std::size_t block = std::size_t{1} << 20;
        buffer_.erase(0, begin_);
        passed_ += begin_;
        begin_ = 0;
        return source_.read(buffer_, block) > 0;
    }

    toml::ByteSource source_;
    std::string buffer_;
    std::size_t begin_ = 0;     ///< start of the bytes that are not consumed yet
    std::uint64_t passed_ = 0;  ///< number of bytes before those of the buffer
};

}  // namespace lostbits::scene::triangle
