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

float below(double x) {
    const auto f = static_cast<float>(x);
    return static_cast<double>(f) <= x ? f : std::nextafter(f, -HUGE_VALF);
}
float above(double x) { return -below(-x); }

double frobenius(const std::array<Vec<double>, 3>& m) {
    double sum = 0;
    for (const Vec<double>& v : m) sum += v.x * v.x + v.y * v.y + v.z * v.z;
    return std::sqrt(sum);
}

/// Sizes of a matrix: `size` bounds the numbers that turn a point of the primitive into one of the world, |A| |p| +
/// |τ|. `condition` is ‖A‖ ‖A⁻¹‖/3 with Frobenius' norm, which lies between κ/3 and κ and is 1 for rotations and even
/// scales.
struct Spread {
    double size = 0, condition = 1;

    explicit Spread(const Primitive<double>& primitive) {
        if (!primitive.placed) return;
        const Affine<double> m = primitive.placed->map();
        for (const double x : primitive.used()) size = std::max(size, std::fabs(x));
        size = frobenius(m.rows) * 1.75 * size + std::sqrt(dot(m.shift, m.shift));
        condition = frobenius(m.rows) * frobenius(m.adjugate()) / std::fabs(m.determinant()) / 3;
    }
};

/// Distance beyond the primitive's box at which a form that squares lengths may still claim a hit.
double growth_of(const Primitive<double>& primitive, const RayBounds& rays, const FloatFormat& format) {
    if (primitive.placed || !length_key(primitive.shape)) return 0;
    const auto ball = ball_around(primitive);
    const double sum = sum_of_squares(rays.origin, length(ball.centre) + ball.radius);
    if (!squares_are_safe(sum, ball.radius, rays, format)) return HUGE_VAL;
    return std::sqrt(std::ldexp(64, -format.precision) * sum);
}

/// Smaller lengths are roots of squares that may have lost bits, or all of them, to underflow.
constexpr double least_trusted = 0x1p-400;

/// The box of a primitive, under a matrix that of the ball around it. Nothing where it is not to be trusted, and where
/// the primitive has none: a plane, or one under a stored inverse.
std::optional<BoundingBox<double>> wide_box_of(const Primitive<double>& primitive) {
    if (!has_bounding_box(primitive.shape) || (primitive.placed && primitive.placed->is_inverse)) return std::nullopt;
    if (primitive.placed) {
        const auto own = visit(primitive, [](const auto& shape) { return shape.ball_around(); });
        if (!(std::min(own.radius, frobenius(primitive.placed->map().rows)) >= least_trusted)) return std::nullopt;
        const auto ball = ball_around(primitive);
        const double reach = ball.radius * (1 + 0x1p-40);  // its radius is rounded
        return BoundingBox<double>{ball.centre - Vec<double>(reach, reach, reach),
                                   ball.centre + Vec<double>(reach, reach, reach)};
    }
    return bounding_box_of(primitive);
}

/// The same, wider by `growth`, in units of 2^shift. Lengths that vanish there are less than the margin.
std::optional<std::array<float, 6>> box_of(const Primitive<double>& primitive, double growth, int shift) {
    const auto bounding_box = wide_box_of(primitive);
    if (!bounding_box) return std::nullopt;
    std::array<float, 6> box;
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        box[i] = below(std::ldexp(bounding_box->lo[k] - growth, -shift));
        box[i + 3] = above(std::ldexp(bounding_box->hi[k] + growth, -shift));
    }
    if (!std::ranges::all_of(box, [](float x) { return std::isfinite(x); })) return std::nullopt;
    return box;
}

/// The power of two that boxes are measured in, from that of the median of some primitives. Any would do.
int shift_of(const PrimitiveList<double>& primitives) {
    constexpr std::size_t looked_at = 1023;
    constexpr int far_from_the_ends_of_binary32 = 100;
    std::vector<int> powers;
    for (std::size_t i = 0; i < primitives.size(); i += primitives.size() / looked_at + 1) {
        const auto box = wide_box_of(primitives[i]);
        double reach = 0;
        for (int k = 0; box && k < 3; ++k) reach = std::max({reach, std::fabs(box->lo[k]), std::fabs(box->hi[k])});
        if (reach > 0 && std::isfinite(reach)) powers.push_back(std::ilogb(reach));
    }
    if (powers.empty()) return 0;
    const auto median = powers.begin() + static_cast<std::ptrdiff_t>(powers.size() / 2);
    std::ranges::nth_element(powers, median);
    return std::abs(*median) <= far_from_the_ends_of_binary32 ? 0 : *median;
}

