// Finds the smallest number of a format that is enough, by bisection over the numbers of the format.
#pragma once

#include <cstdint>
#include <limits>

#include "measure/offset/leaving.hpp"
#include "measure/truth/certified.hpp"

namespace lostbits::measure::offset {

/// Verdict on an offset.
enum class OffsetVerdict : std::int8_t { too_little, enough, too_much };

/// Finds a number e ≥ 0 of the format with verdict_on(e) = enough whose lower neighbour is too little. Returns 0 if 0
/// is enough, and infinity if no number up to `most` is. The search doubles e from `start` on until e is not too
/// little. Then it bisects between the last two numbers. If `verdict_on` is monotone, the result is the smallest number
/// that is enough. If `verdict_on` is not monotone (one more float in a component can turn a grazing ray back), the
/// result is one of several numbers at which "too little" ends.
template <class VerdictOn>
double find_smallest_enough(const FloatFormat& format, double start, double most, const VerdictOn& verdict_on) {
    if (verdict_on(0.0) == OffsetVerdict::enough) return 0;
    const std::int64_t binade = std::int64_t{1} << (format.precision - 1);
    const std::int64_t infinity = truth::ordinal(std::numeric_limits<double>::infinity(), format);
    const auto number_at_index = [&](std::int64_t index) {
        return index < infinity ? truth::number_at(index, format) : std::numeric_limits<double>::infinity();
    };

    // Doubles e until it is not too little.
    std::int64_t low = 0, high = truth::ordinal(start, format);
    if (high < 1) high = 1;
    OffsetVerdict at_high = verdict_on(number_at_index(high));
    while (at_high == OffsetVerdict::too_little) {
        low = high;
        high += binade;
        const double e = number_at_index(high);
        if (!(e <= most)) return std::numeric_limits<double>::infinity();
        at_high = verdict_on(e);
    }

    // Bisects between the last number that is too little and the first that is not.
    while (high - low > 1) {
        const std::int64_t middle = low + (high - low) / 2;
        const OffsetVerdict at_middle = verdict_on(number_at_index(middle));
        if (at_middle == OffsetVerdict::too_little) {
            low = middle;
        } else {
            high = middle;
            at_high = at_middle;
        }
    }
    return at_high == OffsetVerdict::enough ? number_at_index(high) : std::numeric_limits<double>::infinity();
}

}  // namespace lostbits::measure::offset
