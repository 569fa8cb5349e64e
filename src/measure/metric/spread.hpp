// What a number comes to when its random rays are drawn again.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

namespace lostbits::measure::metric {

/// Smallest, middle and largest of several draws. The middle one is a measured number: the lower of two.
struct Spread {
    double low, median, high;
    int draws;  ///< on which the number exists
};

/// Of a file's own draw and of further ones; NaN is a draw on which the number does not exist. All NaN where none has
/// it.
inline Spread spread_of(double own, const std::vector<double>& further) {
    std::vector<double> all;
    const auto exists = [](double x) { return !std::isnan(x); };
    if (exists(own)) all.push_back(own);
    std::ranges::copy_if(further, std::back_inserter(all), exists);
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (all.empty()) return {none, none, none, 0};
    std::ranges::sort(all);
    return {all.front(), all[(all.size() - 1) / 2], all.back(), static_cast<int>(all.size())};
}

}  // namespace lostbits::measure::metric
