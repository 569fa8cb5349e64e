#include "intersect/contraction.hpp"

namespace lostbits::test {

PairOfDoubles rounded_pair(double first, double second) {
    return {static_cast<float>(first), static_cast<float>(second)};
}

}  // namespace lostbits::test
