// Makes a function of one ray a form of a plugin (C++17). A complete plugin:
//
//   #include <lostbits_plugin.hpp>
//   using namespace lostbits_plugin;
//
//   Answer<float> mine(const Ray<float>& ray, const Sphere<float>& sphere) {
//       float t;
//       if (!my_intersect(ray.origin, ray.direction, sphere.centre, sphere.radius, &t)) return miss;
//       return {t};
//   }
//   LOSTBITS_FORMS(form<mine>("mylib.sphere").first_root().unit_direction())
//
// Shape and format follow from the function's arguments. These may also be a `Segment`, a `CentreBox` or a
// `SphereAtOrigin`. The function may also return `bool`, `Thickness` or `Points`. An exception is caught and reported.
#pragma once

#include <cmath>
#include <cstddef>
#include <exception>
#include <type_traits>

#include "lostbits_plugin.h"

namespace lostbits_plugin {

/// A ray, the first argument of a function. Instead it may take a `Segment`: from the origin to from + length
/// direction, a point behind the primitive or the end of the ray. Directions then have unit length. From a segment, t
/// is returned as a fraction of its length, and a point as it is.
template <class T>
struct Ray {
    T origin[3], direction[3];
    T end;        ///< t at the end, or infinity
    T start = 0;  ///< t at the start for a form `in_range`; 0 for others
};
template <class T>
struct Segment {
    T from[3], to[3];
};

/// Primitives, the second argument of a function. A batch has the numbers of `Sphere`, `Box`, `Triangle`, `Ellipsoid`,
/// `Cylinder`, `Capsule`, `Tube`, `Cone`, `Disc`, `Plane` and `Torus`. The other types are computed from these.
template <class T>
struct Sphere {
    T centre[3], radius;
};
template <class T>
struct SphereAtOrigin {  ///< the centre is subtracted from the ray's origin
    T radius;
};
template <class T>
struct Box {
    T lo[3], hi[3];
};
template <class T>
struct Triangle {
    T a[3], b[3], c[3];
};
template <class T>
struct Ellipsoid {
    T centre[3], radii[3];
};
template <class T>
struct Cylinder {
    T base[3], top[3], radius;
};
template <class T>
struct Capsule {
    T start[3], end[3], radius;
};
template <class T>
struct Tube {
    T bottom[3], top[3], radius;
};
template <class T>
struct Cone {
    T base[3], top[3], base_radius, top_radius;
};
template <class T>
struct Disc {
    T centre[3], normal[3], outer_radius, inner_radius;
};
template <class T>
struct Plane {
    T through[3], normal[3];
};
template <class T>
struct Torus {
    T centre[3], axis[3], major_radius, minor_radius;
};
template <class T>
struct CentreBox {  ///< (lo + hi)/2 and (hi - lo)/2
    T centre[3], half[3];
};

inline constexpr struct Miss {
} miss{};

/// Hit of a ray with a primitive: `{t}`, `{near, far}` or `miss`. A form that returns only hit or miss may use `bool`.
template <class T>
struct Answer {
    bool hit;
    T near, far;
    Answer(T t) : hit(true), near(t), far(t) {}
    Answer(T first, T second) : hit(true), near(first), far(second) {}
    Answer(Miss) : hit(false), near(0), far(0) {}
};
/// Hit as near and thickness: far = near + thickness.
template <class T>
struct Thickness {
    bool hit;
    T near, thickness;
    Thickness(T first, T between) : hit(true), near(first), thickness(between) {}
    Thickness(Miss) : hit(false), near(0), thickness(0) {}
};
/// Hit as points. t is computed along the largest component of the direction: (point - origin)/direction.
template <class T>
struct Points {
    bool hit;
    T near[3], far[3];
    Points(Miss) : hit(false), near{}, far{} {}
    template <class V>
    Points(const V& point) : Points(point, point) {}
    template <class V>
    Points(const V& first, const V& second)
        : hit(true), near{first[0], first[1], first[2]}, far{second[0], second[1], second[2]} {}
};

/// Converts an answer to t. A number is multiplied by `lengths`, which is 1 for a ray and the length for a segment.
template <class T>
Answer<T> answer_of(const Answer<T>& a, const Ray<T>&, T lengths) {
    return a.hit ? Answer<T>(a.near * lengths, a.far * lengths) : Answer<T>(miss);
}
template <class T>
Answer<T> answer_of(const Thickness<T>& a, const Ray<T>& ray, T lengths) {
    return answer_of(a.hit ? Answer<T>(a.near, a.near + a.thickness) : Answer<T>(miss), ray, lengths);
}
template <class T>
Answer<T> answer_of(const Points<T>& a, const Ray<T>& ray, T) {
    if (!a.hit) return miss;
    const auto size = [&ray](int k) { return ray.direction[k] < 0 ? -ray.direction[k] : ray.direction[k]; };
    int k = size(1) > size(0) ? 1 : 0;
    if (size(2) > size(k)) k = 2;
    return {(a.near[k] - ray.origin[k]) / ray.direction[k], (a.far[k] - ray.origin[k]) / ray.direction[k]};
}

/// Makes a primitive from the numbers of a batch. `ray` is the ray that it is tested with.
template <class S>
struct PrimitiveOf;
template <class T>
struct PrimitiveOf<Sphere<T>> {
    static constexpr int shape = LB_SPHERE;
    static Sphere<T> make(const T* n, Ray<T>&) { return {{n[0], n[1], n[2]}, n[3]}; }
};
template <class T>
struct PrimitiveOf<SphereAtOrigin<T>> {
    static constexpr int shape = LB_SPHERE;
    static SphereAtOrigin<T> make(const T* n, Ray<T>& ray) {
        for (int k = 0; k < 3; ++k) ray.origin[k] -= n[k];
        return {n[3]};
    }
};
template <class T>
struct PrimitiveOf<Box<T>> {
    static constexpr int shape = LB_BOX;
    static Box<T> make(const T* n, Ray<T>&) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}}; }
};
template <class T>
struct PrimitiveOf<Triangle<T>> {
    static constexpr int shape = LB_TRIANGLE;
    static Triangle<T> make(const T* n, Ray<T>&) {
        return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}};
    }
};
template <class T>
struct PrimitiveOf<Ellipsoid<T>> {
    static constexpr int shape = LB_ELLIPSOID;
    static Ellipsoid<T> make(const T* n, Ray<T>&) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}}; }
};
template <class T>
struct PrimitiveOf<Cylinder<T>> {
    static constexpr int shape = LB_CYLINDER;
    static Cylinder<T> make(const T* n, Ray<T>&) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, n[6]}; }
};
template <class T>
struct PrimitiveOf<Capsule<T>> {
    static constexpr int shape = LB_CAPSULE;
    static Capsule<T> make(const T* n, Ray<T>&) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, n[6]}; }
};
template <class T>
struct PrimitiveOf<Tube<T>> {
    static constexpr int shape = LB_TUBE;
    static Tube<T> make(const T* n, Ray<T>&) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, n[6]}; }
};
template <class T>
struct PrimitiveOf<Cone<T>> {
    static constexpr int shape = LB_CONE;
    static Cone<T> make(const T* n, Ray<T>&) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, n[6], n[7]}; }
};
template <class T>
struct PrimitiveOf<Disc<T>> {
    static constexpr int shape = LB_DISC;
    static Disc<T> make(const T* n, Ray<T>&) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, n[6], n[7]}; }
};
template <class T>
struct PrimitiveOf<Plane<T>> {
    static constexpr int shape = LB_PLANE;
    static Plane<T> make(const T* n, Ray<T>&) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}}; }
};
template <class T>
struct PrimitiveOf<Torus<T>> {
    static constexpr int shape = LB_TORUS;
    static Torus<T> make(const T* n, Ray<T>&) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, n[6], n[7]}; }
};
template <class T>
struct PrimitiveOf<CentreBox<T>> {
    static constexpr int shape = LB_BOX;
    static CentreBox<T> make(const T* n, Ray<T>&) {
        CentreBox<T> box{};
        for (int k = 0; k < 3; ++k) box.centre[k] = (n[k] + n[k + 3]) / 2, box.half[k] = (n[k + 3] - n[k]) / 2;
        return box;
    }
};

