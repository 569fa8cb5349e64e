#include "measure/offset/strategy.hpp"

#include <numeric>

namespace lostbits::measure::offset {
namespace {

template <class Rule>
constexpr Strategy row(std::string_view name, std::string_view title, std::string_view source,
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
    row<None>("offset.none", "p, and t > 0", "-", true),
    row<Tmin<3>>("offset.tmin", "p, and t > 1e-3", "Shirley, Ray Tracing in One Weekend, section 9.3", true),
    row<Tmin<4>>("offset.tmin_1e-4", "p, and t > 1e-4", "Beason, smallpt: Global Illumination in 99 lines of C++",
                 true),
    row<Epsilon<3>>("offset.epsilon", "p + 1e-3 n", "common practice"),
    row<Epsilon<4>>("offset.epsilon_1e-4", "p + 1e-4 n", "common practice"),
    row<AlongNewRay<3>>("offset.direction", "p + 1e-3 w", "common practice"),
    row<Ulps<4>>("offset.ulp", "p + 4 ulp(max |p|) n", "common practice"),
    row<Ulps<16>>("offset.ulp_16", "p + 16 ulp(max |p|) n", "common practice"),
    row<Integer>("offset.integer", "the bits of p moved by 256 n; p + n/65536 where |p| < 1/32",
                 "Wächter, Binder, A Fast and Robust Method for Avoiding Self-Intersection, Ray Tracing Gems (2019), "
                 "chapter 6"),
    row<Cycles>("offset.cycles", "the bits of p moved by 32 toward n; p + 1e-5 n where |p| < 1",
                "Blender Cycles, ray_offset, before it took the rule of Ray Tracing Gems"),
    row<Relative>("offset.relative", "p + (1 + max |p|) 1500u n", "Mitsuba 3, Interaction::offset_p"),
    row<Bound>("offset.bound", "p + (|n| . error bound of p) n, then one float further",
               "Pharr, Jakob, Humphreys, Physically Based Rendering, fourth edition, section 6.8"),
    row<BoundInObject>("offset.bound_object", "the same before a matrix takes p to the world; without one the same",
                       "Pharr, Jakob, Humphreys, Physically Based Rendering, fourth edition, section 6.8, in the space "
                       "of the shape"),
    row<Exclude>("offset.exclude", "p, and the solid that is left is not asked", "common practice for convex solids",
                 true),
};

}  // namespace

std::span<const Strategy> strategies() { return strategy_rows; }

std::vector<const Strategy*> all_strategies() {
    std::vector<const Strategy*> all;
    for (const Strategy& s : strategy_rows) all.push_back(&s);
    return all;
}

std::uint64_t Strategy::operations(Shape shape) const {
    using T = Counted<float>;
    const auto vec = [](float x, float y, float z) { return Vec<T>(T(x), T(y), T(z)); };
    const Solid<T> solid = solid_around<T>(shape, vec(4, 4, 2.5F), T(2.0F));
    const Leaving<T> leaving{.ray = {vec(1, 9, 8), vec(0.3F, -0.5F, -0.7F)},
                             .t = T(7.0F),
                             .solid = solid,
                             .p = vec(3.5F, 5.5F, 3.5F),
                             .n = vec(0.25F, 0.5F, 0.75F),
                             .w = vec(0.5F, 0.25F, 0.5F),
                             .side = T(1.0F),
                             .reach = T(9.0F)};
    operation_counts() = {};
    static_cast<void>(counted(leaving));
    const auto& counts = operation_counts().of;
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

}  // namespace lostbits::measure::offset
