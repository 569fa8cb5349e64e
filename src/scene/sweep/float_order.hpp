// Orders all 2^32 bit patterns of binary32, and groups them into binades.
#pragma once

#include <bit>
#include <cstdint>
#include <string>

namespace lostbits::scene::sweep {

/// Index of a float in the order of all floats: by value, with −0 just before +0. NaNs with a sign come before −∞, the
/// other NaNs after +∞, both ordered by payload. Every 32-bit number is the index of exactly one float.
constexpr std::uint32_t index_of(float x) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return (bits >> 31) != 0 ? ~bits : bits | 0x80000000U;
}
constexpr float float_at(std::uint32_t index) {
    return std::bit_cast<float>((index >> 31) != 0 ? index & 0x7fffffffU : ~index);
}

/// Floats of one sign and one exponent. The subnormals, each zero, each infinity and the NaNs of a sign are binades of
/// their own.
struct Binade {
    enum class Kind { zero, subnormal, normal, infinite, not_a_number };

    Kind kind = Kind::zero;
    bool negative = false;
    int exponent = 0;                 ///< of normal floats: 2^exponent ≤ |x| < 2^(exponent + 1)
    std::uint32_t low = 0, high = 0;  ///< indices of its first and its last float

    /// `+2^-3`, `-subnormal`, `+0`, `-inf`, `+nan`.
    [[nodiscard]] std::string name() const;
};

Binade binade_of(float x);

/// Floats in order from one to another, both included: upwards, or downwards if `last` comes before `first`.
struct FloatRange {
    std::uint32_t first = 0, last = 0;  ///< indices

    bool operator==(const FloatRange&) const = default;

    [[nodiscard]] bool falls() const { return last < first; }
    [[nodiscard]] std::uint64_t size() const { return std::uint64_t{1} + (falls() ? first - last : last - first); }
    /// Index after `steps` steps from `first`.
    [[nodiscard]] std::uint32_t at(std::uint64_t steps) const {
        const auto n = static_cast<std::uint32_t>(steps);
        return falls() ? first - n : first + n;
    }
    /// Number of steps from `first` to an index.
    [[nodiscard]] std::uint64_t steps_to(std::uint32_t index) const { return falls() ? first - index : index - first; }
};

}  // namespace lostbits::scene::sweep
