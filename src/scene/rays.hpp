// The rays of a picture, made once and stored as the numbers that every form is given.
#pragma once

#include <vector>

#include "geometry/shapes.hpp"
#include "number/format.hpp"
#include "scene/scene.hpp"

namespace lostbits::scene {

/// Rays of the pixel rows [y0, y1), a component an array: ray (y − y0)·width + x is pixel (x, y).
template <class T>
struct BasicRayBlock {
    int width = 0;
    int y0 = 0;
    int y1 = 0;
    std::vector<T> ox, oy, oz, dx, dy, dz;

    [[nodiscard]] std::size_t size() const { return ox.size(); }
    [[nodiscard]] Ray<T> operator[](std::size_t i) const {
        return {{ox[i], oy[i], oz[i]}, {dx[i], dy[i], dz[i]}};
    }
};

/// Numbers of a format, held in doubles.
using RayBlock = BasicRayBlock<double>;
/// The ideal rays. About 500 bytes each: ask for a few rows at a time.
using IdealRayBlock = BasicRayBlock<Real>;

/// Shared inputs: the camera in double, each component then rounded once to binary32.
RayBlock make_shared_rays(const Scene& scene, int y0, int y1);

/// Own inputs: the ideal rays, for `round_rays`.
IdealRayBlock make_own_rays(const Scene& scene, int y0, int y1);

/// Each component of the ideal rays, rounded once to F. A direction that rounds to zero is kept: what a form makes
/// of it is for the measurement to say.
RayBlock round_rays(const IdealRayBlock& ideal, const FloatFormat& f);

/// Each component rounded once to F: shared inputs in a format narrower than binary32. The identity where F holds them.
RayBlock round_block(const RayBlock& block, const FloatFormat& f);

/// The sphere, each number rounded once to F. A radius that rounds to zero is kept, as above.
Sphere<double> round_sphere(const SphereSpec& spec, const FloatFormat& f);
Sphere<double> round_sphere(const Sphere<double>& sphere, const FloatFormat& f);
/// The sphere of shared inputs: rounded once to binary32.
Sphere<double> shared_sphere(const SphereSpec& spec);

/// What a form in format F is given, whatever the scene's `inputs`: shared inputs rounded to binary32 and then, where
/// F is narrower, to F; own inputs rounded once to F.
RayBlock input_rays(const Scene& scene, int y0, int y1, const FloatFormat& f);
Sphere<double> input_sphere(const Scene& scene, std::size_t sphere, const FloatFormat& f);

}  // namespace lostbits::scene
