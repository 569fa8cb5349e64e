#include "intersect/bounding_box/box_methods.hpp"

#include <vector>

#include "number/interval.hpp"
#include "number/with_number.hpp"
#include "shapes/lift.hpp"

namespace lostbits::intersect::bounding_box {

namespace {

/// The bounding box of a primitive in the world, computed over T.
template <class Method, class T>
BoundingBox<T> world_box(const Primitive<T>& primitive) {
    const BoundingBox<T> object_box = bounding_box_of(primitive);
    if (!primitive.transform) return object_box;
    const Affine<T> stored = primitive.transform->map();
    const Affine<T> to_world = primitive.transform->is_inverse ? transform::adjugate_over_determinant(stored) : stored;
    return bounding_box_of_corners(object_box, [&](const Vec<T>& p) { return Method::point(to_world, p); });
}

/// The largest number of the format that is ≤ x.
double round_down(mpfr_srcptr x, const FloatFormat& format) {
    const double d = mpfr_get_d(x, MPFR_RNDD), nearest = rounding::to_format(d, 0, format);
    return nearest > d ? -rounding::next_up(-nearest, format) : nearest;
}
/// The smallest number of the format that is ≥ x.
double round_up(mpfr_srcptr x, const FloatFormat& format) {
    const double d = mpfr_get_d(x, MPFR_RNDU), nearest = rounding::to_format(d, 0, format);
    return nearest < d ? rounding::next_up(nearest, format) : nearest;
}

template <class Method>
BoundingBox<double> compute_outward_box(const Format& format, const Primitive<double>& primitive) {
    const Interval::Precision precision(256);
    const auto bounding_box = world_box<Method>(lift_primitive<Interval>(primitive));
    BoundingBox<double> box;
    for (int i = 0; i < 3; ++i) {
        box.lo[i] = round_down(bounding_box.lo[i].lower(), format.parameters);
        box.hi[i] = round_up(bounding_box.hi[i].upper(), format.parameters);
    }
    return box;
}

/// Moves each plane of a box outward by the method's number of neighbouring numbers.
template <class Method, class T>
void move_outward(BoundingBox<T>& box) {
    for (int i = 0; i < 3; ++i) {
        for (int move = 0; move < Method::info.outward_steps; ++move) {
            box.lo[i] = next_down(box.lo[i]);
            box.hi[i] = next_up(box.hi[i]);
        }
    }
}

template <class Method>
BoundingBox<double> compute_box_in_format(const Format& format, const Primitive<double>& stored) {
    return with_number(format, [&]<class T>() {
        const auto primitive = lift_primitive<T>(stored);
        if constexpr (Method::info.rounds_outward) {
            return compute_outward_box<Method>(format,
                                               convert_numbers(primitive, [](const T& x) { return as_double(x); }));
        } else {
            auto bounding_box = world_box<Method>(primitive);
            move_outward<Method>(bounding_box);
            BoundingBox<double> box;
            for (int i = 0; i < 3; ++i) {
                box.lo[i] = as_double(bounding_box.lo[i]);
                box.hi[i] = as_double(bounding_box.hi[i]);
            }
            return box;
        }
    });
}

}  // namespace

std::span<const BoxMethod> box_methods() {
    static const std::vector<BoxMethod> methods = [] {
        std::vector<BoxMethod> rows;
        for_each_box_method([&rows]<class Method>() {
            rows.push_back({&Method::info, compute_box_in_format<Method>});
        });
        return rows;
    }();
    return methods;
}

const BoxMethod& default_box_method() { return box_methods().front(); }

}  // namespace lostbits::intersect::bounding_box
