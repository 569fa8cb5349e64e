// The scenes that come with the program: every one loads and shows what it is there to show.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "catch.hpp"
#include "counts.hpp"
#include "scene/rays/camera.hpp"
#include "scene/rays/rays.hpp"
#include "scene/scene_text.hpp"

namespace test_data {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::file;
using namespace lostbits::scene::rays;

namespace {

std::vector<scene::file::Scene> all_scenes() {
    std::vector<scene::file::Scene> all;
    for (const auto& file : scene::file::scene_files(LOSTBITS_DATA_DIR))
        for (Scene& each : load_scene(file)) all.push_back(std::move(each));
    return all;
}

scene::file::Scene find(const std::string& id) {
    for (Scene& each : all_scenes())
        if (each.id == id) return each;
    throw std::logic_error("no scene " + id);
}

/// Is there a t ≥ 0 with |o + t d − c| = r? By the perpendicular from the centre; plain, but in Real.
bool hits(const Ray<Real>& ray, const Sphere<Real>& sphere) {
    const Vec<Real> to_centre = sphere.centre - ray.origin;
    const Real r2 = sphere.radius * sphere.radius;
    if (dot(to_centre, to_centre) <= r2) return true;
    const Real along = dot(to_centre, ray.direction);
    const Real d2 = dot(ray.direction, ray.direction);
    return along > 0 && dot(to_centre, to_centre) * d2 - along * along <= r2 * d2;
}

/// By clipping the ray with each slab in turn.
bool hits(const Ray<Real>& ray, const Box<Real>& box) {
    Real from(0), to = ldexp(Real(1), 1000);
    for (int i = 0; i < 3; ++i) {
        const Real &o = ray.origin[i], &d = ray.direction[i];
        if (d == 0) {
            if (o < box.lo[i] || o > box.hi[i]) return false;
            continue;
        }
        const Real a = (box.lo[i] - o) / d, b = (box.hi[i] - o) / d;
        from = std::max(from, Real(a < b ? a : b));
        to = std::min(to, Real(a < b ? b : a));
    }
    return from <= to;
}

/// By the barycentric coordinates of the point where it crosses the plane.
bool hits(const Ray<Real>& ray, const Triangle<Real>& triangle) {
    const Vec<Real> ab = triangle.b - triangle.a, ac = triangle.c - triangle.a, n = cross(ab, ac);
    const Real along = dot(n, ray.direction);
    if (along == 0) return false;
    const Real t = dot(n, triangle.a - ray.origin) / along;
    const Vec<Real> p = ray.origin + t * ray.direction - triangle.a;
    const Real v = dot(cross(p, ac), n) / dot(n, n), w = dot(cross(ab, p), n) / dot(n, n);
    return t >= 0 && v >= 0 && w >= 0 && v + w <= 1;
}

/// By the point of the ray that is nearest to the centre, where it is the unit sphere.
bool hits(const Ray<Real>& ray, const Ellipsoid<Real>& e) {
    const auto in_radii = [&e](const Vec<Real>& v) {
        return Vec<Real>(v.x / e.radii.x, v.y / e.radii.y, v.z / e.radii.z);
    };
    const Vec<Real> f = in_radii(ray.origin - e.centre), d = in_radii(ray.direction);
    const Real t = max(Real(-dot(f, d) / dot(d, d)), Real(0));
    return length(Vec<Real>(f + t * d)) <= 1;
}

/// By its distances from the axis along the ray between the caps, less the radius there: that is convex.
bool hits(const Ray<Real>& ray, const Cone<Real>& c) {
    const Vec<Real> v = c.top - c.base, f = ray.origin - c.base, &d = ray.direction;
    const Real v2 = dot(v, v), one = -dot(v, f) / dot(v, d), other = (v2 - dot(v, f)) / dot(v, d);
    Real low = max(min(one, other), Real(0)), high = max(one, other);
    const auto off = [&](const Real& t) {
        const Vec<Real> p = f + t * d;
        const Real k = dot(v, p) / v2;
        return Real(length(Vec<Real>(p - k * v)) - c.base_radius - k * (c.top_radius - c.base_radius));
    };
    if (high < low) return false;
    for (int i = 0; i < 60; ++i) {
        const Real a = (2 * low + high) / 3, b = (low + 2 * high) / 3;
        if (off(a) < off(b)) high = b;
        else low = a;
    }
    return off(low) <= 0;
}

/// By its distance from the circle, which along the ray has its least near the least of three points in a row.
bool hits(const Ray<Real>& ray, const Torus<Real>& t) {
    const Vec<Real> f = ray.origin - t.centre, &d = ray.direction;
    const Real a = dot(d, d), h = dot(f, d), outer = (t.major_radius + t.minor_radius) * 11 / 10;
    const Real disc = h * h - a * (dot(f, f) - outer * outer);
    if (disc < 0) return false;
    const Real begin = max(Real((-h - sqrt(disc)) / a), Real(0)), step = ((-h + sqrt(disc)) / a - begin) / 64;
    const auto off = [&](const Real& at) { return t.distance(ray.origin + at * d); };
    for (int i = 1; i < 64 && step > 0; ++i) {
        Real low = begin + (i - 1) * step, high = begin + (i + 1) * step;
        const Real middle = off(begin + i * step);
        if (off(low) < middle || off(high) < middle) continue;
        for (int k = 0; k < 60; ++k) {
            const Real x = (2 * low + high) / 3, y = (low + 2 * high) / 3;
            if (off(x) < off(y)) high = y;
            else low = x;
        }
        if (off(low) <= 0) return true;
    }
    return step >= 0 && (off(begin) <= 0 || off(begin + 64 * step) <= 0);
}

/// By the point of the ray between the caps that is nearest to the axis.
bool hits(const Ray<Real>& ray, const Cylinder<Real>& c) {
    const Vec<Real> v = c.top - c.base, f = ray.origin - c.base, &d = ray.direction;
    const Real v2 = dot(v, v), one = -dot(v, f) / dot(v, d), other = (v2 - dot(v, f)) / dot(v, d);
    const Vec<Real> across = d - (dot(v, d) / v2) * v, from = f - (dot(v, f) / v2) * v;
    const Real low = max(min(one, other), Real(0)), high = max(one, other);
    if (high < low) return false;
    const Real t = min(max(Real(-dot(from, across) / dot(across, across)), low), high);
    return length(Vec<Real>(from + t * across)) <= c.radius;
}

/// By both points of the line at the radius from the axis.
bool hits(const Ray<Real>& ray, const Tube<Real>& c) {
    const Vec<Real> v = c.top - c.bottom, f = ray.origin - c.bottom, &d = ray.direction;
    const Real v2 = dot(v, v);
    const Vec<Real> across = d - (dot(v, d) / v2) * v, from = f - (dot(v, f) / v2) * v;
    const Real middle = -dot(from, across) / dot(across, across), near = length(Vec<Real>(from + middle * across));
    if (near > c.radius) return false;
    const Real half = sqrt(Real(c.radius * c.radius - near * near)) / length(across);
    const auto counts = [&](const Real& t) {
        const Real k = dot(v, Vec<Real>(f + t * d)) / v2;
        return t >= 0 && k >= 0 && k <= 1;
    };
    return counts(middle - half) || counts(middle + half);
}

/// By the point of its plane.
bool hits(const Ray<Real>& ray, const Disc<Real>& disc) {
    const Real along = dot(disc.normal, ray.direction);
    if (along == 0) return false;
    const Real t = dot(disc.normal, Vec<Real>(disc.centre - ray.origin)) / along;
    const Real from = length(Vec<Real>(ray.origin + t * ray.direction - disc.centre));
    return t >= 0 && from <= disc.outer_radius && from >= disc.inner_radius;
}

/// By whether it comes nearer.
bool hits(const Ray<Real>& ray, const Plane<Real>& plane) {
    return dot(plane.normal, Vec<Real>(plane.through - ray.origin)) * dot(plane.normal, ray.direction) > 0;
}

/// By the least of its distances from the axis along the ray: each part of it is convex, and so is the whole.
bool hits(const Ray<Real>& ray, const Capsule<Real>& c) {
    const Vec<Real> v = c.end - c.start;
    const auto distance = [&](const Real& t) {
        const Vec<Real> f = ray.origin + t * ray.direction - c.start;
        const Real k = min(max(Real(dot(v, f) / dot(v, v)), Real(0)), Real(1));
        return length(Vec<Real>(f - k * v));
    };
    Real low = 0, high = (length(Vec<Real>(c.start - ray.origin)) + length(v)) / length(ray.direction);
    for (int i = 0; i < 60; ++i) {
        const Real a = (2 * low + high) / 3, b = (low + 2 * high) / 3;
        if (distance(a) < distance(b)) high = b;
        else low = a;
    }
    return distance(low) <= c.radius;
}

/// Every eighth pixel each way is plenty for a fraction of the picture. Of a mesh, whose triangles are asked one by
/// one, it is every sixteenth.
double hit_fraction(const scene::file::Scene& scene) {
    const scene::rays::CameraFrame<Real> frame = make_frame<Real>(scene);
    const std::vector<Solid<Real>> solids = scene.mesh ? scene.solids() : scene.listed;
    const int step = scene.mesh ? 16 : lostbits::test::is_long() ? 4 : 8;
    int hit = 0, seen = 0;
    for (int y = 1; y < scene.height; y += step) {
        for (int x = 1; x < scene.width; x += step) {
            const Ray<Real> r = scene::rays::ray(frame, x, y);
            ++seen;
            hit += std::ranges::any_of(solids, [&](const Solid<Real>& solid) {
                if (!solid.placed) return visit(solid, [&](const auto& shape) { return hits(r, shape); });
                const InObject<Real> in = in_object(r, *solid.placed);
                return visit(scaled(solid, in.scale), [&](const auto& shape) { return hits(in.ray, shape); });
            });
        }
    }
    return static_cast<double>(hit) / seen;
}

Real distance(const scene::file::Scene& scene) {
    const Vec<Real> to = scene.listed.at(0).sphere().centre - scene.camera.eye;
    return length(to);
}

bool has_zero_or_equal_components(const Vec<double>& v) {
    const double x = std::fabs(v.x), y = std::fabs(v.y), z = std::fabs(v.z);
    return x == 0 || y == 0 || z == 0 || x == y || y == z || x == z;
}

}  // namespace

TEST_CASE("the data folder holds the scenes that the documentation names") {
    std::set<std::string> ids;
    for (const scene::file::Scene& each : all_scenes()) ids.insert(each.id);
    for (const std::string id :
         {"rtg-fig-7-3-100", "rtg-fig-7-3-2000", "rtg-fig-7-3-4100", "rtg-fig-7-3-8000", "rtg-fig-7-3-100-oblique",
          "rtg-fig-7-3-2000-oblique", "rtg-fig-7-3-4100-oblique", "rtg-fig-7-3-8000-oblique", "rtg-fig-7-4.r1e3",
          "rtg-fig-7-4.r1e4", "rtg-fig-7-4.r1e5", "rtg-fig-7-4.r1e6", "rtg-fig-7-4.r6371000", "near-benign",
          "camera-inside", "grazing", "world-offset", "world-offset-own"}) {
        CAPTURE(id);
        CHECK(ids.count(id) == 1);
    }
}

TEST_CASE("every scene is described and shows hits and misses") {
    for (const scene::file::Scene& each : all_scenes()) {
        CAPTURE(each.id);
        CHECK_FALSE(each.title.empty());
        CHECK_FALSE(each.source.empty());
        CHECK_FALSE(each.note.empty());
        if (each.width * each.height == 1) continue;  // one ray, to be explained
        const double hit = hit_fraction(each);
        CHECK(hit >= 0.1);
        if (each.id == "camera-inside" || each.id == "sphereflake-far" || each.id == "offset-shells.inside" ||
            each.id == "consistency-on-surface" || each.id == "triangle-edge.close" ||
            each.id == "cylinder-along.inside")
            CHECK(hit == 1);  // there the ground, the solid around or under the eye, or a seam fills the picture
        else CHECK(hit <= 0.98);
    }
}

TEST_CASE("the spheres of figure 7-3 stand where they should, straight and oblique") {
    for (const int d : {100, 2000, 4100, 8000}) {
        const scene::file::Scene straight = find("rtg-fig-7-3-" + std::to_string(d));
        const scene::file::Scene oblique = find("rtg-fig-7-3-" + std::to_string(d) + "-oblique");
        CAPTURE(d);
        CHECK(distance(straight) == d);
        CHECK(abs(distance(oblique) - d) < 1e-14);
        CHECK(straight.listed[0].sphere().radius == 1);
        CHECK(hit_fraction(straight) == Approx(3.14159265 / 6.25).margin(0.01));
        CHECK(hit_fraction(oblique) == Approx(3.14159265 / 6.25).margin(0.01));
        const scene::rays::RayBlock straight_rays = make_shared_rays(straight, 100, 101);
        const scene::rays::RayBlock oblique_rays = make_shared_rays(oblique, 100, 101);
        CHECK(straight_rays[7].direction == Vec<double>(0, 0, -1));
        CHECK_FALSE(has_zero_or_equal_components(oblique_rays[7].direction));
    }
}

TEST_CASE("figure 7-4 stands on ever larger spheres, with no zero components") {
    for (const auto& [name, radius] : std::map<std::string, int>{
             {"r1e3", 1000}, {"r1e4", 10000}, {"r1e5", 100000}, {"r1e6", 1000000}, {"r6371000", 6371000}}) {
        const scene::file::Scene s = find("rtg-fig-7-4." + name);
        CAPTURE(name);
        CHECK(s.listed[0].sphere().radius == radius);
        CHECK(s.listed[0].sphere().centre.y == -radius);  // the ground's top is at y = 0
        CHECK(s.width == 320);
        CHECK(s.height == 240);
        const scene::rays::RayBlock rays = make_shared_rays(s, 0, s.height);
        std::size_t special = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) special += rays.dx[i] == 0 || rays.dy[i] == 0 || rays.dz[i] == 0;
        CHECK(special == 0);
    }
}

