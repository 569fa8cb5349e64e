// Cases worked out by hand. Every number is a small dyadic and every direction has length 1 or 2, so float and double
// compute without any rounding and must answer exactly.
#include "catch.hpp"
#include "intersect/ask_row.hpp"
#include "number/random.hpp"
#include "shapes/sphere/forms/expanded.hpp"

namespace lostbits::test {

using intersect::Roots, intersect::table::Intersector;

namespace {

struct KnownCase {
    const char* what;
    std::array<double, 3> origin, direction, centre;
    double radius;
    double near, far;  // line parameters, worked out by hand
    enum { crosses, touches, passes } line;
};

const KnownCase known_cases[] = {
    {"head on from distance 5", {0, 0, -5}, {0, 0, 1}, {0, 0, 0}, 1, 4, 6, KnownCase::crosses},
    {"head on along -x, moved from the world's origin", {7, 2, 1}, {-1, 0, 0}, {2, 2, 1}, 1, 4, 6, KnownCase::crosses},
    {"off the centre, 3-4-5", {3, 0, -8}, {0, 0, 1}, {0, 0, 0}, 5, 4, 12, KnownCase::crosses},
    {"off the centre in y, 3-4-5", {1, 4, -8}, {0, 0, 1}, {1, 0, 0}, 5, 5, 11, KnownCase::crosses},
    {"behind", {0, 0, 5}, {0, 0, 1}, {0, 0, 0}, 1, -6, -4, KnownCase::crosses},
    {"inside, the centre ahead", {0, 0, -1}, {0, 0, 1}, {0, 0, 0}, 2, -1, 3, KnownCase::crosses},
    {"inside, the centre behind", {0, 0, 1}, {0, 0, 1}, {0, 0, 0}, 2, -3, 1, KnownCase::crosses},
    {"at the centre, b' = 0", {0, 0, 0}, {0, 0, 1}, {0, 0, 0}, 2, -2, 2, KnownCase::crosses},
    {"at the centre, b' = -0", {0, 0, -0.0}, {-0.0, -0.0, -1}, {0, 0, 0}, 2, -2, 2, KnownCase::crosses},
    {"inside, square to the centre, b' = 0", {3, 0, 0}, {0, 0, 1}, {0, 0, 0}, 5, -4, 4, KnownCase::crosses},
    {"inside, square to the centre, b' = -0", {-3, 0, 0}, {0, -1, 0}, {0, 0, 0}, 5, -4, 4, KnownCase::crosses},
    {"on the surface, looking in", {0, 0, -2}, {0, 0, 1}, {0, 0, 0}, 2, 0, 4, KnownCase::crosses},
    {"on the surface, looking out", {0, 0, 2}, {0, 0, 1}, {0, 0, 0}, 2, -4, 0, KnownCase::crosses},
    {"touching ahead", {1, 0, -4}, {0, 0, 1}, {0, 0, 0}, 1, 4, 4, KnownCase::touches},
    {"touching ahead, other side, other axis", {-8, 0, -1}, {1, 0, 0}, {0, 0, 1}, 2, 8, 8, KnownCase::touches},
    {"touching behind", {1, 0, 4}, {0, 0, 1}, {0, 0, 0}, 1, -4, -4, KnownCase::touches},
    {"passing by", {1.5, 0, -4}, {0, 0, 1}, {0, 0, 0}, 1, 0, 0, KnownCase::passes},
    {"passing by at the waist, b' = 0", {0, 3, 0}, {0, 0, 1}, {0, 0, 0}, 1, 0, 0, KnownCase::passes},
    {"direction of length 2", {0, 0, -5}, {0, 0, 2}, {0, 0, 0}, 1, 2, 3, KnownCase::crosses},
    {"direction of length 1/2", {3, 0, -8}, {0, 0, 0.5}, {0, 0, 0}, 5, 8, 24, KnownCase::crosses},
    {"direction of length 2, touching", {1, 0, -4}, {0, 0, 2}, {0, 0, 0}, 1, 2, 2, KnownCase::touches},
    {"far enough for a second step", {0, 0, -33}, {0, 0, 1}, {0, 0, 0}, 1, 32, 34, KnownCase::crosses},
    {"second step with direction of length 2", {0, 0, -65}, {0, 0, 2}, {0, 0, 0}, 1, 32, 33, KnownCase::crosses},
};

template <class T>
void ask(const Intersector& row, const KnownCase& known, double slack) {
    const intersect::Info& info = *row.info;
    const double length2 = known.direction[0] * known.direction[0] + known.direction[1] * known.direction[1] +
                           known.direction[2] * known.direction[2];
    if (info.direction == intersect::Direction::unit && length2 != 1) return;
    const bool inside = known.line == KnownCase::crosses && known.near < 0 && known.far > 0;
    if (info.roots == Roots::near_only && inside) return;

    const bool zero_counts = info.at_origin == intersect::AtOrigin::hit;
    const auto counts = [&](double t) { return t > 0 || (t == 0 && zero_counts); };
    bool want = known.line == KnownCase::crosses ||
                (known.line == KnownCase::touches && info.touching == intersect::Touching::hit);
    const double first = counts(known.near) || info.roots == Roots::near_only ? known.near : known.far;
    want = want && counts(first);
    // Two forms cannot see a ray that touches, and this is where that is written down: bounds moved outward make every
    // touching discriminant possibly negative, a miss; and from the point of closest approach q = 0 there, so t is 0/0.
    const bool touches = known.line == KnownCase::touches;
    if (touches && info.name == "sphere.pbrt_interval") want = false;

    const auto vec = [](const std::array<double, 3>& v) { return Vec<T>(T(v[0]), T(v[1]), T(v[2])); };
    const auto [hit, t, near, far] =
        ask_row<T>(row, {vec(known.origin), vec(known.direction)}, Sphere<T>{vec(known.centre), T(known.radius)});
    INFO(info.name << " in " << 8 * sizeof(T) << " bits, " << known.what << ": hit " << hit << " t " << t << " near "
                   << near << " far " << far);
    if (touches && info.name == "sphere.closest_approach") {
        CHECK(std::isnan(t));
        return;
    }
    CHECK(hit == want);
    if (!hit || !want) return;
    CHECK(std::fabs(t - first) <= slack);
    if (info.roots == Roots::both) {
        CHECK(std::fabs(near - known.near) <= slack);
        CHECK(std::fabs(far - known.far) <= slack);
    } else {
        CHECK(near == t);
        CHECK(far == t);
    }
}

template <class T>
void ask_every_form(int precision) {
    for (const Intersector& row : intersect::table::intersectors(Shape::sphere)) {
        if (row.info->formats != intersect::Formats::all && precision != 24) continue;
        // A form that takes the root of |f|² or moves bounds outward may be off by a few units; all others are exact.
        const bool exact = row.info->name != "sphere.pbrt_interval" && row.info->name != "sphere.factored_c";
        for (const KnownCase& k : known_cases)
            ask<T>(row, k, exact ? 0 : std::ldexp(std::fmax(std::fabs(k.near), std::fabs(k.far)), 7 - precision));
    }
}

}  // namespace

TEST_CASE("forms of spheres give the answers worked out by hand", "[intersect][known]") {
    ask_every_form<float>(24);
    ask_every_form<double>(53);
}

namespace {

/// Ray-Casting Formulas as it is printed; `grouped` adds G·G and O·O instead, each summed for itself.
template <class S>
S as_printed(const Ray<S>& ray, const Sphere<S>& sphere, bool grouped) {
    const S dx = ray.direction.x, dy = ray.direction.y, dz = ray.direction.z;
    const S x0 = ray.origin.x, y0 = ray.origin.y, z0 = ray.origin.z;
    const S cx = sphere.centre.x, cy = sphere.centre.y, cz = sphere.centre.z, R = sphere.radius;
    const S a = dx * dx + dy * dy + dz * dz;
    const S b = 2 * dx * (x0 - cx) + 2 * dy * (y0 - cy) + 2 * dz * (z0 - cz);
    const S squares = grouped ? (cx * cx + cy * cy + cz * cz) + (x0 * x0 + y0 * y0 + z0 * z0)
                              : cx * cx + cy * cy + cz * cz + x0 * x0 + y0 * y0 + z0 * z0;
    const S c = squares + -2 * (cx * x0 + cy * y0 + cz * z0) - R * R;
    return (-b - std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

template <class S>
void compare_with_print(std::uint64_t seed) {
    Random random(seed);
    const auto draw = [&](double from, double to) { return static_cast<S>(from + (to - from) * random.unit()); };
    int hits = 0, other = 0;
    for (int k = 0; k < 4000; ++k) {
        const Vec<S> aim{draw(-1, 1), draw(-1, 1), draw(-1, 1)}, centre{draw(-9, 9), draw(-9, 9), draw(-9, 9)},
            origin{draw(-9, 9), draw(-9, 9), draw(-9, 9)};
        const Ray<S> ray{origin, centre + aim - origin};
        const Sphere<S> sphere{centre, draw(0.5, 4)};
        const Hit<S> got = intersect::sphere::Expanded::intersect(ray, sphere);
        if (!got.hit) continue;
        ++hits;
        CHECK(got.t == as_printed(ray, sphere, false));
        other += got.t != as_printed(ray, sphere, true);
    }
    CHECK(hits > 300);
    CHECK(other > hits / 10);  // so that the test would detect the other order
}

}  // namespace

TEST_CASE("sphere.expanded adds its six squares as the source prints them", "[intersect][known]") {
    compare_with_print<float>(31);
    compare_with_print<double>(32);
}

}  // namespace lostbits::test
