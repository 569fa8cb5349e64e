// Errors of rays that can be worked out by hand.
#include <cmath>

#include "catch.hpp"
#include "measure/metric/metrics.hpp"
#include "number/format.hpp"
#include "number/real.hpp"

namespace test_errors_of_rays {

using namespace lostbits;
using namespace lostbits::measure::metric;

namespace {

const auto value_of = [](const char* name) { return find_metric(name)->value; };
const auto origin_error = value_of("origin_error"), origin_lost_bits = value_of("origin_lost_bits"),
           direction_error = value_of("direction_error"), direction_lost_bits = value_of("direction_lost_bits"),
           pixel_error = value_of("pixel_error");

Vec<Real> real(double x, double y, double z) { return {Real(x), Real(y), Real(z)}; }

/// A ray and the true ray, in float.
struct Pair {
    Ray<double> given;
    Ray<Real> truth;
    scene::rays::CameraFrame<Real> frame{};
    Format format = *find_format("f32");

    [[nodiscard]] double of(double (*metric)(const Sample&)) const {
        return metric(Sample{.format = &format, .ray = &given, .true_ray = &truth, .frame = &frame});
    }
};

}  // namespace

TEST_CASE("the error of the origin is a length, and its lost bits are in ulps of its largest component") {
    Pair p{{{1024 + 0x1p-10, 3, 0}, {0, 0, 1}}, {real(1024, 3, 0), real(0, 0, 1)}};
    CHECK(p.of(origin_error) == 0x1p-10);
    CHECK(p.of(origin_lost_bits) == 4);  // 2^-10 are 8 ulps of 2^-13
    p.given.origin = {1024, 3 + 0x1p-10, 0};
    CHECK(p.of(origin_lost_bits) == 4);
    p.given.origin = {1024, 3, 0};
    CHECK(p.of(origin_error) == 0);
    CHECK(p.of(origin_lost_bits) == 0);
    p.given.origin = {NAN, 3, 0};
    CHECK(p.of(origin_error) == HUGE_VAL);
    CHECK(p.of(origin_lost_bits) == 24);
    p.truth.origin = real(0, 0, 0);
    p.given.origin = {0, 0, 0};
    CHECK(p.of(origin_lost_bits) == 0);
}

TEST_CASE("the error of the direction is an angle that does not depend on its length") {
    Pair p{{{0, 0, 0}, {0, 0x1p-30, 2}}, {real(0, 0, 0), real(0, 0, 5)}};
    CHECK(p.of(direction_error) == Approx(0x1p-31).epsilon(1e-12));
    p.given.direction = {0, 0, 7};
    CHECK(p.of(direction_error) == 0);
    CHECK(p.of(direction_lost_bits) == 0);
    p.given.direction = {0, 0x1p-20, 1};  // 2^-20 are 8 ulps of 1
    CHECK(p.of(direction_lost_bits) == Approx(4).epsilon(1e-9));
    p.given.direction = {0, 0, -1};
    CHECK(p.of(direction_error) == Approx(3.141592653589793));
    for (const Vec<double>& none : {Vec<double>(0, 0, 0), Vec<double>(0, NAN, 1), Vec<double>(0, HUGE_VAL, 1)}) {
        p.given.direction = none;
        CHECK(p.of(direction_error) == HUGE_VAL);
        CHECK(p.of(direction_lost_bits) == 24);
        CHECK(p.of(pixel_error) == HUGE_VAL);
    }
}

TEST_CASE("pixel errors are measured in the plane in front of the camera") {
    Pair p{{{0, 0, 0}, {0.3, 0.4, -2}}, {real(0, 0, 0), real(0.3, 0.3, -1)}};
    p.frame.forward = real(0, 0, -1);
    p.frame.pitch = Real(0.125);
    CHECK(p.of(pixel_error) == Approx(std::hypot(0.15 - 0.3, 0.2 - 0.3) / 0.125).epsilon(1e-12));
    p.given.direction = {0.3, 0.4, 2};
    CHECK(p.of(pixel_error) == HUGE_VAL);
}

TEST_CASE("errors of rays are undefined without the true ray, and pixel errors without a camera") {
    const Format format = *find_format("f32");
    const Ray<double> ray{{0, 0, 0}, {0, 0, 1}};
    const Sample sample{.format = &format, .ray = &ray};
    for (const auto metric : {origin_error, origin_lost_bits, direction_error, direction_lost_bits, pixel_error})
        CHECK(std::isnan(metric(sample)));
}

}  // namespace test_errors_of_rays
