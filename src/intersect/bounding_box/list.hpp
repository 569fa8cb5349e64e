// All methods to compute the bounding box of a primitive: a struct for each, and its index in the list.
#pragma once

#include <string_view>

#include "intersect/transform/info.hpp"

namespace lostbits::intersect::bounding_box {

struct BoxMethodInfo {
    std::string_view name;  ///< such as `nearest` in `sphere.unified^box.signs~nearest`, unique
    std::string_view title;
    std::string_view source;
    /// True for the exact box with its numbers rounded outward; otherwise the box is computed in the format.
    bool rounds_outward = false;
    int outward_steps = 0;  ///< number of neighbours in the format by which each number is then moved outward
};

/// Base of methods that compute a corner of a transformed box by rows: ((a p.x + b p.y) + c p.z) + d.
struct PointByRows {
    template <Number T>
    static Vec<T> point(const Affine<T>& m, const Vec<T>& p) {
        return m.point(p);
    }
};

struct OutwardBox : PointByRows {
    static constexpr BoxMethodInfo info{
        .name = "outward",
        .title = "the exact box, its numbers rounded outward",
        .source = "-",
        .rounds_outward = true,
    };
};

struct NearestBox : PointByRows {
    static constexpr BoxMethodInfo info{
        .name = "nearest",
        .title = "c - r and c + r rounded to nearest; corners by rows from the first product on",
        .source = "bvh v2, src/bvh/v2/sphere.h:25; tinybvh, tiny_bvh.h:8386 BLASInstance::Update",
    };
};

/// The error of one rounding to nearest is at most half a last place, so the next number outward covers it.
struct NextBox : PointByRows {
    static constexpr BoxMethodInfo info{
        .name = "next",
        .title = "as nearest, and each number then moved to the next one outward",
        .source = "-",
        .outward_steps = 1,
    };
};

struct PbrtBox {
    static constexpr BoxMethodInfo info{
        .name = "pbrt",
        .title = "as nearest; corners by (a x + b y) + (c z + d)",
        .source = "pbrt-v4, src/pbrt/util/transform.cpp:134 Transform::operator()(Bounds3f)",
    };

    template <Number T>
    static Vec<T> point(const Affine<T>& m, const Vec<T>& p) {
        const auto row_product = [&](std::size_t i) {
            const Vec<T>& a = m.rows[i];
            return (a.x * p.x + a.y * p.y) + (a.z * p.z + m.shift[static_cast<int>(i)]);
        };
        return {row_product(0), row_product(1), row_product(2)};
    }
};

struct EmbreeBox {
    static constexpr BoxMethodInfo info{
        .name = "embree",
        .title = "as nearest; corners by fma from the last component on",
        .source = "Embree 4, common/math/affinespace.h:106 xfmBounds",
    };

    template <Number T>
    static Vec<T> point(const Affine<T>& m, const Vec<T>& p) {
        return transform::point_by_fma(m, p);
    }
};

/// Calls `visit.template operator()<OutwardBox>()`, and so on for each method in turn. The first method is the default.
template <class Visit>
constexpr void for_each_box_method(const Visit& visit) {
    const auto visit_all = [&visit]<class... Method>() { (visit.template operator()<Method>(), ...); };
    visit_all.template operator()<OutwardBox,  //
                                  NearestBox,  //
                                  NextBox,     //
                                  PbrtBox,     //
                                  EmbreeBox>();
}

}  // namespace lostbits::intersect::bounding_box
