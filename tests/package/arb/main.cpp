// A root as a ball, to 64 bits: the header and the library that were found are of one Arb.
#include <cstdio>

#if ARB_IN_FLINT
#include <flint/arb.h>
#else
#include <arb.h>
#endif

int main() {
    arb_t x;
    arb_init(x);
    arb_sqrt_ui(x, 16, 64);
    std::printf("root = %g\n", arf_get_d(arb_midref(x), ARF_RND_NEAR));
    arb_clear(x);
    return 0;
}
