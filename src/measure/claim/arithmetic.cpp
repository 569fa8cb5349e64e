#include "measure/claim/arithmetic.hpp"

#include <cmath>
#include <random>

#include "number/rounded.hpp"

namespace lostbits::measure::claim {
namespace {

constexpr int tried = 4096;

/// The share of significands in [1, 2) on which the test says yes; `unit` gives further numbers in [0, 1).
template <class Test>
double share(const FloatFormat& f, std::uint64_t seed, const Test& test) {
    std::mt19937_64 engine(seed);
    const auto unit = [&engine] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
    int yes = 0;
    for (int i = 0; i < tried; ++i) {
        const double significand =
            std::fmin(rounding::to_format(1 + unit(), 0, f), 2 - std::ldexp(1.0, 1 - f.precision));
        yes += test(significand, unit);
    }
    return static_cast<double>(yes) / tried;
}

/// a ± a/ratio = a, the quotient rounded.
template <int sign>
double sum(const FloatFormat& f, double ratio, std::uint64_t seed) {
    return share(f, seed,
                 [&](double a, const auto&) { return rounding::add(a, sign * rounding::div(a, ratio, f), f) == a; });
}

template <int sign>
double power_of_two(const FloatFormat& f, double ratio, std::uint64_t) {
    return rounding::add(1, sign * rounding::div(1, ratio, f), f) == 1 ? 1 : 0;
}

/// f·f − r² = f·f for |f| = distance·r, r over a binade and f in a random direction.
double far_radius(const FloatFormat& f, double distance, std::uint64_t seed) {
    return share(f, seed, [&](double r, const auto& unit) {
        double v[3], size = 0;
        do {
            size = 0;
            for (double& x : v) {
                x = 2 * unit() - 1;
                size += x * x;
            }
        } while (size > 1 || size < 0.01);
        double ff = 0;
        for (int i = 0; i < 3; ++i) {
            const double x = rounding::to_format(v[i] / std::sqrt(size) * distance * r, 0, f);
            const double square = rounding::mul(x, x, f);
            ff = i == 0 ? square : rounding::add(ff, square, f);
        }
        return rounding::add(ff, -rounding::mul(r, r, f), f) == ff;
    });
}

/// r² − l² is the same for the number after r², l = share·r.
double radius_over_l(const FloatFormat& f, double part, std::uint64_t seed) {
    return share(f, seed, [&](double r, const auto&) {
        const double r2 = rounding::mul(r, r, f), l = rounding::to_format(part * r, 0, f), l2 = rounding::mul(l, l, f);
        return rounding::add(r2, -l2, f) == rounding::add(rounding::next_up(r2, f), -l2, f);
    });
}

/// 0·∞ is NaN, for either sign of both.
double zero_times_infinity(const FloatFormat& f, double, std::uint64_t) {
    int yes = 0;
    for (const double zero : {0.0, -0.0}) {
        for (const double infinity : {HUGE_VAL, -HUGE_VAL}) yes += std::isnan(rounding::mul(zero, infinity, f));
    }
    return yes / 4.0;
}

constexpr ArithmeticRow measured_rows[] = {
    {"sum", "ratio", "a + a/ratio = a", tried, sum<1>},
    {"sum_power_of_two", "ratio", "the same for a = 1", 0, power_of_two<1>},
    {"difference", "ratio", "a - a/ratio = a", tried, sum<-1>},
    {"difference_power_of_two", "ratio", "the same for a = 1", 0, power_of_two<-1>},
    {"ff_minus_r2", "distance in radii", "f.f - r^2 = f.f: the radius has no influence on c", tried, far_radius},
    {"zero_times_infinity", "nothing", "0 times infinity is NaN", 0, zero_times_infinity},
    {"r2_minus_l2", "l/r", "r^2 - l^2 does not notice that r^2 becomes the next number", tried, radius_over_l},
};

}  // namespace

std::span<const ArithmeticRow> arithmetic_rows() { return measured_rows; }

}  // namespace lostbits::measure::claim
