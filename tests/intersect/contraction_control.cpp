#include "intersect/contraction.hpp"

namespace lostbits::test {

double product_minus_contracted(double a, double b, double c) { return a * b - c; }

}  // namespace lostbits::test
