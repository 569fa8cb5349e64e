#include "measure/truth/ray_builders.hpp"

namespace lostbits::test {

RaySample draw_random_ray(Seeded& rng, const FloatFormat& format) {
    const Vec<double> origin = rng.vec(-10, 10), centre = rng.vec(-2, 2);
    const double radius = rng.uniform(0.1, 4);
    const Vec<double> aside = draw_unit_vector(rng);
    const Vec<double> target = centre + aside * (radius * rng.uniform(0, 1.4));
    return stored(RaySample{{origin, target - origin}, {centre, radius}}, format);
}

// A tangent to rounding, then one number moved by 2^j places: relative discriminants from 2^-p up, of either sign.
RaySample draw_near_tangent(Seeded& rng, const FloatFormat& format) {
    const Vec<double> d = draw_unit_vector(rng), n = draw_normal_to(rng, d), origin = rng.vec(-8, 8);
    const double radius = rng.uniform(0.05, 5), along = rng.uniform(-2, 20);
    const double stretch = rng.coin() ? 1 : rng.uniform(0.3, 3);
    RaySample s = stored(RaySample{{origin, d * stretch}, {origin + d * along + n * radius, radius}}, format);
    const std::int64_t places = rng.index(6) == 0 ? 0 : rng.signed_power(format.precision - 10);
    double& moved = rng.coin() ? s.sphere.radius : s.sphere.centre[rng.index(3)];
    moved = nudge(moved, places, format);
    return s;
}

RaySample draw_tangent(Seeded& rng, const FloatFormat& format) {
    const int reach = format == binary32 ? 60 : 400;
    const int lengths = static_cast<int>(rng.integer(-reach, reach)),
              direction = static_cast<int>(rng.integer(-reach, reach));
    if (rng.index(4) != 0) return rescale(draw_integer_tangent(rng, format), lengths, direction);
    // Along an axis, any distance x: the other two components make a triple with the radius.
    const PythagoreanTriple triple = draw_triple(rng, 1000);
    const double x = stored(rng.uniform(-5e3, 5e3), format);
    const RaySample s{{{-x, static_cast<double>(triple.p), static_cast<double>(triple.q)}, {1, 0, 0}},
                      {{0, 0, 0}, static_cast<double>(triple.hypotenuse)}};
    return rescale(shuffle_axes(rng, s), lengths, direction);
}

RaySample draw_on_surface(Seeded& rng, const FloatFormat& format) {
    const int reach = format == binary32 ? 60 : 400;
    const int lengths = static_cast<int>(rng.integer(-reach, reach)),
              direction = static_cast<int>(rng.integer(-reach, reach));
    return rescale(draw_integer_contact(rng, format), lengths, direction);
}

RaySample draw_near_surface(Seeded& rng, const FloatFormat& format) {
    RaySample s = draw_integer_contact(rng, format);
    const std::int64_t places = rng.signed_power(rng.coin() ? 3 : format.precision - 6);
    double& moved = rng.coin() ? s.sphere.radius : s.ray.origin[rng.index(3)];
    moved = nudge(moved, places, format);
    if (rng.coin()) s.ray.direction = stored(draw_unit_vector(rng), format);
    return s;
}

RaySample draw_inside(Seeded& rng, const FloatFormat& format) {
    RaySample s{{{0, 0, 0}, draw_unit_vector(rng)}, {rng.vec(-1, 1), rng.uniform(1, 5)}};
    const Vec<double> out = draw_unit_vector(rng) * s.sphere.radius;
    switch (rng.index(4)) {
        case 0: s.ray.origin = s.sphere.centre; break;
        case 1: s.ray.origin = s.sphere.centre + out * std::ldexp(1.0, -1 - rng.index(60)); break;
        case 2: s.ray.origin = s.sphere.centre + out * rng.uniform(0, 0.999); break;
        default: {  // one place below the surface
            s.sphere.centre = {0, 0, 0};
            s.sphere.radius = stored(s.sphere.radius, format);
            s.ray.origin = {nudge(s.sphere.radius, -1, format), 0, 0};
            s.ray.direction = rng.index(3) == 0 ? Vec<double>(0, 1, rng.unit()) : s.ray.direction;
            s = shuffle_axes(rng, s);
        }
    }
    return stored(s, format);
}

RaySample draw_behind(Seeded& rng, const FloatFormat& format) {
    const Vec<double> d = draw_unit_vector(rng), n = draw_normal_to(rng, d), origin = rng.vec(-8, 8);
    const double radius = rng.uniform(0.05, 5), back = rng.uniform(1.01, 6), aside = rng.uniform(0, 1.1);
    const Vec<double> centre = origin - d * (radius * back) + n * (radius * aside);
    return stored(RaySample{{origin, d * rng.uniform(0.5, 2)}, {centre, radius}}, format);
}

RaySample draw_far_away(Seeded& rng, const FloatFormat& format) {
    const Vec<double> d = draw_unit_vector(rng), n = draw_normal_to(rng, d);
    const double radius = rng.uniform(0.5, 1), along = rng.magnitude(0, 60);
    const Vec<double> origin = d * -along;
    // Aimed from the stored origin, so that the line really passes near the sphere.
    const Vec<double> start = stored(origin, format);
    return stored(RaySample{{start, n * (radius * rng.uniform(0, 1.2)) - start}, {{0, 0, 0}, radius}}, format);
}

RaySample draw_huge_sphere(Seeded& rng, const FloatFormat& format) {
    const double radius = stored(rng.magnitude(0, 60), format), slope = rng.signed_magnitude(-40, 0);
    RaySample s{{{0, 0, 0}, {rng.uniform(-1, 1), slope, rng.uniform(-1, 1)}}, {{0, 0, 0}, radius}};
    if (rng.coin()) {  // the eye's height is a few places of the radius
        s.ray.origin.y = nudge(radius, rng.signed_power(12), format);
    } else {  // the ground at zero, the eye at a height of its own
        s.sphere.centre.y = -radius;
        s.ray.origin = {rng.uniform(-1, 1), rng.magnitude(-60, 3), rng.uniform(-1, 1)};
    }
    return stored(shuffle_axes(rng, s), format);
}

RaySample draw_scaled_direction(Seeded& rng, const FloatFormat& format) {
    const RaySample s = rng.coin() ? draw_random_ray(rng, format) : draw_near_tangent(rng, format);
    return rescale(s, 0, static_cast<int>(rng.integer(-60, 60)));
}

}  // namespace lostbits::test
