// A scene changed as a whole: seen from farther away, enlarged, grown, moved.
#pragma once

#include <optional>

#include "number/real.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::scene::file {

/// tan(degrees/2), and the degrees of which a number is that; by MPFR, so the same on every machine.
Real half_tangent(const Real& degrees);
Real degrees_of(const Real& half_tangent);

/// The mean of the middles of the solids, and of the largest sphere of a flake; world units.
Vec<Real> middle_of(const Scene& scene);
Vec<Real> middle_of(const Solid<Real>& solid);

/// The radius of a sphere; of a box half its longest side. Under a matrix times the cube root of |det A|.
Real size_of(const Solid<Real>& solid);

/// (1, 11/16, −7/16): the way in which everything is moved, short in binary and along no axis.
Vec<Real> offset_direction();

/// A solid moved; and one k times as large about its point nearest to `still` (of a sphere a point of the surface,
/// also from inside), which stays where it is. The latter is nothing for a sphere whose centre that is. Under a matrix
/// the first moves the matrix, and the second is done in the space of the solid.
Solid<Real> moved(const Solid<Real>& solid, const Vec<Real>& by);
std::optional<Solid<Real>> grown(const Solid<Real>& solid, const Vec<Real>& still, const Real& k);

/// How far the solids' middle lies in front of the eye, in lengths of look_at − eye along it.
Real view_share(const Scene& scene);

// All of these take cameras but those of the pixel plane, which stay where they are.

/// The eye goes straight back along its view until the solids' middle is k times as far, measured along the view;
/// tan(fov/2) is divided by k, so the picture stays. Nothing where the middle lies behind the eye.
std::optional<Scene> farther(Scene scene, const Real& k);
/// Every length k times itself, about the origin: solids, eye, light, and the picture of parallel rays. No flake.
Scene enlarged(Scene scene, const Real& k);
/// Each solid about its point nearest to the eye. Nothing where the eye is a centre. No flake.
std::optional<Scene> grown(Scene scene, const Real& k);
/// Everything by a vector: solids, eye and light. The centre of a flake is rounded to double.
Scene moved(Scene scene, const Vec<Real>& by);

}  // namespace lostbits::scene::file
