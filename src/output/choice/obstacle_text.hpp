// What stands in the way of a wish, in words.
#pragma once

#include <string>

#include "output/choice/choice_text.hpp"

namespace lostbits::output::choice {

/// Lines with two blanks in front, for a choice that has an obstacle; `near` comes nearest to the wish.
std::string obstacle_in_words(const Chosen& chosen, const measure::choice::Candidate& near);

}  // namespace lostbits::output::choice
