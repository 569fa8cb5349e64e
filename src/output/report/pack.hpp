// Packs numbers into a page that a browser must open from a single file: their bytes are sorted into planes, deflated,
// and written in base64.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lostbits::output::report {

/// Numbers of the same size in bytes, one per pixel, collected before they are packed.
class Layer {
public:
    /// `number_bytes` is 1, 2, 4 or 8.
    Layer(std::size_t number_bytes, std::size_t number_count)
        : number_bytes_(number_bytes), number_count_(number_count), planes_(number_bytes * number_count) {}

    /// Plane k holds byte k of every number, the lowest byte first. High bytes of neighbours are alike, and this order
    /// puts them side by side for deflate.
    void set(std::size_t i, std::uint64_t bits) {
        for (std::size_t k = 0; k < number_bytes_; ++k)
            planes_[k * number_count_ + i] = static_cast<char>(bits >> (8 * k));
    }
    void set(std::size_t i, float value) { set(i, std::uint64_t{std::bit_cast<std::uint32_t>(value)}); }
    void set(std::size_t i, double value) { set(i, std::bit_cast<std::uint64_t>(value)); }

    [[nodiscard]] std::size_t number_bytes() const { return number_bytes_; }
    [[nodiscard]] std::string_view planes() const { return {planes_.data(), planes_.size()}; }

private:
    std::size_t number_bytes_, number_count_;
    std::vector<char> planes_;
};

/// Deflates `bytes` (zlib's framing, which DecompressionStream("deflate") reads) and encodes them in base64 without
/// line breaks.
[[nodiscard]] std::string pack(std::string_view bytes);

/// Difference `a` − `b` of two bit patterns of `number_bytes` bytes, folded so that small differences of either sign
/// become small numbers: 0, −1, 1, −2, … become 0, 1, 2, 3, ….
[[nodiscard]] constexpr std::uint64_t folded_difference(std::uint64_t a, std::uint64_t b, int number_bytes) {
    const std::uint64_t mask = number_bytes == 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << (8 * number_bytes)) - 1;
    const std::uint64_t difference = (a - b) & mask;
    const bool is_negative = (difference >> (8 * number_bytes - 1)) & 1;
    return ((difference << 1) & mask) ^ (is_negative ? mask : 0);
}

/// Predicts the numbers of true hits from their neighbours, because these lie nearly on a line. Each number becomes the
/// difference of its bits from the line through the two numbers before it in its row of the picture. A band holds whole
/// rows, so no neighbour is missing within a band.
class HitPredictor {
public:
    void begin_row() { last_bits_ = second_last_bits_ = 0; }
    [[nodiscard]] std::uint64_t encode(std::uint64_t bits, int number_bytes) {
        const std::uint64_t difference = folded_difference(
            bits, second_last_bits_ == 0 ? last_bits_ : 2 * last_bits_ - second_last_bits_, number_bytes);
        second_last_bits_ = last_bits_;
        last_bits_ = bits;
        return difference;
    }

private:
    std::uint64_t last_bits_ = 0, second_last_bits_ = 0;  ///< bits of the last two numbers; 0: none
};

}  // namespace lostbits::output::report
