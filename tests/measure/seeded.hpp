// Random numbers that are the same on every standard library, and neighbours in a stored format. C++ leaves open
// which operand of + is evaluated first, so no expression outside braces draws twice.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>

#include "number/format.hpp"
#include "shapes/box/box.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits::test {

/// The engine's sequence is fixed by the standard; its distributions are not, so these are ours.
class Seeded {
public:
    explicit Seeded(std::uint64_t seed) : engine_(seed) {}

    std::uint64_t bits(int n) { return engine_() >> (64 - n); }
    std::int64_t integer(std::int64_t low, std::int64_t high) {
        return low + static_cast<std::int64_t>(engine_() % static_cast<std::uint64_t>(high - low + 1));
    }
    int index(int n) { return static_cast<int>(integer(0, n - 1)); }
    bool coin() { return bits(1) != 0; }
    double sign() { return coin() ? 1 : -1; }
    /// ±2^j with j below n.
    std::int64_t signed_power(int n) {
        const std::int64_t size = std::int64_t{1} << index(n);
        return coin() ? size : -size;
    }
    double unit() { return std::ldexp(static_cast<double>(bits(53)), -53); }
    double uniform(double low, double high) { return low + (high - low) * unit(); }
    /// 2^e·[1, 2) with e drawn from low..high, in all bits of a double.
    double magnitude(int low, int high) {
        const double significand = std::ldexp(static_cast<double>((std::uint64_t{1} << 52) + bits(52)), -52);
        return std::ldexp(significand, static_cast<int>(integer(low, high)));
    }
    double signed_magnitude(int low, int high) {
        const double size = magnitude(low, high);
        return coin() ? size : -size;
    }
    Vec<double> vec(double low, double high) {
        const double x = uniform(low, high), y = uniform(low, high), z = uniform(low, high);
        return {x, y, z};
    }

private:
    std::mt19937_64 engine_;
};

/// x in the storage format: binary32 or binary64.
inline double stored(double x, const FloatFormat& format) {
    return format == binary32 ? static_cast<double>(static_cast<float>(x)) : x;
}
inline Vec<double> stored(const Vec<double>& v, const FloatFormat& format) {
    return {stored(v.x, format), stored(v.y, format), stored(v.z, format)};
}

/// The stored number `ulps` places further from zero (nearer if negative); stays finite and keeps its sign.
inline double nudge(double x, std::int64_t ulps, const FloatFormat& format) {
    if (format == binary32) {
        const auto size =
            static_cast<std::int64_t>(std::bit_cast<std::uint32_t>(static_cast<float>(std::fabs(x)))) + ulps;
        const std::int64_t inside = std::clamp<std::int64_t>(size, 0, 0x7f7fffff);
        return std::copysign(static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(inside))), x);
    }
    const auto size = std::bit_cast<std::int64_t>(std::fabs(x)) + ulps;
    return std::copysign(std::bit_cast<double>(std::clamp<std::int64_t>(size, 0, 0x7fefffffffffffff)), x);
}

}  // namespace lostbits::test
