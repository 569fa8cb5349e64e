// The transform of Unreal Engine into the space of a primitive, from version 5.4 on: world positions are in two floats,
// and the matrix is relative to the position of the primitive.
#pragma once

#include "intersect/transform/in_double.hpp"

namespace lostbits::intersect::transform {

/// On the processor, in double: `PositionHigh` is τ rounded to float. It is subtracted from τ in M, and the resulting
/// matrix is inverted and rounded to float. In a shader: o − PositionHigh is multiplied by that inverse. The stored τ
/// is a float here, so the difference is 0.
struct UnrealTransform : RelativeTransform {
    static constexpr TransformMethodInfo info{
        .name = "unreal",
        .title = "M less T inverted in the next wider format and rounded; o - T, then that; t kept",
        .source =
            "Unreal Engine 5.4, PrimitiveUniformShaderParametersBuilder.h Build, Core/Private/Math/"
            "DoubleFloat.cpp:28 MakeToRelativeWorldMatrixDouble, DoubleFloat.ush DFMultiplyDemote "
            "(FDFInverseMatrix)",
    };

    template <Number T>
    static Affine<T> inverse(const Affine<T>& m) {
        return InDoubleTransform::inverse(m);
    }
};

}  // namespace lostbits::intersect::transform
