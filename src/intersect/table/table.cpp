#include <algorithm>
#include <array>

#include "intersect/table/rows.hpp"

namespace lostbits::intersect::table {

std::span<const Intersector> intersectors() {
    static const auto rows = [] {
        std::array<Intersector, form_count> filled{};
        fill_native(filled);
        fill_rounded(filled);
        fill_enclosed(filled);
        fill_logs(filled);
        fill_recorded(filled);
        return filled;
    }();
    return rows;
}

std::span<const Intersector> intersectors(Shape shape) {
    const auto all = intersectors();
    const auto first = std::ranges::find(all, shape, &Intersector::shape);
    const auto last = std::find_if(first, all.end(), [shape](const Intersector& i) { return i.shape != shape; });
    return {first, last};
}

}  // namespace lostbits::intersect::table
