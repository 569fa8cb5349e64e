// Contraction would turn a·b − c into one rounding where a formula says two, at any optimisation, even in ISO mode. A
// conversion to float rounds, also where two stand side by side (cmake/isa.cmake has the incident).
#include <cmath>

#include "catch.hpp"
#include "intersect/contraction.hpp"

namespace lostbits::test {

TEST_CASE("the compiler does not fuse a·b − c", "[intersect][bits]") {
    const double a = 1 + 0x1p-30;  // a² = 1 + 2^-29 + 2^-60, whose last bit a product alone rounds away
    const double rounded = 1 + 0x1p-29;
    CHECK(product_minus(a, a, rounded) == 0);
    CHECK(std::fma(a, a, -rounded) == 0x1p-60);
    // The control: where contraction is allowed and the machine has FMA, the same line does fuse.
    if (compiled_for_fma()) CHECK(product_minus_contracted(a, a, rounded) == 0x1p-60);
    else WARN("no FMA on this machine: the control has nothing to fuse");
}

TEST_CASE("a double converted to float and back is rounded", "[intersect][bits]") {
    const auto [first, second] = rounded_pair(1.0 / 3, 1.0 / 7);
    CHECK(first == 0x1.555556p-2);
    CHECK(second == 0x1.24924ap-3);
}

}  // namespace lostbits::test
