// Spaces and ways of computing a box by their names.
#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "intersect/hull/hulls.hpp"
#include "intersect/space/space.hpp"

namespace lostbits::test {

template <class Row>
const Row& row_named(std::span<const Row> rows, std::string_view name) {
    const auto found = std::ranges::find(rows, name, [](const Row& row) { return row.info->name; });
    return found == rows.end() ? throw std::logic_error("no row " + std::string(name)) : *found;
}

inline const intersect::space::Space& space_named(std::string_view name) {
    return row_named(intersect::space::spaces(), name);
}
inline const intersect::hull::HullWay& hull_named(std::string_view name) {
    return row_named(intersect::hull::hulls(), name);
}

}  // namespace lostbits::test
