// Parts shared by the files of the image module; no other part of the program includes it. The header also checks what
// an EXR file must hold before the library reads it, because the library allocates memory for whatever a header claims.
// Layout: https://openexr.com/en/latest/OpenEXRFileLayout.html.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "intersect/process/floating_point.hpp"
#include "number/error.hpp"
#include "output/file/machine.hpp"
#include "output/image/image.hpp"

namespace lostbits::output::image {

/// Guard for every call of the library.
using intersect::process::FloatingPointGuard;

/// Implementations of ImageBackend::render_text, cover and write_pdf.
[[nodiscard]] TextBitmap cairo_text(std::string_view utf8, int size, FontWeight weight);
[[nodiscard]] std::vector<std::uint8_t> cairo_coverage(std::span<const Figure> figures, const PixelBox& box);
void cairo_pdf(file::ByteSink& sink, const Canvas& canvas, const FileMetadata& metadata);

/// Product of two sizes, or the largest number if it overflows: 2^30 × 2^30 pixels of 16 bytes would wrap to 0.
inline std::uint64_t saturating_product(std::uint64_t a, std::uint64_t b) {
    constexpr auto largest = std::numeric_limits<std::uint64_t>::max();
    return b != 0 && a > largest / b ? largest : a * b;
}

/// Size of a picture as its header claims it.
struct ClaimedPixels {
    std::uint64_t width = 0, height = 0, bytes_each = 0;
    std::uint64_t max_growth = 0;  ///< largest number of bytes that one byte of the file can become; 0: unknown
};

/// Refuses a header that claims more pixels than the file can hold (InputError) or this machine can hold
/// (EnvironmentError), before anything is allocated. `copies` of the pixels are in memory at a time.
inline void require_pixel_memory(const std::filesystem::path& path, const ClaimedPixels& pixels,
                                 std::uint64_t copy_count) {
    const std::uint64_t bytes = saturating_product(saturating_product(pixels.width, pixels.height), pixels.bytes_each);
    std::error_code error;
    const std::uint64_t file_bytes = std::filesystem::file_size(path, error), max_growth = pixels.max_growth;
    const std::string claim_text = path.string() + ": claims " + std::to_string(pixels.width) + "x" +
                                   std::to_string(pixels.height) + " pixels of " + std::to_string(pixels.bytes_each) +
                                   " bytes, " + file::bytes_text(bytes);
    if (!error && max_growth > 0 && bytes / max_growth > file_bytes)
        throw InputError(claim_text + ", which no file of " + file::bytes_text(file_bytes) +
                         " can hold; give one that is complete");
    file::require_memory(saturating_product(bytes, copy_count), claim_text,
                         "compare smaller pictures, or on a larger machine");
}

/// Reads the headers of an EXR file. Throws InputError if an attribute, or the table of block offsets, reaches beyond
/// the end of the file, and the errors of `require_pixel_memory`.
class ExrHeads {
public:
    explicit ExrHeads(const std::filesystem::path& path) : path_(path), in_(path, std::ios::binary) {
        std::error_code error;
        file_bytes_ = std::filesystem::file_size(path, error);
        if (!in_ || error) throw InputError(path.string() + ": cannot read; give an existing openexr file");
        if (read_number(4) != 20000630) throw InputError(path.string() + ": is not an openexr file");
        version_ = read_number(4);

        std::uint64_t blocks = 0;
        for (bool is_first = true, has_several_parts = (version_ & 0x1000U) != 0; is_first || has_several_parts;
             is_first = false) {
            const Head head = read_head();
            if (head.is_empty) break;
            blocks += block_count(head);
            pixels_ += saturating_product(head.pixels.width, head.pixels.height);
            require_pixel_memory(path_, head.pixels, 1);
        }
        if (saturating_product(blocks, 8) > file_bytes_ - position_) fail_cut_off();
    }
    /// Number of pixels of all parts together.
    [[nodiscard]] std::uint64_t pixels() const { return pixels_; }

private:
    struct Head {
        bool is_empty = true;
        ClaimedPixels pixels = {};
        unsigned compression = 0;
        bool is_tiled = false;
        std::uint64_t tile_width = 1, tile_height = 1;
    };

