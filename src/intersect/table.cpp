#include <array>

#include "intersect/rows.hpp"

namespace lostbits {

std::span<const Intersector> sphere_intersectors() {
    static const auto rows = [] {
        std::array<Intersector, SphereForms::size> filled{};
        fill_native(filled);
        fill_rounded(filled);
        fill_enclosed(filled);
        return filled;
    }();
    return rows;
}

}  // namespace lostbits