void sort(std::vector<std::uint32_t>& primitives) { sort_by_index(primitives, std::identity()); }

std::array<float, 6> around(const std::array<float, 6>& a, const std::array<float, 6>& b) {
    std::array<float, 6> both;
    for (std::size_t k = 0; k < 3; ++k) both[k] = std::min(a[k], b[k]), both[k + 3] = std::max(a[k + 3], b[k + 3]);
    return both;
}

}  // namespace

std::shared_ptr<const BoxTree> BoxTree::make(const PrimitiveList<double>& primitives, const RayBounds& bounds,
                                             const FloatFormat* format) {
    std::shared_ptr<BoxTree> tree(new BoxTree);
    const double rounding = format ? std::ldexp(8.0, -format->precision) : 0;
    const int shift = tree->shift_ = shift_of(primitives);
    const bool has_mesh = primitives.mesh() != nullptr;
    std::vector<Corners> boxes(primitives.size());
    double reach = 0, widest = rounding, growth_of_all = 0;
    for (std::uint32_t i = 0; i < primitives.size(); ++i) {
        const Primitive<double> primitive = primitives[i];
        const double growth = format ? growth_of(primitive, bounds, *format) : 0;
        const auto box = box_of(primitive, growth, shift);
        const Spread spread(primitive);
        // Under a matrix, a rounded inverse is off by κu of itself. An error in the space of the primitive becomes κ
        // times as large in the world.
        const double its_rounding = primitive.placed ? 2 * spread.condition * spread.condition * rounding : rounding;
        if (!box || (primitive.placed && format && !(its_rounding < 0x1p-5))) {
            tree->unboxed_.push_back(i);
            if (!has_mesh && tree->unboxed_.size() > most_unboxed) return nullptr;
            continue;
        }
        tree->order_.push_back(i);
        boxes[i] = *box;
        reach = std::max(reach, std::ldexp(spread.size, -shift)), widest = std::max(widest, its_rounding);
        growth_of_all = std::max(growth_of_all, growth);
        for (const float x : *box) reach = std::max(reach, std::fabs(static_cast<double>(x)));
    }
    if (tree->order_.empty()) return has_mesh ? tree : nullptr;
    // |(x, y, z)| ≤ √3 max |x|. Of lengths below the least float squares may underflow, and so may a margin times
    // 1/|d|.
    tree->relative_ = 0x1p-40 + std::min(widest, 0x1p-5);
    tree->reach_ = 1.75 * reach + 0x1p-149;
    tree->behind_ = std::ldexp(growth_of_all, -shift);
    const auto count = static_cast<std::uint32_t>(tree->order_.size());
    tree->nodes_.resize(1 + nodes_over(count));
    for (std::size_t k = 0; k < 6; ++k) tree->nodes_[0].box[k][1] = k < 3 ? HUGE_VALF : -HUGE_VALF;
    // Isolated: a thread that waits here takes no other work, which might wait for this tree.
    tbb::this_task_arena::isolate([&] { tree->build(boxes, {.node = 0, .c = 0, .free = 1}, 0, count); });
    return tree;
}

std::uint32_t BoxTree::nodes_over(std::uint32_t count) {
    return count <= most_in_leaf ? 0 : 1 + nodes_over(count / 2) + nodes_over(count - count / 2);
}

