// The table of methods to compute the bounding box of a primitive, in any format.
#pragma once

#include <span>

#include "intersect/bounding_box/list.hpp"
#include "number/format.hpp"
#include "shapes/bounding_box.hpp"

namespace lostbits::intersect::bounding_box {

struct BoxMethod {
    const BoxMethodInfo* info;
    /// Computes the box of a primitive whose numbers are first rounded to the format. The numbers of the box are of the
    /// format too. With a transform the box is in the world, around the corners of the box in the space of the
    /// primitive. The primitive must have a bounding box (`has_bounding_box`).
    BoundingBox<double> (*compute_box)(const Format&, const Primitive<double>&);
};

/// All methods, in the order of list.hpp.
std::span<const BoxMethod> box_methods();
/// The method used if none is named: the exact box rounded outward.
const BoxMethod& default_box_method();

}  // namespace lostbits::intersect::bounding_box
