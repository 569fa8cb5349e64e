#include "intersect/contraction.hpp"

namespace lostbits::test {

double product_minus(double a, double b, double c) { return a * b - c; }

bool compiled_for_fma() {
#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
    return true;
#else
    return false;
#endif
}

}  // namespace lostbits::test