    /// Largest growth of a byte of the file, and lines per block, for each compression in OpenEXR's order: none, RLE
    /// (two bytes for 128), ZIP of one line and of 16 (deflate's longest match takes two bits, RFC 1951), PIZ, PXR24,
    /// B44, B44A, DWAA, DWAB.
    static constexpr std::array<unsigned, 10> max_growths{1, 64, 1032, 1032, 0, 0, 0, 0, 0, 0},
        block_lines{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

    /// Number of bytes of a value, for each type of attribute whose values all have the same size.
    static constexpr std::array<std::pair<std::string_view, unsigned>, 24> type_sizes{{{"box2f", 16},
                                                                                       {"box2i", 16},
                                                                                       {"chromaticities", 32},
                                                                                       {"compression", 1},
                                                                                       {"deepImageState", 1},
                                                                                       {"double", 8},
                                                                                       {"envmap", 1},
                                                                                       {"float", 4},
                                                                                       {"int", 4},
                                                                                       {"keycode", 28},
                                                                                       {"lineOrder", 1},
                                                                                       {"m33d", 72},
                                                                                       {"m33f", 36},
                                                                                       {"m44d", 128},
                                                                                       {"m44f", 64},
                                                                                       {"rational", 8},
                                                                                       {"tiledesc", 9},
                                                                                       {"timecode", 8},
                                                                                       {"v2d", 16},
                                                                                       {"v2f", 8},
                                                                                       {"v2i", 8},
                                                                                       {"v3d", 24},
                                                                                       {"v3f", 12},
                                                                                       {"v3i", 12}}};
    static constexpr auto not_found = std::string::npos;

    [[noreturn]] void fail_cut_off() const {
        throw InputError(path_.string() + ": the file is cut off, or its header is damaged; give a complete file");
    }
    std::uint64_t read_number(std::uint64_t bytes) {
        std::array<unsigned char, 8> raw{};
        if (bytes > file_bytes_ - position_ ||
            !in_.read(reinterpret_cast<char*>(raw.data()), static_cast<std::streamsize>(bytes)))
            fail_cut_off();
        position_ += bytes;
        std::uint64_t value = 0;
        for (std::uint64_t i = bytes; i-- > 0;) value = value << 8 | raw[i];
        return value;
    }
    std::string read_name() {
        std::string text;
        for (std::uint64_t c = read_number(1); c != 0; c = read_number(1)) {
            text += static_cast<char>(c);
            if (text.size() > 255) fail_cut_off();
        }
        return text;
    }
    Head read_head() {
        Head head;
        head.is_tiled = (version_ & 0x200U) != 0;
        for (std::string attribute = read_name(); !attribute.empty(); attribute = read_name()) {
            head.is_empty = false;
            const std::string type = read_name();
            const std::uint64_t bytes = read_number(4), begin = position_, end = position_ + bytes;
            if (bytes > file_bytes_ - position_) fail_cut_off();
            require_value(type, bytes);

            // The attributes that tell how many pixels and blocks the part has.
            seek_to(begin);
            if (attribute == "channels") head.pixels.bytes_each = pixel_bytes(end);
            if (attribute == "compression" && bytes == 1) head.compression = static_cast<unsigned>(read_number(1));
            if (attribute == "dataWindow" && bytes == 16) read_window(head.pixels);
            if (attribute == "tiles" && bytes == 9) {
                head.tile_width = read_number(4);
                head.tile_height = read_number(4);
            }
            if (attribute == "type" && (version_ & 0x1000U) != 0)
                head.is_tiled = read_text(bytes).find("tile") != not_found;
            seek_to(end);
        }
        if (head.compression < max_growths.size()) head.pixels.max_growth = max_growths[head.compression];
        return head;
    }
    /// Checks the size of a value. The library reads the size that the type has, whatever the header says, and
    /// allocates memory for lengths inside the value.
    void require_value(const std::string& type, std::uint64_t bytes) {
        const auto fixed_size = std::ranges::find(type_sizes, type, &std::pair<std::string_view, unsigned>::first);
        if (fixed_size != type_sizes.end() && fixed_size->second != bytes) fail_cut_off();

        const std::uint64_t end = position_ + bytes;
        if (type == "chlist") static_cast<void>(pixel_bytes(end));
        if (type == "preview") {
            const std::uint64_t width = read_number(4), height = read_number(4);
            if (saturating_product(saturating_product(width, height), 4) != end - position_) fail_cut_off();
        }
        if (type == "idmanifest" && read_number(4) / 1032 > bytes) fail_cut_off();
        while (type == "stringvector" && position_ < end) {
            const std::uint64_t length = read_number(4);
            if (position_ > end || length > end - position_) fail_cut_off();
            seek_to(position_ + length);
        }
    }
    void seek_to(std::uint64_t position) {
        position_ = position;
        in_.seekg(static_cast<std::streamoff>(position));
    }
    std::string read_text(std::uint64_t bytes) {
        std::string content(bytes, '\0');
        if (!in_.read(content.data(), static_cast<std::streamsize>(bytes))) fail_cut_off();
        position_ += bytes;
        return content;
    }
    /// Bytes per pixel of a list of channels. A channel is a name, a type (HALF is 1) and 12 more bytes; an empty name
    /// ends the list.
    std::uint64_t pixel_bytes(std::uint64_t end) {
        std::uint64_t bytes = 0;
        while (!read_name().empty()) {
            const std::uint64_t type = read_number(4);
            if (type > 2) fail_cut_off();  // OpenImageIO 2.4 aborts
            bytes += type == 1 ? 2 : 4;
            static_cast<void>(read_text(12));
        }
        if (position_ != end) fail_cut_off();
        return bytes;
    }
    void read_window(ClaimedPixels& pixels) {
        std::array<std::int64_t, 4> corners{};
        for (std::int64_t& x : corners) x = static_cast<std::int32_t>(read_number(4));
        pixels.width = static_cast<std::uint64_t>(std::max<std::int64_t>(corners[2] - corners[0] + 1, 0));
        pixels.height = static_cast<std::uint64_t>(std::max<std::int64_t>(corners[3] - corners[1] + 1, 0));
    }
    static std::uint64_t block_count(const Head& head) {
        const auto count_pieces = [](std::uint64_t length, std::uint64_t piece_length) {
            return (length + std::max<std::uint64_t>(piece_length, 1) - 1) / std::max<std::uint64_t>(piece_length, 1);
        };
        if (head.is_tiled)
            return saturating_product(count_pieces(head.pixels.width, head.tile_width),
                                      count_pieces(head.pixels.height, head.tile_height));
        return count_pieces(head.pixels.height,
                            head.compression < block_lines.size() ? block_lines[head.compression] : 256);
    }

    std::filesystem::path path_;
    std::ifstream in_;
    std::uint64_t file_bytes_ = 0, position_ = 0, version_ = 0, pixels_ = 0;
};

}  // namespace lostbits::output::image
