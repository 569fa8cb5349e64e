// As Unreal Engine takes a position into the space of a primitive from 5.4 on: the world in two floats, the matrix
// relative to where the primitive stands.
#pragma once

#include "intersect/space/in_double.hpp"

namespace lostbits::intersect::space {

/// On the processor, in double: `PositionHigh` is τ in float, and M with τ less by it is inverted and rounded to float.
/// In a shader: o − PositionHigh, then that matrix. A stored τ is a float, so that nothing is left of it in the matrix.
struct UnrealSpace : RelativeSpace {
    static constexpr SpaceInfo info{
        .name = "unreal",
        .title = "M less T inverted in the next wider format and rounded; o - T, then that; t kept",
        .source =
            "Unreal Engine 5.4, PrimitiveUniformShaderParametersBuilder.h Build, Core/Private/Math/"
            "DoubleFloat.cpp:28 MakeToRelativeWorldMatrixDouble, DoubleFloat.ush DFMultiplyDemote "
            "(FDFInverseMatrix)",
    };

    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        return InDoubleSpace::inverse(m);
    }
};

}  // namespace lostbits::intersect::space
