// Crossings with meshes and winding numbers, compared with integers. Corners, origins and directions are on a small
// grid, so that rays often meet edges, vertices, planes and ties, and 64 bits hold every polynomial.
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <vector>

#include "catch.hpp"
#include "measure/crossing/mesh_crossings.hpp"
#include "measure/culling/box_tree.hpp"
#include "scene/rays/random.hpp"
#include "shapes/triangle/mesh/mesh.hpp"

namespace lostbits::test::test_mesh_crossings {

using measure::crossing::find_crossings;
using measure::crossing::find_facing;
using measure::crossing::find_nearest_edges;
using measure::crossing::locate_in_mesh;
using measure::crossing::Triangles;
using measure::culling::BoxTree;
using scene::rays::PrimitiveList;
using Whole = std::int64_t;
using Point = std::array<Whole, 3>;

namespace {

Point less(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point crossed(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Whole dotted(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec<double> vec(const Point& p) {
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

struct Corners {
    Point a, b, c;
    [[nodiscard]] Primitive<double> primitive() const { return Triangle<double>{vec(a), vec(b), vec(c)}; }
};

/// A crossing in whole numbers: t = n/m, m > 0.
struct ExpectedCrossing {
    std::uint32_t triangle;
    Whole n, m;
    bool front, at_rim;
};

/// In the order of t. `in_plane`: whether the ray lies in the plane of a triangle.
std::vector<ExpectedCrossing> brute_force(const Point& o, const Point& d, const std::vector<Corners>& mesh,
                                          bool& in_plane) {
    std::vector<ExpectedCrossing> met;
    for (std::uint32_t k = 0; k < mesh.size(); ++k) {
        const Point a = less(mesh[k].a, o), b = less(mesh[k].b, o), c = less(mesh[k].c, o);
        const Point normal = crossed(less(b, a), less(c, a));
        const Whole m = dotted(d, normal), sign = m < 0 ? -1 : 1;
        if (m == 0) in_plane |= dotted(a, normal) == 0;
        const std::array<Whole, 3> sides{sign * dotted(d, crossed(b, c)), sign * dotted(d, crossed(c, a)),
                                         sign * dotted(d, crossed(a, b))};
        const Whole least = std::ranges::min(sides), n = sign * dotted(a, normal);
        if (m != 0 && least >= 0 && n >= 0) met.push_back({k, n, sign * m, m < 0, least == 0});
    }
    std::ranges::stable_sort(
        met, [](const ExpectedCrossing& x, const ExpectedCrossing& y) { return x.n * y.m < y.n * x.m; });
    return met;
}

class RandomMeshRays {
public:
    explicit RandomMeshRays(std::uint64_t seed) : random_(seed) {}
    Point point(int half) { return {in(half), in(half), in(half)}; }
    Corners triangle(int half) {
        for (;;) {
            const Corners t{point(half), point(half), point(half)};
            if (crossed(less(t.b, t.a), less(t.c, t.a)) != Point{}) return t;
        }
    }
    Point direction(int half) {
        for (;;)
            if (const Point d = point(half); d != Point{}) return d;
    }
    int below(int n) { return random_.below(n); }

private:
    Whole in(int half) { return random_.below(2 * half + 1) - half; }
    scene::rays::Random random_;
};

/// The faces of a box, some of them divided differently, turned inside out if `turn`.
void add_box(std::vector<Corners>& mesh, const Point& lo, const Point& size, bool turn, RandomMeshRays& draw) {
    for (int axis = 0; axis < 3; ++axis)
        for (int end = 0; end < 2; ++end) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const auto corner = [&](int i, int j) {
                Point p = lo;
                p[axis] += end * size[axis], p[u] += i * size[u], p[v] += j * size[v];
                return p;
            };
            std::array<Point, 4> round{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
            if (draw.below(2) != 0) std::ranges::rotate(round, round.begin() + 1);
            if ((end == 0) != turn) std::ranges::reverse(round);
            mesh.push_back({round[0], round[1], round[2]});
            mesh.push_back({round[0], round[2], round[3]});
        }
}

PrimitiveList<double> primitives_of(const std::vector<Corners>& mesh) {
    std::vector<Primitive<double>> primitives;
    for (const Corners& one : mesh) primitives.push_back(one.primitive());
    return primitives;
}

std::shared_ptr<const BoxTree> tree_of(const PrimitiveList<double>& primitives) {
    return BoxTree::make(primitives, {.max_origin_distance = 64, .min_direction_length = 1, .max_direction_length = 64},
                         nullptr);
}

/// Compares all crossings of a ray with those in integers.
void check_ray(const Point& o, const Point& d, const std::vector<Corners>& mesh, const Triangles& among) {
    bool in_plane = false;
    const auto expected = brute_force(o, d, mesh, in_plane);
    const auto found = find_crossings({vec(o), vec(d)}, among);
    REQUIRE(found.is_resolved);
    REQUIRE(found.in_order.size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const auto& x = found.in_order[i];
        const ExpectedCrossing& y = expected[i];
        const double t = static_cast<double>(y.n) / static_cast<double>(y.m);
        REQUIRE(x.triangle == y.triangle);
        REQUIRE(x.hits_front == y.front);
        REQUIRE(x.is_at_rim == y.at_rim);
        REQUIRE(x.t.is_zero() == (y.n == 0));
        REQUIRE(std::fabs(std::ldexp(x.t.hi, static_cast<int>(x.t.exponent)) - t) <= 0x1p-52 * t);
        const int step = i == 0 ? x.rank : x.rank - found.in_order[i - 1].rank;
        REQUIRE(step == (i > 0 && expected[i - 1].n * y.m != y.n * expected[i - 1].m ? 1 : 0));
    }
}

}  // namespace

TEST_CASE("crossings of rays with triangles agree with integer arithmetic, also for ties and on rims") {
    RandomMeshRays draw(17);
    std::size_t met = 0, ties = 0, rims = 0;
    for (int soup = 0; soup < 20; ++soup) {
        std::vector<Corners> mesh;
        for (int k = 0; k < 400; ++k) mesh.push_back(draw.triangle(soup % 2 == 0 ? 4 : 12));
        for (int k = 0; k < 20; ++k) mesh.push_back(mesh[draw.below(400)]);  // duplicates
        for (int k = 0; k < 7; ++k) add_box(mesh, draw.point(8), {1 + draw.below(4), 2, 3}, k % 2 == 0, draw);
        const PrimitiveList<double> primitives = primitives_of(mesh);
        const auto tree = tree_of(primitives);
        REQUIRE(tree != nullptr);
        for (int i = 0; i < 500; ++i) {
            const Point o = draw.point(10), d = draw.direction(6);
            check_ray(o, d, mesh, {primitives, i % 4 == 0 ? nullptr : tree.get()});
            bool in_plane = false;
            const auto all = brute_force(o, d, mesh, in_plane);
            met += all.size();
            for (std::size_t k = 0; k < all.size(); ++k) {
                rims += all[k].at_rim;
                ties += k > 0 && all[k - 1].n * all[k].m == all[k].n * all[k - 1].m;
            }
        }
    }
    CHECK(met > 100000);
    CHECK(ties > 3000);
    CHECK(rims > 3000);
}

TEST_CASE("a range takes the crossings within it, and its ends follow their convention") {
    const std::vector<Corners> mesh{{{0, 0, 1}, {4, 0, 1}, {0, 4, 1}}, {{0, 0, 3}, {4, 0, 3}, {0, 4, 3}}};
    const PrimitiveList<double> primitives = primitives_of(mesh);
    const Ray<double> ray{{1, 1, 0}, {0, 0, 1}};
    const auto count = [&](const Range<double>& range) {
        return find_crossings(ray, {primitives}, range).in_order.size();
    };
    CHECK(count({}) == 2);
    CHECK(count({.tmin = 1, .tmax = 3}) == 2);
    CHECK(count({.tmin = 1, .tmax = 3, .open_ends = {.tmin = true}}) == 1);
    CHECK(count({.tmin = 1, .tmax = 3, .open_ends = {.tmin = true, .tmax = true}}) == 0);
    CHECK(count({.tmin = 2, .tmax = 2.5}) == 0);
}

TEST_CASE("the side from which a line crosses a triangle and its nearest edges are exact") {
    const auto triangle = [](const Vec<double>& a, const Vec<double>& b, const Vec<double>& c) {
        return Primitive<double>(Triangle<double>{a, b, c});
    };
    // The normal is (1, 1, −1), and d·n = 1 + 2^-300 − 1.
    const Primitive<double> slanted = triangle({0, 0, 0}, {1, 0, 1}, {1, -1, 0}),
                            turned = triangle({0, 0, 0}, {1, -1, 0}, {1, 0, 1});
    for (const double least : {0x1p-300, 0x1p-1000}) {
        const Vec<double> d(1, least, 1);
        CHECK(find_facing({{0, 0, -1}, d}, slanted) == -1);
        CHECK(find_facing({{0, 0, -1}, d}, turned) == 1);
        CHECK(find_facing({{0, 0, -1}, -1.0 * d}, slanted) == 1);
    }
    CHECK(find_facing({{0, 0, -1}, {1, 0, 1}}, slanted) == 0);
    CHECK(find_nearest_edges({{0, 0, -1}, {1, 0, 1}}, slanted) == 0b111);

    // A point (x, y) of a triangle with sides 3, 4 and 5 is (12 − 3x − 4y)/5, x and y away from the edges opposite to
    // a, b and c: all are 1 at (1, 1).
    const Primitive<double> right = triangle({0, 0, 0}, {4, 0, 0}, {0, 3, 0}),
                            left = triangle({0, 0, 0}, {0, 3, 0}, {4, 0, 0});
    const auto nearest = [&](double x, double y, double dy = 0) {
        const unsigned from_above = find_nearest_edges({{x, y, 1}, {0, dy, -1}}, right);
        CHECK(find_nearest_edges({{x, y, -1}, {0, dy, 1}}, right) == from_above);
        CHECK(find_nearest_edges({{x, y, -1}, {0, dy, 1}}, left) ==
              ((from_above & 1U) | (from_above & 2U) << 1 | (from_above & 4U) >> 1));
        return from_above;
    };
    CHECK(nearest(1, 1) == 0b111);
    CHECK(nearest(0.5, 0.5) == 0b110);
    CHECK(nearest(0.5, 1) == 0b010);
    CHECK(nearest(1, 0.5) == 0b100);
    CHECK(nearest(1.5, 1.5) == 0b001);
    CHECK(nearest(1, 1 + 0x1p-52) == 0b001);
    CHECK(nearest(1, 1 - 0x1p-53) == 0b100);
    CHECK(nearest(1 - 0x1p-53, 1) == 0b010);
    CHECK(nearest(1, 1, 0x1p-300) == 0b001);
    CHECK(nearest(1, 1, -0x1p-300) == 0b100);
    CHECK(nearest(0, 1) == 0b010);
    CHECK(nearest(0, 0) == 0b110);
}

TEST_CASE("winding numbers of points agree with the boxes of which a mesh consists") {
    RandomMeshRays draw(23);
    std::size_t on_surface = 0, deep = 0;
    for (int scene = 0; scene < 40; ++scene) {
        std::vector<Corners> mesh;
        struct Placed {
            Point lo, size;
            bool turn;
        };
        std::vector<Placed> boxes;
        for (int k = 0; k < 12; ++k) {
            boxes.push_back({draw.point(6), {4 + draw.below(9), 4 + draw.below(9), 4 + draw.below(9)}, k % 3 == 0});
            add_box(mesh, boxes.back().lo, boxes.back().size, boxes.back().turn, draw);
        }
        const PrimitiveList<double> primitives = primitives_of(mesh);
        const auto tree = tree_of(primitives);
        for (int i = 0; i < 250; ++i) {
            const Point p = draw.point(9);
            int winding = 0;
            bool on = false;
            for (const Placed& box : boxes) {
                bool in = true, at_wall = false;
                for (int k = 0; k < 3; ++k) {
                    in &= p[k] >= box.lo[k] && p[k] <= box.lo[k] + box.size[k];
                    at_wall |= p[k] == box.lo[k] || p[k] == box.lo[k] + box.size[k];
                }
                on |= in && at_wall;
                if (in && !at_wall) winding += box.turn ? -1 : 1;
            }
            const auto found = locate_in_mesh(vec(p), {primitives, i % 4 == 0 ? nullptr : tree.get()});
            REQUIRE(found.is_resolved);
            REQUIRE(found.is_on_surface == on);
            if (!on) REQUIRE(found.winding == winding);
            if (!on) REQUIRE((found.crossings - winding) % 2 == 0);
            on_surface += on, deep += !on && winding > 1;
        }
    }
    CHECK(on_surface > 1000);
    CHECK(deep > 100);
    CHECK_FALSE(locate_in_mesh({NAN, 0, 0}, {primitives_of({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}})}).is_resolved);
}

}  // namespace lostbits::test::test_mesh_crossings
