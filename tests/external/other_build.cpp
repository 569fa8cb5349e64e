// A library of forms that was compiled with the headers of another version.
#include <lostbits_plugin.h>

#include <cstddef>

namespace lostbits::intersect::external {

struct FormulaWatch {};
struct FormulaList {
    const char* build;
    const void* all;
    std::size_t count;
};

extern "C" const FormulaList* lostbits_formulas(const FormulaWatch*) {
    static const FormulaList list{"lostbits 0.0.7-cafe, libstdc++ 12, GLM 998", nullptr, 1};
    return &list;
}

}  // namespace lostbits::intersect::external

extern "C" const lb_form* lostbits_forms(int, std::size_t* count) {
    *count = 0;
    static const lb_form none{};
    return &none;
}
