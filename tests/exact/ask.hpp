// Answers of lostbits to problems.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "exact/check.hpp"

namespace lostbits::exact {

/// By what the truth is found.
enum class TruthRoute {
    floats_for_ulps,  ///< columns of floats, each t to 2^-33 of itself
    floats,           ///< columns of floats
    doubles,          ///< columns of doubles
    one_by_one,       ///< ray after ray, as of those that no pack settles
    interface         ///< through liblostbits.so
};

/// Relative error bound of t computed by that route.
double tightness_of(TruthRoute route);

/// All problems of a batch have their ends open alike, and matrices of one kind; through the interface, not inverses.
void ask(std::string_view shape, TruthRoute route, std::span<const Problem> problems, std::vector<Answer>& answers);

/// Which of the problems are hits, 0 or 1: of rays that go on without end, by columns, with nothing asked beside. The
/// open primitive, without its rim, is asked where `with_rim` is false.
void decide(std::string_view shape, TruthRoute route, bool with_rim, std::span<const Problem> problems,
            std::vector<std::uint8_t>& hits);

/// The shapes that lostbits has, and how many numbers a primitive of each.
std::vector<std::pair<std::string_view, std::size_t>> shapes_there_are();

}  // namespace lostbits::exact
