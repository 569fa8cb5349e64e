// A sum of doubles without any rounding: neither the order of the terms nor how they were grouped can show.
#pragma once

#include <array>
#include <cstdint>

#include "number/error_free.hpp"

namespace lostbits::measure::metric {

/// A number Σ limbs[i]·2^(32·i − 1074), in which every sum of up to 2^64 finite doubles has room (Kulisch's long
/// accumulator, with room for carries in every limb). Its sign is that of the top limb.
class ExactTotal {
public:
    /// x is finite.
    void add(double x);
    void add(const ExactTotal& other);
    /// The total over n, rounded to a double: off by at most an ulp where it is normal. The total is not negative.
    [[nodiscard]] double over(std::uint64_t n) const;

    template <class Bits>
    void fields(Bits& bits) {
        settle();
        bits(limbs_);
    }

private:
    void settle();

    static constexpr int limb_bits = 32;
    static constexpr std::uint32_t most_unsettled = std::uint32_t{1} << 29;  // each moves a limb by less than 2^32

    std::array<std::int64_t, 68> limbs_{};
    std::uint32_t unsettled_ = 0;  // terms since all limbs were from 0 to 2^32 − 1
};

}  // namespace lostbits::measure::metric
