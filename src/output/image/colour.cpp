// Colour scales, their ticks, and the colours of categories.
#include "output/image/colour.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "output/file/number_text.hpp"

namespace lostbits::output::image {
namespace {

// Colours of maximal contrast, an idea of Kelly's, that can be told apart on a screen.
constexpr std::array<Rgb8, 20> first_colours{{
    {230, 159, 0},  {86, 180, 233},  {0, 158, 115},   {240, 228, 66},  {0, 114, 178},
    {213, 94, 0},   {204, 121, 167}, {153, 221, 85},  {136, 34, 85},   {170, 170, 255},
    {153, 102, 51}, {68, 221, 221},  {255, 153, 136}, {102, 51, 170},  {187, 187, 119},
    {34, 102, 51},  {255, 102, 187}, {119, 136, 153}, {255, 214, 170}, {0, 68, 119},
}};

const std::array<std::uint16_t, 256>& linear_light_of_byte() {
    static const auto table = [] {
        std::array<std::uint16_t, 256> out{};
        for (int i = 0; i < 256; ++i) {
            const double c = i / 255.0;
            const double l = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
            out[i] = static_cast<std::uint16_t>(std::lround(l * 65535.0));
        }
        return out;
    }();
    return table;
}

/// Colour of a ramp at a position from 0 to 1.
Rgb8 ramp_colour(const std::vector<Rgb8>& table, double position) {
    const double exact_index = std::clamp(position, 0.0, 1.0) * static_cast<double>(table.size() - 1);
    const auto below = static_cast<std::size_t>(exact_index);
    // Rounds halves up, like lround.
    return table[below + (exact_index - static_cast<double>(below) >= 0.5 ? 1 : 0)];
}

bool is_multiple(double value, double step) {
    const double n = value / step;
    return std::fabs(n - std::round(n)) < 1e-6;
}

/// A round step of at least `min_step`. Prefers a step of which both ends are multiples; otherwise returns
/// `round_step(min_step)`.
double choose_step(double lo, double hi, double min_step) {
    const double power_of_10 = std::pow(10.0, std::floor(std::log10(min_step)));
    for (const double m : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0}) {
        if (m * power_of_10 >= min_step * (1 - 1e-9) && is_multiple(lo, m * power_of_10) &&
            is_multiple(hi, m * power_of_10))
            return m * power_of_10;
    }
    return round_step(min_step);
}

/// Oklab (Ottosson 2020) in whole thousandths, so that the last bits of a machine's cbrt do not matter.
struct Oklab {
    int l, a, b;
    explicit Oklab(Rgb8 c) {
        const auto linear = [](std::uint8_t x) { return linear_light(x) / 65535.0; };
        const double r = linear(c.r), g = linear(c.g), blue = linear(c.b);
        const double x = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * blue);
        const double y = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * blue);
        const double z = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * blue);
        const auto thousandths = [](double v) { return static_cast<int>(std::lround(1000 * v)); };
        l = thousandths(0.2104542553 * x + 0.7936177850 * y - 0.0040720468 * z);
        a = thousandths(1.9779984951 * x - 2.4285922050 * y + 0.4505937099 * z);
        b = thousandths(0.0259040371 * x + 0.7827717662 * y - 0.8086757660 * z);
    }
    [[nodiscard]] int distance(const Oklab& o) const {
        return (l - o.l) * (l - o.l) + (a - o.a) * (a - o.a) + (b - o.b) * (b - o.b);
    }
};

/// Every colour of a 17 x 17 x 17 cube, with its distance from the nearest excluded colour.
class FarthestColours {
public:
    FarthestColours() {
        for (int i = 0; i < 17 * 17 * 17; ++i) {
            const auto level = [](int k) { return static_cast<std::uint8_t>(k * 255 / 16); };
            const Rgb8 c{level(i / 289), level(i / 17 % 17), level(i % 17)};
            candidates_.push_back({c, Oklab(c), std::numeric_limits<int>::max()});
        }
    }
    void exclude(Rgb8 c) {
        const Oklab lab(c);
        for (Candidate& candidate : candidates_)
            candidate.nearest = std::min(candidate.nearest, candidate.lab.distance(lab));
    }
    Rgb8 take_next() {
        const Rgb8 c = std::ranges::max_element(candidates_, {}, &Candidate::nearest)->colour;
        exclude(c);
        return c;
    }

private:
    struct Candidate {
        Rgb8 colour;
        Oklab lab;
        int nearest;
    };
    std::vector<Candidate> candidates_;
};

}  // namespace

Rgb8 distinct_colour(std::size_t index) {
    static const auto colours = [] {
        std::vector<Rgb8> list(first_colours.begin(), first_colours.end());
        FarthestColours farthest;
        for (const Rgb8 c : first_colours) farthest.exclude(c);
        for (const Rgb8 c : outcome_colours) farthest.exclude(c);
        farthest.exclude({255, 255, 255});
        while (list.size() < 1000) list.push_back(farthest.take_next());
        return list;
    }();
    return colours[index % colours.size()];
}

double ColourScale::to_even_scale(double value) const {
    switch (spacing_) {
        case Spacing::root: return std::sqrt(value);
        case Spacing::log2: return std::log2(value);
        case Spacing::linear: break;
    }
    return value / 2;  // hi − lo may overflow
}

