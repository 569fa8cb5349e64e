// The shading formulas by hand.
#include <cmath>
#include <limits>

#include "catch.hpp"
#include "measure/render/blockers.hpp"
#include "measure/render/render.hpp"
#include "measure/render/shade.hpp"
#include "measure/rows.hpp"

namespace test_shade {

using namespace lostbits;
using namespace lostbits::measure::render;

namespace {

template <class T>
Vec<T> vec(double x, double y, double z) {
    return Vec<T>(T(x), T(y), T(z));
}

const ShadeRule everything{.has_diffuse = true, .has_shadows = true, .has_phong = true, .keeps_half_diffuse = false};

Paint<double> is_shiny() { return {vec<double>(0.5, 0.25, 1), 0.25, 0.5, 0.75, 3, true}; }

}  // namespace

TEST_CASE("shade agrees with values worked out by hand, for light along the normal and at 60 degrees") {
    const auto n = vec<double>(0, 0, 1);
    // N·L = 1, H = (0, 0, 1): ka S + kd S + ks = 0.75 S + 0.75.
    CHECK(shade<double>(is_shiny(), everything, false, {n, n, n}) == vec<double>(1.125, 0.9375, 1.5));
    CHECK(shade<double>(is_shiny(), everything, true, {n, n, n}) == vec<double>(0.125, 0.0625, 0.25));  // ka S alone
    ShadeRule half = everything;
    half.keeps_half_diffuse = true;
    CHECK(shade<double>(is_shiny(), half, true, {n, n, n}) == vec<double>(0.25, 0.125, 0.5));  // ka S + ½ kd S
    CHECK(shade<double>(is_shiny(), half, false, {n, n, n}) == vec<double>(1.125, 0.9375, 1.5));
    ShadeRule diffuse{.has_diffuse = true};
    CHECK(shade<double>(is_shiny(), diffuse, true, {n, n, n}) == vec<double>(0.375, 0.1875, 0.75));
    CHECK(shade<double>(is_shiny(), ShadeRule{}, true, {n, n, n}) == is_shiny().colour);
    // N·L = ½ and L = V: H = L, (H·N)³ = ⅛.
    const auto l = vec<double>(std::sqrt(0.75), 0, 0.5);
    const Vec<double> c = shade<double>(is_shiny(), everything, false, {n, l, l});
    CHECK(c.x == Approx(0.5 * (0.25 + 0.25) + 0.75 / 8).epsilon(1e-15));
    // From behind there is no light, and none is subtracted.
    CHECK(shade<double>(is_shiny(), everything, false, {n, -n, n}) == vec<double>(0.125, 0.0625, 0.25));
    Paint<double> matte = is_shiny();
    matte.is_shiny = false;
    CHECK(shade<double>(matte, everything, false, {n, n, n}) == vec<double>(0.375, 0.1875, 0.75));
    // A NaN is not treated as darkness.
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(std::isnan(shade<double>(is_shiny(), everything, false, {vec<double>(nan, 0, 1), n, n}).x));
}

TEST_CASE("integer powers are exact where the results are representable") {
    for (int n = 1; n <= 33; ++n) {
        double power = 1;
        for (int i = 0; i < n; ++i) power *= 3;  // 3^33 < 2^53
        CHECK(whole_power<double>(3, n) == power);
    }
    CHECK(whole_power<double>(0.5, 1000) == 0x1p-1000);
}

TEST_CASE("a shadow ray starts at the point, an epsilon off, or some ulps of the largest coordinate off") {
    using ShadowOffset = scene::file::ShadowRule::ShadowOffset;
    const auto p = vec<float>(3, -4, 0.5), n = vec<float>(1, 0, 0);
    CHECK(shadow_origin<float>(p, n, ShadowOffset::none, 1, 5) == p);
    CHECK(shadow_origin<float>(p, n, ShadowOffset::epsilon, 0.25F, 5) == vec<float>(3.25, -4, 0.5));
    CHECK(shadow_origin<float>(p, n, ShadowOffset::ulp, 1, 2) == vec<float>(3 + 0x1p-20, -4, 0.5));  // ulp(4) = 2^-21
}

TEST_CASE("a byte of an image is 255 times the channel, rounded half up and clamped") {
    CHECK(byte_of(0) == 0);
    CHECK(byte_of(1) == 255);
    CHECK(byte_of(0.5) == 128);  // 127.5
    CHECK(byte_of(std::nextafter(0.5, 0)) == 127);
    CHECK(byte_of(-1) == 0);
    CHECK(byte_of(1e300) == 255);
    CHECK(byte_of(HUGE_VAL) == 255);
    CHECK(byte_of(std::nan("")) == 0);
}

TEST_CASE("a primitive blocks light only between point and light, the point's own sphere if it counts") {
    const std::vector<Primitive<double>> primitives{Sphere<double>{{0, 0, 0}, 1}, Sphere<double>{{5, 0, 0}, 1}};
    ShadowRays rays;
    const auto ray = [&rays](Vec<double> from, Vec<double> to, std::int32_t own) { rays.add(from, to - from, 1, own); };
    ray({1, 0, 0}, {10, 0, 0}, 0);   // through the second
    ray({1, 0, 0}, {3, 0, 0}, 0);    // the light before it
    ray({1, 0, 0}, {-10, 0, 0}, 0);  // away from it, through its own
    ray({6, 0, 0}, {-10, 0, 0}, 1);  // through its own and the first
    ray({6, 0, 0}, {3, 0, 0}, 1);    // through its own
    ray({0, 9, 0}, {5, 9, 0}, -1);   // past all
    ray({5.5, 0, 0}, {3, 0, 0}, 1);  // from below its own surface
    for (const intersect::table::Intersector& form : intersect::table::intersectors(Shape::sphere)) {
        if (form.info->direction == intersect::Direction::unit) continue;
        for (const char* name : {"f32", "f64", "bf16"}) {
            const Format format = *find_format(name);
            if (!form.exists_in(format)) continue;
            CAPTURE(form.info->name, name);
            const measure::truth::FormatInputs among{.format = format, .primitives = primitives};
            const auto skipped = find_blockers(form, format, rays, among, false);
            CHECK(skipped == std::vector<std::uint8_t>{blocked_by_other, 0, 0, blocked_by_other, 0, 0, 0});
            const auto held = find_blockers(form, format, rays, among, true);
            CHECK((held[0] & blocked_by_other) != 0);
            CHECK((held[3] & blocked_by_other) != 0);
            CHECK(held[5] == 0);
        }
    }
    // From below the surface the far root lies ahead; the form that knows the near one only sees nothing. Exactly on it
    // the first root is 0 and no obstacle.
    const measure::truth::FormatInputs in_f64{.format = *find_format("f64"), .primitives = primitives};
    const auto unified = find_blockers(test::form_named("sphere.unified"), in_f64.format, rays, in_f64, true);
    const auto expanded = find_blockers(test::form_named("sphere.expanded"), in_f64.format, rays, in_f64, true);
    CHECK(unified[6] == blocked_by_departed_sphere);
    CHECK(expanded[6] == blocked_by_nothing);
    CHECK(unified[4] == blocked_by_nothing);
}

}  // namespace test_shade
