// What stands in the way of a wish that nothing meets: the format, the inputs, or the formula.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "measure/choice/candidates.hpp"
#include "measure/choice/ideal_rays.hpp"

namespace lostbits::measure::choice {

/// Some of the inputs in a wider format, the others in that of all.
struct InputTrial {
    unsigned wide = 0;  ///< bit k: those of `input_kinds[k]` come wider
    /// What exact arithmetic makes of inputs so stored, held against the truth of the ideal ones. Bits are of 53.
    Worth exact{};
    /// The same of the form in f64; nothing where it does not exist, or inputs are wider than that.
    std::optional<Worth> form{};

    [[nodiscard]] bool has(Input input) const { return (wide >> static_cast<unsigned>(input) & 1U) != 0; }
};

struct Obstacle {
    enum class Cause {
        no_hit,    ///< no ray truly hits, so no bits can be kept, whatever is chosen; nothing else is looked at
        width,     ///< the format has fewer bits than are wished
        inputs,    ///< rounded to the format, they are another problem: exact arithmetic fails as well
        inherent,  ///< they are as meant, but half an ulp of the format in each of them costs more than the wish
                   ///< leaves, and the form loses no more than that
        formula    ///< none of these: its own arithmetic
    };
    Cause cause = Cause::formula;
    Worth exact{};             ///< exact arithmetic on the inputs as the row is given them; of 53 bits
    double inherent_kept = 0;  ///< p − inherent_bits at the wish's quantile: what half an ulp in each input leaves; NaN
                               ///< where nothing is hit
    double inherent_kept_f64 = 0;  ///< the same of binary64
    double inherent_off = 0;       ///< how far half an ulp of the format in each input moves the hit point, as above

    bool rounded_before = false;  ///< the inputs of all formats were rounded to binary32 before: trials are about that
    FloatFormat base{};           ///< the format of all inputs in the trials but those that come wider
    bool wider_than_f64 = false;  ///< what is wide in the trials is exact; else binary64
    /// Every choice of inputs, none first and all last; empty where there are too many solids, or where nothing is
    /// rounded.
    std::vector<InputTrial> trials{};
    /// The fewest inputs that need to come wider for exact arithmetic to meet the wish, and the least bits of
    /// significand that they need; nothing where none need to, or all are not enough.
    std::optional<std::size_t> enough{};
    int least_precision = 0;
};

/// Why this row, which comes nearest, does not meet the request's wish. On at most `pixels` rays.
Obstacle find_obstacle(const ChoiceRequest& request, const evaluate::TestedForm& nearest, int pixels = 2048);

}  // namespace lostbits::measure::choice
