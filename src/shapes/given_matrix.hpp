// The transform of a primitive, whose matrix the user gives as twelve numbers, row by row.
#pragma once

#include <array>
#include <string_view>

#include "shapes/lift.hpp"

namespace lostbits {

/// Builds the transform, with the sign of the determinant. The caller must refuse it if it is not proper.
template <class S>
Transform<S> transform_of(const std::array<S, Affine<S>::number_count>& numbers, bool is_inverse = false) {
    return {numbers, is_inverse, orientation_of(numbers)};
}

/// Reason for refusing a transform that is not proper, as the rest of a sentence after "the matrix " or the name of its
/// key.
inline constexpr std::string_view singular_reason =
    "is singular: it flattens the primitive, so no ray can be transformed back; write rows that do not lie in one "
    "plane";

}  // namespace lostbits
