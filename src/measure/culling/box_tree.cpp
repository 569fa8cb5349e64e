#include "measure/culling/box_tree.hpp"

#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "measure/culling/sort_by_index.hpp"
#include "shapes/bounding_box.hpp"

namespace lostbits::measure::culling {

using scene::rays::PrimitiveList;

namespace {

float round_down(double x) {
    const auto f = static_cast<float>(x);
    return static_cast<double>(f) <= x ? f : std::nextafter(f, -HUGE_VALF);
}
float round_up(double x) { return -round_down(-x); }

double frobenius(const std::array<Vec<double>, 3>& m) {
    double sum = 0;
    for (const Vec<double>& v : m) sum += v.x * v.x + v.y * v.y + v.z * v.z;
    return std::sqrt(sum);
}

/// Bounds of a matrix. `size` bounds the numbers that turn a point of the primitive into one of the world, |A| |p| +
/// |τ|. `condition` is ‖A‖ ‖A⁻¹‖/3 with Frobenius' norm, which lies between κ/3 and κ and is 1 for rotations and even
/// scales.
struct MatrixBounds {
    double size = 0, condition = 1;

    explicit MatrixBounds(const Primitive<double>& primitive) {
        if (!primitive.transform) return;
        const Affine<double> m = primitive.transform->map();
        for (const double x : primitive.shape_numbers()) size = std::max(size, std::fabs(x));
        size = frobenius(m.rows) * 1.75 * size + std::sqrt(dot(m.shift, m.shift));
        condition = frobenius(m.rows) * frobenius(m.adjugate()) / std::fabs(m.determinant()) / 3;
    }
};

/// Distance from the primitive's box up to which a form that squares lengths may still claim a hit.
double growth_of(const Primitive<double>& primitive, const RayBounds& rays, const FloatFormat& format) {
    if (primitive.transform || !length_key(primitive.shape)) return 0;
    const auto ball = ball_around(primitive);
    const double sum = bound_sum_of_squares(rays.max_origin_distance, length(ball.centre) + ball.radius);
    if (!squares_are_safe(sum, ball.radius, rays, format)) return HUGE_VAL;
    return std::sqrt(std::ldexp(64, -format.precision) * sum);
}

/// Smaller lengths are roots of squares that may have lost bits, or all of them, to underflow.
constexpr double min_trusted = 0x1p-400;

/// Box of a primitive; with a matrix, the box of the ball around the primitive. Nothing if the box cannot be trusted,
/// and for a primitive without a box: a plane, or one with a stored inverse.
std::optional<BoundingBox<double>> wide_box_of(const Primitive<double>& primitive) {
    if (!has_bounding_box(primitive.shape) || (primitive.transform && primitive.transform->is_inverse))
        return std::nullopt;
    if (primitive.transform) {
        const auto object_ball = visit(primitive, [](const auto& shape) { return shape.ball_around(); });
        if (!(std::min(object_ball.radius, frobenius(primitive.transform->map().rows)) >= min_trusted))
            return std::nullopt;
        const auto ball = ball_around(primitive);
        const double radius = ball.radius * (1 + 0x1p-40);  // the radius of the ball is rounded
        return BoundingBox<double>{ball.centre - Vec<double>(radius, radius, radius),
                                   ball.centre + Vec<double>(radius, radius, radius)};
    }
    return bounding_box_of(primitive);
}

/// Box of a primitive, wider by `growth`, in units of 2^shift. Lengths that underflow in these units are less than the
/// margin.
std::optional<std::array<float, 6>> box_of(const Primitive<double>& primitive, double growth, int shift) {
    const auto bounding_box = wide_box_of(primitive);
    if (!bounding_box) return std::nullopt;
    std::array<float, 6> box;
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        box[i] = round_down(std::ldexp(bounding_box->lo[k] - growth, -shift));
        box[i + 3] = round_up(std::ldexp(bounding_box->hi[k] + growth, -shift));
    }
    if (!std::ranges::all_of(box, [](float x) { return std::isfinite(x); })) return std::nullopt;
    return box;
}

/// Exponent of the power of two that is the unit of the boxes: that of the median size of some primitives. Any exponent
/// would be correct.
int shift_of(const PrimitiveList<double>& primitives) {
    constexpr std::size_t sample_size = 1023;
    constexpr int largest_unscaled_exponent = 100;
    std::vector<int> powers;
    for (std::size_t i = 0; i < primitives.size(); i += primitives.size() / sample_size + 1) {
        const auto box = wide_box_of(primitives[i]);
        double reach = 0;
        for (int k = 0; box && k < 3; ++k) reach = std::max({reach, std::fabs(box->lo[k]), std::fabs(box->hi[k])});
        if (reach > 0 && std::isfinite(reach)) powers.push_back(std::ilogb(reach));
    }
    if (powers.empty()) return 0;
    const auto median = powers.begin() + static_cast<std::ptrdiff_t>(powers.size() / 2);
    std::ranges::nth_element(powers, median);
    return std::abs(*median) <= largest_unscaled_exponent ? 0 : *median;
}

void sort(std::vector<std::uint32_t>& primitives) { sort_by_index(primitives, std::identity()); }

std::array<float, 6> union_of(const std::array<float, 6>& a, const std::array<float, 6>& b) {
    std::array<float, 6> result;
    for (std::size_t k = 0; k < 3; ++k) {
        result[k] = std::min(a[k], b[k]);
        result[k + 3] = std::max(a[k + 3], b[k + 3]);
    }
    return result;
}

/// Middle of a box along an axis.
float box_middle(const std::array<float, 6>& box, std::size_t axis) { return box[axis] / 2 + box[axis + 3] / 2; }

/// Box around the middles of the boxes of some primitives.
std::array<float, 6> bounds_of_middles(const std::vector<std::array<float, 6>>& boxes,
                                       std::span<const std::uint32_t> primitives) {
    std::array<float, 6> bounds;
    for (std::size_t k = 0; k < 3; ++k) {
        bounds[k] = HUGE_VALF;
        bounds[k + 3] = -HUGE_VALF;
    }
    for (const std::uint32_t i : primitives) {
        for (std::size_t k = 0; k < 3; ++k) {
            bounds[k] = std::min(bounds[k], box_middle(boxes[i], k));
            bounds[k + 3] = std::max(bounds[k + 3], box_middle(boxes[i], k));
        }
    }
    return bounds;
}

/// The axis along which a box is longest.
std::size_t longest_axis(const std::array<float, 6>& box) {
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (box[k + 3] - box[k] > box[axis + 3] - box[axis]) axis = k;
    return axis;
}

}  // namespace

