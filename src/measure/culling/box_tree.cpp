#include "measure/culling/box_tree.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "shapes/hull.hpp"

namespace lostbits::measure::culling {

using scene::rays::SolidList;

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

    explicit Spread(const Solid<double>& solid) {
        if (!solid.placed) return;
        const Affine<double> m = solid.placed->map();
        for (const double x : solid.used()) size = std::max(size, std::fabs(x));
        size = frobenius(m.rows) * 1.75 * size + std::sqrt(dot(m.shift, m.shift));
        condition = frobenius(m.rows) * frobenius(m.adjugate()) / std::fabs(m.determinant()) / 3;
    }
};

/// Distance beyond the primitive's box at which a form that squares lengths may still claim a hit.
double growth_of(const Solid<double>& solid, const RayBounds& rays, const FloatFormat& format) {
    if (solid.placed || !length_key(solid.shape)) return 0;
    const auto ball = ball_around(solid);
    const double sum = sum_of_squares(rays.origin, length(ball.centre) + ball.radius);
    if (!squares_are_safe(sum, ball.radius, rays, format)) return HUGE_VAL;
    return std::sqrt(std::ldexp(64, -format.precision) * sum);
}

/// Smaller lengths are roots of squares that may have lost bits, or all of them, to underflow.
constexpr double least_trusted = 0x1p-400;

/// Bounding box of a primitive, widened by `growth`; under a matrix, the box of the ball around it. Nothing if it is
/// not finite or cannot be trusted, and if the primitive has none: a plane, or one under a stored inverse.
std::optional<std::array<float, 6>> box_of(const Solid<double>& solid, double growth) {
    if (!has_hull(solid.shape) || (solid.placed && solid.placed->is_inverse)) return std::nullopt;
    Hull<double> hull;
    if (solid.placed) {
        const auto own = visit(solid, [](const auto& shape) { return shape.ball_around(); });
        if (!(std::min(own.radius, frobenius(solid.placed->map().rows)) >= least_trusted)) return std::nullopt;
        const auto ball = ball_around(solid);
        const double reach = ball.radius * (1 + 0x1p-40);  // the radius is rounded
        hull = {ball.centre - Vec<double>(reach, reach, reach), ball.centre + Vec<double>(reach, reach, reach)};
    } else {
        hull = hull_of(solid);
    }
    std::array<float, 6> box;
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        box[i] = below(hull.lo[k] - growth), box[i + 3] = above(hull.hi[k] + growth);
    }
    if (!std::ranges::all_of(box, [](float x) { return std::isfinite(x); })) return std::nullopt;
    return box;
}

std::array<float, 6> around(const std::array<float, 6>& a, const std::array<float, 6>& b) {
    std::array<float, 6> both;
    for (std::size_t k = 0; k < 3; ++k) both[k] = std::min(a[k], b[k]), both[k + 3] = std::max(a[k + 3], b[k + 3]);
    return both;
}

}  // namespace

std::shared_ptr<const BoxTree> BoxTree::make(const SolidList<double>& solids, const RayBounds& bounds,
                                             const FloatFormat* format) {
    if (!std::isfinite(bounds.origin) || !(bounds.least_direction > 0)) return nullptr;
    std::shared_ptr<BoxTree> tree(new BoxTree);
    const double rounding = format ? std::ldexp(8.0, -format->precision) : 0;
    std::vector<Corners> boxes(solids.size());
    double reach = 0, widest = rounding, growth_of_all = 0;
    for (std::uint32_t i = 0; i < solids.size(); ++i) {
        const Solid<double> solid = solids[i];
        const double growth = format ? growth_of(solid, bounds, *format) : 0;
        const auto box = box_of(solid, growth);
        const Spread spread(solid);
        // Under a matrix, a rounded inverse is off by κu of itself. An error in the space of the primitive becomes κ
        // times as large in the world.
        const double its_rounding = solid.placed ? 2 * spread.condition * spread.condition * rounding : rounding;
        if (!box || (solid.placed && format && !(its_rounding < 0x1p-5))) {
            tree->asked_each_.push_back(i);
            if (tree->asked_each_.size() > most_asked_each) return nullptr;
            continue;
        }
        tree->order_.push_back(i);
        boxes[i] = *box;
        reach = std::max(reach, spread.size), widest = std::max(widest, its_rounding);
        growth_of_all = std::max(growth_of_all, growth);
        for (const float x : *box) reach = std::max(reach, std::fabs(static_cast<double>(x)));
    }
    if (tree->order_.empty()) return nullptr;
    // |(x, y, z)| ≤ √3 max |x|. Squares of lengths below the least float may underflow, and so may a margin times
    // 1/|d|.
    tree->margin_ = (0x1p-40 + std::min(widest, 0x1p-5)) * (bounds.origin + 1.75 * reach + 0x1p-149);
    tree->behind_ = growth_of_all;
    tree->nodes_.reserve(tree->order_.size());
    tree->build(boxes, 0, static_cast<std::uint32_t>(tree->order_.size()));
    tree->nodes_.shrink_to_fit();
    return tree;
}

