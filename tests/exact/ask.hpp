// Answers of lostbits to problems.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "exact/check.hpp"

namespace lostbits::exact {

/// Route by which the truth is found.
enum class TruthRoute {
    floats_for_ulps,  ///< columns of floats, each t to 2^-33 of itself
    floats,           ///< columns of floats
    doubles,          ///< columns of doubles
    one_by_one,       ///< ray after ray, as of those that no pack settles
    interface         ///< through liblostbits.so
};

/// Relative error bound of t computed by that route.
double tightness_of(TruthRoute route);

/// All problems of a batch have the same open ends and matrices of one kind; through the interface, no inverses.
void ask(std::string_view shape, TruthRoute route, std::span<const Problem> problems, std::vector<Answer>& answers);

/// Decides each problem as 1 (hit) or 0, for rays without end, by columns and without any other result. If `with_rim`
/// is false, the primitive is open: its rim does not belong to it.
void decide(std::string_view shape, TruthRoute route, bool with_rim, std::span<const Problem> problems,
            std::vector<std::uint8_t>& hits);

/// The shapes of lostbits, and the count of numbers of a primitive of each shape.
std::vector<std::pair<std::string_view, std::size_t>> all_shapes();

}  // namespace lostbits::exact
