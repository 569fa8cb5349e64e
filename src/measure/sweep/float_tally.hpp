// What is known of a form over floats that were tried one after another.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "measure/answer/outcome.hpp"

namespace lostbits::measure::sweep {

/// What first happens along an axis: an outcome, or an error of so many bits.
struct FirstEvent {
    answer::Outcome outcome;  ///< of a wrong decision
    int lost_bits = 0;        ///< 0: the outcome; otherwise so many bits are lost, and the outcome is `agree_hit`
};
inline constexpr std::array<FirstEvent, 11> first_events{{{answer::Outcome::false_miss},
                                                          {answer::Outcome::false_hit},
                                                          {answer::Outcome::not_a_number},
                                                          {answer::Outcome::agree_hit, 1},
                                                          {answer::Outcome::agree_hit, 4},
                                                          {answer::Outcome::agree_hit, 8},
                                                          {answer::Outcome::agree_hit, 12},
                                                          {answer::Outcome::wrong_object},
                                                          {answer::Outcome::crack},
                                                          {answer::Outcome::double_hit},
                                                          {answer::Outcome::out_of_order}}};
/// Whether it can happen where a ray has one solid to hit.
inline constexpr bool is_of_one_solid(const FirstEvent& event) {
    return static_cast<std::size_t>(event.outcome) < answer::outcomes_of_one_solid;
}

/// A form on one ray over floats in their order. Floats are named by their place among all (scene/sweep/float_order).
struct FloatTally {
    struct Worst {
        std::uint32_t place;
        double ulps;  ///< (t − t*)/ulp(t*), signed
        friend bool operator==(const Worst&, const Worst&) = default;
    };
    struct Wrong {
        std::uint32_t place;
        answer::Outcome outcome;
        friend bool operator==(const Wrong&, const Wrong&) = default;
    };

    /// A hit that is missed, and how much more tmax would have to be, in u.
    struct Padding {
        std::uint32_t place;
        double u;
        friend bool operator==(const Padding&, const Padding&) = default;
    };

    std::array<std::uint64_t, answer::outcome_names.size()> outcomes{};
    /// Of the floats where both hit, the first whose error is the largest in size; see `try_floats`.
    std::optional<Worst> worst;
    /// No float's error is larger in size; −1 where none is a hit for both.
    double at_most = -1;
    std::optional<Wrong> first_wrong, last_wrong;
    /// The place where each of `first_events` first happens.
    std::array<std::optional<std::uint32_t>, first_events.size()> first;
    /// Of a form that asks a box: the first of the hits that it misses whose slabs come apart most; none where they
    /// come apart at none of them.
    std::optional<Padding> padding;

    [[nodiscard]] std::uint64_t count(answer::Outcome o) const { return outcomes[static_cast<std::size_t>(o)]; }
    [[nodiscard]] std::uint64_t floats() const;
    [[nodiscard]] std::uint64_t wrong() const;
    /// The next float; the error is NaN where not both hit.
    void add(std::uint32_t place, answer::Outcome outcome, double ulps);
    /// What is known of these floats and of those that come after them.
    void append(const FloatTally& after);
    friend bool operator==(const FloatTally&, const FloatTally&) = default;
};

}  // namespace lostbits::measure::sweep
