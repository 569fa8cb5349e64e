// Integers with a fixed number of words, which are many times as fast as integers of any length.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lostbits::exact {

using Int128 = __int128;
inline int sign(Int128 x) { return (x > 0) - (x < 0); }

/// Two's complement in words of 64 bits, the lowest first. Sums and products are right while they fit.
template <std::size_t N>
class Fixed {
public:
    Fixed() = default;
    explicit Fixed(Int128 x) {
        words_.fill(x < 0 ? ~std::uint64_t{0} : 0);
        words_[0] = static_cast<std::uint64_t>(x), words_[1] = static_cast<std::uint64_t>(x >> 64);
    }
    friend Fixed operator+(Fixed a, const Fixed& b) {
        Wide sum = 0;
        for (std::size_t i = 0; i < N; ++i) {
            sum += Wide{a.words_[i]} + b.words_[i];
            a.words_[i] = static_cast<std::uint64_t>(sum), sum >>= 64;
        }
        return a;
    }
    friend Fixed operator-(Fixed a, const Fixed& b) {
        Wide difference = 0;
        for (std::size_t i = 0; i < N; ++i) {
            difference = Wide{a.words_[i]} - b.words_[i] - (difference >> 127);
            a.words_[i] = static_cast<std::uint64_t>(difference);
        }
        return a;
    }
    friend Fixed operator*(const Fixed& a, const Fixed& b) {
        Fixed c;
        for (std::size_t i = 0; i < N; ++i) {
            Wide sum = 0;
            for (std::size_t j = 0; i + j < N; ++j) {
                sum += Wide{a.words_[i]} * b.words_[j] + c.words_[i + j];
                c.words_[i + j] = static_cast<std::uint64_t>(sum), sum >>= 64;
            }
        }
        return c;
    }
    friend int sign(const Fixed& a) {
        if (a.words_[N - 1] >> 63 != 0) return -1;
        for (const std::uint64_t word : a.words_)
            if (word != 0) return 1;
        return 0;
    }

private:
    using Wide = unsigned __int128;
    std::array<std::uint64_t, N> words_{};
};

}  // namespace lostbits::exact
