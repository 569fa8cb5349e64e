// The program that `probe` runs, and its operations by name.
#pragma once

#include <string>

namespace lostbits::intersect::device {

/// Results that the program computes from six numbers x y z u v w, in this order.
enum class ProbedOperation : unsigned {
    add,           ///< x + y
    subtract,      ///< x - y
    multiply,      ///< x * y
    divide,        ///< x / y
    square_root,   ///< sqrt(|x|)
    inverse_root,  ///< inversesqrt(|x|)
    length,        ///< length(x y z)
    normalize,     ///< normalize(x y z).x
    fma,           ///< fma(x, y, z)
    fma_precise,   ///< the same, precise
    contraction,   ///< x * y + z
    contraction_precise,
    dot,      ///< dot(x y z, u v w)
    two_sum,  ///< the error of x + y by Knuth
    two_sum_precise,
    kahan,  ///< x + y + z + u + v + w by Kahan
    kahan_precise,
    factored,      ///< x * y + x * z
    root_squared,  ///< sqrt(|x|) * sqrt(|x|)
    count
};
inline constexpr std::size_t probed_count = static_cast<std::size_t>(ProbedOperation::count);

/// Returns GLSL that reads six numbers for each element at binding 0, and writes `probed_count` answers for each
/// element at binding 1.
std::string write_probe_program(int bits, int version);

enum class LoopKind { single, nested };

/// Returns GLSL that counts to the first number at binding 0 and writes the count at binding 1. If the loop is nested,
/// an outer loop repeats this as many times as the third number at binding 0 says.
std::string write_loop_program(int version, LoopKind kind);

}  // namespace lostbits::intersect::device