TEST_CASE("the camera of camera-inside is inside, off centre") {
    const scene::file::Scene s = find("camera-inside");
    CHECK(distance(s) < s.listed[0].sphere().radius);
    CHECK(distance(s) > 0.1);
}

TEST_CASE("grazing rays pass within a thousandth of the limb, half of them hitting") {
    const scene::file::Scene s = find("grazing");
    CHECK(hit_fraction(s) == Approx(0.5).margin(0.02));
    const scene::rays::RayBlock rays = make_shared_rays(s, 0, s.height);
    const Sphere<Real> sphere = s.listed[0].sphere();
    for (std::size_t i = 0; i < rays.size(); i += 97) {
        const Vec<Real> o(Real(rays.ox[i]), Real(rays.oy[i]), Real(rays.oz[i])),
            d(Real(rays.dx[i]), Real(rays.dy[i]), Real(rays.dz[i]));
        const Vec<Real> c = cross<Real>(sphere.centre - o, d);
        const Real apart = length(c) / length(d);
        REQUIRE(abs(apart - 1) < 1e-3);
    }
}

TEST_CASE("the offset worlds are near-benign, moved exactly") {
    const scene::file::Scene near = find("near-benign");
    const Vec<Real> offset(scene::test::real("100000"), scene::test::real("100000.3"), scene::test::real("-99999.7"));
    for (const std::string id : {"world-offset", "world-offset-own"}) {
        const scene::file::Scene moved = find(id);
        CAPTURE(id);
        CHECK(moved.inputs == (id == "world-offset" ? scene::file::Inputs::shared : scene::file::Inputs::own));
        const auto is_moved = [&](const Vec<Real>& a, const Vec<Real>& b) {
            const Vec<Real> d = b - a - offset;
            return length(d) < 1e-70;
        };
        CHECK(is_moved(near.camera.eye, moved.camera.eye));
        CHECK(is_moved(near.camera.look_at, moved.camera.look_at));
        REQUIRE(moved.listed.size() == near.listed.size());
        for (std::size_t i = 0; i < near.listed.size(); ++i) {
            CHECK(is_moved(near.listed[i].sphere().centre, moved.listed[i].sphere().centre));
            CHECK(moved.listed[i].sphere().radius == near.listed[i].sphere().radius);
        }
    }
}

TEST_CASE("own inputs show in world-offset-own: binary32 moves the eye by more than double does") {
    const scene::file::Scene s = find("world-offset-own");
    const scene::rays::IdealRayBlock ideal = make_own_rays(s, 0, 1);
    const auto moved = [&](const FloatFormat& f) {
        return abs(Real(scene::rays::round_rays(ideal, f).ox[0]) - ideal.ox[0]);
    };
    CHECK(moved(binary32) > 1e-4);
    CHECK(moved(binary64) < 1e-11);
    CHECK(moved(binary64) > 0);
}

}  // namespace test_data
