// Shading as in the course notes Ray-Casting Formulas, written once for any number type: for rendered pictures and for
// the certified one.
#pragma once

#include "scene/file/appearance.hpp"

namespace lostbits::measure::render {

/// Paint of a sphere, as numbers of T.
template <class T>
struct Paint {
    Vec<T> colour;
    T ambient, diffuse, specular;  ///< ka, kd, ks
    int exponent = 1;              ///< n
    bool is_shiny = false;         ///< ks > 0: the sphere gets a highlight
};

/// Terms of the shading that are added to the plain colour of a sphere.
struct ShadeRule {
    bool has_diffuse = false, has_shadows = false, has_phong = false;
    bool keeps_half_diffuse = false;  ///< in shadow, half of the diffuse light stays
};

/// Returns the rule that a scene asks for, up to a stage.
inline ShadeRule make_shade_rule(const scene::file::Appearance& appearance, scene::file::Stage stage) {
    using scene::file::Stage;
    const auto has_stage = [&](Stage s) { return s <= stage && appearance.has_stage(s); };
    return {has_stage(Stage::diffuse), has_stage(Stage::shadows), has_stage(Stage::phong),
            appearance.shadows && appearance.shadows->keeps_half_diffuse};
}

/// Returns the point at t: x = x0 + t·dx, and so on.
template <Number T>
Vec<T> point_at(const Ray<T>& ray, const T& t) {
    return Vec<T>(ray.origin.x + t * ray.direction.x, ray.origin.y + t * ray.direction.y,
                  ray.origin.z + t * ray.direction.z);
}

/// Calls `act` on a primitive of the shape that pictures can show, without its matrix.
template <class T, class Act>
auto visit_rendered_shape(const Primitive<T>& primitive, const Act& act) {
    return Primitives::of_shape<scene::file::rendered_shape>(
        [&]<template <class> class S>() { return act(primitive.template as<S>()); });
}

/// Returns the normal that pictures shade with, at a point of such a primitive.
template <Number T>
Vec<T> normal_at(const Vec<T>& p, const Primitive<T>& primitive) {
    return visit_rendered_shape(primitive, [&p](const auto& shape) { return shape.shading_normal(p); });
}

/// Returns xⁿ for n ≥ 1 by repeated squaring, from the highest bit of n down: at most 2·log2(n) products.
template <Number T>
T whole_power(const T& x, int n) {
    int bit = 1;
    while (bit <= n / 2) bit *= 2;
    T power = x;
    for (bit /= 2; bit > 0; bit /= 2) {
        power = square(power);
        if ((n & bit) != 0) power = power * x;
    }
    return power;
}

/// Returns the start of a shadow ray that is also tested against its own sphere: the point moved along the normal by
/// `epsilon`, or by `ulps` units in the last place of its largest coordinate. In exact arithmetic, which has no last
/// place, the latter does not move it.
template <Number T>
Vec<T> shadow_origin(const Vec<T>& p, const Vec<T>& n, scene::file::ShadowRule::ShadowOffset offset, const T& epsilon,
                     int ulps) {
    using ShadowOffset = scene::file::ShadowRule::ShadowOffset;
    if (offset == ShadowOffset::none) return p;
    T offset_length = epsilon;
    if (offset == ShadowOffset::ulp) {
        const T size = max(max(abs(p.x), abs(p.y)), abs(p.z));
        offset_length = T(ulps) * (next_up(size) - size);
    }
    return Vec<T>(p.x + offset_length * n.x, p.y + offset_length * n.y, p.z + offset_length * n.z);
}

/// Vectors at a point of a surface: the unit normal, and the unit vectors to the light and to the eye.
template <Number T>
struct DirectionsAt {
    Vec<T> normal, to_light, to_eye;
};

/// Returns C = ka S + kd max(0, N·L) S + ks max(0, H·N)ⁿ (1, 1, 1) with H = (L + V)/|L + V|, without the terms that
/// `rule` leaves out. In shadow, there is no highlight, and the diffuse term is 0, or half in a variant of the source.
/// A point that faces away from the light (N·L ≤ 0) is in the shadow of its own sphere and has no highlight. The source
/// has no max(0, ·), so N·L < 0 takes ambient light away there. NaN stays NaN, because max(0, x) gives x then.
template <Number T>
Vec<T> shade(const Paint<T>& paint, const ShadeRule& rule, const mask_t<T>& shadowed, const DirectionsAt<T>& point) {
    const auto& [n, l, v] = point;
    if (!rule.has_diffuse) return paint.colour;
    const T zero(0);
    const T facing = dot(n, l);
    T diffuse = paint.diffuse * max(zero, facing);
    if (rule.has_shadows)
        diffuse = select(shadowed, rule.keeps_half_diffuse ? T(T(1) / T(2) * diffuse) : zero, diffuse);
    const Vec<T>& s = paint.colour;
    Vec<T> colour(paint.ambient * s.x + diffuse * s.x, paint.ambient * s.y + diffuse * s.y,
                  paint.ambient * s.z + diffuse * s.z);
    if (!rule.has_phong || !paint.is_shiny) return colour;
    const T highlight = paint.specular * whole_power<T>(max(zero, dot(unit_of<T>(l + v), n)), paint.exponent);
    mask_t<T> dark = facing <= zero;
    if (rule.has_shadows) dark = dark || shadowed;
    const T added = select(dark, zero, highlight);
    return Vec<T>(colour.x + added, colour.y + added, colour.z + added);
}

}  // namespace lostbits::measure::render