std::shared_ptr<const BoxTree> BoxTree::make(const PrimitiveList<double>& primitives, const RayBounds& bounds,
                                             const FloatFormat* format) {
    std::shared_ptr<BoxTree> tree(new BoxTree);
    const double rounding = format ? std::ldexp(8.0, -format->precision) : 0;
    const int shift = tree->shift_ = shift_of(primitives);
    const bool has_mesh = primitives.mesh() != nullptr;

    // Finds the box of each primitive, and sorts out the primitives without one.
    std::vector<Corners> boxes(primitives.size());
    double reach = 0, largest_rounding = rounding, largest_growth = 0;
    for (std::uint32_t i = 0; i < primitives.size(); ++i) {
        const Primitive<double> primitive = primitives[i];
        const double growth = format ? growth_of(primitive, bounds, *format) : 0;
        const auto box = box_of(primitive, growth, shift);
        const MatrixBounds matrix(primitive);
        // With a transform, a rounded inverse has a relative error of κu. An error in the space of the primitive
        // becomes κ times as large in the world.
        const double primitive_rounding =
            primitive.transform ? 2 * matrix.condition * matrix.condition * rounding : rounding;
        if (!box || (primitive.transform && format && !(primitive_rounding < 0x1p-5))) {
            tree->unboxed_.push_back(i);
            if (!has_mesh && tree->unboxed_.size() > max_unboxed_primitives) return nullptr;
            continue;
        }
        tree->order_.push_back(i);
        boxes[i] = *box;

        // Bounds over all primitives with a box.
        reach = std::max(reach, std::ldexp(matrix.size, -shift));
        largest_rounding = std::max(largest_rounding, primitive_rounding);
        largest_growth = std::max(largest_growth, growth);
        for (const float x : *box) reach = std::max(reach, std::fabs(static_cast<double>(x)));
    }
    if (tree->order_.empty()) return has_mesh ? tree : nullptr;

    // |(x, y, z)| ≤ √3 max |x|. Squares of lengths below the least float may underflow, and so may a margin times
    // 1/|d|.
    tree->relative_ = 0x1p-40 + std::min(largest_rounding, 0x1p-5);
    tree->reach_ = 1.75 * reach + 0x1p-149;
    tree->max_distance_behind_ = std::ldexp(largest_growth, -shift);

    // Builds the tree below node 0, whose second child no ray meets.
    const auto count = static_cast<std::uint32_t>(tree->order_.size());
    tree->nodes_.resize(1 + count_nodes(count));
    for (std::size_t k = 0; k < 6; ++k) tree->nodes_[0].box[k][1] = k < 3 ? HUGE_VALF : -HUGE_VALF;
    // Isolated: a thread that waits here takes no other work, since that might wait for this tree.
    tbb::this_task_arena::isolate([&] { tree->build(boxes, {.node = 0, .c = 0, .free = 1}, 0, count); });
    return tree;
}

