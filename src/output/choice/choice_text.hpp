// A choice in words: what meets the wish, what it costs and assumes, and how far it holds.
#pragma once

#include <string>

#include "measure/choice/candidates.hpp"
#include "measure/choice/obstacle.hpp"
#include "measure/choice/requirement.hpp"
#include "measure/choice/respawn.hpp"
#include "measure/choice/room.hpp"

namespace lostbits::output::choice {

/// All that is known of a choice.
struct Chosen {
    const measure::choice::ChoiceRequest& request;
    const std::vector<measure::choice::Candidate>& all;
    measure::choice::TimedRays timed;
    std::optional<std::size_t> meets;                              ///< the cheapest that meets the wish
    std::vector<measure::choice::Room> rooms = {};                 ///< of that one
    std::optional<measure::choice::SafeOffsets> offsets = {};      ///< of that one, where it was measured
    std::optional<measure::choice::Obstacle> obstacle = {};        ///< where nothing meets the wish
    std::optional<measure::choice::Requirement> requirement = {};  ///< of each pixel of a scene
};

/// Bits to one decimal, or to as many as show on which side of the wish they are: 15.96 beside a wish of 16.
std::string bits_beside(double kept, const measure::choice::Wish& wish);
/// `, 0.0012 off`, with as many digits as tell it from the wish's tolerance; empty where there is none.
std::string off_beside(double off, const measure::choice::Wish& wish);

/// `16 bits of 99 of 100 hits, no wrong decision`.
std::string in_words(const measure::choice::Wish& wish);
/// The answer, several lines; every time is of this run.
std::string in_words(const Chosen& chosen);

}  // namespace lostbits::output::choice
