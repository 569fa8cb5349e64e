#include "measure/culling/box_tree.hpp"

#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <optional>

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
            tree->asked_each_.push_back(i);
            if (!has_mesh && tree->asked_each_.size() > most_asked_each) return nullptr;
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
    tree->nodes_.resize(nodes_over(count));
    // Isolated: a thread that waits here takes no other work, which might wait for this tree.
    tbb::this_task_arena::isolate([&] { tree->build(boxes, 0, 0, count); });
    return tree;
}

std::uint32_t BoxTree::nodes_over(std::uint32_t count) {
    return count <= most_in_leaf ? 1 : 1 + nodes_over(count / 2) + nodes_over(count - count / 2);
}

void BoxTree::build(const std::vector<Corners>& boxes, std::uint32_t here, std::uint32_t begin, std::uint32_t end) {
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
    nodes_[here] = {all, begin, end - begin};
    if (end - begin <= most_in_leaf) return;
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (middles[k + 3] - middles[k] > middles[axis + 3] - middles[axis]) axis = k;
    const std::uint32_t half = begin + (end - begin) / 2;
    const auto before = [&](std::uint32_t a, std::uint32_t b) { return middle(a, axis) < middle(b, axis); };
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, before);
    const std::uint32_t other = here + 1 + nodes_over(half - begin);
    nodes_[here] = {all, other, 0};
    const auto build_one = [&] { build(boxes, here + 1, begin, half); };
    const auto build_other = [&] { build(boxes, other, half, end); };
    if (end - begin > 1U << 14) tbb::parallel_invoke(build_one, build_other);
    else build_one(), build_other();
}

double BoxTree::least_distance(const Vec<double>& p, std::uint32_t i) const {
    const Corners& box = nodes_[i].box;
    Vec<double> beside(0, 0, 0);
    double size = reach_;
    for (int k = 0; k < 3; ++k) {
        const auto c = static_cast<std::size_t>(k);
        const double x = std::ldexp(p[k], -shift_);
        beside[k] = std::max({0.0, static_cast<double>(box[c]) - x, x - static_cast<double>(box[c + 3])});
        size += std::fabs(x);
    }
    return std::ldexp(length(beside) * (1 - 0x1p-40) - 0x1p-40 * size, shift_);
}

void BoxTree::within(const Vec<double>& p, double distance, std::vector<std::uint32_t>& found) const {
    found = asked_each_;
    std::vector<std::uint32_t> later;
    if (!nodes_.empty()) later.push_back(0);
    while (!later.empty()) {
        const std::uint32_t i = later.back();
        later.pop_back();
        if (least_distance(p, i) > distance) continue;
        const Node& node = nodes_[i];
        for (std::uint32_t k = 0; k < node.count; ++k) found.push_back(order_[node.next + k]);
        if (node.count == 0) later.insert(later.end(), {i + 1, node.next});
    }
    std::ranges::sort(found);
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

void BoxTree::candidates(const Ray<double>& ray, std::vector<std::uint32_t>& found) const {
    found = asked_each_;
    if (order_.empty()) return;
    if (!is_no_ray(ray)) find_met(ray, found);
    else found.insert(found.end(), order_.begin(), order_.begin() + std::min(order_.size(), most_for_no_ray));
    std::ranges::sort(found);
}

void BoxTree::find_met(const Ray<double>& ray, std::vector<std::uint32_t>& found) const {
    Vec<double> o(std::ldexp(ray.origin.x, -shift_), std::ldexp(ray.origin.y, -shift_),
                  std::ldexp(ray.origin.z, -shift_));
    if (!std::isfinite(largest(o))) {
        found.insert(found.end(), order_.begin(), order_.end());
        return;
    }
    const int e = std::ilogb(largest(ray.direction));
    const Vec<double> d(std::ldexp(ray.direction.x, -e), std::ldexp(ray.direction.y, -e),
                        std::ldexp(ray.direction.z, -e));
    const double margin = relative_ * size_of_any(o) + relative_ * reach_;
    const double before = behind_ == 0 ? 0 : -behind_ / length(d);
    // Corner of each axis through which a ray enters, and the one through which it leaves.
    std::array<std::size_t, 3> in, out;
    std::array<double, 3> o_in, o_out, inverse;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<int>(k);
        const bool up = !std::signbit(d[axis]);
        in[k] = up ? k : k + 3, out[k] = up ? k + 3 : k;
        o_in[k] = up ? o[axis] + margin : o[axis] - margin;
        o_out[k] = up ? o[axis] - margin : o[axis] + margin;
        inverse[k] = std::copysign(1 / std::max(std::fabs(d[axis]), least_component), d[axis]);
    }
    const auto may_meet = [&](const Corners& box) {
        const auto crossing = [&](std::size_t corner, double from, std::size_t k) {
            return (static_cast<double>(box[corner]) - from) * inverse[k];
        };
        const double enter = std::max(std::max(before, crossing(in[0], o_in[0], 0)),
                                      std::max(crossing(in[1], o_in[1], 1), crossing(in[2], o_in[2], 2)));
        const double leave = std::min(std::min(crossing(out[0], o_out[0], 0), crossing(out[1], o_out[1], 1)),
                                      crossing(out[2], o_out[2], 2));
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
            __builtin_prefetch(&nodes_[node.next]);
            later[waiting++] = node.next;
            later[waiting++] = i + 1;
        }
    }
}

}  // namespace lostbits::measure::culling
