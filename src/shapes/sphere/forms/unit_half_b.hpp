// The form of a shader, which assumes a = 1: t² + 2bt + c = 0, t = −b − √|disc|, a hit by step(0, min(t, disc)), −1 on
// a miss. It finds the near root only.
#pragma once

#include "intersect/roots.hpp"

namespace lostbits::intersect::sphere {

struct UnitHalfB {
    static constexpr Info info{
        .name = "sphere.unit_half_b",
        .title = "shader form, unit direction, near root",
        .source = "Ruimin Ma, analytic_sphere.glsl, procedural_shader_framework",
        .direction = Direction::unit,
        .roots = Roots::near_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Sphere<T>& sphere) {
        const Vec<T> f = ray.origin - sphere.centre;
        const T c = named("c", square(f) - square(sphere.radius));
        const T b = named("b", dot(ray.direction, f));
        const T disc = named("disc", square(b) - c);
        const T t = -b - sqrt(abs(disc));
        // step(0, x) is 1 unless x < 0; mix(-1, t, step) keeps t there and the sentinel elsewhere.
        const mask_t<T> is_hit = !(min(t, disc) < T(0));
        const T answer = named("t", select(is_hit, t, T(-1)));
        return Hit<T>{is_hit, answer, answer, answer};
    }
};

}  // namespace lostbits::intersect::sphere
