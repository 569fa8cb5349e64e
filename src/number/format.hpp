// Floating-point formats, each by its three parameters: the set of possible results, whatever computes them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lostbits {

/// A binary format: significand width p with the leading bit, and the exponents of its normal numbers
/// (2^emin is the smallest normal, (2 - 2^(1-p))·2^emax the largest finite number).
struct FloatFormat {
    int precision;
    int emin;
    int emax;
    friend constexpr bool operator==(const FloatFormat&, const FloatFormat&) = default;
};

inline constexpr FloatFormat binary16{11, -14, 15};
inline constexpr FloatFormat bfloat16{8, -126, 127};
inline constexpr FloatFormat tensor_float32{11, -126, 127};
inline constexpr FloatFormat binary32{24, -126, 127};
inline constexpr FloatFormat binary64{53, -1022, 1023};

/// Exponent of the unit in the last place of a format at x, which is 2^(max(⌊log2|x|⌋, emin) − p + 1). `floor_log2_x`
/// is ⌊log2|x|⌋, or any very negative number for x = 0.
constexpr long ulp_exponent(const FloatFormat& format, long floor_log2_x) {
    return (floor_log2_x > format.emin ? floor_log2_x : format.emin) - format.precision + 1;
}

/// A format and how a form is evaluated in it: natively, or through `Rounded` in a format of any width.
struct Format {
    enum class Engine { native32, native64, rounded };
    std::string name;
    FloatFormat parameters;
    Engine engine;

    /// True if software rounds every operation to the format. A time in it says nothing about a machine.
    [[nodiscard]] bool is_emulated() const { return engine == Engine::rounded; }
    friend bool operator==(const Format&, const Format&) = default;
};

/// Finds `f32`, `f64`, `bf16`, `fp16`, `tf32`, or `pN` (2 ≤ N ≤ 53: N significand bits with binary64's exponents).
/// Returns nothing for any other name.
std::optional<Format> find_format(std::string_view name);

/// The names that `lostbits list formats` shows, each with a line of explanation.
struct FormatDescription {
    std::string_view name, meaning;
};
inline constexpr FormatDescription format_descriptions[] = {
    {"f32", "IEEE 754 binary32, the machine's float: 24 bits"},
    {"f64", "IEEE 754 binary64, the machine's double: 53 bits"},
    {"fp16", "IEEE 754 binary16 (half): 11 bits, exponents -14..15"},
    {"bf16", "bfloat16: 8 bits, exponents of binary32"},
    {"tf32", "TensorFloat-32: 11 bits, exponents of binary32"},
    {"pN", "N significand bits (2 to 53), exponents of binary64; p5..p12 names a range"},
};

}  // namespace lostbits
