// Rays that break filters and bounds: every distribution in which a decision or t depends on a last bit, seeded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "number/random.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::test {

/// A ray and the primitive at which it is aimed, in numbers of a format.
struct HostileRay {
    Ray<double> ray;
    Primitive<double> primitive;
    double tmax = HUGE_VAL;
};

inline constexpr std::array<std::string_view, 12> sphere_distributions{"near",    "grazing by 2^-1 to 2^-50 radii",
                                                                       "inside",  "on the surface",
                                                                       "far",     "behind",
                                                                       "huge",    "tiny",
                                                                       "lattice", "tangent to the bit",
                                                                       "between", "beside tangent by a last place"};

inline constexpr std::array<std::string_view, 8> hostile_box_distributions{
    "inside", "edges and corners", "edges by a last place", "far",
    "flat",   "lattice",           "lattice, on a face",    "magnitudes"};

/// Draws rays in S.
template <class S>
class HostileRays {
public:
    explicit HostileRays(std::uint64_t seed) : random_(seed) {}

    HostileRay sphere(std::size_t distribution) {
        const std::string_view name = sphere_distributions.at(distribution);
        if (name == "lattice") return lattice_sphere();
        if (name == "tangent to the bit") return tangent(false);
        if (name == "beside tangent by a last place") return tangent(true);
        double r = power(-2, 2), distance = r * power(0.5, 4), impact = 1.3 * random_.unit();
        if (name.starts_with("grazing")) impact = 1 + random_.sign() * power(-50, -1);
        if (name == "inside") distance = r * random_.unit();
        if (name == "on the surface") distance = r;
        if (name == "far") distance = r * power(4, 22);
        if (name == "huge") distance = (r = power(18, 40)) * (1 + random_.sign() * power(-30, -8));
        if (name == "tiny") distance = (r = power(-20, -6)) * power(0.5, 20);
        if (name == "between") distance = r * (1 + random_.sign() * 4e-5 * random_.unit());
        const Vec<double> w = unit(), side = across(w);
        const double world = random_.one_in(4) ? 1e3 * r : r;
        const Vec<double> c = stored(world * unit());
        const Vec<double> o = stored(c + distance * w + (distance > r ? impact * r : 0.0) * side);
        const bool aimed = distance > 1.01 * r && !random_.one_in(8);
        const double back = name == "behind" ? 1 : -1, size = power(-12, 12);
        return {{o, stored(size * (aimed ? back * w : unit()))}, Sphere<double>{c, stored(r)}, HUGE_VAL};
    }

    HostileRay box(std::size_t distribution) {
        const std::string_view name = hostile_box_distributions.at(distribution);
        const bool whole = name.starts_with("lattice");
        const auto place = [&](double s) { return whole ? whole_number(4) : stored(s * (2 * random_.unit() - 1)); };
        Vec<double> lo(0, 0, 0), hi(0, 0, 0), aim(0, 0, 0), d(0, 0, 0), o(0, 0, 0);
        for (int k = 0; k < 3; ++k) {
            lo[k] = place(2);
            hi[k] = place(2);
            if (lo[k] > hi[k]) std::swap(lo[k], hi[k]);
            if (name == "flat" && random_.one_in(3)) hi[k] = lo[k];
            const long at = name == "inside" ? 2 : random_.between(0, 3);
            aim[k] = at == 0 ? lo[k] : at == 1 ? hi[k] : stored(lo[k] + (hi[k] - lo[k]) * random_.unit());
            d[k] = random_.one_in(5) && name != "inside" ? random_.sign() * 0.0 : place(3);
        }
        if (d.x == 0 && d.y == 0 && d.z == 0) d.x = 1;
        const double back = whole ? whole_number(4) : stored((name == "far" ? 1e5 : 6) * random_.unit());
        for (int k = 0; k < 3; ++k) {
            o[k] = name.ends_with("on a face") && random_.one_in(3) ? aim[k] : stored(aim[k] - back * d[k]);
            if (name == "edges by a last place" && random_.one_in(3)) o[k] = beside(o[k]);
            if (name == "magnitudes") d[k] = stored(d[k] * power(-8, 8));
        }
        const double tmax =
            random_.one_in(3) ? (whole ? std::fabs(whole_number(6)) : stored(8 * random_.unit())) : HUGE_VAL;
        return {{o, d}, Box<double>{lo, hi}, tmax};
    }

private:
    static double stored(double x) { return static_cast<double>(static_cast<S>(x)); }
    static Vec<double> stored(const Vec<double>& v) { return {stored(v.x), stored(v.y), stored(v.z)}; }
    /// The number of S next to x, which is not 0: next to 0 are subnormal numbers.
    double beside(double x) {
        if (x == 0) return x;
        return static_cast<double>(std::nextafter(static_cast<S>(x), static_cast<S>(random_.sign() * HUGE_VAL)));
    }
    double power(double low, double high) { return std::exp2(low + (high - low) * random_.unit()); }
    double whole_number(long most) { return static_cast<double>(random_.between(-most, most)); }
    Vec<double> unit() {
        for (;;) {
            const Vec<double> v(2 * random_.unit() - 1, 2 * random_.unit() - 1, 2 * random_.unit() - 1);
            const double size = dot(v, v);
            if (size > 0.01 && size < 1) return v / Vec<double>(std::sqrt(size), std::sqrt(size), std::sqrt(size));
        }
    }
    Vec<double> across(const Vec<double>& w) {
        for (;;) {
            const Vec<double> v = unit(), n = v - dot(v, w) * w;
            const double size = std::sqrt(dot(n, n));
            if (size > 0.1) return (1 / size) * n;
        }
    }

