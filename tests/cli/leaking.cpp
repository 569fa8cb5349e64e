// Leaks ten blocks of memory, which the test of leaks must find.
#include <cstdlib>

int main() {
    for (int i = 0; i < 10; ++i) {
        volatile char* const lost = static_cast<char*>(std::malloc(1000));
        lost[0] = 1;
    }
}