ColourScale::ColourScale(std::string name, std::vector<Rgb8> table, double lo, double hi, Spacing spacing)
    : name_(std::move(name)), table_(std::move(table)), lo_(lo), hi_(hi), spacing_(spacing) {
    if (table_.size() < 2) throw std::invalid_argument("colour scale " + name_ + ": it has fewer than two colours");
    if (!std::isfinite(lo) || !std::isfinite(hi) || !(hi > lo) || (spacing == Spacing::log2 && !(lo > 0)) ||
        (spacing == Spacing::root && lo < 0)) {
        throw std::invalid_argument("colour scale " + name_ + ": not a valid range from " + file::decimal(lo) + " to " +
                                    file::decimal(hi));
    }
    spaced_lo_ = to_even_scale(lo);
    spaced_range_ = to_even_scale(hi) - spaced_lo_;
}

double ColourScale::position(double value) const {
    if (std::isnan(value)) throw std::invalid_argument("colour scale " + name_ + ": a NaN has no colour");
    if (value <= lo_) return 0;
    if (value >= hi_) return 1;
    return std::clamp((to_even_scale(value) - spaced_lo_) / spaced_range_, 0.0, 1.0);
}

Rgb8 ColourScale::colour_at_position(double position) const { return ramp_colour(table_, position); }

Rgb8 ColourScale::colour_of_value(double value) const {
    // The same as colour_at_position(position(value)) in one call, because it runs for every pixel.
    if (!(value > lo_ && value < hi_)) return colour_at_position(position(value));
    return ramp_colour(table_, (to_even_scale(value) - spaced_lo_) / spaced_range_);
}

/// Ticks at both ends, then at powers of two where there is space, powers of four first.
std::vector<ColourScale::Tick> ColourScale::root_ticks(int max_ticks) const {
    std::vector<Tick> out{{0, file::short_decimal(lo_, tick_digits)}, {1, file::short_decimal(hi_, tick_digits)}};
    const double gap = 0.75 / max_ticks;
    for (const int first_exponent : {0, 1}) {
        for (int e = first_exponent; e < 1024 && static_cast<int>(out.size()) < max_ticks; e += 2) {
            const double value = std::exp2(e);
            if (!(value > lo_ && value < hi_)) continue;
            const double tick_position = position(value);
            if (std::ranges::all_of(out, [&](const Tick& t) { return std::fabs(t.position - tick_position) >= gap; }))
                out.push_back({tick_position, file::short_decimal(value, tick_digits)});
        }
    }
    std::ranges::sort(out, {}, &Tick::position);
    return out;
}

/// Ticks at powers of two with the same number of powers from each to the next.
std::vector<ColourScale::Tick> ColourScale::log_ticks(int max_ticks) const {
    const double first = std::ceil(std::log2(lo_)), last = std::floor(std::log2(hi_));
    double step = 0;
    for (const double s : {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 128, 256, 512, 1024, 2048}) {
        step = s;
        if (std::floor((last - first) / s) + 1 <= max_ticks) break;
    }

    // Labels are either all powers or all plain numbers.
    const bool has_plain_labels = first >= -3 && last <= 10;
    std::vector<Tick> out;
    for (double e = first; e <= last; e += step) {
        out.push_back({position(std::exp2(e)),
                       has_plain_labels || e == 0 ? file::decimal(std::exp2(e)) : "2^" + file::decimal(e)});
    }
    return out;
}

std::vector<ColourScale::Tick> ColourScale::ticks(int max_ticks) const {
    max_ticks = std::max(max_ticks, 2);
    if (spacing_ == Spacing::root) return root_ticks(max_ticks);
    std::vector<Tick> out;
    if (spacing_ == Spacing::log2) {
        out = log_ticks(max_ticks);
    } else {
        const double step = choose_step(lo_, hi_, (hi_ / 2 - lo_ / 2) / (max_ticks - 1) * 2);
        for (const double value : multiples(step, lo_, hi_))
            out.push_back({position(value), file::short_decimal(value, tick_digits)});
    }
    // A range without two round values is labelled at its ends.
    if (out.size() < 2) out = {{0, file::short_decimal(lo_, tick_digits)}, {1, file::short_decimal(hi_, tick_digits)}};
    return out;
}

double round_step(double min_step) {
    const double power_of_10 = std::pow(10.0, std::floor(std::log10(min_step)));
    for (const double m : {1.0, 2.0, 5.0}) {
        if (m * power_of_10 >= min_step * (1 - 1e-9)) return m * power_of_10;
    }
    return 10 * power_of_10;
}

std::vector<double> multiples(double step, double lo, double hi) {
    std::vector<double> out;
    const auto is_inside = [&](double value) { return std::isfinite(value) && value <= hi + step * 1e-9; };
    for (double k = std::ceil(lo / step - 1e-9); is_inside(k * step); k += 1) out.push_back(k * step);
    return out;
}

std::uint16_t linear_light(std::uint8_t srgb) noexcept { return linear_light_of_byte()[srgb]; }

std::uint8_t srgb_byte(std::uint16_t linear) noexcept {
    const auto& table = linear_light_of_byte();
    const auto above = std::lower_bound(table.begin(), table.end(), linear);
    if (above == table.begin()) return 0;
    const auto below = above - 1;
    return static_cast<std::uint8_t>((*above - linear < linear - *below ? above : below) - table.begin());
}

}  // namespace lostbits::output::image
