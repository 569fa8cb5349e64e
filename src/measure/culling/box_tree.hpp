// Tree of boxes over many primitives of any shapes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "measure/culling/culling.hpp"
#include "scene/rays/primitive_list.hpp"

namespace lostbits::measure::culling {

/// Every primitive that has a box lies in the box of its leaf, and every box in that of its parent. Corners are
/// binary32, rounded outward, in units of a power of two: 1, except for scenes so large or small that binary32 would
/// not hold them. A plane, and any other primitive without a box here, is a candidate of every ray.
///
/// A ray is tested against a box that is wider by m on each side: m = (2^-40 + min(8 u, 2^-5)) (|O| + R). O is the
/// origin of the ray, R the distance to which primitives reach from the world's origin, at least 2^-149, and u the unit
/// roundoff of the format whose forms are tested, 0 for the truth. m does not depend on other rays, so one tree serves
/// all rays of a file.
///
/// No primitive that the line meets is missed. The direction is scaled by a power of two, so that its largest component
/// has 1 ≤ |d| < 2, and smaller components than 2^-1000 are replaced by it. This replacement, and numbers that become
/// subnormal, move no point of the line in a box, where t ≤ |O| + R, by more than 2^-1000 (|O| + R). A crossing (b − (o
/// ± m))/d of a slab takes four roundings, of which the last may be to a subnormal number: it is off by less than
/// 5·2^-53 (|O| + R + m)/|d| + 2^-1074. The margin moves the crossing by m/|d| ≥ 2^-40 (|O| + R)/|d| and ≥ 2^-190,
/// which is more than all these errors, so the computed crossing lies outside of the crossing of the box itself. A
/// crossing that overflows is infinite, and lies outside too. For an origin that overflows in the tree's unit, all
/// primitives are candidates.
///
/// Forms of a primitive with a length, such as a radius, square it. For them the box is also wider by √(64 u B), with B
/// of the index of spheres (`culling.hpp`). As √(r² + x) ≤ r + √x, that covers every hit that rounding can make a form
/// of spheres claim.
///
/// The bound does not cover other shapes: their forms lose more along an axis, and the quartics in t of tori lose more
/// at any distance. Renderers choose their candidates in a similar way: Embree's robust boxes are wider by 3 ulp,
/// pbrt's by 2γ(3). A form can also claim a hit of a triangle whose box the ray passes at a distance, because all its
/// signs are rounding errors for a ray in the plane of the triangle. Such a pair is not tested.
class BoxTree : public PrimitiveIndex {
public:
    /// Limit on the primitives without a box: they are tested for every ray.
    static constexpr std::size_t max_unboxed_primitives = 64;

    /// Limit on the candidates of a ray with a number that is not finite or without a direction. Such a ray meets
    /// nothing; the answers of forms to it are measured on small scenes.
    static constexpr std::size_t max_primitives_for_invalid_ray = 1024;

    /// Returns nothing if no primitive has a box, or if more than `max_unboxed_primitives` have none. Meshes always
    /// have a tree, because their cracks are found among its candidates. `format` null: for the truth. `bounds` matters
    /// only to forms of primitives with a length; if it is not finite, these primitives have no box.
    static std::shared_ptr<const BoxTree> make(const scene::rays::PrimitiveList<double>& primitives,
                                               const RayBounds& bounds, const FloatFormat* format);

    void find_candidates(const Ray<double>& ray, std::vector<std::uint32_t>& candidates) const override;
    void append_candidates(std::span<const Ray<double>> rays, std::vector<std::uint32_t>& candidates,
                           std::span<std::size_t> ends) const override;

    /// Finds every primitive that has a point within `distance` of p, and perhaps others, in ascending order.
    void find_within(const Vec<double>& p, double distance, std::vector<std::uint32_t>& primitives) const;

