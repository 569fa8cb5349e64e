// Published rules for the start of a new ray: one function for each, and the table of all. If a rule gives a constant
// for float, the comment says how it is scaled to other formats. u is ½ε of the format.
#include "measure/offset/strategy.hpp"

#include <numeric>

namespace lostbits::measure::offset {
namespace {

/// Returns x moved by k floats toward +∞ (k < 0: toward −∞), by adding to its bits as an integer. The result must have
/// the sign of x.
float step_by_floats(float x, int k) { return std::bit_cast<float>(std::bit_cast<std::int32_t>(x) + (x < 0 ? -k : k)); }
double step_by_floats(double x, int k) {
    return std::bit_cast<double>(std::bit_cast<std::int64_t>(x) + (x < 0 ? -k : k));
}
template <class F>
BasicRounded<F> step_by_floats(BasicRounded<F> x, int k) {
    for (; k > 0; --k) x = next_up(x);
    for (; k < 0; ++k) x = next_down(x);
    return x;
}
/// The step counts as one integer addition.
Counted<float> step_by_floats(const Counted<float>& x, int k) {
    ++operation_counts()[Operation::neighbour];
    return Counted<float>(step_by_floats(x.value(), k));
}

/// Returns x as an integer, rounded toward zero.
template <class T>
int truncate_to_int(const T& x) {
    return static_cast<int>(as_double(x));
}
int truncate_to_int(const Counted<float>& x) {
    ++operation_counts()[Operation::convert];
    return static_cast<int>(x.value());
}

/// Returns the normal on the side to which the new ray goes.
template <Number T>
Vec<T> normal_towards_ray(const StrategyInput<T>& input) {
    return Vec<T>(input.side_sign * input.normal.x, input.side_sign * input.normal.y, input.side_sign * input.normal.z);
}

/// Returns a new ray from an origin, tested from t = 0 on against every primitive.
template <Number T>
StrategyOutput<T> ray_from(const Vec<T>& origin, const StrategyInput<T>& input) {
    return {origin, T(0), input.target_distance, true};
}

/// Returns 10^-k: the quotient of 1 and 10^k, rounded to the format. For float and k = 3 it is the literal 1e-3f.
template <Number T, int k>
T tenth_power() {
    T x(1);
    for (int i = 0; i < k; ++i) x = x * T(10);
    return T(1) / x;
}

struct NoOffset {
    template <Number T>
    static StrategyOutput<T> respawn(const StrategyInput<T>& input) {
        return ray_from<T>(input.point, input);
    }
};

template <int k>
struct Tmin {
    template <Number T>
    static StrategyOutput<T> respawn(const StrategyInput<T>& input) {
        return {input.point, tenth_power<T, k>(), input.target_distance, true};
    }
};

template <int k>
struct AlongNormal {
    template <Number T>
    static StrategyOutput<T> respawn(const StrategyInput<T>& input) {
        return ray_from<T>(add_scaled<T>(input.point, input.side_sign * tenth_power<T, k>(), input.normal), input);
    }
};

template <int k>
struct AlongNewRay {
    template <Number T>
    static StrategyOutput<T> respawn(const StrategyInput<T>& input) {
        return ray_from<T>(add_scaled<T>(input.point, tenth_power<T, k>(), input.new_direction), input);
    }
};

/// Moves p along n by k units in the last place of its largest coordinate.
template <int k>
struct Ulps {
    template <Number T>
    static StrategyOutput<T> respawn(const StrategyInput<T>& input) {
        const T size = largest_of<T>(input.point);
        return ray_from<T>(add_scaled<T>(input.point, input.side_sign * (T(k) * (next_up(size) - size)), input.normal),
                           input);
    }
};

/// Moves each component p by 256 n floats, where n is that component of the normal, or to p + n/65536 if |p| < 1/32.
/// 1/65536 is 256u of float; other formats use 256u too.
struct Integer {
    template <Number T>
    static StrategyOutput<T> respawn(const StrategyInput<T>& input) {
        const Vec<T> n = normal_towards_ray<T>(input);
        const T step = T(256) * unit_roundoff<T>(), near_zero = T(1) / T(32);
        Vec<T> o = input.point;
        for (int i = 0; i < 3; ++i) {
            const T stepped = step_by_floats(input.point[i], truncate_to_int(T(256) * n[i]));
            o[i] = select(abs(input.point[i]) < near_zero, input.point[i] + step * n[i], stepped);
        }
        return ray_from<T>(o, input);
    }
};

/// Moves each component p by 32 floats to the side to which n points, or to p + 1e-5 n if |p| < 1. 1e-5 is 167.8u of
/// float; other formats use the same multiple of their u.
struct Cycles {
    template <Number T>
    static StrategyOutput<T> respawn(const StrategyInput<T>& input) {
        const Vec<T> n = normal_towards_ray<T>(input);
        const T step = T(4096) * unit_roundoff<T>() * T(4096) / T(1000) / T(100);
        Vec<T> o = input.point;
        for (int i = 0; i < 3; ++i) {
            const T stepped = step_by_floats(input.point[i], n[i] < T(0) ? -32 : 32);
            o[i] = select(abs(input.point[i]) < T(1), input.point[i] + step * n[i], stepped);
        }
        return ray_from<T>(o, input);
    }
};

/// Moves p along n by (1 + max |p|) 1500u; 1500u is 750ε. A ray with a target ends at 1 − 15000u of the way to it.
struct RelativeOffset {
    template <Number T>
    static StrategyOutput<T> respawn(const StrategyInput<T>& input) {
        const T e = (T(1) + largest_of<T>(input.point)) * (T(1500) * unit_roundoff<T>());

        // The end of a ray with a target.
        const T shorter = (T(1) - T(15000) * unit_roundoff<T>()) * input.target_distance;
        const T& distance = input.target_distance;
        const bool has_target = distance + distance > distance;  // false for an infinite distance
        return {add_scaled<T>(input.point, input.side_sign * e, input.normal), T(0),
                select(has_target, shorter, distance), true};
    }
};

/// Returns p + d n with d = |n|·δ, each component moved one float further in the direction of n.
template <Number T>
Vec<T> beyond_bound(const BoundedPoint<T>& b, const Vec<T>& n) {
    const T d = abs(n.x) * b.delta.x + abs(n.y) * b.delta.y + abs(n.z) * b.delta.z;
    Vec<T> o = add_scaled<T>(b.p, d, n);
    for (int i = 0; i < 3; ++i) o[i] = n[i] > T(0) ? next_up(o[i]) : n[i] < T(0) ? next_down(o[i]) : o[i];
    return o;
}

/// Returns the point with its error bound. For a transformed primitive, both are in object space.
template <Number T>
BoundedPoint<T> bounded_point_of(const StrategyInput<T>& input) {
    return visit(input.primitive, [&input](const auto& shape) {
        return input.object_point
                   ? shape.bounded_point(input.object_point->ray, input.object_point->t, input.object_point->point)
                   : shape.bounded_point(input.ray, input.t, input.point);
    });
}

/// Returns M p with M = [A τ], and its error bound (γ₃ + 1)|A| δ + γ₃(|A||p| + |τ|), as in pbrt-v4's
/// Transform::operator()(Point3fi).
template <Number T>
BoundedPoint<T> transform_point(const Affine<T>& m, const BoundedPoint<T>& b) {
    const T g = gamma_bound<T>(3);
    BoundedPoint<T> world_point{Vec<T>(T(0), T(0), T(0)), Vec<T>(T(0), T(0), T(0))};
    for (int i = 0; i < 3; ++i) {
        const Vec<T>& a_row = m.rows[i];
        const Vec<T> parts(a_row.x * b.p.x, a_row.y * b.p.y, a_row.z * b.p.z);
        world_point.p[i] = (parts.x + parts.y) + (parts.z + m.shift[i]);
        world_point.delta[i] =
            (g + T(1)) * (abs(a_row.x) * b.delta.x + abs(a_row.y) * b.delta.y + abs(a_row.z) * b.delta.z) +
            g * (abs(parts.x) + abs(parts.y) + abs(parts.z) + abs(m.shift[i]));
    }
    return world_point;
}

/// Moves p beyond its error bound. For a transformed primitive, the bound is transformed to world space together with
/// the point, as in pbrt's SpawnRay.
struct Bound {
    template <Number T>
    static StrategyOutput<T> respawn(const StrategyInput<T>& input) {
        const BoundedPoint<T> bounded = bounded_point_of(input);
        return ray_from<T>(
            beyond_bound<T>(input.object_point ? transform_point<T>(input.object_point->to_world, bounded) : bounded,
                            normal_towards_ray<T>(input)),
            input);
    }
};

/// Applies the bound in object space, and transforms the new origin to world space. The rounding of that transform is
/// not part of the bound.
struct BoundInObject {
    template <Number T>
    static StrategyOutput<T> respawn(const StrategyInput<T>& input) {
        if (!input.object_point) return Bound::respawn(input);
        const Vec<T>& n = input.object_point->normal;
        const Vec<T> o = beyond_bound<T>(bounded_point_of(input),
                                         Vec<T>(input.side_sign * n.x, input.side_sign * n.y, input.side_sign * n.z));
        return ray_from<T>(input.object_point->to_world.point(o), input);
    }
};

struct ExcludeDeparted {
    template <Number T>
    static StrategyOutput<T> respawn(const StrategyInput<T>& input) {
        return {input.point, T(0), input.target_distance, false};
    }
};

template <class Rule>
constexpr Strategy strategy_row(std::string_view name, std::string_view title, std::string_view source,
                                bool keeps_point = false) {
    return {name,
            title,
            source,
            keeps_point,
            &Rule::template respawn<float>,
            &Rule::template respawn<double>,
            &Rule::template respawn<RoundedAny>,
            &Rule::template respawn<Counted<float>>};
}

constexpr Strategy strategy_rows[] = {
    strategy_row<NoOffset>("offset.none", "p, and t > 0", "-", true),
    strategy_row<Tmin<3>>("offset.tmin", "p, and t > 1e-3", "Shirley, Ray Tracing in One Weekend, section 9.3", true),
    strategy_row<Tmin<4>>("offset.tmin_1e-4", "p, and t > 1e-4",
                          "Beason, smallpt: Global Illumination in 99 lines of C++", true),
    strategy_row<AlongNormal<3>>("offset.epsilon", "p + 1e-3 n", "common practice"),
    strategy_row<AlongNormal<4>>("offset.epsilon_1e-4", "p + 1e-4 n", "common practice"),
    strategy_row<AlongNewRay<3>>("offset.direction", "p + 1e-3 w", "common practice"),
    strategy_row<Ulps<4>>("offset.ulp", "p + 4 ulp(max |p|) n", "common practice"),
    strategy_row<Ulps<16>>("offset.ulp_16", "p + 16 ulp(max |p|) n", "common practice"),
    strategy_row<Integer>(
        "offset.integer", "the bits of p moved by 256 n; p + n/65536 where |p| < 1/32",
        "Wächter, Binder, A Fast and Robust Method for Avoiding Self-Intersection, Ray Tracing Gems (2019), "
        "chapter 6"),
    strategy_row<Cycles>("offset.cycles", "the bits of p moved by 32 toward n; p + 1e-5 n where |p| < 1",
                         "Blender Cycles, ray_offset, before it took the rule of Ray Tracing Gems"),
    strategy_row<RelativeOffset>("offset.relative", "p + (1 + max |p|) 1500u n", "Mitsuba 3, Interaction::offset_p"),
    strategy_row<Bound>("offset.bound", "p + (|n| . error bound of p) n, then one float further",
                        "Pharr, Jakob, Humphreys, Physically Based Rendering, fourth edition, section 6.8"),
    strategy_row<BoundInObject>(
        "offset.bound_object", "as offset.bound, but in object space; the same without a matrix",
        "Pharr, Jakob, Humphreys, Physically Based Rendering, fourth edition, section 6.8, in the space "
        "of the primitive"),
    strategy_row<ExcludeDeparted>("offset.exclude", "p, and the primitive that is left is not tested",
                                  "common practice for convex solids", true),
};

}  // namespace

std::span<const Strategy> strategies() { return strategy_rows; }

std::vector<const Strategy*> all_strategies() {
    std::vector<const Strategy*> all;
    for (const Strategy& strategy : strategy_rows) all.push_back(&strategy);
    return all;
}

std::uint64_t Strategy::operation_count(Shape shape) const {
    using T = Counted<float>;
    const auto vec = [](float x, float y, float z) { return Vec<T>(T(x), T(y), T(z)); };
    const Primitive<T> primitive = primitive_around<T>(shape, vec(4, 4, 2.5F), T(2.0F));
    const StrategyInput<T> strategy_input{.ray = {vec(1, 9, 8), vec(0.3F, -0.5F, -0.7F)},
                                          .t = T(7.0F),
                                          .primitive = primitive,
                                          .point = vec(3.5F, 5.5F, 3.5F),
                                          .normal = vec(0.25F, 0.5F, 0.75F),
                                          .new_direction = vec(0.5F, 0.25F, 0.5F),
                                          .side_sign = T(1.0F),
                                          .target_distance = T(9.0F)};
    operation_counts() = {};
    static_cast<void>(respawn_counted(strategy_input));
    const auto& counts = operation_counts().counts;
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

}  // namespace lostbits::measure::offset