std::uint32_t BoxTree::count_nodes(std::uint32_t count) {
    return count <= max_primitives_in_leaf ? 0 : 1 + count_nodes(count / 2) + count_nodes(count - count / 2);
}

void BoxTree::build(const std::vector<Corners>& boxes, Child child, std::uint32_t begin, std::uint32_t end) {
    // Writes the child: a leaf, or a node that follows.
    const bool is_leaf = end - begin <= max_primitives_in_leaf;
    Corners box = boxes[order_[begin]];
    for (std::uint32_t i = begin; i < end; ++i) box = union_of(box, boxes[order_[i]]);
    Node& node = nodes_[child.node];
    for (std::size_t k = 0; k < 6; ++k) node.box[k][child.c] = box[k];
    node.next[child.c] = is_leaf ? begin : child.free;
    node.count[child.c] = is_leaf ? end - begin : 0;
    if (is_leaf) return;

    // Divides the primitives into halves along the axis on which their middles lie farthest apart.
    const std::size_t axis = longest_axis(bounds_of_middles(boxes, std::span(order_).subspan(begin, end - begin)));
    const std::uint32_t middle_index = begin + (end - begin) / 2, first_free = child.free + 1;
    const auto is_before = [&](std::uint32_t a, std::uint32_t b) {
        return box_middle(boxes[a], axis) < box_middle(boxes[b], axis);
    };
    std::nth_element(order_.begin() + begin, order_.begin() + middle_index, order_.begin() + end, is_before);

    // Large halves are built at the same time. The nodes of the first half are stored before those of the second.
    const auto build_first = [&] { build(boxes, {child.free, 0, first_free}, begin, middle_index); };
    const auto build_second = [&] {
        build(boxes, {child.free, 1, first_free + count_nodes(middle_index - begin)}, middle_index, end);
    };
    if (end - begin > 1U << 14) {
        tbb::parallel_invoke(build_first, build_second);
    } else {
        build_first();
        build_second();
    }
}

double BoxTree::min_distance(const Vec<double>& p, const Node& node, std::size_t child) const {
    Vec<double> outside(0, 0, 0);
    double size = reach_;
    for (int k = 0; k < 3; ++k) {
        const auto c = static_cast<std::size_t>(k);
        const double x = std::ldexp(p[k], -shift_);
        outside[k] = std::max(
            {0.0, static_cast<double>(node.box[c][child]) - x, x - static_cast<double>(node.box[c + 3][child])});
        size += std::fabs(x);
    }
    return std::ldexp(length(outside) * (1 - 0x1p-40) - 0x1p-40 * size, shift_);
}

