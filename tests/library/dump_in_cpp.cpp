// lostbits_dump.h in C++, of doubles.
#define LOSTBITS_DUMP_REAL double
#include <lostbits_dump.h>

int dump_of_doubles(const char* path) {
    lostbits_dump dump;
    if (lostbits_dump_begin(&dump, 1, "triangle") != 0) return -1;
    const double o[] = {0, 0, 3}, d[] = {0, 0, -1}, corners[] = {-1, -1, 0, 1, -1, 0, 0, 1, 0};
    for (unsigned i = 0; i < 2; ++i) lostbits_dump_add(&dump, i, o, d, 0, 1e300, corners, 1, 3.0);
    return lostbits_dump_end(&dump, path);
}
