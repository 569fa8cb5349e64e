#include "intersect/hull/hulls.hpp"

#include <vector>

#include "number/interval.hpp"
#include "number/with_number.hpp"
#include "shapes/lift.hpp"

namespace lostbits::intersect::hull {

namespace {

/// The bounding box of a primitive, computed over T, in the world.
template <class Way, class T>
Hull<T> computed(const Solid<T>& solid) {
    const Hull<T> own = hull_of(solid);
    if (!solid.placed) return own;
    const Affine<T> stored = solid.placed->map();
    const Affine<T> to_world = solid.placed->is_inverse ? space::adjugate_over_determinant(stored) : stored;
    return hull_of_corners(own, [&](const Vec<T>& p) { return Way::point(to_world, p); });
}

/// `down`: the largest number of the format that is not above x. `up`: the smallest that is not below x.
double down(mpfr_srcptr x, const FloatFormat& format) {
    const double d = mpfr_get_d(x, MPFR_RNDD), near = rounding::to_format(d, 0, format);
    return near > d ? -rounding::next_up(-near, format) : near;
}
double up(mpfr_srcptr x, const FloatFormat& format) {
    const double d = mpfr_get_d(x, MPFR_RNDU), near = rounding::to_format(d, 0, format);
    return near < d ? rounding::next_up(near, format) : near;
}

template <class Way>
Hull<double> outward(const Format& format, const Solid<double>& solid) {
    const Interval::Precision precision(256);
    const auto hull = computed<Way>(lift_solid<Interval>(solid));
    Hull<double> box;
    for (int i = 0; i < 3; ++i) {
        box.lo[i] = down(hull.lo[i].lower(), format.parameters);
        box.hi[i] = up(hull.hi[i].upper(), format.parameters);
    }
    return box;
}

template <class Way>
Hull<double> in_format(const Format& format, const Solid<double>& given) {
    return with_number(format, [&]<class T>() {
        const auto solid = lift_solid<T>(given);
        if constexpr (Way::info.outward) {
            return outward<Way>(format, transformed(solid, [](const T& x) { return as_double(x); }));
        } else {
            auto hull = computed<Way>(solid);
            Hull<double> box;
            for (int i = 0; i < 3; ++i) {
                for (int step = 0; step < Way::info.steps; ++step) {
                    hull.lo[i] = next_down(hull.lo[i]);
                    hull.hi[i] = next_up(hull.hi[i]);
                }
                box.lo[i] = as_double(hull.lo[i]);
                box.hi[i] = as_double(hull.hi[i]);
            }
            return box;
        }
    });
}

}  // namespace

std::span<const HullWay> hulls() {
    static const std::vector<HullWay> all = [] {
        std::vector<HullWay> rows;
        for_each_hull([&rows]<class Way>() { rows.push_back({&Way::info, in_format<Way>}); });
        return rows;
    }();
    return all;
}

const HullWay& usual_hull() { return hulls().front(); }

}  // namespace lostbits::intersect::hull