template <class T>
T length(const T (&v)[3]) {
    return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}
/// Distance from the ray's origin to a point behind the primitive: the distance of its middle plus its diameter or
/// diagonal, or the end of the ray if that is nearer.
template <int shape, class T>
T reach(const T* n, const Ray<T>& ray) {
    constexpr bool along = shape == LB_CYLINDER || shape == LB_CAPSULE || shape == LB_TUBE || shape == LB_CONE;
    constexpr bool of_two = shape == LB_BOX || along;  // two points, with the middle between them
    T between[3], across[3] = {},
                  radius = shape == LB_BOX ? 0 : n[along || shape == LB_DISC || shape == LB_TORUS ? 6 : 3];
    for (int k = 4; shape == LB_ELLIPSOID && k < 6; ++k) radius = n[k] > radius ? n[k] : radius;
    if (shape == LB_CONE && n[7] > radius) radius = n[7];
    if (shape == LB_TORUS) radius += n[7];
    for (int k = 0; k < 3; ++k) {
        between[k] = (of_two ? (n[k] + n[k + 3]) / 2 : n[k]) - ray.origin[k];
        if (of_two) across[k] = n[k + 3] - n[k];
    }
    const T far = length(between) + length(across) + 2 * radius;
    return ray.end < far ? ray.end : far;
}

