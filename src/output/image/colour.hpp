// Colours of numbers, outcomes and primitives, the same in every picture.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lostbits::output::image {

/// An 8-bit sRGB colour in three bytes without padding, so that a row of them is a row of a PNG.
struct Rgb8 {
    std::uint8_t r = 0, g = 0, b = 0;
    friend bool operator==(const Rgb8&, const Rgb8&) = default;
};
static_assert(sizeof(Rgb8) == 3);

/// One fixed colour per outcome, in the order of `Outcome` (measure/answer/outcome.hpp) and of the values of the
/// `class` layer. All colours but `agree_hit` differ from the whole viridis ramp and from each other: between any two,
/// CIEDE2000 is at least 25 for every eye, including a deuteranope's and a protanope's (tests check the distances).
/// Their lightness differs too, so that they can be told apart on a grey print. `agree_hit` is drawn in its metric's
/// colour; it has the colour of this list if the metric has no value there, and in a map of outcomes alone. Only these
/// seven colours fit beside the ramp. The four outcomes of meshes are 20 apart from the seven and from the ramp for an
/// ordinary eye, and 10 for a deuteranope's and a protanope's.
inline constexpr std::array<Rgb8, 11> outcome_colours{{
    {95, 110, 110},   // agree_hit: slate, near the middle of the ramp
    {231, 231, 231},  // agree_miss: neutral, recedes
    {114, 51, 0},     // false_hit: brown
    {214, 148, 255},  // false_miss: lilac
    {0, 0, 0},        // not_a_number: black
    {95, 46, 225},    // unresolved: violet
    {181, 124, 0},    // wrong_primitive: gold
    {200, 0, 65},     // crack: crimson
    {110, 235, 255},  // double_hit: light cyan
    {245, 175, 180},  // wrong_neighbour: pale pink
    {127, 154, 195},  // out_of_order: steel blue
}};

/// One fixed colour per reason for a march to stop, in the order of `StopReason` (intersect/march.hpp).
inline constexpr std::array<Rgb8, 4> stop_colours{{
    outcome_colours[0],  // hit
    outcome_colours[1],  // max_dist: neutral, recedes
    outcome_colours[6],  // max_steps: gold
    outcome_colours[5],  // stagnated: violet
}};

/// One fixed colour for each relation of two forms, in the order of `AgainstOutcome` (measure/answer/against.hpp).
inline constexpr std::array<Rgb8, 6> against_colours{{
    outcome_colours[1],  // both_miss
    outcome_colours[0],  // same_t
    outcome_colours[6],  // other_t: gold
    outcome_colours[5],  // incomparable_t: violet
    outcome_colours[2],  // alone_hits: brown
    outcome_colours[3],  // other_alone_hits: lilac
}};

/// Colour of category `index`, from 0. The first twenty colours were chosen; each further one is the farthest in Oklab
/// from all before it, from the outcomes' colours and from the page. There are a thousand different colours; then they
/// repeat.
[[nodiscard]] Rgb8 distinct_colour(std::size_t index);

/// Spacing of values between the ends of a scale: by value, by square root (small values get more of the ramp), or by
/// logarithm.
enum class Spacing : std::uint8_t { linear, root, log2 };
inline constexpr std::array<const char*, 3> spacing_names{"linear", "root", "log2"};

/// Maps a metric to a colour between two ends, clamped outside.
class ColourScale {
public:
    /// `table` is the ramp from low to high, with at least two colours (`ImageBackend::ramp`). `hi > lo`, both finite;
    /// `lo >= 0` for roots and `lo > 0` for logarithms. Otherwise throws std::invalid_argument.
    ColourScale(std::string name, std::vector<Rgb8> table, double lo, double hi, Spacing spacing = Spacing::linear);

    /// The colour of `value`. -inf and +inf have the colours of the ends; on a log2 scale, a value that is not
    /// positive has the colour of the low end. Throws std::invalid_argument for NaN, which is not on the ramp; draw
    /// its outcome instead.
    [[nodiscard]] Rgb8 colour_of_value(double value) const;

    /// Position of `value` on the ramp, clamped to 0..1.
    [[nodiscard]] double position(double value) const;

    /// Colour at a position from 0 to 1 on the ramp.
    [[nodiscard]] Rgb8 colour_at_position(double position) const;

    /// A tick of the colour bar.
    struct Tick {
        double position;    ///< 0..1
        std::string label;  ///< `4`, `0.25`, `2^-10`
    };

    /// Round values between the ends, at most `max_ticks` (at least 2).
    [[nodiscard]] std::vector<Tick> ticks(int max_ticks) const;

    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    [[nodiscard]] double lo() const noexcept { return lo_; }
    [[nodiscard]] double hi() const noexcept { return hi_; }
    [[nodiscard]] Spacing spacing() const noexcept { return spacing_; }
    /// True if both scales give every value the same position.
    [[nodiscard]] bool is_same_scale(const ColourScale& o) const noexcept {
        return lo_ == o.lo_ && hi_ == o.hi_ && spacing_ == o.spacing_ && name_ == o.name_;
    }

private:
    /// The value, its root or its logarithm, whichever has even steps along the ramp.
    [[nodiscard]] double to_even_scale(double value) const;
    [[nodiscard]] std::vector<Tick> root_ticks(int max_ticks) const;
    [[nodiscard]] std::vector<Tick> log_ticks(int max_ticks) const;

    std::string name_;
    std::vector<Rgb8> table_;
    double lo_, hi_;
    Spacing spacing_;
    double spaced_lo_, spaced_range_;  ///< `to_even_scale(lo)`, and `to_even_scale(hi)` minus `to_even_scale(lo)`
};

// Round values for the ticks of axes and colour bars.

/// Significant digits of a tick's label, so that a tick at 3 times 0.1 is not labelled 0.30000000000000004.
inline constexpr int tick_digits = 6;

/// The smallest number of the form 1, 2 or 5 times 10^k that is at least `min_step` > 0.
[[nodiscard]] double round_step(double min_step);

/// Multiples of `step` from `lo` to `hi`. Both ends are included if they are multiples up to rounding.
[[nodiscard]] std::vector<double> multiples(double step, double lo, double hi);

/// Linear light of an sRGB byte, from 0 to 65535. Pixels are averaged in linear light.
[[nodiscard]] std::uint16_t linear_light(std::uint8_t srgb) noexcept;

/// The sRGB byte nearest in linear light to `linear` (0..65535).
[[nodiscard]] std::uint8_t srgb_byte(std::uint16_t linear) noexcept;

}  // namespace lostbits::output::image
