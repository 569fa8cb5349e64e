// Tree of boxes over many primitives of any shapes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "measure/culling/culling.hpp"
#include "scene/rays/solid_list.hpp"

namespace lostbits::measure::culling {

/// Tree of boxes. Every primitive that has a box lies in that of its leaf, and every box in that of its parent. Corners
/// are binary32, rounded outward. Planes, and primitives without a bound here, are candidates of every ray.
///
/// A ray is tested against a box widened by m on each side: m = (2^-40 + min(8 u, 2^-5)) (|O| + R). R is the largest
/// distance of the primitives from the world's origin, and at least 2^-149. u is the unit roundoff of the format of the
/// forms, and 0 for the truth. In this file's arithmetic, a crossing (b − o)/d of a slab is off by less than 4·2^-53
/// (|O| + R + m)/|d|, which 2^-40 of that covers. So no primitive is missed that the line meets.
///
/// Forms of a primitive with a length, such as a radius, square it. For them the box is also wider by √(64 u B), with B
/// of the index of spheres (`culling.hpp`). As √(r² + x) ≤ r + √x, that covers all that rounding can make a form of
/// spheres claim.
///
/// The bound does not cover other shapes: their forms lose more along an axis, and the quartics in t of tori more at
/// any distance. The choice of candidates is a renderer's choice too: Embree's robust boxes are wider by 3 ulp, pbrt's
/// by 2γ(3). A form can also claim a hit of a triangle whose box the ray passes at a distance, since for a ray in the
/// plane of the triangle all of its signs are rounding. That pair is not tested.
class BoxTree : public SolidIndex {
public:
    /// Limit on the primitives without a box: they are tested for every ray.
    static constexpr std::size_t most_asked_each = 64;

    /// Makes a tree. Returns nothing if no tree can be trusted (a number of the rays is not finite), if no primitive
    /// has a box, and if more than `most_asked_each` have none. `format` null: for the truth.
    static std::shared_ptr<const BoxTree> make(const scene::rays::SolidList<double>& solids, const RayBounds& bounds,
                                               const FloatFormat* format);

    void candidates(const Ray<double>& ray, std::vector<std::uint32_t>& found) const override;

private:
    using Corners = std::array<float, 6>;  ///< lo.x lo.y lo.z hi.x hi.y hi.z
    /// The children of node i are i + 1 and `next`. A leaf has `count` > 0 primitives, from `next` on in `order_`.
    struct Node {
        Corners box;
        std::uint32_t next, count;
    };
    static constexpr std::size_t most_in_leaf = 4;

    void build(const std::vector<Corners>& boxes, std::uint32_t begin, std::uint32_t end);

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> order_, asked_each_;
    double margin_ = 0;
    double behind_ = 0;  ///< distance before the origin at which a box may end and still be met
};

}  // namespace lostbits::measure::culling
