// Phrases for wrong decisions.
#pragma once

#include <string_view>

#include "measure/answer/outcome.hpp"

namespace lostbits::measure::answer {

/// Phrase for one ray with this wrong decision, such as `a false miss`.
constexpr std::string_view wrong_decision_phrase(Outcome wrong) {
    switch (wrong) {
        case Outcome::false_hit: return "a false hit";
        case Outcome::false_miss: return "a false miss";
        case Outcome::wrong_primitive: return "a hit of the wrong primitive";
        case Outcome::crack: return "a crack in the mesh";
        case Outcome::double_hit: return "a double hit";
        case Outcome::out_of_order: return "two triangles out of order";
        default: return "an answer that is not a number";
    }
}

}  // namespace lostbits::measure::answer
