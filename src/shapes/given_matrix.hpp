// A given matrix for a primitive: twelve numbers, row by row.
#pragma once

#include <array>
#include <string_view>

#include "shapes/lift.hpp"

namespace lostbits {

/// Builds the placement, with the sign of its determinant. The caller refuses a placement that is not proper.
template <class S>
Placement<S> placement_of(const std::array<S, Affine<S>::numbers>& numbers, bool is_inverse = false) {
    return {numbers, is_inverse, orientation_of(numbers)};
}

/// The reason for refusing it. The text in front is "the matrix " or the name of its key.
inline constexpr std::string_view singular_words =
    "is singular: it flattens the primitive, so no ray can be transformed back; write rows that do not lie in one "
    "plane";

}  // namespace lostbits