void BoxTree::build(const std::vector<Corners>& boxes, Child child, std::uint32_t begin, std::uint32_t end) {
    Corners all = boxes[order_[begin]], middles;
    for (std::size_t k = 0; k < 3; ++k) middles[k] = HUGE_VALF, middles[k + 3] = -HUGE_VALF;
    const auto middle = [&boxes](std::uint32_t primitive, std::size_t k) {
        return boxes[primitive][k] / 2 + boxes[primitive][k + 3] / 2;
    };
    for (std::uint32_t i = begin; i < end; ++i) {
        all = around(all, boxes[order_[i]]);
        for (std::size_t k = 0; k < 3; ++k) {
            middles[k] = std::min(middles[k], middle(order_[i], k));
            middles[k + 3] = std::max(middles[k + 3], middle(order_[i], k));
        }
    }
    const bool is_leaf = end - begin <= most_in_leaf;
    Node& node = nodes_[child.node];
    for (std::size_t k = 0; k < 6; ++k) node.box[k][child.c] = all[k];
    node.next[child.c] = is_leaf ? begin : child.free, node.count[child.c] = is_leaf ? end - begin : 0;
    if (is_leaf) return;
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (middles[k + 3] - middles[k] > middles[axis + 3] - middles[axis]) axis = k;
    const std::uint32_t half = begin + (end - begin) / 2, below = child.free + 1;
    const auto before = [&](std::uint32_t a, std::uint32_t b) { return middle(a, axis) < middle(b, axis); };
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, before);
    const auto build_one = [&] { build(boxes, {child.free, 0, below}, begin, half); };
    const auto build_other = [&] { build(boxes, {child.free, 1, below + nodes_over(half - begin)}, half, end); };
    if (end - begin > 1U << 14) tbb::parallel_invoke(build_one, build_other);
    else build_one(), build_other();
}

double BoxTree::least_distance(const Vec<double>& p, const Node& node, std::size_t child) const {
    Vec<double> beside(0, 0, 0);
    double size = reach_;
    for (int k = 0; k < 3; ++k) {
        const auto c = static_cast<std::size_t>(k);
        const double x = std::ldexp(p[k], -shift_);
        beside[k] = std::max(
            {0.0, static_cast<double>(node.box[c][child]) - x, x - static_cast<double>(node.box[c + 3][child])});
        size += std::fabs(x);
    }
    return std::ldexp(length(beside) * (1 - 0x1p-40) - 0x1p-40 * size, shift_);
}

void BoxTree::within(const Vec<double>& p, double distance, std::vector<std::uint32_t>& found) const {
    found = unboxed_;
    std::vector<std::uint32_t> later;
    if (!nodes_.empty()) later.push_back(0);
    while (!later.empty()) {
        const std::uint32_t i = later.back();
        later.pop_back();
        const Node& node = nodes_[i];
        for (std::size_t c = 0; c < 2; ++c) {
            if (least_distance(p, node, c) > distance) continue;
            found.insert(found.end(), leaf(node, c).begin(), leaf(node, c).end());
            if (node.has_node(c)) later.push_back(node.next[c]);
        }
    }
    sort(found);
}

