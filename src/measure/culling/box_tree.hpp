// A tree of boxes over many solids of any shapes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "measure/culling/culling.hpp"
#include "scene/rays/solid_list.hpp"

namespace lostbits::measure::culling {

/// Every solid that has a box lies in that of its leaf, and every box in that of its parent. Corners are binary32,
/// rounded outward. A plane, and what nothing bounds here, is a candidate of every ray.
///
/// A ray is held against a box that is wider by m on each side: m = (2^-40 + min(8 u, 2^-5)) (|O| + R), with R how far
/// from the world's origin the solids reach and no less than 2^-149, u the unit roundoff of the format whose forms are
/// asked, 0 for the truth.
/// In this file's arithmetic a crossing (b − o)/d of a slab is off by less than 4·2^-53 (|O| + R + m)/|d|, which 2^-40
/// of that covers: no solid is missed that the line meets.
///
/// For forms of a solid with a length, which they square, its box is wider by √(64 u B) as well, with B of the index
/// of spheres (`culling.hpp`): as √(r² + x) ≤ r + √x, that covers all that rounding can make a form of spheres claim.
/// Forms of other shapes lose more along an axis, and quartics in t of tori more at any distance. What a form is asked
/// about is a renderer's choice too: Embree's robust boxes are wider by 3 ulp, pbrt's by 2γ(3). A form can also claim a
/// hit of a triangle whose box the ray passes at a distance, for where the ray lies in the plane of the triangle all of
/// its signs are rounding; nobody asks it there.
class BoxTree : public SolidIndex {
public:
    /// So many solids are asked without any index.
    static constexpr std::size_t most_asked_each = 64;

    /// Nothing where no tree can be trusted (a number of rays that is not finite), where no solid has a box, and where
    /// more than `most_asked_each` have none. `format` null: for the truth.
    static std::shared_ptr<const BoxTree> make(const scene::rays::SolidList<double>& solids, const RayBounds& bounds,
                                               const FloatFormat* format);

    void candidates(const Ray<double>& ray, std::vector<std::uint32_t>& found) const override;

private:
    using Corners = std::array<float, 6>;  ///< lo.x lo.y lo.z hi.x hi.y hi.z
    /// The children of node i are i + 1 and `next`; a leaf has `count` > 0 solids from `next` on in `order_`.
    struct Node {
        Corners box;
        std::uint32_t next, count;
    };
    static constexpr std::size_t most_in_leaf = 4;

    void build(const std::vector<Corners>& boxes, std::uint32_t begin, std::uint32_t end);

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> order_, asked_each_;
    double margin_ = 0;
    double behind_ = 0;  ///< how far in front of the origin a box may end
};

}  // namespace lostbits::measure::culling
