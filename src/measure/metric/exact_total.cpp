#include "measure/metric/exact_total.hpp"

#include <bit>
#include <cmath>

namespace lostbits::measure::metric {

void ExactTotal::add(double x) {
    if (x == 0) return;
    const auto word = std::bit_cast<std::uint64_t>(x);
    const auto exponent = static_cast<unsigned>(word >> 52 & 0x7ff);
    const std::uint64_t fraction = word & ((std::uint64_t{1} << 52) - 1);
    const std::uint64_t significand = exponent == 0 ? fraction : fraction | std::uint64_t{1} << 52;
    const unsigned place = exponent == 0 ? 0 : exponent - 1;  // |x| = significand·2^(place − 1074)
    const unsigned shift = place % limb_bits;
    const std::uint64_t low = (significand & 0xffffffffU) << shift, high = (significand >> limb_bits) << shift;
    const std::uint64_t parts[3] = {low & 0xffffffffU, (low >> limb_bits) + (high & 0xffffffffU), high >> limb_bits};
    for (std::size_t i = 0; i < 3; ++i) {
        std::int64_t& limb = limbs_[place / limb_bits + i];
        limb += x < 0 ? -static_cast<std::int64_t>(parts[i]) : static_cast<std::int64_t>(parts[i]);
    }
    if (++unsettled_ == most_unsettled) settle();
}

void ExactTotal::add(const ExactTotal& other) {
    ExactTotal settled = other;
    settled.settle();
    settle();
    for (std::size_t i = 0; i < limbs_.size(); ++i) limbs_[i] += settled.limbs_[i];
    ++unsettled_;
}

void ExactTotal::settle() {
    for (std::size_t i = 0; i + 1 < limbs_.size(); ++i) {
        limbs_[i + 1] += limbs_[i] >> limb_bits;  // rounds down: what stays is not negative
        limbs_[i] &= 0xffffffff;
    }
    unsettled_ = 0;
}

double ExactTotal::over(std::uint64_t n) const {
    ExactTotal settled = *this;
    settled.settle();
    const auto& limbs = settled.limbs_;
    std::size_t top = limbs.size() - 1;
    while (top > 0 && limbs[top] == 0) --top;
    // In units of the top limb. Five limbs have at least 129 bits, more than two doubles.
    DoubleDouble sum{0, 0};
    for (std::size_t i = 0; i < 5 && i <= top; ++i) {
        const double term = std::ldexp(static_cast<double>(limbs[top - i]), -limb_bits * static_cast<int>(i));
        const DoubleDouble s = two_sum(sum.hi, term);
        sum = quick_two_sum(s.hi, s.lo + sum.lo);
    }
    const auto count = static_cast<double>(n);
    const double mean = sum.hi / count;
    return std::ldexp(mean + (quotient_residual(sum.hi, count, mean) + sum.lo) / count,
                      limb_bits * static_cast<int>(top) - 1074);
}

}  // namespace lostbits::measure::metric