void BoxTree::find_within(const Vec<double>& p, double distance, std::vector<std::uint32_t>& primitives) const {
    primitives = unboxed_;
    std::vector<std::uint32_t> pending;
    if (!nodes_.empty()) pending.push_back(0);
    while (!pending.empty()) {
        const std::uint32_t i = pending.back();
        pending.pop_back();
        const Node& node = nodes_[i];
        for (std::size_t c = 0; c < 2; ++c) {
            if (min_distance(p, node, c) > distance) continue;
            primitives.insert(primitives.end(), leaf(node, c).begin(), leaf(node, c).end());
            if (node.has_node(c)) pending.push_back(node.next[c]);
        }
    }
    sort(primitives);
}

namespace {

double largest(const Vec<double>& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

/// True if a number of the ray is not finite, or if its direction is zero.
bool is_invalid(const Ray<double>& ray) {
    const auto is_finite = [](const Vec<double>& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    return !is_finite(ray.origin) || !is_finite(ray.direction) || largest(ray.direction) == 0;
}

/// Smaller components of a direction whose largest component is at least 1 are replaced by this, so that 1/d stays
/// finite.
constexpr double min_component = 0x1p-1000;

/// Upper bound of |v|, even if squares overflow or underflow.
double safe_length(const Vec<double>& v) {
    const double computed_length = length(v), largest_component = largest(v);
    return std::isfinite(computed_length) ? std::max(computed_length, largest_component) : 1.75 * largest_component;
}

}  // namespace

/// Walk of one ray down the tree, node by node. The walks of several rays can take turns.
class BoxTree::Walk {
public:
    Walk() = default;
    /// Starts with the primitives outside the tree. `candidates` outlives the walk.
    Walk(const BoxTree& tree, const Ray<double>& ray, std::vector<std::uint32_t>& candidates);

    [[nodiscard]] bool is_done() const { return pending_count_ == 0; }
    /// Visits one node. Adds the primitives of each leaf that the ray may meet, and records each such child node for a
    /// later visit.
    void step();

private:
    /// The t at which the ray crosses a side of the box of child `c`.
    [[nodiscard]] double crossing(const Node& node, std::size_t c, std::size_t corner, double origin,
                                  std::size_t k) const {
        return (static_cast<double>(node.box[corner][c]) - origin) * inverse_[k];
    }
    [[nodiscard]] bool may_meet(const Node& node, std::size_t c) const {
        const double enter = std::max(std::max(earliest_t_, crossing(node, c, entry_corner_[0], entry_origin_[0], 0)),
                                      std::max(crossing(node, c, entry_corner_[1], entry_origin_[1], 1),
                                               crossing(node, c, entry_corner_[2], entry_origin_[2], 2)));
        const double leave = std::min(std::min(crossing(node, c, exit_corner_[0], exit_origin_[0], 0),
                                               crossing(node, c, exit_corner_[1], exit_origin_[1], 1)),
                                      crossing(node, c, exit_corner_[2], exit_origin_[2], 2));
        return enter <= leave;
    }

    const BoxTree* tree_ = nullptr;
    std::vector<std::uint32_t>* candidates_ = nullptr;
    double earliest_t_ = 0;
    /// Corner of each axis through which the ray enters, and corner through which it leaves.
    std::array<std::size_t, 3> entry_corner_, exit_corner_;
    std::array<double, 3> entry_origin_, exit_origin_, inverse_;
    std::array<std::uint32_t, 64> pending_;  ///< nodes to visit: a tree over 2^32 primitives is 33 deep
    std::size_t pending_count_ = 0;
};

BoxTree::Walk::Walk(const BoxTree& tree, const Ray<double>& ray, std::vector<std::uint32_t>& candidates)
    : tree_(&tree), candidates_(&candidates) {
    candidates = tree.unboxed_;
    const auto& order = tree.order_;
    if (order.empty()) return;

    // A ray that cannot be tested has all primitives as candidates, or the first ones.
    if (is_invalid(ray)) {
        candidates.insert(candidates.end(), order.begin(),
                          order.begin() + std::min(order.size(), max_primitives_for_invalid_ray));
        return;
    }
    const Vec<double> o(std::ldexp(ray.origin.x, -tree.shift_), std::ldexp(ray.origin.y, -tree.shift_),
                        std::ldexp(ray.origin.z, -tree.shift_));
    if (!std::isfinite(largest(o))) {
        candidates.insert(candidates.end(), order.begin(), order.end());
        return;
    }

    // Scales the direction by a power of two, and widens the boxes by the margin.
    const int e = std::ilogb(largest(ray.direction));
    const Vec<double> d(std::ldexp(ray.direction.x, -e), std::ldexp(ray.direction.y, -e),
                        std::ldexp(ray.direction.z, -e));
    const double margin = tree.relative_ * safe_length(o) + tree.relative_ * tree.reach_;
    earliest_t_ = tree.max_distance_behind_ == 0 ? 0 : -tree.max_distance_behind_ / length(d);
    for (std::size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<int>(k);
        const bool is_positive = !std::signbit(d[axis]);
        entry_corner_[k] = is_positive ? k : k + 3;
        exit_corner_[k] = is_positive ? k + 3 : k;
        entry_origin_[k] = is_positive ? o[axis] + margin : o[axis] - margin;
        exit_origin_[k] = is_positive ? o[axis] - margin : o[axis] + margin;
        inverse_[k] = std::copysign(1 / std::max(std::fabs(d[axis]), min_component), d[axis]);
    }
    pending_[pending_count_++] = 0;
}

void BoxTree::Walk::step() {
    const Node& node = tree_->nodes_[pending_[--pending_count_]];
    for (std::size_t c = 0; c < 2; ++c) {
        if (!may_meet(node, c)) continue;
        if (node.count[c] > 0) {
            const auto primitives = tree_->leaf(node, c);
            candidates_->insert(candidates_->end(), primitives.begin(), primitives.end());
        } else {
            __builtin_prefetch(&tree_->nodes_[node.next[c]]);
            pending_[pending_count_++] = node.next[c];
        }
    }
}

void BoxTree::find_candidates(const Ray<double>& ray, std::vector<std::uint32_t>& candidates) const {
    for (Walk walk(*this, ray, candidates); !walk.is_done();) walk.step();
    sort(candidates);
}

// A node of a large tree is rarely in a cache, so a walk waits for memory most of its time. If several walks take
// turns, their waits overlap.
void BoxTree::append_candidates(std::span<const Ray<double>> rays, std::vector<std::uint32_t>& candidates,
                                std::span<std::size_t> ends) const {
    constexpr std::size_t most_walk_count = 16, batch_size = 256;
    std::array<Walk, most_walk_count> walks;
    std::vector<std::vector<std::uint32_t>> candidates_by_ray(std::min(rays.size(), batch_size));
    for (std::size_t begin = 0; begin < rays.size(); begin += batch_size) {
        const std::size_t count = std::min(batch_size, rays.size() - begin);

        // A walk that is done takes the next ray of the batch.
        std::size_t next = 0;
        for (bool is_running = true; is_running;) {
            is_running = next < count;
            for (Walk& walk : walks) {
                if (!walk.is_done()) {
                    walk.step();
                    is_running = true;
                } else if (next < count) {
                    walk = Walk(*this, rays[begin + next], candidates_by_ray[next]);
                    ++next;
                }
            }
        }

        for (std::size_t i = 0; i < count; ++i) {
            sort(candidates_by_ray[i]);
            candidates.insert(candidates.end(), candidates_by_ray[i].begin(), candidates_by_ray[i].end());
            ends[begin + i] = candidates.size();
        }
    }
}

}  // namespace lostbits::measure::culling
