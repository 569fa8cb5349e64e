// A binary format of four bits, small enough to try every pair of its numbers: each operation is done
// in double and rounded once (products of eight bits are exact there; quotients and roots of four bits are nearer to no
// tie than 2^-10 of themselves, so that rounding twice is rounding once).
#pragma once

#include <cmath>
#include <limits>

namespace lostbits::test {

class Tiny {
public:
    static constexpr int precision = 4, emin = -6, emax = 4;
    static constexpr double least = 0x1p-9, most = 30;  ///< the smallest subnormal; 1.875 · 2^4

    constexpr Tiny() = default;
    constexpr Tiny(int x) : Tiny(double{static_cast<double>(x)}) {}  // NOLINT: a formula's constants
    constexpr explicit Tiny(double x) : value_(rounded(x)) {}
    [[nodiscard]] constexpr double value() const { return value_; }
    constexpr explicit operator double() const { return value_; }

    friend constexpr Tiny operator-(Tiny a) { return Tiny(-a.value_); }
    friend constexpr Tiny operator+(Tiny a, Tiny b) { return Tiny(a.value_ + b.value_); }
    friend constexpr Tiny operator-(Tiny a, Tiny b) { return Tiny(a.value_ - b.value_); }
    friend constexpr Tiny operator*(Tiny a, Tiny b) { return Tiny(a.value_ * b.value_); }
    friend constexpr Tiny operator/(Tiny a, Tiny b) { return Tiny(a.value_ / b.value_); }
    friend constexpr bool operator==(Tiny a, Tiny b) { return a.value_ == b.value_; }
    friend constexpr bool operator<(Tiny a, Tiny b) { return a.value_ < b.value_; }
    friend constexpr bool operator>(Tiny a, Tiny b) { return a.value_ > b.value_; }
    friend constexpr bool operator<=(Tiny a, Tiny b) { return a.value_ <= b.value_; }
    friend constexpr bool operator>=(Tiny a, Tiny b) { return a.value_ >= b.value_; }
    friend Tiny abs(Tiny a) { return Tiny(std::fabs(a.value_)); }
    friend Tiny sqrt(Tiny a) { return Tiny(std::sqrt(a.value_)); }
    friend Tiny fma(Tiny a, Tiny b, Tiny c) { return Tiny(a.value_ * b.value_ + c.value_); }
    friend Tiny copysign(Tiny a, Tiny b) { return Tiny(std::copysign(a.value_, b.value_)); }
    friend Tiny next_up(Tiny a) {
        if (!(a.value_ < HUGE_VAL)) return a;
        if (a.value_ < -most) return Tiny(-most);
        // Half a last place of the smallest numbers is more than nothing for all inputs, and a whole last place for
        // none.
        for (double step = least;; step *= 2) {
            if (const Tiny next(a.value_ + step); next.value_ > a.value_) return next;
        }
    }

private:
    /// To nearest, ties to even. 1.5 · 2^(52 + k) has last place 2^k.
    static constexpr double rounded(double x) {
        const double size = x < 0 ? -x : x;
        if (size == 0 || !(size < std::numeric_limits<double>::infinity())) return x;
        if (size >= most + 1)
            return x < 0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
        double place = least;
        while (size >= 16 * place) place *= 2;
        const double magic = 0x1.8p52 * place, y = (size + magic) - magic;
        return x < 0 ? -y : y;
    }

    double value_ = 0;
};

}  // namespace lostbits::test

template <>
struct std::numeric_limits<lostbits::test::Tiny> {
    static constexpr lostbits::test::Tiny infinity() {
        return lostbits::test::Tiny(std::numeric_limits<double>::infinity());
    }
    static constexpr lostbits::test::Tiny epsilon() { return lostbits::test::Tiny(0x1p-3); }
    static constexpr lostbits::test::Tiny min() { return lostbits::test::Tiny(0x1p-6); }
    static constexpr lostbits::test::Tiny denorm_min() { return lostbits::test::Tiny(lostbits::test::Tiny::least); }
};
