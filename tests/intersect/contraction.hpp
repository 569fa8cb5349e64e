// Compiled for this machine's own instruction set, where a compiler may fuse a·b − c if it is allowed to.
#pragma once

namespace lostbits::test {

/// a·b − c as formulas write it, with the project's own options, and with contraction allowed (the control).
double product_minus(double a, double b, double c);
double product_minus_contracted(double a, double b, double c);

/// Whether the instruction set that the two were compiled for has FMA at all.
bool compiled_for_fma();

}  // namespace lostbits::test
