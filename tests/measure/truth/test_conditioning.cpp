// κ compared with values worked out by hand, and gradients with central differences.
#include <cmath>

#include "catch.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/seeded.hpp"
#include "measure/truth/conditioning.hpp"
#include "measure/truth/lost_bits.hpp"
#include "measure/truth/reach_of_t.hpp"
#include "measure/truth/truth.hpp"
#include "number/dual.hpp"
#include "number/real.hpp"
#include "scene/sweep/distributions.hpp"

namespace test_conditioning {

using namespace lostbits;
using measure::truth::as_certified;
using test::reach_of_t;

namespace {

using Wide = BasicReal<1024>;

/// Number i of a ray and its primitive.
double& number_of(Ray<double>& ray, Primitive<double>& primitive, std::size_t i) {
    if (i >= 6) return primitive.numbers[i - 6];
    return i < 3 ? ray.origin[static_cast<int>(i)] : ray.direction[static_cast<int>(i) - 3];
}

/// Central differences of t, which is known to 2^-72, for steps of 2^-40; empty if one of the changed problems misses
/// the primitive.
std::vector<double> by_differences(const Ray<double>& ray, const Primitive<double>& primitive) {
    std::vector<double> slopes;
    for (std::size_t i = 0; i < 6 + primitive.shape_numbers().size(); ++i) {
        measure::truth::Truth aside[2];
        double at[2];
        for (const int side : {0, 1}) {
            Ray<double> r = ray;
            Primitive<double> s = primitive;
            double& x = number_of(r, s, i);
            x += (side == 0 ? -0x1p-40 : 0x1p-40) * std::max(std::fabs(x), 0x1p-6);
            at[side] = x, aside[side] = measure::truth::find_truth(r, s);
            if (!aside[side].is_hit()) return {};
        }
        slopes.push_back(measure::truth::scaled_difference(aside[1].t, aside[0].t, 0) / (at[1] - at[0]));
    }
    return slopes;
}

}  // namespace

TEST_CASE("the condition number grows as one over the cosine towards a tangent, and is infinite on it") {
    // x = sin: the ray's offset; ∂t/∂x = x/√(1 − x²), and the other inputs add their own.
    for (int k = 2; k <= 50; k += 4) {
        const double x = 1 - std::ldexp(1, -k);
        const Ray<double> ray{{x, 0, 4}, {0, 0, -1}};
        const Sphere<double> sphere{{0, 0, 0}, 1};
        // t = 4 − w, w² = (1 − x)(1 + x), which is exact enough in double. Σ|xᵢ∂t| = x²/w + 4 + t + 1/w.
        const double w = std::sqrt((1 - x) * (1 + x)), t = 4 - w;
        CHECK(measure::truth::condition(ray, sphere) == Approx((x * x / w + 4 + t + 1 / w) / t).epsilon(1e-5));
    }
    CHECK(std::isinf(measure::truth::condition(Ray<double>{{1, 0, 4}, {0, 0, -1}}, Sphere<double>{{0, 0, 0}, 1})));
}

TEST_CASE("the condition number is infinite on the surface and undefined for a miss") {
    CHECK(std::isinf(measure::truth::condition(Ray<double>{{0, 0, 1}, {0, 0, -1}}, Sphere<double>{{0, 0, 0}, 1})));
    CHECK(std::isnan(measure::truth::condition(Ray<double>{{2, 0, 4}, {0, 0, -1}}, Sphere<double>{{0, 0, 0}, 1})));
}

TEST_CASE("the gradient of every shape agrees with central differences, and gives the condition number") {
    for (const auto& distribution : scene::sweep::distributions()) {
        INFO(distribution.table);
        int ray_count = 0, compared = 0;
        for (const auto& group : distribution.ray_sets().front().groups()) {
            if (ray_count == 400) break;
            Ray<double> ray = group.rays[0];
            Primitive<double> primitive = group.primitives.front();
            const measure::truth::Truth truth = measure::truth::find_truth(ray, primitive);
            const auto gradient = measure::truth::gradient(ray, primitive);
            if (gradient.empty()) continue;
            ++ray_count;
            const auto slopes = by_differences(ray, primitive);
            const double kappa = measure::truth::condition(ray, primitive);
            if (slopes.empty() || kappa > 0x1p14) continue;
            ++compared;
            double sum = 0, largest = 0;
            for (const double slope : gradient) largest = std::max(largest, std::fabs(slope));
            for (std::size_t i = 0; i < gradient.size(); ++i) {
                CHECK(std::fabs(gradient[i] - slopes[i]) <= 1e-5 * largest);
                sum += std::fabs(number_of(ray, primitive, i) * gradient[i]);
            }
            CHECK(kappa == Approx(sum / measure::truth::scaled_difference(truth.t, {}, 0)).epsilon(1e-5));
        }
        CHECK(compared > 150);  // a radius of 0 has no other below it
    }
}

TEST_CASE("Real inputs have the condition number of the same doubles") {
    const Ray<double> ray{{1.25, -2.5, 6}, {-0.25, 0.5, -1.5}};
    const Sphere<double> sphere{{0.5, -0.75, 1}, 1.5};
    const auto real = [](const Vec<double>& v) { return Vec<Real>(Real(v.x), Real(v.y), Real(v.z)); };
    CHECK(measure::truth::condition(Ray<Real>{real(ray.origin), real(ray.direction)},
                                    Sphere<Real>{real(sphere.centre), Real(sphere.radius)}) ==
          Approx(measure::truth::condition(ray, sphere)).epsilon(1e-5));
}

TEST_CASE("t = 0 can move as far as the surface can move from the origin, and not at all from inside", "[reach]") {
    const Sphere<double> sphere{{0, 0, 0}, 1};
    const double half_ulp = 0x1p-24;
    // c = z² − 1 moves by 2 z² + 2 half ulps, along a ray by that over 2|h| = 2.
    CHECK(reach_of_t(Ray<double>{{0, 0, 1}, {0, 0, -1}}, sphere, as_certified(0), binary32) == Approx(2 * half_ulp));
    CHECK(reach_of_t(Ray<double>{{0, 0, 0.5}, {0, 0, -1}}, sphere, as_certified(0), binary32) == 0);
    const Box<double> box{{-1, -1, -1}, {1, 1, 1}};
    CHECK(reach_of_t(Ray<double>{{0, 0, 1}, {0, 0, -0.5}}, box, as_certified(0), binary32) == Approx(4 * half_ulp));
    CHECK(reach_of_t(Ray<double>{{0, 0, 0.5}, {0, 0, -1}}, box, as_certified(0), binary32) == 0);
    // Beyond what a double's square holds.
    const double far = 0x1p600;
    CHECK(reach_of_t(Ray<double>{{far, 0, 4 * far}, {0, 0, -1}}, Sphere<double>{{0, 0, 0}, far}, as_certified(4 * far),
                     binary32) < far / 64);
}

TEST_CASE("inherent bits near a tangent are fewer than the condition number says") {
    using measure::truth::inherent_bits;
    const Sphere<double> sphere{{0, 0, 0}, 1};
    const auto bits_at = [&](double x, double t) {
        const Ray<double> ray{{x, 0, 4}, {0, 0, -1}};
        const double reach =
            measure::truth::reach(ray, sphere, as_certified(t), measure::truth::Length::parameter, binary32);
        return inherent_bits(reach, as_certified(t), binary32);
    };
    const auto by_condition = [&](double x) {
        const double kappa = measure::truth::condition(Ray<double>{{x, 0, 4}, {0, 0, -1}}, sphere);
        return measure::truth::lost_bits(kappa / 2, 24);
    };
    // On it κ is infinite: all 24. x² − r² moves by 2^-22, t by the root of that, which is 2^10 ulp(4).
    CHECK(by_condition(1) == 24);
    CHECK(bits_at(1, 4) == Approx(11).margin(0.1));
    // w = √(1 − x²) is 2^-19.5; first order says 2^-23/w. x² − r² moves by 3·2^-24, as x has a smaller ulp here, and no
    // error can move t further than the root of that, 2^10.8 ulp.
    const double beside = 1 - 0x1p-40, w = std::sqrt(0x1p-40 * (1 + beside));
    CHECK(by_condition(beside) > 18);
    CHECK(bits_at(beside, 4 - w) == Approx(11.8).margin(0.1));
    // Well beside it the first order is right.
    const double well = 1 - 0x1p-6, far = std::sqrt(0x1p-6 * (1 + well));
    CHECK(bits_at(well, 4 - far) == Approx(by_condition(well)).margin(1.01));
}

TEST_CASE("an error within the reach of t is excused") {
    using measure::truth::excess_bits;
    // A tangent at t = 8, which moves by 2^-11 of itself for half an ulp: 8.002 is due to the inputs, 0 loses all bits
    // beyond the 13.
    CHECK(excess_bits(8.002, as_certified(8), binary32, 0x1p-11) == 0);
    CHECK(excess_bits(0, as_certified(8), binary32, 0x1p-11) == 24 - 13);
    // t = 6 with the origin on the surface, where 0 is right; 1e-7 is due to the inputs.
    CHECK(excess_bits(6, as_certified(0), binary32, 0x1p-23) == 24);
    CHECK(excess_bits(1e-7, as_certified(0), binary32, 0x1p-23) == 0);
    CHECK(excess_bits(6, as_certified(0), binary64, 0) == 53);
    CHECK(excess_bits(0, as_certified(0), binary64, 0) == 0);
    CHECK(excess_bits(HUGE_VAL, as_certified(8), binary32, 0x1p-11) == 24 - 13);
    CHECK(excess_bits(HUGE_VAL, as_certified(8), binary32, HUGE_VAL) == 24);
}

TEST_CASE("every operation of Dual differentiates as a central difference does") {
    using D = Dual<Wide, 3>;
    test::Seeded random(99);
    const auto draw = [&] { return Wide((0.2 + random.unit()) * (random.index(2) == 0 ? 1 : -1)); };
    struct Operation {
        const char* name;
        D (*dual)(const D&, const D&, const D&);
        Wide (*plain)(const Wide&, const Wide&, const Wide&);
    };
    const Operation operations[] = {
        {"+", [](const D& a, const D& b, const D&) { return a + b; },
         [](const Wide& a, const Wide& b, const Wide&) { return Wide(a + b); }},
        {"-", [](const D& a, const D& b, const D&) { return a - b; },
         [](const Wide& a, const Wide& b, const Wide&) { return Wide(a - b); }},
        {"*", [](const D& a, const D& b, const D&) { return a * b; },
         [](const Wide& a, const Wide& b, const Wide&) { return Wide(a * b); }},
        {"/", [](const D& a, const D& b, const D&) { return a / b; },
         [](const Wide& a, const Wide& b, const Wide&) { return Wide(a / b); }},
        {"neg", [](const D& a, const D&, const D&) { return -a; },
         [](const Wide& a, const Wide&, const Wide&) { return Wide(-a); }},
        {"sqrt", [](const D& a, const D&, const D&) { return sqrt(a * a + D(1)); },
         [](const Wide& a, const Wide&, const Wide&) { return Wide(sqrt(Wide(a * a + 1))); }},
        {"fma", [](const D& a, const D& b, const D& c) { return fma(a, b, c); },
         [](const Wide& a, const Wide& b, const Wide& c) { return Wide(a * b + c); }},
        {"abs", [](const D& a, const D&, const D&) { return abs(a); },
         [](const Wide& a, const Wide&, const Wide&) { return Wide(abs(a)); }},
        {"copysign", [](const D& a, const D& b, const D&) { return copysign(a, b); },
         [](const Wide& a, const Wide& b, const Wide&) { return (a < 0) == (b < 0) ? a : Wide(-a); }},
        {"select", [](const D& a, const D& b, const D& c) { return select(c > D(0), a * b, a + b); },
         [](const Wide& a, const Wide& b, const Wide& c) { return c > 0 ? Wide(a * b) : Wide(a + b); }},
    };
    for (const Operation& operation : operations) {
        INFO(operation.name);
        for (int round = 0; round < 50; ++round) {
            const std::array<Wide, 3> x{draw(), draw(), draw()};
            const D result = operation.dual(D::input(x[0], 0), D::input(x[1], 1), D::input(x[2], 2));
            CHECK(abs(Wide(result.value() - operation.plain(x[0], x[1], x[2]))) < 1e-200);
            for (std::size_t i = 0; i < 3; ++i) {
                auto up = x, down = x;
                const Wide step = ldexp(Wide(1), -300);
                up[i] += step;
                down[i] -= step;
                const Wide slope =
                    (operation.plain(up[0], up[1], up[2]) - operation.plain(down[0], down[1], down[2])) / (2 * step);
                CHECK(abs(Wide(result.derivative(i) - slope)) < 1e-100);
            }
        }
    }
}

}  // namespace test_conditioning
