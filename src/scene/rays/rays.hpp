// Makes the rays of a picture once, and stores them as the numbers that every form receives.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/range.hpp"
#include "intersect/march.hpp"
#include "number/format.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::scene::rays {

/// Rays of the pixel rows [y0, y1), with one array per component. Ray (y − y0)·width + x is pixel (x, y).
template <class T>
struct BasicRayBlock {
    int width = 0;
    int y0 = 0;
    int y1 = 0;
    std::vector<T> ox, oy, oz, dx, dy, dz;
    std::vector<double> tmin = {}, tmax = {};  ///< start and end of the range of each ray; empty: 0 and no end
    OpenEnds open_ends = {};                   ///< for the ranges of all rays

    [[nodiscard]] std::size_t size() const { return ox.size(); }
    void push(const Ray<T>& ray) {
        ox.push_back(ray.origin.x);
        oy.push_back(ray.origin.y);
        oz.push_back(ray.origin.z);
        dx.push_back(ray.direction.x);
        dy.push_back(ray.direction.y);
        dz.push_back(ray.direction.z);
    }
    /// Adds the range of ray i of another block, for the ray that is pushed just before or after this call. All rays
    /// share `open_ends`.
    template <class S>
    void push_range(const BasicRayBlock<S>& block, std::size_t i) {
        if (!block.tmin.empty()) tmin.push_back(block.tmin[i]);
        if (!block.tmax.empty()) tmax.push_back(block.tmax[i]);
        open_ends = block.open_ends;
    }
    [[nodiscard]] bool have_ranges() const { return !tmin.empty() || !tmax.empty() || open_ends.tmin; }
    [[nodiscard]] Range<double> range(std::size_t i) const {
        Range<double> ray_range{.open_ends = open_ends};
        if (!tmin.empty()) ray_range.tmin = tmin[i];
        if (!tmax.empty()) ray_range.tmax = tmax[i];
        return ray_range;
    }
    [[nodiscard]] Ray<T> operator[](std::size_t i) const { return {{ox[i], oy[i], oz[i]}, {dx[i], dy[i], dz[i]}}; }
    /// The six numbers of the rays, with a column for each number.
    [[nodiscard]] auto numbers() { return std::array{&ox, &oy, &oz, &dx, &dy, &dz}; }
    [[nodiscard]] auto numbers() const { return std::array{&ox, &oy, &oz, &dx, &dy, &dz}; }
    /// Declares that the rays are a list and not a picture: one line.
    void mark_as_list() { width = static_cast<int>(size()), y0 = 0, y1 = 1; }
};

/// Numbers of a format, held in doubles.
using RayBlock = BasicRayBlock<double>;
class GeneratedRays;
/// The ideal rays. Each takes about 500 bytes; make a few rows at a time.
struct IdealRayBlock : BasicRayBlock<Real> {
    /// Makes the rays in each format; null: each component of the ideal rays is rounded.
    std::shared_ptr<const GeneratedRays> generated_rays = {};
};

class StoredMesh;
/// A set of rays with the primitives at which they are aimed: the input of a step of a sweep.
struct RayGroup {
    RayBlock rays;
    std::vector<Primitive<double>> primitives;
    std::optional<intersect::MarchConstants<double>> march = {};  ///< absent: forms that march cannot be used
    bool is_paired = false;  ///< there are as many primitives as rays, and ray i is aimed only at primitive i
    std::shared_ptr<const StoredMesh> mesh = {};  ///< the meshes whose triangles come after the primitives
    /// The scene, for pixels of a scene whose camera has a projection, so that rays can be made in each format.
    std::shared_ptr<const file::Scene> scene = {};
};

/// Makes a group of one ray, without a primitive.
RayGroup make_group(const Ray<double>& ray);
/// Returns every n-th ray as a list, with the smallest n for which at most `max_rays` rays are left, and their
/// primitives except those of meshes.
RayGroup sample_rays(const RayGroup& group, std::size_t max_rays);

/// Sets the range of the scene's rays for all rays of a block.
template <class T>
void set_range(const file::Scene& scene, BasicRayBlock<T>& block) {
    if (scene.range.tmin > 0) block.tmin.assign(block.size(), scene.range.tmin);
    if (scene.range.tmax < HUGE_VAL) block.tmax.assign(block.size(), scene.range.tmax);
    block.open_ends = scene.range.open_ends;
}

/// Shared inputs: rays from the camera in double, each component rounded once to binary32.
RayBlock make_shared_rays(const file::Scene& scene, int y0, int y1);

/// Own inputs: the ideal rays, for `round_rays`.
IdealRayBlock make_own_rays(const file::Scene& scene, int y0, int y1);

/// Rounds each component of the ideal rays once to F, or makes the rays in F. A direction that rounds to zero stays,
/// and the measurement shows what a form makes of it.
RayBlock round_rays(const IdealRayBlock& ideal, const FloatFormat& format);

/// Rounds each component once to F, for shared inputs in a format narrower than binary32. Components that F holds do
/// not change.
RayBlock round_block(const RayBlock& block, const FloatFormat& format);

/// The primitives of a scene, in its order, with each number rounded once to binary32. A primitive takes 56 bytes.
std::vector<Primitive<double>> make_shared_primitives(const file::Scene& scene);

/// The primitive with each number rounded once to F. A radius that rounds to zero stays, too.
Primitive<double> round_primitive(const Primitive<Real>& primitive, const FloatFormat& format);
Primitive<double> round_primitive(const Primitive<double>& primitive, const FloatFormat& format);

/// The primitives of a scene as in a map: if inputs are shared, the primitives of all formats; else each number rounded
/// once to F.
std::vector<Primitive<double>> make_stored_primitives(const file::Scene& scene, const FloatFormat& format);

/// The inputs of a form in format F, for either kind of `inputs`: shared inputs are rounded to binary32 and then, if F
/// is narrower, to F; own inputs are rounded once to F.
RayBlock make_input_rays(const file::Scene& scene, int y0, int y1, const FloatFormat& format);

}  // namespace lostbits::scene::rays
