// Meshes made by formula, in binary64 and by + − × ÷ √ alone, so they are the same on every machine.
#pragma once

#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::scene::triangle {

/// 20·4^levels faces, closed, wound outward. The icosahedron's twelve corners are (±1, ±φ, 0) and its rotations,
/// divided by √(1 + φ²), φ = (1 + √5)/2. Each level adds a corner in the middle of every edge, divided by its length.
/// At the end each corner is multiplied by the radius and added to the centre.
Mesh make_icosphere(int levels, const Vec<double>& centre, double radius);

/// 2·across·up faces over a rectangle around the centre. Relative to it, the corner (i, j) is at x = size.x (i/across
/// − 1/2), y = size.y (j/up − 1/2) and z = bump (1 − (2x/size.x)²)(1 − (2y/size.y)²). Its border is open.
Mesh make_grid(std::uint32_t across, std::uint32_t up, const Vec<double>& centre, const Vec<double>& size, double bump);

/// 2·around·along faces, closed: a tube of `radius` bent into a ring of `ring_radius` about the z axis of the centre.
Mesh make_tube(std::uint32_t around, std::uint32_t along, const Vec<double>& centre, double ring_radius, double radius);

/// `count` thin triangles around the centre, in its plane of z: a disc of that radius. Its border is open.
Mesh make_fan(std::uint32_t count, const Vec<double>& centre, double radius);

}  // namespace lostbits::scene::triangle
