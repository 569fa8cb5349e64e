// lostbits_dump.h in C++, of doubles: SHAPE FILE T NUMBERS… writes that the ray from (0, 0, 9) down meets the primitive
// of these numbers at t, and a second ray, for which there is no room.
#define LOSTBITS_DUMP_REAL double
#include <lostbits_dump.h>

int main(int count, char** words) {
    lostbits_dump dump;
    if (count < 4 || lostbits_dump_begin(&dump, 1, words[1]) != 0 || dump.primitive != count - 4) return 1;
    const double o[] = {0, 0, 9}, d[] = {0, 0, -1};
    double primitive[LOSTBITS_DUMP_MOST] = {0};
    for (int k = 0; k < dump.primitive; ++k) primitive[k] = atof(words[4 + k]);
    for (unsigned i = 0; i < 2; ++i) lostbits_dump_add(&dump, i, o, d, 0, 1e300, primitive, 1, atof(words[3]));
    return dump.count != 2 || lostbits_dump_end(&dump, words[2]) != 0;
}
