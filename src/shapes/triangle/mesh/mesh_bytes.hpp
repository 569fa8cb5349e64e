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

/// Reads a mesh file, and checks the stop token before each block. Returned views are valid until the next call.
class MeshBytes {
public:
    /// Throws InputError if the path is not a file: a folder, a pipe, a device.
    MeshBytes(const std::filesystem::path& path, intersect::process::StopToken stop)
        : source_(path, stop, toml::AllowedFiles::files) {}

    [[nodiscard]] const std::string& name() const { return source_.name(); }
    [[nodiscard]] std::uint64_t size() const { return *source_.size(); }
    /// Returns the position of the next byte, from 0.
    [[nodiscard]] std::uint64_t position() const { return dropped_count_ + begin_; }
    /// Returns the number of bytes that are not consumed yet.
    [[nodiscard]] std::uint64_t remaining() const { return size() - std::min(size(), position()); }

    /// Returns the next `count` bytes; fewer only at the end.
    std::string_view take(std::size_t count) {
        while (buffer_.size() - begin_ < count && read_more()) {}
        const std::string_view result = std::string_view(buffer_).substr(begin_, count);
        begin_ += result.size();
        return result;
    }
    /// Returns the next bytes without consuming them.
    std::string_view peek(std::size_t count) {
        const std::string_view result = take(count);
        begin_ -= result.size();
        return result;
    }
    /// Reads the next line without its break, cut after `longest` + 1 bytes. Returns false after the last line.
    bool take_line(std::string_view& line, std::size_t longest) {
        std::size_t searched = 0;
        while (true) {
            const char* const line_start = buffer_.data() + begin_;
            const std::size_t available = buffer_.size() - begin_;
            const void* const line_break = std::memchr(line_start + searched, '\n', available - searched);
            const std::size_t end =
                line_break ? static_cast<std::size_t>(static_cast<const char*>(line_break) - line_start) : available;
            if (line_break || end > longest) {
                line = std::string_view(line_start, std::min(end, longest + 1));
                begin_ += line.size() + (line_break && line.size() == end ? 1 : 0);
                return true;
            }

            // Reads more bytes, and searches only those.
            searched = available;
            if (read_more()) continue;
            line = std::string_view(buffer_).substr(begin_);
            begin_ = buffer_.size();
            return !line.empty();
        }
    }

private:
    /// Returns false at the end of the file.
    bool read_more() {
        constexpr std::size_t block_size = std::size_t{1} << 20;
        buffer_.erase(0, begin_);
        dropped_count_ += begin_;
        begin_ = 0;
        return source_.read(buffer_, block_size) > 0;
    }

    toml::ByteSource source_;
    std::string buffer_;
    std::size_t begin_ = 0;            ///< start of the bytes that are not consumed yet
    std::uint64_t dropped_count_ = 0;  ///< number of bytes of the file before the buffer
};

}  // namespace lostbits::scene::triangle
