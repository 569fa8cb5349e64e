// Transforms and box methods by their names.
#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "intersect/bounding_box/box_methods.hpp"
#include "intersect/transform/transform_method.hpp"

namespace lostbits::test {

template <class Row>
const Row& row_named(std::span<const Row> rows, std::string_view name) {
    const auto found = std::ranges::find(rows, name, [](const Row& row) { return row.info->name; });
    return found == rows.end() ? throw std::logic_error("no row " + std::string(name)) : *found;
}

inline const intersect::transform::TransformMethod& transform_method_named(std::string_view name) {
    return row_named(intersect::transform::transform_methods(), name);
}
inline const intersect::bounding_box::BoxMethod& box_method_named(std::string_view name) {
    return row_named(intersect::bounding_box::box_methods(), name);
}

}  // namespace lostbits::test
