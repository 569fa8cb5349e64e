// Ray distributions in exact arithmetic: position of the eye, distance of the centre, and gap of the line.
#include "shapes/sphere/distribution/distribution.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "catch.hpp"
#include "number/real.hpp"
#include "scene/scene_text.hpp"
#include "scene/sweep/distributions.hpp"

namespace test_distribution {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::rays;
using lostbits::scene::sphere::SphereDistribution;
using namespace lostbits::scene::toml;
using namespace lostbits::scene::test;

namespace {

Vec<Real> lifted(const Vec<double>& v) { return {Real(v.x), Real(v.y), Real(v.z)}; }

/// A ray against its sphere, in 256 bits; all lengths in radii.
struct Geometry {
    Geometry(const RayGroup& group, std::size_t i) {
        const Ray<double> ray = group.rays[i];
        const Sphere<double> sphere = group.primitives.front().sphere();
        const Vec<Real> f = lifted(ray.origin) - lifted(sphere.centre), d = lifted(ray.direction),
                        c = cross<Real>(f, d);
        const Real r(sphere.radius), size = length(d);
        eye = static_cast<double>(Real(length(f) / r));
        impact = static_cast<double>(Real(length(c) / (size * r)));
        along = static_cast<double>(Real(dot(f, d) / (size * r)));
    }
    double eye;     ///< from eye to centre
    double impact;  ///< from line to centre
    double along;   ///< negative where the ray goes toward the centre
};

scene::sphere::SphereDistribution distribution_of(const std::string& text) {
    const Scratch folder;
    const Node root = read_toml(folder.write("f.toml", text));
    return SphereDistribution::read(TableReader(root));
}
std::string distribution_error(const std::string& text) {
    const Scratch folder;
    const fs::path file = folder.write("f.toml", text);
    return error_in(folder, [&] {
        const Node root = read_toml(file);
        SphereDistribution::read(TableReader(root));
    });
}

}  // namespace

TEST_CASE("tilted views differ from an axis by the given angle and stay centred") {
    for (const double tilt : {0.0, 0x1p-24, 0x1p-7, 0.3, 1.0}) {
        for (const double distance : {4.0, 1000.0, 777.7}) {
            scene::sphere::SphereDistribution f =
                distribution_of("directions = \"tilted\"\nimpact_to = 0.99\nviews = 64\nrays = 1\n");
            f.tilt = tilt;
            f.distance = distance;
            const auto groups = f.draw();
            REQUIRE(groups.size() == 64);
            std::set<double> distances;
            for (const RayGroup& group : groups) {
                const Vec<double> c = group.primitives.front().sphere().centre, d = group.rays[0].direction;
                CAPTURE(tilt, distance, d.x, d.y, d.z);
                const double far = static_cast<double>(length(lifted(c)));
                distances.insert(far);
                CHECK(std::fabs(far / distance - 1) <= 0x1p-6 + 0x1p-12);
                double parts[] = {std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)};
                std::ranges::sort(parts);
                CHECK(parts[2] > 0);
                CHECK(std::hypot(parts[0], parts[1]) == Approx(tilt * parts[2]).epsilon(0x1p-11).margin(0));
                // Exactly along the centre's direction: every product of 12-bit numbers is a float.
                CHECK((c.x * d.y == c.y * d.x && c.y * d.z == c.z * d.y && c.x * d.z == c.z * d.x));
                const Geometry at(group, 0);
                CHECK(at.impact < 0.9901);
                CHECK(at.along < -0.98 * distance + 1);
            }
            CHECK(distances.size() > 16);  // otherwise all views would share the rounding of c
        }
    }
}

TEST_CASE("a silhouette gap g puts every line at 1 - g radii, computed from both projections") {
    for (const char* projection : {"parallel", "point"}) {
        for (const double gap : {0.5, 0x1p-5, 0x1p-10}) {
            for (const double radius : {1.0, 48.0}) {
                scene::sphere::SphereDistribution f =
                    distribution_of("projection = \"" + std::string(projection) +
                                    "\"\nimpact_from = 0.25\nweighting = \"silhouette\"\nviews = 4\nrays = 16\n");
                f.silhouette_gap = gap;
                f.radius = radius;
                f.distance = 16;
                f.height = 3 * radius;
                for (const RayGroup& group : f.draw()) {
                    for (std::size_t i = 0; i < group.rays.size(); ++i) {
                        const Geometry at(group, i);
                        CAPTURE(projection, gap, radius, i);
                        CHECK(std::fabs(at.impact - (1 - gap)) < 0x1p-20);  // every number is rounded to a float
                        CHECK(at.eye > 1);
                        CHECK(at.along < 0);
                    }
                }
            }
        }
    }
    // Without a gap the impacts are spread.
    double least = 1, most = 0;
    for (const RayGroup& group : distribution_of("impact_to = 0.99").draw()) {
        for (std::size_t i = 0; i < group.rays.size(); ++i) {
            least = std::min(least, Geometry(group, i).impact);
            most = std::max(most, Geometry(group, i).impact);
        }
    }
    CHECK(least < 0.2);
    CHECK(most > 0.95);
}

