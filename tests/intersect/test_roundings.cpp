// A conversion to float rounds, also where two stand side by side (cmake/isa.cmake has the incident).
#include "catch.hpp"
#include "intersect/rounded_pair.hpp"

namespace lostbits::test {

TEST_CASE("doubles that become floats and doubles again are rounded", "[intersect][bits]") {
    const auto [first, second] = rounded_pair(1.0 / 3, 1.0 / 7);
    CHECK(first == 0x1.555556p-2);
    CHECK(second == 0x1.24924ap-3);
}

}  // namespace lostbits::test
