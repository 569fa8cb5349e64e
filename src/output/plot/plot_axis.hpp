// The axis of a plot: from values to places, and the round values that are written beside it.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace lostbits::output::plot {

/// What the caller says about an axis.
struct AxisSpec {
    enum class Scale { linear, log2, log10 };
    std::string title;
    Scale scale = Scale::linear;
    std::optional<double> low, high;  ///< the ends; where one is missing the data gives it
    bool zero = false;                ///< of a log axis: 0 has a place of its own, below its low end
    bool decimals = false;            ///< of a log axis: ticks are `0.5` and `64`, not `2^-1` and `2^6`
};

/// An axis whose ends are known.
class AxisRange {
public:
    /// The ends are those of `axis`, else the least and greatest of `values` that have a place. A range without extent
    /// is widened about its value, and a linear one that comes near 0 starts there. Throws std::invalid_argument for
    /// ends that are not finite, not in order, or not positive on a log scale.
    AxisRange(const AxisSpec& axis, const std::vector<double>& values);

    /// Whether `value` has a place: infinities have, a NaN and what is not positive on a log scale have not, but for a
    /// zero that has a place of its own.
    [[nodiscard]] bool has_place(double value) const noexcept;

    /// 0 at the low end, 1 at the high one, beyond them outside (at most 10^3, so that pixels stay countable); an
    /// infinite value lies at its end. Meaningless without a place.
    [[nodiscard]] double position(double value) const noexcept;

    /// A tick; without a label it is a minor one.
    struct Tick {
        double position;
        std::string label;  ///< `4`, `0.25`, `2^-10`, `10^3`
    };

    /// Round values between the ends, about `most` (at least 2) labelled ones.
    [[nodiscard]] std::vector<Tick> ticks(int most) const;

    [[nodiscard]] const std::string& title() const noexcept { return title_; }
    [[nodiscard]] bool is_log() const noexcept { return scale_ != AxisSpec::Scale::linear; }

private:
    [[nodiscard]] double scaled(double value) const noexcept;
    [[nodiscard]] double place(double s) const noexcept;
    [[nodiscard]] std::string power_label(double exponent, const std::string& text) const;
    void widen(bool low_fixed, bool high_fixed);
    [[nodiscard]] std::vector<Tick> exponent_ticks(int most) const;
    /// Where less than two powers lie between the ends.
    [[nodiscard]] std::vector<Tick> ticks_within_a_step(int most) const;

    std::string title_;
    AxisSpec::Scale scale_;
    bool zero_, decimals_;
    double lo_ = 0, hi_ = 1;  // exponents on a log scale
};

}  // namespace lostbits::output::plot
