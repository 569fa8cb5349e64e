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

/// The radius of a sphere, or half of the longest side of a box. Under a matrix it is multiplied by the cube root of
/// |det A|.
Real size_of(const Primitive<Real>& primitive);

/// (1, 11/16, −7/16): the direction in which everything is moved. Its numbers are short in binary, and it is not along
/// an axis.
Vec<Real> offset_direction();

/// `moved` moves a primitive. `grown` scales a primitive by k about its point nearest to `viewpoint`; this point stays
/// where it is (for a sphere it is a point of the surface, also from inside). `grown` returns nothing for a sphere
/// centred at `viewpoint`. For a primitive under a matrix, `moved` changes the matrix, and `grown` works in the space
/// of the primitive.
Primitive<Real> moved(const Primitive<Real>& primitive, const Vec<Real>& by);
std::optional<Primitive<Real>> grown(const Primitive<Real>& primitive, const Vec<Real>& viewpoint, const Real& k);

/// Distance of the primitives' middle in front of the eye, in lengths of look_at − eye along it.
Real view_share(const Scene& scene);

// All functions below accept every camera except cameras of kind `pixel_plane`, which stay where they are.

/// Moves the eye straight back along its view until the primitives' middle is k times as far, measured along the view.
/// tan(fov/2) is divided by k, so the picture stays the same. Returns nothing if the middle is behind the eye.
std::optional<Scene> farther(Scene scene, const Real& k);
/// Multiplies every length by k about the origin: primitives, eye, light, and the picture of parallel rays, but not a
/// flake.
Scene enlarged(Scene scene, const Real& k);
/// Scales each primitive about its point nearest to the eye, but not a flake. Returns nothing if the eye is at a
/// centre, and for a scene with meshes.
std::optional<Scene> grown(Scene scene, const Real& k);
/// Moves everything by a vector: primitives, eye and light. The centre of a flake and the vertices of meshes are
/// rounded to double.
Scene moved(Scene scene, const Vec<Real>& by);

}  // namespace lostbits::scene::file
