// Bytes for a page that must open from a file: shuffled into planes, deflated, in base64.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lostbits::output::page {

/// Numbers of one width, a pixel each, gathered before they are packed.
class Layer {
public:
    /// `width` bytes a number: 1, 2, 4 or 8.
    Layer(std::size_t width, std::size_t count) : width_(width), count_(count), planes_(width * count) {}

    /// Byte k of every number lies in plane k, lowest first: neighbours' high bytes are alike, and deflate sees them
    /// side by side.
    void set(std::size_t i, std::uint64_t bits) {
        for (std::size_t k = 0; k < width_; ++k) planes_[k * count_ + i] = static_cast<char>(bits >> (8 * k));
    }
    void set(std::size_t i, float value) { set(i, std::uint64_t{std::bit_cast<std::uint32_t>(value)}); }
    void set(std::size_t i, double value) { set(i, std::bit_cast<std::uint64_t>(value)); }

    [[nodiscard]] std::size_t width() const { return width_; }
    [[nodiscard]] std::string_view planes() const { return {planes_.data(), planes_.size()}; }

private:
    std::size_t width_, count_;
    std::vector<char> planes_;
};

/// `bytes` deflated (zlib's framing, which DecompressionStream("deflate") reads), in base64 without line breaks.
[[nodiscard]] std::string pack(std::string_view bytes);

/// RFC 4648, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

/// `a` − `b` of two bit patterns of `width` bytes, folded so that small differences of either sign are small numbers:
/// 0, −1, 1, −2, … become 0, 1, 2, 3, ….
[[nodiscard]] constexpr std::uint64_t folded_difference(std::uint64_t a, std::uint64_t b, int width) {
    const std::uint64_t all = width == 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << (8 * width)) - 1;
    const std::uint64_t d = (a - b) & all;
    const bool negative = (d >> (8 * width - 1)) & 1;
    return ((d << 1) & all) ^ (negative ? all : 0);
}

/// Numbers of neighbouring true hits lie nearly on a line: of each is kept how far its bits are from where the two
/// before it point to, in its row of the picture. A band holds whole rows, so within one no neighbour is missing.
class LineOfHits {
public:
    void begin_row() { last_ = before_ = 0; }
    [[nodiscard]] std::uint64_t take(std::uint64_t bits, int width) {
        const std::uint64_t off = folded_difference(bits, before_ == 0 ? last_ : 2 * last_ - before_, width);
        before_ = last_;
        last_ = bits;
        return off;
    }

private:
    std::uint64_t last_ = 0, before_ = 0;  ///< bits of the two before; 0: none
};

}  // namespace lostbits::output::page