TEST_CASE("rays pointing away leave the centre behind, the others are the same rays reversed") {
    for (const double height : {1.0, 0.0, -0x1p-6, -0.5}) {
        scene::sphere::SphereDistribution f =
            distribution_of("projection = \"point\"\nimpact_to = 0.5\nradius = 1\nviews = 6\nrays = 16\n");
        f.height = height;
        const auto toward = f.draw();
        f.away = true;
        const auto away = f.draw();
        REQUIRE(away.size() == toward.size());
        for (std::size_t v = 0; v < away.size(); ++v) {
            CHECK(away[v].primitives.front().numbers == toward[v].primitives.front().numbers);
            for (std::size_t i = 0; i < away[v].rays.size(); ++i) {
                const Geometry a(away[v], i), b(toward[v], i);
                CAPTURE(height, v, i);
                CHECK(away[v].rays[i].origin == toward[v].rays[i].origin);
                CHECK(std::fabs(a.eye - (1 + height)) < 0x1p-10);  // the radius has 12 bits
                CHECK((a.eye < 1) == (height < 0));
                CHECK(a.along > 0);
                CHECK(b.along < 0);
                CHECK(a.impact == Approx(b.impact).margin(1e-6));
                CHECK(a.impact < 0.51);
            }
        }
    }
}

TEST_CASE("wrong keys of a ray distribution are refused with their line") {
    CHECK(distribution_error("tilt = 0.5\nsilhouette_gap = 1\naway = true\ndirections = \"tilted\"") == "no error");
    CHECK(distribution_error("radius = 1\ntilt = 1.5").starts_with("f.toml:2:8: tilt must lie between 0"));
    CHECK(distribution_error("tilt = -0.5").starts_with("f.toml:1:8: tilt must lie between"));
    CHECK(distribution_error("silhouette_gap = 1.25").starts_with("f.toml:1:18: silhouette_gap must lie between"));
    CHECK(distribution_error("silhouette_gap = -1").starts_with("f.toml:1:18: silhouette_gap must lie between"));
}

TEST_CASE("rays of every shape may begin on the surface of another primitive") {
    const Scratch folder;
    std::size_t shapes = 0;
    for (const sweep::DistributionRow& row : sweep::distributions()) {
        INFO(row.table);
        const Node root = read_toml(folder.write("f.toml", "begin = \"other\"\ndistance = 8\nviews = 16\nrays = 4\n"));
        std::size_t rays = 0;
        for (const RayGroup& group : row.read(TableReader(root))(0)) {
            REQUIRE(group.primitives.size() == 2);
            for (std::size_t i = 0; i < group.rays.size(); ++i, ++rays) {
                const Vec<double> o = group.rays[i].origin, d = group.rays[i].direction;
                CHECK(std::fabs(visit(group.primitives[1], [&o](const auto& shape) { return shape.distance(o); })) <
                      1e-5);
                // It passes a point of the first primitive, whose size is about 1.
                const Vec<double> from = o - ball_around(group.primitives[0]).centre;
                CHECK(length(cross(from, d)) < 4 * length(d));
                CHECK(dot(from, d) < 0);
            }
        }
        CHECK(rays == 64);
        ++shapes;
    }
    CHECK(shapes == 11);
}

TEST_CASE("rays that begin on another box are aimed at its features, and those of spheres keep their impact") {
    const Scratch folder;
    const auto drawn = [&](Shape shape, std::string_view keys) {
        const Node root =
            read_toml(folder.write("f.toml", "begin = \"other\"\nviews = 16\nrays = 4\n" + std::string(keys)));
        return std::ranges::find(sweep::distributions(), shape, &sweep::DistributionRow::shape)
            ->read(TableReader(root))(0);
    };
    for (const RayGroup& group : drawn(Shape::sphere, "silhouette_gap = 0.25\n"))
        for (std::size_t i = 0; i < group.rays.size(); ++i) {
            const Sphere<double> sphere = group.primitives[0].sphere();
            const Vec<double> from = group.rays[i].origin - sphere.centre, d = group.rays[i].direction;
            CHECK(length(cross(from, d)) / length(d) == Approx(0.75 * sphere.radius).epsilon(1e-5));
        }
    for (const RayGroup& group : drawn(Shape::box, "aim = \"corner\"\nadjoining = true\n")) {
        REQUIRE(group.primitives.size() == 9);
        const Vec<double> corner = group.primitives[0].box().hi;  // shared by all eight
        for (std::size_t i = 0; i < group.rays.size(); ++i) {
            const Vec<double> from = group.rays[i].origin - corner, d = group.rays[i].direction;
            CHECK(length(cross(from, d)) / length(d) < 1e-5);
        }
    }
    CHECK(distribution_error("begin = \"other\"\nprojection = \"point\"")
              .starts_with("f.toml:1:9: begin is \"other\", but"));
}

}  // namespace test_distribution
