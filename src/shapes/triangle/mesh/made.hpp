// Makes meshes by formula, in binary64 and with + − × ÷ √ alone, so they are the same on every machine.
#pragma once

#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::scene::triangle {

/// Makes a closed mesh of 20·4^level_count faces, wound outward. The icosahedron's twelve corners are (±1, ±φ, 0) and
/// its rotations, divided by √(1 + φ²), φ = (1 + √5)/2. Each level adds a corner in the middle of every edge, divided
/// by its length. At the end each corner is multiplied by the radius and added to the centre.
Mesh make_icosphere(int level_count, const Vec<double>& centre, double radius);

/// Makes 2·across·up faces over a rectangle around the centre. Relative to the centre, the corner (i, j) is at x =
/// size.x (i/across − 1/2), y = size.y (j/up − 1/2) and z = bump (1 − (2x/size.x)²)(1 − (2y/size.y)²). The border is
/// open.
Mesh make_grid(std::uint32_t across, std::uint32_t up, const Vec<double>& centre, const Vec<double>& size, double bump);

/// Makes a closed mesh of 2·around·along faces: a tube of `radius`, bent into a ring of `ring_radius` about the z axis
/// through the centre.
Mesh make_tube(std::uint32_t around, std::uint32_t along, const Vec<double>& centre, double ring_radius, double radius);

/// Makes a disc of `count` thin triangles around the centre, across z. The border is open.
Mesh make_fan(std::uint32_t count, const Vec<double>& centre, double radius);

}  // namespace lostbits::scene::triangle
