#include "intersect/simd/plain_many.hpp"

#include <algorithm>
#include <array>

#include "intersect/catalogue.hpp"
#include "intersect/simd/packed.hpp"

namespace lostbits::intersect::simd {

std::span<const PlainRow> plain_rows() {
#if defined(LOSTBITS_PACKED_X86)
    static const auto rows = [] {
        std::array<PlainRow, BoxForms::size> filled{};
        fill_plain_w256(filled.data());
        std::size_t i = 0;
        BoxForms::for_each([&]<class Form>() { filled[i++].info = &Form::info; });
        return filled;
    }();
    const auto isas = available_isas();
    if (std::ranges::find(isas, Isa::w256) != isas.end()) return rows;
#endif
    return {};
}

}  // namespace lostbits::intersect::simd
