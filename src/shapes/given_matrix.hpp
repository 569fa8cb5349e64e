// A matrix that a solid is to stand under, as it is given: twelve numbers, row by row.
#pragma once

#include <array>
#include <string_view>

#include "shapes/lift.hpp"

namespace lostbits {

/// With the sign of its determinant; one that is not proper is to be refused.
template <class S>
Placement<S> placement_of(const std::array<S, Affine<S>::numbers>& numbers, bool is_inverse = false) {
    return {numbers, is_inverse, orientation_of(numbers)};
}

/// Why it is refused, behind "the matrix " or the name of its key.
inline constexpr std::string_view singular_words =
    "is singular: it flattens the solid, and no ray can be taken back; write rows that lie in no plane";

}  // namespace lostbits