namespace {

double largest(const Vec<double>& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

/// Some number that is not finite, or no direction.
bool is_no_ray(const Ray<double>& ray) {
    const auto finite = [](const Vec<double>& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    return !finite(ray.origin) || !finite(ray.direction) || largest(ray.direction) == 0;
}

/// Components of a direction whose largest is 1 or more are taken for no less than it: 1/d stays finite.
constexpr double least_component = 0x1p-1000;

/// |v| or more, where squares overflow or underflow too.
double size_of_any(const Vec<double>& v) {
    const double size = length(v), largest_of_v = largest(v);
    return std::isfinite(size) ? std::max(size, largest_of_v) : 1.75 * largest_of_v;
}

}  // namespace

/// Walk of one ray down the tree, node by node, so that the walks of several rays can take turns.
class BoxTree::Walk {
public:
    Walk() = default;
    /// Starts with all that is found without the tree. `found` outlives the walk.
    Walk(const BoxTree& tree, const Ray<double>& ray, std::vector<std::uint32_t>& found);

    [[nodiscard]] bool is_done() const { return waiting_ == 0; }
    /// Visits one node. Of the children that the ray may meet, leaves are found, and nodes are visited later.
    void step();

private:
    /// The t at which the ray crosses a side of the box of child `c`.
    [[nodiscard]] double crossing(const Node& node, std::size_t c, std::size_t corner, double from,
                                  std::size_t k) const {
        return (static_cast<double>(node.box[corner][c]) - from) * inverse_[k];
    }
    [[nodiscard]] bool may_meet(const Node& node, std::size_t c) const {
        const double enter =
            std::max(std::max(before_, crossing(node, c, in_[0], o_in_[0], 0)),
                     std::max(crossing(node, c, in_[1], o_in_[1], 1), crossing(node, c, in_[2], o_in_[2], 2)));
        const double leave =
            std::min(std::min(crossing(node, c, out_[0], o_out_[0], 0), crossing(node, c, out_[1], o_out_[1], 1)),
                     crossing(node, c, out_[2], o_out_[2], 2));
        return enter <= leave;
    }

    const BoxTree* tree_ = nullptr;
    std::vector<std::uint32_t>* found_ = nullptr;
    double before_ = 0;
    /// Corner of each axis through which the ray enters, and the one through which it leaves.
    std::array<std::size_t, 3> in_, out_;
    std::array<double, 3> o_in_, o_out_, inverse_;
    std::array<std::uint32_t, 64> later_;  ///< nodes to visit: a tree over 2^32 primitives is 33 deep
    std::size_t waiting_ = 0;
};

BoxTree::Walk::Walk(const BoxTree& tree, const Ray<double>& ray, std::vector<std::uint32_t>& found)
    : tree_(&tree), found_(&found) {
    found = tree.unboxed_;
    const auto& order = tree.order_;
    if (order.empty()) return;
    if (is_no_ray(ray)) {
        found.insert(found.end(), order.begin(), order.begin() + std::min(order.size(), most_for_no_ray));
        return;
    }
    const Vec<double> o(std::ldexp(ray.origin.x, -tree.shift_), std::ldexp(ray.origin.y, -tree.shift_),
                        std::ldexp(ray.origin.z, -tree.shift_));
    if (!std::isfinite(largest(o))) {
        found.insert(found.end(), order.begin(), order.end());
        return;
    }
    const int e = std::ilogb(largest(ray.direction));
    const Vec<double> d(std::ldexp(ray.direction.x, -e), std::ldexp(ray.direction.y, -e),
                        std::ldexp(ray.direction.z, -e));
    const double margin = tree.relative_ * size_of_any(o) + tree.relative_ * tree.reach_;
    before_ = tree.behind_ == 0 ? 0 : -tree.behind_ / length(d);
    for (std::size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<int>(k);
        const bool up = !std::signbit(d[axis]);
        in_[k] = up ? k : k + 3, out_[k] = up ? k + 3 : k;
        o_in_[k] = up ? o[axis] + margin : o[axis] - margin;
        o_out_[k] = up ? o[axis] - margin : o[axis] + margin;
        inverse_[k] = std::copysign(1 / std::max(std::fabs(d[axis]), least_component), d[axis]);
    }
    later_[waiting_++] = 0;
}

void BoxTree::Walk::step() {
    const Node& node = tree_->nodes_[later_[--waiting_]];
    for (std::size_t c = 0; c < 2; ++c) {
        if (!may_meet(node, c)) continue;
        if (node.count[c] > 0) {
            const auto primitives = tree_->leaf(node, c);
            found_->insert(found_->end(), primitives.begin(), primitives.end());
        } else {
            __builtin_prefetch(&tree_->nodes_[node.next[c]]);
            later_[waiting_++] = node.next[c];
        }
    }
}

void BoxTree::candidates(const Ray<double>& ray, std::vector<std::uint32_t>& found) const {
    for (Walk walk(*this, ray, found); !walk.is_done();) walk.step();
    sort(found);
}

// A node of a large tree is rarely in a cache, so a walk waits for memory most of its time. If several walks take
// turns, their waits overlap.
void BoxTree::append_candidates(std::span<const Ray<double>> rays, std::vector<std::uint32_t>& found,
                                std::span<std::size_t> ends) const {
    constexpr std::size_t at_once = 16, together = 256;
    std::array<Walk, at_once> walks;
    std::vector<std::vector<std::uint32_t>> found_by(std::min(rays.size(), together));
    for (std::size_t begin = 0; begin < rays.size(); begin += together) {
        const std::size_t count = std::min(together, rays.size() - begin);
        std::size_t next = 0;
        for (bool under_way = true; under_way;) {
            under_way = next < count;
            for (Walk& walk : walks) {
                if (!walk.is_done()) walk.step(), under_way = true;
                else if (next < count) walk = Walk(*this, rays[begin + next], found_by[next]), ++next;
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            sort(found_by[i]);
            found.insert(found.end(), found_by[i].begin(), found_by[i].end());
            ends[begin + i] = found.size();
        }
    }
}

}  // namespace lostbits::measure::culling
