// Forms that are given the rays of a camera as a way makes them, as rows of the table.
#pragma once

#include "intersect/table/table.hpp"
#include "scene/camera/makers.hpp"

namespace lostbits::scene::rays {

/// What a name has between the form and the way: `sphere.unified@ray-three`.
inline constexpr std::string_view maker_prefix = "ray-";

/// The row `sphere.unified@ray-three`: the form itself, asked about rays made that way. Made once and kept. InputError
/// for sets, and for forms through the space of solids under matrices, which a scene with `camera.rays` asks.
const intersect::table::Intersector& with_maker(const camera::Maker& maker, const intersect::table::Intersector& form);

/// Null where the scene says who makes the rays.
const camera::Maker* maker_of(const intersect::table::Intersector& row);

/// The row itself, to be made part of another one. InputError where its rays are made already: the way stands last, as
/// in `FORM^BOX@ray-WAY`.
const intersect::table::Intersector& without_maker(const intersect::table::Intersector& row);

}  // namespace lostbits::scene::rays
