// Computations in separate files, so that the compiler of a caller cannot see what they compute.
#pragma once

namespace lostbits::test {

/// Compiled for this machine's own instruction set, where a compiler may fuse if it is allowed to: a·b − c as formulas
/// write it, with the project's own options, and with contraction allowed (the control).
double product_minus(double a, double b, double c);
double product_minus_contracted(double a, double b, double c);

/// True if the instruction set that the two were compiled for has FMA at all.
bool compiled_for_fma();

/// Doubles that are converted to floats and back.
struct PairOfDoubles {
    double first, second;
};
PairOfDoubles rounded_pair(double first, double second);

}  // namespace lostbits::test
