// What lostbits says of problems.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "exact/check.hpp"

namespace lostbits::exact {

/// By what the truth is found.
enum class Way {
    floats_for_ulps,  ///< columns of floats, each t to 2^-33 of itself
    floats,           ///< columns of floats
    doubles,          ///< columns of doubles
    one_by_one,       ///< ray after ray, as of those that no pack settles
    interface         ///< through liblostbits.so
};

/// How close t is known by that way, as a share of itself.
double tightness_of(Way way);

/// All problems of a batch have their ends open alike, and matrices of one kind; through the interface, not inverses.
void ask(std::string_view shape, Way way, std::span<const Problem> problems, std::vector<Answer>& answers);

/// The shapes that lostbits has, and how many numbers a solid of each.
std::vector<std::pair<std::string_view, std::size_t>> shapes_there_are();

}  // namespace lostbits::exact
