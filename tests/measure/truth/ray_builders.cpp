#include "measure/truth/ray_builders.hpp"

namespace lostbits::test {

Frame draw_frame(Seeded& rng, std::int64_t largest) {
    std::int64_t w = 0, x = 0, y = 0, z = 0;
    while (w == 0 && x == 0 && y == 0 && z == 0) {
        w = rng.integer(-largest, largest);
        x = rng.integer(-largest, largest);
        y = rng.integer(-largest, largest);
        z = rng.integer(-largest, largest);
    }
    Frame f;
    f.u = {w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)};
    f.v = {2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)};
    f.w = {2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z};
    f.length = w * w + x * x + y * y + z * z;
    return f;
}

PythagoreanTriple draw_triple(Seeded& rng, std::int64_t largest_scale) {
    static constexpr PythagoreanTriple known[] = {{1, 0, 1},  {0, 1, 1},   {3, 4, 5},
                                                  {4, -3, 5}, {5, 12, 13}, {-15, 8, 17}};
    PythagoreanTriple t = known[rng.index(6)];
    const std::int64_t k = rng.integer(1, largest_scale);
    return {t.p * k, t.q * k, t.hypotenuse * k};
}

Vec<double> combine(std::int64_t a, const Integers& u, std::int64_t b, const Integers& v, std::int64_t c,
                    const Integers& w) {
    const auto at = [&](int i) { return static_cast<double>(a * u[i] + b * v[i] + c * w[i]); };
    return {at(0), at(1), at(2)};
}

RaySample rescale(RaySample s, int lengths, int direction) {
    for (int i = 0; i < 3; ++i) {
        s.ray.origin[i] = std::ldexp(s.ray.origin[i], lengths);
        s.ray.direction[i] = std::ldexp(s.ray.direction[i], direction);
        s.sphere.centre[i] = std::ldexp(s.sphere.centre[i], lengths);
    }
    s.sphere.radius = std::ldexp(s.sphere.radius, lengths);
    return s;
}

RaySample shuffle_axes(Seeded& rng, const RaySample& sample) {
    const int first = rng.index(3), step = 1 + rng.index(2);
    RaySample r = sample;
    for (int i = 0; i < 3; ++i) {
        const int from = (first + i * step) % 3;
        const double sign = rng.sign();
        r.ray.origin[i] = sign * sample.ray.origin[from];
        r.ray.direction[i] = sign * sample.ray.direction[from];
        r.sphere.centre[i] = sign * sample.sphere.centre[from];
    }
    return r;
}

RaySample stored(const RaySample& sample, const FloatFormat& format) {
    return {{stored(sample.ray.origin, format), stored(sample.ray.direction, format)},
            {stored(sample.sphere.centre, format), stored(sample.sphere.radius, format)}};
}

Vec<double> draw_unit_vector(Seeded& rng) {
    Vec<double> v = rng.vec(-1, 1);
    while (dot(v, v) > 1 || dot(v, v) < 0.01) v = rng.vec(-1, 1);
    const double size = length(v);
    return {v.x / size, v.y / size, v.z / size};
}

Vec<double> draw_normal_to(Seeded& rng, const Vec<double>& d) {
    Vec<double> n = cross(d, draw_unit_vector(rng));
    while (dot(n, n) < 0.01 * dot(d, d)) n = cross(d, draw_unit_vector(rng));
    const double size = length(n);
    return {n.x / size, n.y / size, n.z / size};
}

RaySample draw_integer_scene(Seeded& rng) {
    const auto number = [&](std::int64_t size) { return static_cast<double>(rng.integer(-size, size)); };
    const auto vec = [&](std::int64_t size) { return Vec<double>{number(size), number(size), number(size)}; };
    RaySample s{{vec(1000), {0, 0, 0}}, {vec(1000), static_cast<double>(rng.integer(1, 400))}};
    s.ray.direction = s.sphere.centre - s.ray.origin + vec(static_cast<std::int64_t>(s.sphere.radius));
    if (dot(s.ray.direction, s.ray.direction) == 0) s.ray.direction.x = 1;
    if (rng.index(8) == 0) s.ray.direction = -s.ray.direction;
    return s;
}

// f = −s·u + p·v + q·w and d = u: the line's distance from the centre is hypotenuse·|v| = r, exactly.
RaySample draw_integer_tangent(Seeded& rng, const FloatFormat& storage) {
    const bool narrow = storage == binary32;
    const Frame frame = draw_frame(rng, narrow ? 3 : 200);
    const PythagoreanTriple triple = draw_triple(rng, narrow ? 50 : 1 << 20);
    const std::int64_t far = narrow ? 1 << 10 : 1 << 30;
    const std::int64_t s = rng.index(8) == 0 ? 0 : rng.integer(-far / 4, far);
    const Integers c = {rng.integer(-far, far), rng.integer(-far, far), rng.integer(-far, far)};
    const Vec<double> centre(static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2]));
    const Vec<double> f = combine(-s, frame.u, triple.p, frame.v, triple.q, frame.w);
    return {{centre + f, combine(1, frame.u, 0, frame.v, 0, frame.w)},
            {centre, static_cast<double>(triple.hypotenuse * frame.length)}};
}

// f = p·v + q·w has the length hypotenuse·|v| = r: the origin is on the surface.
RaySample draw_integer_contact(Seeded& rng, const FloatFormat& storage) {
    RaySample s = draw_integer_tangent(rng, storage);
    const bool narrow = storage == binary32;
    const Frame frame = draw_frame(rng, narrow ? 3 : 200);
    const PythagoreanTriple triple = draw_triple(rng, narrow ? 50 : 1 << 20);
    const Vec<double> f = combine(0, frame.u, triple.p, frame.v, triple.q, frame.w);
    s.ray.origin = s.sphere.centre + f;
    s.sphere.radius = static_cast<double>(triple.hypotenuse * frame.length);
    switch (rng.index(4)) {
        case 0: s.ray.direction = combine(1, frame.u, 0, frame.v, 0, frame.w); break;  // along the surface
        case 1: s.ray.direction = f; break;                                            // straight out
        case 2: s.ray.direction = -f; break;                                           // through the centre
        default: break;                                                                // the other frame's: any way
    }
    return s;
}

}  // namespace lostbits::test