/// Calls a function for one ray, with the arguments that it takes. Sets `lengths` to the length of a segment.
template <class R, class T, class S>
R call(R (*function)(const Ray<T>&, const S&), Ray<T>& ray, const T* n, T&) {
    const S primitive = PrimitiveOf<S>::make(n, ray);
    return function(ray, primitive);
}
template <class R, class T, class S>
R call(R (*function)(const Segment<T>&, const S&), Ray<T>& ray, const T* n, T& lengths) {
    lengths = reach<PrimitiveOf<S>::shape>(n, ray);
    const S primitive = PrimitiveOf<S>::make(n, ray);
    Segment<T> segment{};
    for (int k = 0; k < 3; ++k) {
        segment.from[k] = ray.origin[k];
        segment.to[k] = ray.origin[k] + lengths * ray.direction[k];
    }
    return function(segment, primitive);
}

template <class Function>
struct Traits;
template <class R, template <class> class A, class T, class S>
struct Traits<R (*)(const A<T>&, const S&)> {
    using Number = T;
    static_assert(!(std::is_same_v<A<T>, Segment<T>> &&
                    (PrimitiveOf<S>::shape == LB_TRIANGLE || PrimitiveOf<S>::shape == LB_PLANE)),
                  "a triangle or a plane gives a segment no end behind it: take a Ray instead of a Segment");
    static constexpr int shape = PrimitiveOf<S>::shape;
    static constexpr bool hit_only = std::is_same_v<R, bool>;
    static constexpr bool of_segments = std::is_same_v<A<T>, Segment<T>>;
};

template <auto function>
const char* run(const lb_batch* batch) {
    using Of = Traits<decltype(function)>;
    using T = typename Of::Number;
    const T* ray = static_cast<const T*>(batch->rays);
    const T* const starts = static_cast<const T*>(batch->starts);
    const T* const ends = static_cast<const T*>(batch->ends);
    const T* primitive = static_cast<const T*>(batch->primitives);
    T* const near_far = static_cast<T*>(batch->near_far);
    try {
        for (std::size_t i = 0; i < batch->size; ++i, ray += 6, primitive += batch->primitive_stride) {
            Ray<T> one{{ray[0], ray[1], ray[2]},
                       {ray[3], ray[4], ray[5]},
                       ends ? ends[i] : static_cast<T>(__builtin_huge_val()),
                       starts ? starts[i] : T(0)};
            T lengths = 1;
            const auto told = call(function, one, primitive, lengths);
            if constexpr (Of::hit_only) {
                batch->hit[i] = told ? 1 : 0;
            } else {
                const Answer<T> answer = answer_of(told, one, lengths);
                batch->hit[i] = answer.hit ? 1 : 0;
                near_far[2 * i] = answer.near;
                near_far[2 * i + 1] = answer.far;
            }
        }
    } catch (const std::exception& error) {
        static thread_local char text[256];
        std::size_t k = 0;
        for (const char* c = error.what(); *c != 0 && k + 1 < sizeof text; ++c) text[k++] = *c;
        text[k] = 0;
        return text;
    } catch (...) {
        return "threw something other than a std::exception";
    }
    return nullptr;
}

