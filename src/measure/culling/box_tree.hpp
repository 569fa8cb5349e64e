// A tree of boxes over many solids of any shape.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "measure/culling/culling.hpp"
#include "measure/culling/solid_index.hpp"
#include "scene/rays/solid_list.hpp"

namespace lostbits::measure::culling {

/// Every solid lies in the box of its leaf, and every box in that of its parent. Corners are binary32, rounded outward.
///
/// A ray is held against a box that is wider by m on each side: m = (2^-40 + min(8 u, 2^-5)) (|O| + R), with R how far
/// from the world's origin the solids reach, u the unit roundoff of the format whose forms are asked, 0 for the truth.
/// In this file's arithmetic a crossing (b − o)/d of a slab is off by less than 4·2^-53 (|O| + R + m)/|d|, which 2^-40
/// of that covers: no solid is missed that the line meets.
///
/// What a form is asked about is a renderer's choice too: Embree's robust boxes are wider by 3 ulp, pbrt's by 2γ(3); 8
/// u of the whole picture is more than either. A form can claim a hit of a triangle whose box the ray passes at a
/// distance, for where the ray lies in the plane of the triangle all of its signs are rounding; nobody asks it there.
class BoxTree : public SolidIndex {
public:
    /// Nothing where no tree can be trusted (a number of solids or rays that is not finite) and where a solid is round.
    /// `format` null: for the truth.
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
    std::vector<std::uint32_t> order_;
    double margin_ = 0;
};

}  // namespace lostbits::measure::culling
