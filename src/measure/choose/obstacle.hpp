// Finds why no form meets a requirement: because of the format, the inputs, or the formula.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "measure/choose/candidates.hpp"
#include "measure/choose/ideal_rays.hpp"

namespace lostbits::measure::choose {

/// Trial with some kinds of inputs in a wider format and the others in the base format.
struct InputTrial {
    unsigned wide_inputs = 0;  ///< bit mask; bit k: the inputs of `input_kinds[k]` are wider
    /// Result of exact arithmetic on the inputs as stored, compared with the truth of the ideal inputs. Its kept bits
    /// count from 53.
    FormQuality exact{};
    /// Result of the form in f64; nothing if the form does not exist in f64, or if inputs are wider than f64.
    std::optional<FormQuality> form{};

    [[nodiscard]] bool is_wide(Input input) const { return (wide_inputs >> static_cast<unsigned>(input) & 1U) != 0; }
};

struct Obstacle {
    enum class Cause {
        no_hit,    ///< no ray truly hits, so no bits can be kept with any choice; nothing else is examined
        width,     ///< the format has fewer bits than required
        inputs,    ///< rounding the inputs to the format changes the problem: exact arithmetic fails as well
        inherent,  ///< the inputs are exact enough, but half an ulp of the format in each costs more than the
                   ///< requirement leaves, and the form loses no more than that
        formula    ///< none of these: the form's own arithmetic
    };
    Cause cause = Cause::formula;
    FormQuality exact{};       ///< exact arithmetic on the inputs as the row receives them; kept bits count from 53
    double inherent_kept = 0;  ///< p − inherent_bits at the requirement's quantile: the bits that half an ulp in each
                               ///< input leaves; NaN if nothing is hit
    double inherent_kept_f64 = 0;  ///< the same for binary64
    double inherent_distance = 0;  ///< distance by which half an ulp of the format in each input moves the hit point,
                                   ///< at the same quantile

    bool rounds_to_binary32_first = false;  ///< the inputs of all formats are first rounded to binary32; the trials
                                            ///< vary this rounding
    FloatFormat base_format{};              ///< format of the inputs that are not wider in a trial
    bool wide_inputs_are_exact = false;     ///< wide inputs are exact in the trials; otherwise they are binary64
    /// Every choice of wide inputs, from none to all. Empty if there are too many primitives, or if nothing is rounded.
    std::vector<InputTrial> trials{};
    /// Index of the trial with the fewest wide inputs with which exact arithmetic meets the requirement, and the least
    /// precision that these inputs need. Nothing if no input has to be wider, or if widening all of them is not enough.
    std::optional<std::size_t> sufficient_trial{};
    int min_precision = 0;
};

/// Finds why the row nearest to the request's requirement does not meet it. Uses at most `pixels` rays.
Obstacle find_obstacle(const ChoiceRequest& request, const evaluate::TestedForm& nearest, int pixels = 2048);

}  // namespace lostbits::measure::choose
