// A library of forms that was compiled with the headers of another version.
#include <cstddef>

extern "C" const void* lostbits_formulas(const void*) {
    static const struct {
        const char* build;
        const void* all;
        std::size_t count;
    } list{"lostbits 0.0.7-cafe, libstdc++ 12, GLM 998", nullptr, 1};
    return &list;
}
extern "C" const void* lostbits_forms(int, std::size_t* count) {
    *count = 0;
    static const char none = 0;
    return &none;
}