/// The properties of a form, each set by a function. `lb_form` explains them.
struct Form : lb_form {
    constexpr Form titled(const char* words) const { return with(&lb_form::title, words); }
    constexpr Form from(const char* words) const { return with(&lb_form::source, words); }
    constexpr Form unit_direction() const { return with(&lb_form::direction, int{LB_UNIT}); }
    constexpr Form both_roots() const { return with(&lb_form::roots, int{LB_BOTH}); }
    constexpr Form near_root() const { return with(&lb_form::roots, int{LB_NEAR}); }
    constexpr Form first_root() const { return with(&lb_form::roots, int{LB_FIRST}); }
    constexpr Form touching_misses() const { return with(&lb_form::touching, int{LB_MISS}); }
    constexpr Form origin_misses() const { return with(&lb_form::at_origin, int{LB_MISS}); }
    constexpr Form origin_exits() const { return with(&lb_form::at_origin, int{LB_EXIT}); }
    constexpr Form inside_exit() const { return inside(LB_INSIDE_EXIT); }
    constexpr Form inside_zero() const { return inside(LB_INSIDE_ZERO); }
    constexpr Form inside_near() const { return inside(LB_INSIDE_NEAR); }
    constexpr Form inside_misses() const { return inside(LB_INSIDE_MISS); }
    constexpr Form facing_front() const { return facing(LB_FACING_FRONT); }
    constexpr Form facing_back() const { return facing(LB_FACING_BACK); }
    /// The interval is clipped to the ray. A clipped interval of a sphere does not distinguish an entry at the origin
    /// from one behind it, so this also sets `origin_exits`. Call `origin_misses` after it to replace that.
    constexpr Form clipped() const {
        const Form made = with(&lb_form::flags, flags | LB_CLIPPED);
        return shape == LB_SPHERE ? made.origin_exits() : made;
    }
    constexpr Form whole_line() const { return with(&lb_form::flags, flags | LB_LINE); }
    constexpr Form ignores_end() const { return with(&lb_form::flags, flags | LB_NO_END); }
    constexpr Form in_range() const { return with(&lb_form::flags, flags | LB_RANGE); }
    constexpr Form one_thread() const { return with(&lb_form::flags, flags | LB_ONE_THREAD); }

private:
    constexpr Form inside(unsigned word) const { return with(&lb_form::flags, (flags & ~unsigned{LB_INSIDE}) | word); }
    constexpr Form facing(unsigned word) const { return with(&lb_form::flags, (flags & ~unsigned{LB_FACING}) | word); }
    template <class Value>
    constexpr Form with(Value lb_form::*field, Value value) const {
        Form changed = *this;
        changed.*field = value;
        return changed;
    }
};

/// Makes a form of a function. Until changed it returns both roots and takes directions of any length (unit length for
/// segments), and touching hits.
template <auto function>
constexpr Form form(const char* name) {
    using Of = Traits<decltype(function)>;
    return {{name, nullptr, nullptr, Of::shape, sizeof(typename Of::Number) == 4 ? LB_F32 : LB_F64,
             Of::of_segments ? LB_UNIT : LB_ANY, Of::hit_only ? LB_HIT_ONLY : LB_BOTH, LB_HIT, LB_HIT, 0, nullptr,
             run<function>}};
}

}  // namespace lostbits_plugin

/// Exports these forms from the library.
#define LOSTBITS_FORMS(...)                                                 \
    extern "C" const lb_form* lostbits_forms(int abi, std::size_t* count) { \
        static const lb_form forms[] = {__VA_ARGS__};                       \
        if (abi != LOSTBITS_PLUGIN_ABI) return nullptr;                     \
        *count = sizeof forms / sizeof forms[0];                            \
        return forms;                                                       \
    }
