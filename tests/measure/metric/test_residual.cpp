// The residual, the distance of a hit point from the surface, by hand.
#include "catch.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/metric/statistics.hpp"

namespace lostbits::test::test_residual {

namespace {

double residual(const Primitive<double>& primitive, const Ray<double>& ray, double t, const char* format = "f64") {
    const Format in = find_format(format).value();
    return measure::metric::find_metric("residual")
        ->value({.t = t, .format = &in, .ray = &ray, .primitive = &primitive});
}

}  // namespace

TEST_CASE("residual of a sphere: (|P - G| - r)/r, negative inside", "[measure][metric]") {
    const Primitive<double> sphere(Sphere<double>{{1, 0, 0}, 2});
    const Ray<double> ray{{-3, 0, 0}, {1, 0, 0}};
    CHECK(residual(sphere, ray, 2) == 0);
    CHECK(residual(sphere, ray, 1) == 0.5);                        // P = (−2, 0, 0), 3 from the centre
    CHECK(residual(sphere, ray, 3) == -0.5);                       // 1 from the centre
    CHECK(residual(sphere, {{1, 0, 0}, {0, 3, 4}}, 0.5) == 0.25);  // (0, 1.5, 2): 2.5 from it
}

TEST_CASE("residual of a box: the largest of lo - P and P - hi, in longest sides, negative inside",
          "[measure][metric]") {
    const Primitive<double> box(Box<double>{{0, 0, 0}, {4, 2, 1}});
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
    CHECK(residual(Primitive<double>(Box<double>{{0, 0, 0}, {4, 2, 0}}), {{1, 1, -3}, {0, 0, 1}}, 3) == 0);
    CHECK_FALSE(
        std::isfinite(residual(Primitive<double>(Box<double>{{1, 1, 1}, {1, 1, 1}}), {{1, 1, 0}, {0, 0, 1}}, 1)));
}

TEST_CASE("the residual belongs to the point that the format computes, and tables have its magnitude",
          "[measure][metric]") {
    const Primitive<double> box(Box<double>{{256, 0, 0}, {320, 64, 64}});
    const Ray<double> ray{{256, 32, 32}, {1, 0, 0}};
    CHECK(residual(box, ray, 1, "f32") == -1.0 / 64);
    CHECK(residual(box, ray, 1, "bf16") == 0);  // 257 takes nine bits, and bf16 has eight: a tie to 256
    measure::metric::Distribution tabled;
    for (const double x : {-0.5, 0.25, 0.25}) tabled.add(x);
    CHECK(tabled.mean() == Approx(1.0 / 3));
    CHECK(tabled.quantile(0.5) == Approx(0.25).epsilon(0x1p-10));
    CHECK(tabled.quantile(1) == 0.5);
}

TEST_CASE("the error of a normal is the angle to the normal at the true hit", "[measure][metric]") {
    const auto error = [](const Primitive<double>& primitive, const Ray<double>& ray, double t, double exact) {
        const Format in = *find_format("f64");
        const measure::truth::CertifiedNumber truth = measure::truth::as_certified(exact);
        return measure::metric::find_metric("normal_error")
            ->value({.t = t, .format = &in, .true_t = &truth, .ray = &ray, .primitive = &primitive});
    };
    const Sphere<double> sphere{{0, 0, 0}, 5};
    const Ray<double> ray{{-8, 3, 0}, {1, 0, 0}};  // meets it at (-4, 3, 0), t = 4
    CHECK(error(sphere, ray, 4, 4) < 1e-16);
    CHECK(error(sphere, ray, 4.25, 4) == Approx(std::atan2(3, 3.75) - std::atan2(3, 4)));
    // A plane has one normal, and a box one for each face: that of the face that the ray hits, whatever t is.
    CHECK(error(Box<double>{{-1, -4, -1}, {1, 4, 1}}, ray, 6, 7) == 0);
}

TEST_CASE("a wrong decision is forgiven within u, and right decisions are not examined", "[measure][metric]") {
    const Format in = *find_format("f32");
    const Ray<double> ray{{0, 0, 0}, {0, 0, 1}};
    const auto wrong = [&](double centre, measure::answer::Outcome outcome) {
        const Primitive<double> sphere = Sphere<double>{{centre, 0, 4}, 1};
        return measure::metric::find_metric("wrong_decision")
            ->value({.format = &in, .ray = &ray, .primitive = &sphere, .outcome = outcome});
    };
    using measure::answer::Outcome;
    CHECK(wrong(1 - 0x1p-20, Outcome::false_miss) == 2);  // 2^-21 of centre and radius: 8 u
    CHECK(wrong(1 - 0x1p-24, Outcome::false_miss) == 1);
    CHECK(wrong(1 - 0x1p-24, Outcome::agree_hit) == 0);
    CHECK(wrong(1 + 0x1p-20, Outcome::false_hit) == 2);
}

}  // namespace lostbits::test::test_residual
