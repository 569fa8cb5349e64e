// The rays of a picture, made once and stored as the numbers that every form is given.
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
#include "shapes/solid.hpp"

namespace lostbits::scene::rays {

/// Rays of the pixel rows [y0, y1), a component per array: ray (y − y0)·width + x is pixel (x, y).
template <class T>
struct BasicRayBlock {
    int width = 0;
    int y0 = 0;
    int y1 = 0;
    std::vector<T> ox, oy, oz, dx, dy, dz;
    std::vector<double> tmin = {}, tmax = {};  ///< where the range of each ray begins and ends; empty: at 0, nowhere
    OpenEnds open = {};                        ///< of all of these ranges

    [[nodiscard]] std::size_t size() const { return ox.size(); }
    void push(const Ray<T>& ray) {
        ox.push_back(ray.origin.x);
        oy.push_back(ray.origin.y);
        oz.push_back(ray.origin.z);
        dx.push_back(ray.direction.x);
        dy.push_back(ray.direction.y);
        dz.push_back(ray.direction.z);
    }
    /// The range of a ray of another block, for the ray that is pushed before or after it. All open the same ends.
    template <class S>
    void push_range(const BasicRayBlock<S>& from, std::size_t i) {
        if (!from.tmin.empty()) tmin.push_back(from.tmin[i]);
        if (!from.tmax.empty()) tmax.push_back(from.tmax[i]);
        open = from.open;
    }
    [[nodiscard]] bool have_ranges() const { return !tmin.empty() || !tmax.empty() || open.tmin; }
    [[nodiscard]] Range<double> range(std::size_t i) const {
        Range<double> one{.open = open};
        if (!tmin.empty()) one.tmin = tmin[i];
        if (!tmax.empty()) one.tmax = tmax[i];
        return one;
    }
    [[nodiscard]] Ray<T> operator[](std::size_t i) const { return {{ox[i], oy[i], oz[i]}, {dx[i], dy[i], dz[i]}}; }
    /// The six numbers of the rays, a column each.
    [[nodiscard]] auto numbers() { return std::array{&ox, &oy, &oz, &dx, &dy, &dz}; }
    [[nodiscard]] auto numbers() const { return std::array{&ox, &oy, &oz, &dx, &dy, &dz}; }
    /// The rays are a list and no picture: one line.
    void be_list() { width = static_cast<int>(size()), y0 = 0, y1 = 1; }
};

/// Numbers of a format, held in doubles.
using RayBlock = BasicRayBlock<double>;
class MadeRays;
/// The ideal rays. About 500 bytes each: ask for a few rows at a time.
struct IdealRayBlock : BasicRayBlock<Real> {
    /// Who makes them in each format; null: each component is rounded.
    std::shared_ptr<const MadeRays> made = {};
};

/// A ray set with the solids it is aimed at: what a step of a sweep evaluates.
class MeshColumns;
struct RayGroup {
    RayBlock rays;
    std::vector<Solid<double>> solids;
    std::optional<intersect::MarchConstants<double>> march = {};  ///< absent: no form that marches may be asked
    bool paired = false;  ///< there are as many solids as rays, and ray i is aimed at solid i alone
    std::shared_ptr<const MeshColumns> mesh = {};  ///< whose triangles come after the solids
    /// Of pixels of a scene whose camera has a projection: where rays can be made in each format.
    std::shared_ptr<const file::Scene> scene = {};
};

/// A ray alone; what it is aimed at is still to be added.
RayGroup group_of(const Ray<double>& ray);
/// Every so many of the rays, as a list, that at most `most` are left; with its solids, but for those of meshes.
RayGroup some_of(const RayGroup& all, std::size_t most);

/// The range of the scene's rays, for all rays of a block.
template <class T>
void put_range(const file::Scene& scene, BasicRayBlock<T>& block) {
    if (scene.range.tmin > 0) block.tmin.assign(block.size(), scene.range.tmin);
    if (scene.range.tmax < HUGE_VAL) block.tmax.assign(block.size(), scene.range.tmax);
    block.open = scene.range.open;
}

/// Shared inputs: the camera in double, each component then rounded once to binary32.
RayBlock make_shared_rays(const file::Scene& scene, int y0, int y1);

/// Own inputs: the ideal rays, for `round_rays`.
IdealRayBlock make_own_rays(const file::Scene& scene, int y0, int y1);

/// Each component of the ideal rays, rounded once to F, or the rays as they are made there. A direction that rounds to
/// zero is kept: what a form makes of it is for the measurement to say.
RayBlock round_rays(const IdealRayBlock& ideal, const FloatFormat& f);

/// Each component rounded once to F: shared inputs in a format narrower than binary32. The identity where F holds them.
RayBlock round_block(const RayBlock& block, const FloatFormat& f);

/// The solids of a scene, in its order, each number rounded once to binary32; 56 bytes each.
std::vector<Solid<double>> shared_solids(const file::Scene& scene);

/// The solid, each number rounded once to F. A radius that rounds to zero is kept, as above.
Solid<double> round_solid(const Solid<Real>& spec, const FloatFormat& f);
Solid<double> round_solid(const Solid<double>& solid, const FloatFormat& f);

/// The solids of a scene as a map has them: those of all formats where inputs are shared, else each number rounded
/// once to F.
std::vector<Solid<double>> stored_solids(const file::Scene& scene, const FloatFormat& f);

/// What a form in format F is given, whatever the scene's `inputs`: shared inputs rounded to binary32 and then, where
/// F is narrower, to F; own inputs rounded once to F.
RayBlock input_rays(const file::Scene& scene, int y0, int y1, const FloatFormat& f);

}  // namespace lostbits::scene::rays
