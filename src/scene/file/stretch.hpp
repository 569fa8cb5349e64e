// Changes a scene as a whole: views it from farther away, enlarges it, grows its primitives, or moves it.
#pragma once

#include <optional>

#include "number/real.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::scene::file {

/// tan(degrees/2) and its inverse. They use MPFR, so they are the same on every machine.
Real half_tangent(const Real& degrees);
Real degrees_of(const Real& half_tangent);

/// The mean of the middles of the primitives, triangles of meshes included, and of the largest sphere of a flake, in
/// world units.
Vec<Real> middle_of(const Scene& scene);
Vec<Real> middle_of(const Primitive<Real>& primitive);

/// The radius of a sphere, or half of the longest side of a box. With a transform it is multiplied by the cube root of
/// |det A|.
Real size_of(const Primitive<Real>& primitive);

/// (1, 11/16, −7/16): the direction in which everything is moved. Its numbers are short in binary, and it is not along
/// an axis.
Vec<Real> offset_direction();

/// `translate` moves a primitive by `offset`. `grow` scales a primitive by k about its point nearest to `viewpoint`.
/// This point stays where it is; for a sphere it is a point of the surface, also from inside. `grow` returns nothing
/// for a sphere centred at `viewpoint`. For a transformed primitive, `translate` changes the matrix, and `grow` works
/// in the space of the primitive.
Primitive<Real> translate(const Primitive<Real>& primitive, const Vec<Real>& offset);
std::optional<Primitive<Real>> grow(const Primitive<Real>& primitive, const Vec<Real>& viewpoint, const Real& k);

/// Distance of the primitives' middle in front of the eye, in lengths of look_at − eye along it.
Real view_fraction(const Scene& scene);

// All functions below accept every camera except cameras of kind `pixel_plane`, which stay where they are.

/// Moves the eye straight back along its view until the primitives' middle is k times as far, measured along the view.
/// tan(fov/2) is divided by k, so the picture stays the same. Returns nothing if the middle is behind the eye.
std::optional<Scene> move_farther(Scene scene, const Real& k);
/// Multiplies every length by k about the origin: primitives, eye, light, and the picture of parallel rays, but not a
/// flake.
Scene enlarge(Scene scene, const Real& k);
/// Scales each primitive about its point nearest to the eye, but not a flake. Returns nothing if the eye is at a
/// centre, and for a scene with meshes.
std::optional<Scene> grow(Scene scene, const Real& k);
/// Moves everything by a vector: primitives, eye and light. The centre of a flake and the vertices of meshes are
/// rounded to double.
Scene translate(Scene scene, const Vec<Real>& offset);

}  // namespace lostbits::scene::file
