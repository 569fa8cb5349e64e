#include "output/plot/plot_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "output/image/colour.hpp"

namespace lostbits::output::plot {
namespace {

/// A range narrower than this, relative to its ends, has no round values that a double could tell apart.
constexpr double least_extent = 1e-12;
/// What is smaller is taken for 0: a step between subnormal numbers is not round any more.
constexpr double least_size = 1e-300;
/// Of the axis: between the place of 0 and the low end of a log axis.
constexpr double below_low_end = 0.08;

/// Multiples of 1, 2 or 5 times ten^k from `lo` to `hi`, at most `most` + 1 of them.
std::vector<double> round_values(double lo, double hi, int most) {
    return image::multiples(image::round_step((hi / 2 - lo / 2) / most * 2), lo, hi);
}

/// With as many digits as tell the ticks apart.
std::vector<std::string> labels_of(const std::vector<double>& values) {
    double largest = 0, step = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        largest = std::max(largest, std::fabs(values[i]));
        if (i == 1) step = values[1] - values[0];
    }
    const double digits = step > 0 && std::isfinite(step) ? std::ceil(std::log10(largest / step)) + 1 : 6;
    std::vector<std::string> out;
    for (const double value : values)
        out.push_back(image::tick_label(value, static_cast<int>(std::clamp(digits, 6.0, 16.0))));
    return out;
}

}  // namespace

AxisRange::AxisRange(const AxisSpec& axis, const std::vector<double>& values)
    : title_(axis.title), scale_(axis.scale), zero_(axis.zero && is_log()), decimals_(axis.decimals) {
    for (const auto& end : {axis.low, axis.high}) {
        if (end && (!std::isfinite(*end) || (is_log() && !(*end > 0)))) {
            throw std::invalid_argument("axis " + axis.title + ": an end without a place");
        }
    }
    if (axis.low && axis.high && !(*axis.low < *axis.high)) {
        throw std::invalid_argument("axis " + axis.title + ": its ends are not in order");
    }
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const double value : values) {
        if (!std::isfinite(value) || !has_place(value) || (zero_ && value == 0)) continue;
        lo = std::min(lo, scaled(value));
        hi = std::max(hi, scaled(value));
    }
    if (lo > hi) lo = hi = 0;
    if (!is_log() && !axis.low && lo > 0 && lo < hi / 4) lo = 0;
    lo_ = axis.low ? scaled(*axis.low) : lo;
    hi_ = axis.high ? scaled(*axis.high) : hi;
    widen(axis.low.has_value(), axis.high.has_value());
}

void AxisRange::widen(bool low_fixed, bool high_fixed) {
    const double size = std::max(std::fabs(lo_), std::fabs(hi_));
    if (size > least_size && hi_ / 2 - lo_ / 2 > size * least_extent) return;
    const double by = is_log() || size <= least_size ? 1 : size / 10;
    constexpr double most = std::numeric_limits<double>::max();
    if (high_fixed && !low_fixed) {
        lo_ = std::max(hi_ - by, -most);
    } else if (low_fixed && !high_fixed) {
        hi_ = std::min(lo_ + by, most);
    } else {
        lo_ = std::max(lo_ - by, -most);
        hi_ = std::min(hi_ + by, most);
    }
}

bool AxisRange::has_place(double value) const noexcept {
    return is_log() ? value > 0 || (zero_ && value == 0) : !std::isnan(value);
}

double AxisRange::scaled(double value) const noexcept {
    return scale_ == AxisSpec::Scale::linear ? value
           : scale_ == AxisSpec::Scale::log2 ? std::log2(value)
                                             : std::log10(value);
}

double AxisRange::place(double s) const noexcept {
    // Halves first: hi - lo may overflow.
    const double share = std::clamp((s / 2 - lo_ / 2) / (hi_ / 2 - lo_ / 2), -1e3, 1e3);
    return zero_ ? below_low_end + (1 - below_low_end) * share : share;
}

double AxisRange::position(double value) const noexcept {
    if (std::isinf(value)) return value > 0 ? 1 : 0;
    if (zero_ && value == 0) return 0;
    return place(scaled(value));
}

std::vector<AxisRange::Tick> AxisRange::ticks_within_a_step(int most) const {
    const bool two = scale_ == AxisSpec::Scale::log2;
    std::vector<Tick> out;
    // Numbers that can be read as they are: 2.4, not 2^1.26. A label has room for some six digits, and round steps that
    // are alike crowd at the upper end of a wider range.
    const double low = two ? std::exp2(lo_) : std::pow(10, lo_), high = two ? std::exp2(hi_) : std::pow(10, hi_);
    if (low >= 1e-3 && high <= 1e5 && high <= 5 * low && high - low > high * least_extent) {
        const auto values = round_values(low, high, most);
        const auto labels = labels_of(values);
        for (std::size_t i = 0; i < values.size(); ++i) out.push_back({position(values[i]), labels[i]});
        if (out.size() >= 2) return out;
        out.clear();
    }
    const auto exponents = round_values(lo_, hi_, most);
    const auto labels = labels_of(exponents);
    for (std::size_t i = 0; i < labels.size(); ++i)
        out.push_back({place(exponents[i]), power_label(exponents[i], labels[i])});
    return out;
}

std::string AxisRange::power_label(double exponent, const std::string& text) const {
    const bool two = scale_ == AxisSpec::Scale::log2;
    // 6 digits: 2^-4 is 0.0625, 2^16 is 65536.
    if (decimals_) return image::tick_label(two ? std::exp2(exponent) : std::pow(10, exponent));
    return (two ? "2^" : "10^") + text;
}

std::vector<AxisRange::Tick> AxisRange::exponent_ticks(int most) const {
    const bool two = scale_ == AxisSpec::Scale::log2;
    double step = 1;
    const std::vector<double> steps = two ? std::vector<double>{1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024}
                                          : std::vector<double>{1, 2, 5, 10, 20, 50, 100, 200, 500};
    for (const double s : steps) {
        step = s;
        if (std::floor(hi_ / s + 1e-9) - std::ceil(lo_ / s - 1e-9) + 1 <= most) break;
    }
    std::vector<double> exponents;
    for (double k = std::ceil(lo_ / step - 1e-9); k * step <= hi_ + 1e-9; k += 1) exponents.push_back(k * step);
    if (exponents.size() < 2) return ticks_within_a_step(most);
    std::vector<Tick> out;
    const auto labels = labels_of(exponents);
    for (std::size_t i = 0; i < labels.size(); ++i) {
        out.push_back({place(exponents[i]), power_label(exponents[i], labels[i])});
    }
    if (two || step != 1 || hi_ - lo_ > 12) return out;
    for (double decade = std::floor(lo_); decade <= hi_; decade += 1) {
        for (int m = 2; m < 10; ++m) {
            const double s = decade + std::log10(m);
            if (s > lo_ && s < hi_) out.push_back({place(s), {}});
        }
    }
    return out;
}

std::vector<AxisRange::Tick> AxisRange::ticks(int most) const {
    most = std::max(most, 2);
    if (is_log()) {
        auto out = exponent_ticks(most);
        if (zero_) out.insert(out.begin(), {0, "0"});
        return out;
    }
    const auto values = round_values(lo_, hi_, most);
    const auto labels = labels_of(values);
    std::vector<Tick> out;
    for (std::size_t i = 0; i < values.size(); ++i) out.push_back({place(values[i]), labels[i]});
    return out;
}

}  // namespace lostbits::output::plot