void BoxTree::build(const std::vector<Corners>& boxes, std::uint32_t begin, std::uint32_t end) {
    const std::size_t here = nodes_.size();
    Corners all = boxes[order_[begin]], middles;
    for (std::size_t k = 0; k < 3; ++k) middles[k] = HUGE_VALF, middles[k + 3] = -HUGE_VALF;
    const auto middle = [&boxes](std::uint32_t solid, std::size_t k) {
        return boxes[solid][k] / 2 + boxes[solid][k + 3] / 2;
    };
    for (std::uint32_t i = begin; i < end; ++i) {
        all = around(all, boxes[order_[i]]);
        for (std::size_t k = 0; k < 3; ++k) {
            middles[k] = std::min(middles[k], middle(order_[i], k));
            middles[k + 3] = std::max(middles[k + 3], middle(order_[i], k));
        }
    }
    nodes_.push_back({all, begin, end - begin});
    if (end - begin <= most_in_leaf) return;
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (middles[k + 3] - middles[k] > middles[axis + 3] - middles[axis]) axis = k;
    const std::uint32_t half = begin + (end - begin) / 2;
    const auto before = [&](std::uint32_t a, std::uint32_t b) { return middle(a, axis) < middle(b, axis); };
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, before);
    build(boxes, begin, half);
    nodes_[here] = {all, static_cast<std::uint32_t>(nodes_.size()), 0};
    build(boxes, half, end);
}

void BoxTree::candidates(const Ray<double>& ray, std::vector<std::uint32_t>& found) const {
    found = asked_each_;
    const Vec<double>&o = ray.origin, &d = ray.direction;
    const Vec<double> inverse(1 / d.x, 1 / d.y, 1 / d.z);
    const double before = behind_ == 0 ? 0 : -behind_ / length(d);
    const auto may_meet = [&](const Corners& box) {
        double enter = before, leave = HUGE_VAL;
        for (int k = 0; k < 3; ++k) {
            const double lo = static_cast<double>(box[static_cast<std::size_t>(k)]) - margin_ - o[k],
                         hi = static_cast<double>(box[static_cast<std::size_t>(k + 3)]) + margin_ - o[k];
            if (d[k] == 0 && (lo > 0 || hi < 0)) return false;
            if (std::isinf(inverse[k])) continue;  // the component is zero, or so small that 1/d overflows
            const double a = lo * inverse[k], b = hi * inverse[k];
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        return enter <= leave;
    };
    std::array<std::uint32_t, 64> later;  // nodes to visit: a tree over 2^32 primitives is 32 deep
    std::size_t waiting = 0;
    later[waiting++] = 0;
    while (waiting > 0) {
        const std::uint32_t i = later[--waiting];
        const Node& node = nodes_[i];
        if (!may_meet(node.box)) continue;
        if (node.count > 0) {
            for (std::uint32_t k = 0; k < node.count; ++k) found.push_back(order_[node.next + k]);
        } else {
            later[waiting++] = node.next;
            later[waiting++] = i + 1;
        }
    }
    std::ranges::sort(found);
}

}  // namespace lostbits::measure::culling
