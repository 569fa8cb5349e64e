// The tests' reference for the truth, alone: a ray along z that meets a sphere of radius 1/4 at 5 - 1/4.
#include <cstdio>

#include "measure/truth/arb_reference.hpp"

int main() {
    using lostbits::testing::ArbReference;
    ArbReference reference;
    const auto found = reference.find({{0, 0, -5}, {0, 0, 1}}, {{0, 0, 0}, 0.25});
    std::printf("%s t = %g\n", found.decision == ArbReference::Decision::hit ? "hit" : "no hit", found.t);
    return 0;
}
