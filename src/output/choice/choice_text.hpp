// A choice in words: what meets the wish, what it costs and assumes, and how far it holds.
#pragma once

#include <string>

#include "measure/choice/candidates.hpp"
#include "measure/choice/room.hpp"

namespace lostbits::output::choice {

/// All that is known of a choice.
struct Chosen {
    const measure::choice::ChoiceRequest& request;
    const std::vector<measure::choice::Candidate>& all;
    measure::choice::TimedRays timed;
    std::optional<std::size_t> meets;               ///< the cheapest that meets the wish
    std::vector<measure::choice::Room> rooms = {};  ///< of that one
};

/// The places of all, cheapest first.
std::vector<std::size_t> by_price(const std::vector<measure::choice::Candidate>& all);

/// `16 bits of 99 of 100 hits, no wrong decision`.
std::string in_words(const measure::choice::Wish& wish);
/// The answer, several lines; every time is of this run.
std::string in_words(const Chosen& chosen);

}  // namespace lostbits::output::choice
