// Woop's test with a rule for ties: of the triangles around an edge or a vertex, exactly one claims a line through it.
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "catch.hpp"
#include "number/rounded.hpp"
#include "scene/rays/random.hpp"
#include "shapes/triangle/forms/woop.hpp"
#include "shapes/triangle/forms/woop_once.hpp"
#include "shapes/triangle/mesh/made.hpp"

namespace lostbits::test::test_exactly_once {

using intersect::triangle::Woop;
using intersect::triangle::WoopOnce;

namespace {

template <class T>
Vec<T> vec(const Vec<double>& v) {
    return {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
}
/// v with each component rounded to float or double.
template <class T>
Vec<double> stored_in(const Vec<double>& v) {
    const Vec<T> rounded = vec<T>(v);
    return {static_cast<double>(rounded.x), static_cast<double>(rounded.y), static_cast<double>(rounded.z)};
}
template <class Form, class T>
bool claims(const Ray<double>& ray, const Triangle<double>& triangle) {
    const Ray<T> stored{vec<T>(ray.origin), vec<T>(ray.direction)};
    return Form::template intersect<T>(stored, {vec<T>(triangle.a), vec<T>(triangle.b), vec<T>(triangle.c)}).hit;
}

using Whole = std::int64_t;
/// A point of the plane in units of 2^-20.
struct Point {
    Whole x, y;
};
constexpr Whole unit = Whole{1} << 20;

Whole turn(const Point& p, const Point& q, const Point& s) {
    return (p.x - s.x) * (q.y - s.y) - (p.y - s.y) * (q.x - s.x);
}

/// True if the triangle holds the point moved by (ε, ε²) with ε = 2^-10. Corners are whole numbers up to 3 and the
/// point is halves: no edge lies between the point and the moved one, and none meets the moved one.
bool holds_moved(const std::array<Point, 3>& corners, const Point& s) {
    const Point moved{s.x + (Whole{1} << 10), s.y + 1};
    const Whole a = turn(corners[1], corners[2], moved), b = turn(corners[2], corners[0], moved),
                c = turn(corners[0], corners[1], moved);
    return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
}

/// A point of a grid of `size` by `size` points, `parts` of them in a unit.
Point on_grid(int k, int size, int parts) { return {k % size * unit / parts, k / size * unit / parts}; }

template <class T>
void check_grid() {
    std::size_t differ = 0, ties = 0, cases = 0;
    for (int i = 0; i < 16 * 16 * 16; ++i) {
        const std::array corners{on_grid(i % 16, 4, 1), on_grid(i / 16 % 16, 4, 1), on_grid(i / 256, 4, 1)};
        const auto at = [](const Point& p, double z) {
            return Vec<double>(static_cast<double>(p.x) / unit, static_cast<double>(p.y) / unit, z);
        };
        const Triangle<double> triangle{at(corners[0], 0), at(corners[1], 1), at(corners[2], -1)};
        for (int o = 0; o < 49; ++o) {
            const Point origin = on_grid(o, 7, 2);
            const bool claimed = claims<WoopOnce, T>({at(origin, 4), {0, 0, -1}}, triangle);
            differ += claimed != holds_moved(corners, origin);
            ties += turn(corners[0], corners[1], origin) == 0;
            ++cases;
        }
    }
    CHECK(differ == 0);
    CHECK(cases == 16 * 16 * 16 * 49);
    CHECK(ties > cases / 8);
}

/// Rays from outside of a closed mesh that aim at its vertices, at its edges and into its faces.
class RaysAtMesh {
public:
    explicit RaysAtMesh(const scene::triangle::Mesh& mesh) : mesh_(mesh), random_(11) {}

    template <class T>
    Ray<double> next(double distance) {
        const auto& face = mesh_.faces[random_.below(static_cast<int>(mesh_.faces.size()))];
        const Vec<double>&a = mesh_.vertices[face[0]], &b = mesh_.vertices[face[1]], &c = mesh_.vertices[face[2]];
        const double u = random_.unit(), v = random_.unit() * (1 - u);
        Vec<double> at = a;
        if (random_.unit() < 0.7) at = a + u * (b - a);
        if (random_.unit() < 0.2) at = at + v * (c - a);
        Vec<double> from(random_.unit() - 0.5, random_.unit() - 0.5, random_.unit() - 0.5);
        from = (distance / length(from)) * from;
        const Vec<double> origin = stored_in<T>(from);
        return {origin, stored_in<T>(at - origin)};
    }

private:
    const scene::triangle::Mesh& mesh_;
    scene::rays::Random random_;
};

/// Counts the rays of which an odd number of triangles is claimed: those that end inside of the mesh, or begin there.
template <class Form, class T>
int odd_rays(const scene::triangle::Mesh& mesh, int rays) {
    RaysAtMesh draw(mesh);
    int odd = 0;
    for (int i = 0; i < rays; ++i) {
        const Ray<double> ray = draw.next<T>(std::ldexp(1.0, 2 + i % 19));
        int claimed = 0;
        for (std::size_t k = 0; k < mesh.faces.size(); ++k) claimed += claims<Form, T>(ray, mesh.triangle(k));
        odd += claimed % 2;
    }
    return odd;
}

}  // namespace

TEST_CASE("of all triangles on a grid, those that hold the moved origin claim it", "[triangle][once]") {
    check_grid<float>();
    check_grid<double>();
    check_grid<Half>();
}

TEST_CASE("a line through a closed mesh enters as often as it leaves, by the claims of one form", "[triangle][once]") {
    scene::triangle::Mesh mesh = scene::triangle::make_icosphere(2, Vec<double>(0, 0, 0), 1);
    for (Vec<double>& v : mesh.vertices) v = stored_in<float>(v);
    constexpr int rays = 4000;
    CHECK(odd_rays<WoopOnce, float>(mesh, rays) == 0);
    CHECK(odd_rays<WoopOnce, double>(mesh, rays) == 0);
    CHECK(odd_rays<Woop, float>(mesh, rays) > 20);
    CHECK(odd_rays<Woop, double>(mesh, rays) > 0);
}

}  // namespace lostbits::test::test_exactly_once
