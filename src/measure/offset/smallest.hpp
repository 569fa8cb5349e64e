// Finds the smallest sufficient number of a format by bisection over its floats.
#pragma once

#include <cstdint>
#include <limits>

#include "measure/offset/leaving.hpp"
#include "measure/truth/certified.hpp"

namespace lostbits::measure::offset {

/// Verdict on an offset.
enum class OffsetVerdict : std::int8_t { too_little, enough, too_much };

/// Finds a number e ≥ 0 of the format with judge(e) = enough whose lower neighbour is too little. Returns 0 if 0 is
/// enough, and infinity if no number up to `most` is. From `start` on, e is doubled until it is not too little; then
/// the floats in between are bisected. Where `judge` is monotone, the result is the smallest. Where it is not (a step
/// of one component can turn a grazing ray back), it is one of the places where "too little" ends.
template <class Judge>
double smallest_enough(const FloatFormat& format, double start, double most, const Judge& judge) {
    if (judge(0.0) == OffsetVerdict::enough) return 0;
    const std::int64_t binade = std::int64_t{1} << (format.precision - 1);
    const std::int64_t infinity = truth::ordinal(std::numeric_limits<double>::infinity(), format);
    const auto number = [&](std::int64_t n) {
        return n < infinity ? truth::number_at(n, format) : std::numeric_limits<double>::infinity();
    };
    std::int64_t low = 0, high = truth::ordinal(start, format);
    if (high < 1) high = 1;
    OffsetVerdict at_high = judge(number(high));
    while (at_high == OffsetVerdict::too_little) {
        low = high;
        high += binade;
        const double e = number(high);
        if (!(e <= most)) return std::numeric_limits<double>::infinity();
        at_high = judge(e);
    }
    while (high - low > 1) {
        const std::int64_t middle = low + (high - low) / 2;
        const OffsetVerdict at_middle = judge(number(middle));
        if (at_middle == OffsetVerdict::too_little) low = middle;
        else high = middle, at_high = at_middle;
    }
    return at_high == OffsetVerdict::enough ? number(high) : std::numeric_limits<double>::infinity();
}

}  // namespace lostbits::measure::offset
