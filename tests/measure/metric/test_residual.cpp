// The residual: how far a hit point lies off the surface, by hand.
#include "catch.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/metric/statistics.hpp"

namespace lostbits::test::test_residual {

namespace {

double residual(const Solid<double>& solid, const Ray<double>& ray, double t, const char* format = "f64") {
    const Format in = find_format(format).value();
    return measure::metric::find_metric("residual")->value({.t = t, .format = &in, .ray = &ray, .solid = &solid});
}

}  // namespace

TEST_CASE("residual of a sphere: (|P - G| - r)/r, negative inside", "[measure][metric]") {
    const Solid<double> sphere(Sphere<double>{{1, 0, 0}, 2});
    const Ray<double> ray{{-3, 0, 0}, {1, 0, 0}};
    CHECK(residual(sphere, ray, 2) == 0);
    CHECK(residual(sphere, ray, 1) == 0.5);                        // P = (−2, 0, 0), 3 from the centre
    CHECK(residual(sphere, ray, 3) == -0.5);                       // 1 from the centre
    CHECK(residual(sphere, {{1, 0, 0}, {0, 3, 4}}, 0.5) == 0.25);  // (0, 1.5, 2): 2.5 from it
}

TEST_CASE("residual of a box: the largest of lo - P and P - hi, in longest sides, negative inside",
          "[measure][metric]") {
    const Solid<double> box(Box<double>{{0, 0, 0}, {4, 2, 1}});
    const Ray<double> ray{{-1, 1, 0.5}, {1, 0, 0}};
    CHECK(residual(box, ray, 1) == 0);                              // in the face x = 0, inside of the other slabs
    CHECK(residual(box, ray, 0.25) == 0.75 / 4);                    // 0.75 short of it
    CHECK(residual(box, ray, 1.25) == -0.25 / 4);                   // a quarter deep, x = 0 is the nearest face
    CHECK(residual(box, ray, 3) == -0.5 / 4);                       // deeper, z = 0 and z = 1 are nearer
    CHECK(residual(box, ray, 5.5) == 0.5 / 4);                      // out on the other side
    CHECK(residual(box, {{1, 1, 0.5}, {1, 0, 0}}, 0) == -0.5 / 4);  // an eye inside hits at t = 0, wherever it is
    // Beside a corner it is the largest of 3, 4 and 1 beyond, and not the distance √26.
    CHECK(residual(box, {{0, 0, 0}, {-3, 6, 2}}, 1) == 4.0 / 4);
    // A box in the plane z = 0 has no inside; nor has a point a size.
    CHECK(residual(Solid<double>(Box<double>{{0, 0, 0}, {4, 2, 0}}), {{1, 1, -3}, {0, 0, 1}}, 3) == 0);
    CHECK_FALSE(std::isfinite(residual(Solid<double>(Box<double>{{1, 1, 1}, {1, 1, 1}}), {{1, 1, 0}, {0, 0, 1}}, 1)));
}

TEST_CASE("residual is of the point that the format computes, and tables have its magnitude", "[measure][metric]") {
    const Solid<double> box(Box<double>{{256, 0, 0}, {320, 64, 64}});
    const Ray<double> ray{{256, 32, 32}, {1, 0, 0}};
    CHECK(residual(box, ray, 1, "f32") == -1.0 / 64);
    CHECK(residual(box, ray, 1, "bf16") == 0);  // 257 takes nine bits, and bf16 has eight: a tie to 256
    measure::metric::Distribution tabled;
    for (const double x : {-0.5, 0.25, 0.25}) tabled.add(x);
    CHECK(tabled.mean() == Approx(1.0 / 3));
    CHECK(tabled.quantile(0.5) == Approx(0.25).epsilon(0x1p-10));
    CHECK(tabled.quantile(1) == 0.5);
}

}  // namespace lostbits::test::test_residual
