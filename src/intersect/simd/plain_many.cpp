#include "intersect/simd/plain_many.hpp"

#include <algorithm>
#include <vector>

#include <lostbits_widths.hpp>  // generated: the widths of this build
#include "intersect/simd/packed.hpp"

namespace lostbits::intersect::simd {

std::span<const PlainFormKernels> all_plain_kernels() {
#ifdef LOSTBITS_HAS_W256
    // The function that fills the rows was itself compiled for these registers.
    const auto isas = available_isas();
    if (std::ranges::find(isas, Isa::w256) == isas.end()) return {};
    static const auto rows = [] {
        const auto forms = table::intersectors(shape_as<Box>);
        std::vector<PlainFormKernels> filled(forms.size());
        fill_plain_w256(filled.data());
        for (std::size_t i = 0; i < forms.size(); ++i) filled[i].info = forms[i].info;
        std::erase_if(filled, [](const PlainFormKernels& row) { return !row.columns; });
        return filled;
    }();
    return rows;
#else
    return {};
#endif
}

}  // namespace lostbits::intersect::simd