    HostileRay lattice_sphere() {
        const auto whole = [this] { return Vec<double>(whole_number(20), whole_number(20), whole_number(20)); };
        const Vec<double> o = whole(), c = whole();
        Vec<double> d = whole();
        if (dot(d, d) == 0) d.z = 1;
        return {{o, d}, Sphere<double>{c, static_cast<double>(random_.between(1, 20))}, HUGE_VAL};
    }

    /// Along an axis at exactly a radius from the centre: the discriminant is zero, or differs from zero by a last
    /// place.
    HostileRay tangent(bool moved) {
        const auto axis = static_cast<int>(random_.between(0, 2)), side = (axis + 1) % 3;
        const double scale = std::ldexp(1, static_cast<int>(random_.between(-10, 10)));
        Vec<double> o(whole_number(20), whole_number(20), whole_number(20)), d(0, 0, 0);
        Vec<double> c(whole_number(20), whole_number(20), whole_number(20));
        const auto r = static_cast<double>(random_.between(1, 20));
        d[axis] = random_.one_in(2) ? 3 : -7;
        o[side] = c[side] + r;
        o[(axis + 2) % 3] = c[(axis + 2) % 3];
        o = scale * o;
        c = scale * c;
        if (moved) o[static_cast<int>(random_.between(0, 2))] = beside(o[static_cast<int>(random_.between(0, 2))]);
        return {{o, d}, Sphere<double>{c, scale * r}, HUGE_VAL};
    }

    Random random_;
};

/// The same situation at another scale, lengths and directions by powers of two from all that the format has: squares
/// and products under- and overflow on the way, and numbers of the ray and the primitive themselves are subnormal.
template <class S>
HostileRay at_any_scale(HostileRay x, Random& random) {
    constexpr int reach = std::numeric_limits<S>::max_exponent + 20;
    const int of_lengths = static_cast<int>(random.between(-reach, reach)),
              of_direction = static_cast<int>(random.between(-reach, reach));
    const auto scaled = [](double v, int k) {
        constexpr double most = std::numeric_limits<S>::max();
        return static_cast<double>(static_cast<S>(std::clamp(std::ldexp(v, k), -most, most)));
    };
    for (int k = 0; k < 3; ++k) {
        x.ray.origin[k] = scaled(x.ray.origin[k], of_lengths);
        x.ray.direction[k] = scaled(x.ray.direction[k], of_direction);
    }
    x.primitive = convert_numbers(x.primitive, [&](double v) { return scaled(v, of_lengths); });
    for_each_key(x.primitive.shape, [&x](const Key& key, std::size_t first) {
        for (std::size_t k = first; key.limit == Key::Limit::positive && k < first + key.count(); ++k)
            if (x.primitive.numbers[k] == 0) x.primitive.numbers[k] = std::numeric_limits<S>::denorm_min();
    });
    if (x.ray.direction == Vec<double>(0, 0, 0)) x.ray.direction.x = std::numeric_limits<S>::denorm_min();
    return x;
}

}  // namespace lostbits::test
