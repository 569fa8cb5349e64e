#include "scene/rays/camera.hpp"

#include <cmath>

#include "catch.hpp"
#include "number/real.hpp"
#include "scene/scene_text.hpp"

namespace test_camera {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::file;
using namespace lostbits::scene::rays;
using namespace lostbits::scene::test;

namespace {

const std::string oblique_pinhole = R"(schema = "lostbits-scene/1"
title = "A test"
source = "-"
size = [16, 12]
[camera]
kind = "pinhole"
eye = [0.3, -1.7, 2.9]
look_at = [1.1, 0.2, -0.4]
up = [0.2, 1, 0.1]
fov_deg = 50
shift = [0.25, -0.125]
[[sphere]]
centre = [0, 0, 0]
radius = 1
)";

template <class T>
bool equal(const Vec<T>& a, double x, double y, double z) {
    return a.x == T(x) && a.y == T(y) && a.z == T(z);
}

/// ±1 and +0 only: not even a negative zero.
bool is_clean_axis(const Vec<double>& v) {
    for (const double c : {v.x, v.y, v.z})
        if (!(c == 1 || c == -1 || (c == 0 && !std::signbit(c)))) return false;
    return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z) == 1;
}

}  // namespace

TEST_CASE("an axis-aligned orthographic camera is exact") {
    const Scene s = load_text(good_scene);  // 8 × 4 pixels, 2.5 wide
    const CameraFrame<double> frame = make_frame<double>(s);
    CHECK(equal(frame.forward, 0, 0, -1));
    CHECK(equal(frame.right, 1, 0, 0));
    CHECK(equal(frame.up, 0, 1, 0));
    CHECK(frame.pitch == 0.3125);
    const Ray<double> top_left = ray(frame, 0, 0);
    CHECK(equal(top_left.origin, -3.5 * 0.3125, 1.5 * 0.3125, 0));
    CHECK(equal(top_left.direction, 0, 0, -1));
    const Ray<double> bottom_right = ray(frame, 7, 3);
    CHECK(equal(bottom_right.origin, 3.5 * 0.3125, -1.5 * 0.3125, 0));
    const Ray<Real> ideal = ray(make_frame<Real>(s), 0, 0);
    CHECK(equal(ideal.origin, -3.5 * 0.3125, 1.5 * 0.3125, 0));
    CHECK(equal(ideal.direction, 0, 0, -1));
}

TEST_CASE("views along all six axes give exact frames without negative zeros") {
    const char* axes[] = {"[1, 0, 0]", "[-1, 0, 0]", "[0, 1, 0]", "[0, -1, 0]", "[0, 0, 1]", "[0, 0, -1]"};
    for (int view = 0; view < 6; ++view) {
        for (int up = 0; up < 6; ++up) {
            if (view / 2 == up / 2) continue;
            const std::string text =
                replace_text(replace_text(good_scene, "look_at = [0, 0, -1]", std::string("look_at = ") + axes[view]),
                             "up = [0, 1, 0]", std::string("up = ") + axes[up]);
            const CameraFrame<double> frame = make_frame<double>(load_text(text));
            CAPTURE(axes[view], axes[up]);
            CHECK(is_clean_axis(frame.forward));
            CHECK(is_clean_axis(frame.right));
            CHECK(is_clean_axis(frame.up));
            const Vec<double> back = cross(frame.up, frame.right);  // right-handed: right × up = −forward
            CHECK(equal(back, frame.forward.x, frame.forward.y, frame.forward.z));
        }
    }
}

TEST_CASE("double and ideal rays agree to 1e-15") {
    for (const std::string normalise : {"true", "false"}) {
        const Scene s =
            load_text(replace_text(oblique_pinhole, "fov_deg = 50", "fov_deg = 50\nnormalise = " + normalise));
        const auto rough = make_frame<double>(s);
        const auto ideal = make_frame<Real>(s);
        for (int y = 0; y < s.height; ++y) {
            for (int x = 0; x < s.width; ++x) {
                const Ray<double> a = ray(rough, x, y);
                const Ray<Real> b = ray(ideal, x, y);
                for (int i = 0; i < 3; ++i) {
                    REQUIRE(abs(Real(a.origin[i]) - b.origin[i]) <= 1e-15);
                    REQUIRE(abs(Real(a.direction[i]) - b.direction[i]) <= 1e-15);
                }
            }
        }
    }
}

TEST_CASE("directions of a pinhole camera have unit length only if they are normalised") {
    const Scene unit = load_text(oblique_pinhole);
    const Scene raw = load_text(replace_text(oblique_pinhole, "fov_deg = 50", "fov_deg = 50\nnormalise = false"));
    const Ray<double> a = ray(make_frame<double>(unit), 1, 1);
    const Ray<double> b = ray(make_frame<double>(raw), 1, 1);
    CHECK(std::fabs(length(a.direction) - 1) < 1e-15);
    CHECK(length(b.direction) > 1.03);
    CHECK(length(cross(a.direction, b.direction)) < 1e-15);
    CHECK(dot(b.direction, make_frame<double>(raw).forward) == Approx(1).epsilon(1e-14));  // on the plane at distance 1
}

TEST_CASE("the vertical field of view runs from the top edge to the bottom edge") {
    // One pixel high: the middle of the rows ±1/2 is a corner ray, seen by asking for rows beyond the picture.
    const std::string text = replace_text(replace_text(good_scene, "kind = \"orthographic\"", "kind = \"pinhole\""),
                                          "width = 2.5", "fov_deg = 90");
    const CameraFrame<double> frame = make_frame<double>(load_text(text));  // 4 rows: edges at ±2 pixels
    CHECK(frame.pitch == 0.5);                                              // 2 tan 45° / 4, correctly rounded
    const Ray<double> inner = ray(frame, 4, 0);
    CHECK(inner.direction.y / -inner.direction.z == Approx(0.75).epsilon(1e-15));
    CHECK(inner.direction.x / -inner.direction.z == Approx(0.25).epsilon(1e-15));  // pixels are square
    CHECK(equal(inner.origin, 0, 0, 0));
}

TEST_CASE("a shift moves the window right and up, in picture widths, and does not turn it") {
    const std::string shifted = replace_text(good_scene, "width = 2.5", "width = 2.5\nshift = [0.5, 0.25]");
    const Ray<double> before = ray(make_frame<double>(load_text(good_scene)), 3, 2);
    const Ray<double> after = ray(make_frame<double>(load_text(shifted)), 3, 2);
    CHECK(after.origin.x == before.origin.x + 1.25);
    CHECK(after.origin.y == before.origin.y + 0.625);
    CHECK(after.origin.z == before.origin.z);
    CHECK(equal(after.direction, 0, 0, -1));
}

}  // namespace test_camera