    /// Primitive with the least `distance(primitive)`, the first one among equals. The distances are those of p from
    /// the surfaces, or from the insides, and must be known to 2^-40 (|p| + R). Returns the first primitive if p is not
    /// finite.
    template <class Distance>
    [[nodiscard]] std::uint32_t nearest(const Vec<double>& p, const Distance& distance) const {
        double smallest_distance_so_far = HUGE_VAL;
        std::uint32_t nearest_primitive = 0;
        const auto test = [&](std::uint32_t primitive) {
            const double d = distance(primitive);
            if (d < smallest_distance_so_far || (d == smallest_distance_so_far && primitive < nearest_primitive)) {
                smallest_distance_so_far = d;
                nearest_primitive = primitive;
            }
        };
        if (!(std::fabs(p.x) < HUGE_VAL && std::fabs(p.y) < HUGE_VAL && std::fabs(p.z) < HUGE_VAL))
            return nearest_primitive;
        for (const std::uint32_t primitive : unboxed_) test(primitive);

        // Visits the nearer of two nodes first, and leaves out what lies farther away than the nearest primitive so
        // far.
        std::vector<std::pair<double, std::uint32_t>> pending;
        if (!nodes_.empty()) pending.push_back({0, 0});  // least distance below a node, and the node's index
        while (!pending.empty()) {
            const auto [least_below, i] = pending.back();
            pending.pop_back();
            if (least_below > smallest_distance_so_far) continue;
            const Node& node = nodes_[i];
            std::array<std::pair<double, std::size_t>, 2> children{std::pair(min_distance(p, node, 0), 0),
                                                                   std::pair(min_distance(p, node, 1), 1)};
            if (children[0].first < children[1].first) std::swap(children[0], children[1]);
            for (const auto& [distance_of_child, c] : children) {
                if (distance_of_child > smallest_distance_so_far) continue;
                for (const std::uint32_t primitive : leaf(node, c)) test(primitive);
                if (node.has_node(c)) pending.push_back({distance_of_child, node.next[c]});
            }
        }
        return nearest_primitive;
    }

private:
    using Corners = std::array<float, 6>;  ///< lo.x lo.y lo.z hi.x hi.y hi.z
    /// Boxes of two children, in one line of a cache. A child is either a leaf of `count` primitives, from `next` on in
    /// `order_`, or the node `next`, with `count` = 0. The first child of node 0 is the whole tree; its second child
    /// has no primitives, a box that no ray meets, and `next` = 0.
    struct alignas(64) Node {
        std::array<std::array<float, 2>, 6> box;
        std::array<std::uint32_t, 2> next, count;
        [[nodiscard]] bool has_node(std::size_t c) const { return count[c] == 0 && next[c] != 0; }
    };
    [[nodiscard]] std::span<const std::uint32_t> leaf(const Node& node, std::size_t c) const {
        return std::span(order_).subspan(node.count[c] == 0 ? 0 : node.next[c], node.count[c]);
    }
    static constexpr std::size_t max_primitives_in_leaf = 4;
    class Walk;

    /// Number of nodes in a child over that many primitives.
    static std::uint32_t count_nodes(std::uint32_t count);
    /// Child `c` of a node. The nodes below it are stored from `free` on.
    struct Child {
        std::uint32_t node, c, free;
    };
    /// Builds a child over the primitives from `begin` to `end` in `order_`.
    void build(const std::vector<Corners>& boxes, Child child, std::uint32_t begin, std::uint32_t end);
    /// Lower bound of the distance of p from the box of a child, by the margin of distances.
    [[nodiscard]] double min_distance(const Vec<double>& p, const Node& node, std::size_t child) const;

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> order_, unboxed_;
    int shift_ = 0;                    ///< corners, and the lengths below, are in units of 2^shift_
    double relative_ = 0, reach_ = 0;  ///< m = relative_ (|O| + reach_)
    double max_distance_behind_ = 0;   ///< a box may end up to this far behind the origin of a ray
};

}  // namespace lostbits::measure::culling
