#include "measure/truth/box_distributions.hpp"

#include <cstdio>

#include "measure/truth/box_builders.hpp"

namespace lostbits::test {
namespace {

BoxSample draw_random_ray(Seeded& rng, const FloatFormat& format) {
    const Box<double> box = draw_box(rng, -5, 5);
    const Vec<double> origin = rng.vec(-12, 12);
    const Vec<double> target = rng.vec(-6, 6);
    const double tmax = rng.index(3) == 0 ? rng.uniform(0, 2) : HUGE_VAL;
    return stored(BoxSample{{origin, target - origin}, box, tmax}, format);
}

/// At a point of an edge or a corner, as near as rounded directions come: every rounding of a form may decide.
BoxSample draw_at_edge(Seeded& rng, const FloatFormat& format) {
    const Box<double> box = draw_box(rng, -5, 5);
    const Vec<double> origin = rng.vec(-12, 12);
    Vec<double> target = rng.vec(-5, 5);
    const int free = rng.index(4);
    for (int i = 0; i < 3; ++i) {
        target[i] =
            i != free ? (rng.coin() ? box.lo[i] : box.hi[i]) : std::fmin(std::fmax(target[i], box.lo[i]), box.hi[i]);
    }
    return stored(BoxSample{{origin, target - origin}, box, HUGE_VAL}, format);
}

/// In the plane of a face, crossing the face or passing it by.
BoxSample draw_along_face(Seeded& rng, const FloatFormat&) {
    const Box<double> box = draw_integer_box(rng);
    const int axis = rng.index(3);
    std::array<int, 3> place{0, 0, 0};
    place[axis] = draw_side(rng);
    Vec<double> d = draw_integer_direction(rng);
    d[axis] = draw_zero(rng);
    return draw_ray_through(rng, box, draw_point_at(rng, box, place), d);
}

/// Through an edge from outside to outside: entering one slab in the moment of leaving the other.
BoxSample draw_across_edge(Seeded& rng, const FloatFormat&) {
    const Box<double> box = draw_integer_box(rng);
    const auto place = shuffle(rng, {draw_side(rng), draw_side(rng), 0});
    Vec<double> d = draw_integer_direction(rng);
    int met = 0;
    for (int i = 0; i < 3; ++i) {
        const int where = place[i];
        if (where == 0) continue;
        d[i] = (met++ == 0 ? 1 : -1) * where * std::fabs(d[i]);
    }
    return draw_ray_through(rng, box, draw_point_at(rng, box, place), d);
}

/// Through a corner from outside to outside.
BoxSample draw_across_corner(Seeded& rng, const FloatFormat&) {
    const Box<double> box = draw_integer_box(rng);
    const std::array<int, 3> place{draw_side(rng), draw_side(rng), draw_side(rng)};
    Vec<double> d = draw_integer_direction(rng);
    const int in = rng.index(3), out = (in + 1 + rng.index(2)) % 3;
    d[in] = -place[in] * std::fabs(d[in]);
    d[out] = place[out] * std::fabs(d[out]);
    return draw_ray_through(rng, box, draw_point_at(rng, box, place), d);
}

/// Across an edge or a corner, one number a few places off.
BoxSample draw_beside_edge(Seeded& rng, const FloatFormat& format) {
    BoxSample s = rng.coin() ? draw_across_edge(rng, format) : draw_across_corner(rng, format);
    Vec<double>* const vectors[] = {&s.ray.origin, &s.ray.direction, &s.box.lo, &s.box.hi};
    Vec<double>& v = *vectors[rng.index(4)];
    const int i = rng.index(3);
    v[i] = nudge(v[i], rng.coin() ? rng.integer(-2, 2) : rng.signed_power(20), format);
    s.box = box_between(s.box.lo, s.box.hi);
    return s;
}

/// One or two zeros of either sign in the direction; the origin in, on or beside each slab.
BoxSample draw_axis_parallel(Seeded& rng, const FloatFormat&) {
    const Box<double> box = draw_integer_box(rng);
    const auto along = shuffle(rng, {1, rng.coin() ? 1 : 0, 0});
    Vec<double> d = draw_integer_direction(rng);
    Vec<double> p = draw_point_at(rng, box, {rng.index(3) - 1, rng.index(3) - 1, rng.index(3) - 1});
    for (int i = 0; i < 3; ++i) {
        if (along[i] == 0) d[i] = draw_zero(rng);
        if (rng.index(6) != 0) continue;
        const auto beside = static_cast<double>(rng.integer(1, 700));
        p[i] += rng.coin() ? beside : -beside;
    }
    return draw_ray_through(rng, box, p, d);
}

/// Zero thickness on one, two or all three axes; aimed at the box exactly, or a little off.
BoxSample draw_flat_box(Seeded& rng, const FloatFormat& format) {
    Box<double> box = draw_integer_box(rng);
    const auto thick = shuffle(rng, {rng.coin() ? 1 : 0, rng.coin() ? 1 : 0, 0});
    std::array<int, 3> place{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto k = static_cast<int>(i);
        if (thick[i] == 0) box.hi[k] = box.lo[k];
        place[i] = thick[i] == 0 ? -1 : rng.index(3) - 1;
    }
    Vec<double> d = draw_integer_direction(rng);
    if (rng.coin()) d[rng.index(3)] = draw_zero(rng);
    BoxSample s = draw_ray_through(rng, box, draw_point_at(rng, box, place), d);
    if (rng.index(4) == 0) {
        const int i = rng.index(3);
        s.ray.origin[i] = nudge(s.ray.origin[i], rng.integer(-2, 2), format);
    }
    return s;
}

/// Through a face to somewhere inside, the ray's end exactly at the entry.
BoxSample draw_at_end(Seeded& rng, const FloatFormat&) {
    const Box<double> box = draw_integer_box(rng);
    const auto place = shuffle(rng, {draw_side(rng), 0, 0});
    Vec<double> d = draw_integer_direction(rng);
    for (int i = 0; i < 3; ++i) {
        if (place[i] != 0) d[i] = -place[i] * std::fabs(d[i]);
    }
    const auto steps = static_cast<double>(rng.integer(1, 400));
    return {{draw_point_at(rng, box, place) - steps * d, d}, box, steps};
}

/// An exact meeting of planes or of a plane and the ray's end, seen from the world's origin; then the origin moves by a
/// hair, and what decides is as many bits away.
BoxSample draw_by_a_hair(Seeded& rng, const FloatFormat& format) {
    BoxSample s = rng.index(3) == 0 ? draw_at_end(rng, format)
                  : rng.coin()      ? draw_across_edge(rng, format)
                                    : draw_across_corner(rng, format);
    s.box.lo -= s.ray.origin;
    s.box.hi -= s.ray.origin;
    s.ray.origin = Vec<double>(0);
    for (int i = 0; i < 3; ++i) {
        if (rng.index(3) == 0) continue;
        const double hair = std::ldexp(1.0, -static_cast<int>(rng.integer(20, format.precision - 1 - format.emin)));
        s.ray.origin[i] = rng.coin() ? hair : -hair;
    }
    return s;
}

BoxSample draw_far_away(Seeded& rng, const FloatFormat& format) {
    const Box<double> box = draw_box(rng, -1, 1);
    const double distance = rng.magnitude(10, 40);
    const Vec<double> towards = rng.vec(-1, 1);
    const Vec<double> origin = -distance * towards;
    const Vec<double> target = rng.vec(-1.2, 1.2);
    BoxSample s = stored(BoxSample{{origin, target - origin}, box, HUGE_VAL}, format);
    if (rng.coin()) s = rescale(s, 0, -static_cast<int>(rng.integer(0, 40)));
    return s;
}

BoxSample draw_inside(Seeded& rng, const FloatFormat&) {
    const Box<double> box = draw_integer_box(rng);
    Vec<double> d = draw_integer_direction(rng);
    if (rng.coin()) d[rng.index(3)] = draw_zero(rng);
    const double tmax = rng.coin() ? HUGE_VAL : static_cast<double>(rng.integer(0, 3));
    return {{draw_point_at(rng, box, {0, 0, 0}), d}, box, tmax};
}

/// On a face, an edge or a corner, looking anywhere.
BoxSample draw_on_boundary(Seeded& rng, const FloatFormat&) {
    const Box<double> box = draw_integer_box(rng);
    const auto place = shuffle(rng, {draw_side(rng), rng.coin() ? draw_side(rng) : 0, rng.index(3) - 1});
    Vec<double> d = draw_integer_direction(rng);
    if (rng.coin()) d[rng.index(3)] = draw_zero(rng);
    const double tmax = rng.coin() ? HUGE_VAL : static_cast<double>(rng.integer(0, 3));
    return {{draw_point_at(rng, box, place), d}, box, tmax};
}

/// As `at_end`, the end a place before or after; or the entry itself rounded, when the end lies on either side.
BoxSample draw_about_end(Seeded& rng, const FloatFormat& format) {
    if (rng.coin()) {
        BoxSample s = draw_at_end(rng, format);
        s.tmax = nudge(s.tmax, rng.coin() ? 1 : -1, format);
        return s;
    }
    BoxSample s = draw_random_ray(rng, format);
    double entry = 0;
    for (int i = 0; i < 3; ++i) {
        entry = std::fmax(
            entry, ((s.ray.direction[i] > 0 ? s.box.lo[i] : s.box.hi[i]) - s.ray.origin[i]) / s.ray.direction[i]);
    }
    s.tmax = nudge(stored(entry, format), rng.integer(-1, 1), format);
    return s;
}

/// Lengths, directions or both below the normal range, where they lose their last bits: any ray may become any other.
BoxSample draw_subnormal(Seeded& rng, const FloatFormat& format) {
    const int down = format.emin - format.precision + static_cast<int>(rng.integer(4, 30));
    const int which = rng.index(3);
    const BoxSample s = rng.coin() ? draw_random_ray(rng, format) : draw_across_edge(rng, format);
    BoxSample r = stored(rescale(s, which == 1 ? 0 : down, which == 0 ? 0 : down), format);
    if (r.ray.direction == Vec<double>(0)) r.ray.direction.x = std::ldexp(1.0, format.emin - format.precision + 1);
    return r;
}

BoxSample draw_huge(Seeded& rng, const FloatFormat& format) {
    const int up = format.emax - 14;
    const int which = rng.index(3);
    const BoxSample s = rng.coin() ? draw_random_ray(rng, format) : draw_across_corner(rng, format);
    BoxSample r = stored(rescale(s, which == 1 ? 0 : up, which == 0 ? 0 : up), format);
    if (!(r.tmax <= std::ldexp(1.0, format.emax))) r.tmax = HUGE_VAL;
    return r;
}

/// Every number of any size at all.
BoxSample draw_mixed_exponents(Seeded& rng, const FloatFormat& format) {
    const auto any = [&] {
        return rng.index(8) == 0
                   ? draw_zero(rng)
                   : stored(rng.signed_magnitude(format.emin - format.precision + 2, format.emax - 2), format);
    };
    const auto vec = [&] {
        const double x = any(), y = any(), z = any();
        return Vec<double>(x, y, z);
    };
    const Vec<double> a = vec(), b = vec(), origin = vec();
    Vec<double> d = vec();
    if (d == Vec<double>(0)) d.y = 1;
    // Half of the rays look at the box on every axis, or nothing would ever be hit.
    if (rng.coin()) {
        for (int i = 0; i < 3; ++i) d[i] = std::copysign(d[i], a[i] - origin[i]);
    }
    return {{origin, d}, box_between(a, b), rng.coin() ? HUGE_VAL : std::fabs(any())};
}

/// t = (lo − o)/2^k with one bit too many for a double or a float: half way between two neighbours, or beside it.
BoxSample draw_tie(Seeded& rng, const FloatFormat& format) {
    const int axis = rng.index(3), p = format.precision;
    const double odd = std::ldexp(static_cast<double>(2 * static_cast<std::int64_t>(rng.bits(p - 2)) + 1), 1 - p);
    Box<double> box{Vec<double>(-4), Vec<double>(4)};
    box.lo[axis] = 1 + odd / 2;
    box.hi[axis] = 8;
    // lo − o = 1 + odd/2 + 2^-j: a tie of the format where 2^-j is half its last place.
    const int j = p + static_cast<int>(rng.integer(-2, 2));
    Vec<double> origin(0), d(0);
    for (int i = 0; i < 3; ++i) {
        d[i] = i == axis ? 1.0 : draw_zero(rng);
        origin[i] = i == axis ? -std::ldexp(1.0, -j) : rng.uniform(-4.5, 4.5);
    }
    if (rng.index(4) == 0) origin[axis] = nudge(origin[axis], rng.integer(-1, 1), format);
    return rescale(stored(BoxSample{{origin, d}, box, HUGE_VAL}, format), 0, static_cast<int>(rng.integer(-20, 20)));
}

/// The entry, or its distance, on a power of two, or off it by less than a bound of 2^-72 can tell.
BoxSample draw_power_of_two(Seeded& rng, const FloatFormat& format) {
    const double k = std::ldexp(1.0, rng.index(11) - 5);
    const auto small = [&] { return static_cast<double>(rng.index(15) - 7); };
    BoxSample s;
    s.ray.direction =
        rng.coin() ? Vec<double>(1 + rng.index(9), small(), small()) : Vec<double>(3 + rng.index(9), 0, 0);
    const double near = s.ray.direction.y == 0 && s.ray.direction.z == 0 ? k : k * s.ray.direction.x;
    const double y = k * s.ray.direction.y, z = k * s.ray.direction.z;
    s.box = {{near, y - 3, z - 3}, {near + 5, y + 3, z + 3}};
    if (rng.index(8) == 0) s.ray.direction.x = -s.ray.direction.x;
    if (rng.coin())
        s.ray.origin.x = std::ldexp(rng.coin() ? 1.0 : -1.0, -75 - rng.index(format == binary32 ? 40 : 700));
    return s;
}

}  // namespace

using Promise = BoxDistribution::Promise;
const BoxDistribution box_distributions[19] = {
    {"random", Promise::none, draw_random_ray, 20000},
    {"at edge", Promise::none, draw_at_edge, 10000},
    {"along face", Promise::touches, draw_along_face, 5000},
    {"across edge", Promise::touches, draw_across_edge, 5000},
    {"across corner", Promise::touches, draw_across_corner, 5000},
    {"beside edge", Promise::none, draw_beside_edge, 12000},
    {"axis parallel", Promise::none, draw_axis_parallel, 8000},
    {"flat box", Promise::flat, draw_flat_box, 8000},
    {"by a hair", Promise::none, draw_by_a_hair, 5000},
    {"far away", Promise::none, draw_far_away, 5000},
    {"inside", Promise::inside, draw_inside, 3000},
    {"on boundary", Promise::on_boundary, draw_on_boundary, 5000},
    {"at end", Promise::at_end, draw_at_end, 4000},
    {"about end", Promise::none, draw_about_end, 6000},
    {"subnormal", Promise::none, draw_subnormal, 3000},
    {"huge", Promise::none, draw_huge, 4000},
    {"mixed exponents", Promise::none, draw_mixed_exponents, 2000},
    {"tie", Promise::none, draw_tie, 5000},
    {"power of two", Promise::none, draw_power_of_two, 6000},
};

std::string paste(const BoxSample& sample) {
    const Vec<double>&o = sample.ray.origin, &d = sample.ray.direction, &a = sample.box.lo, &b = sample.box.hi;
    char text[640];
    std::snprintf(
        text, sizeof text,
        "Ray<double> ray{{%a, %a, %a}, {%a, %a, %a}}; Box<double> box{{%a, %a, %a}, {%a, %a, %a}}; double tmax = %a;",
        o.x, o.y, o.z, d.x, d.y, d.z, a.x, a.y, a.z, b.x, b.y, b.z, sample.tmax);
    return text;
}

}  // namespace lostbits::test
