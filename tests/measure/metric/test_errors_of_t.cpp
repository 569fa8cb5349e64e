// Errors that are not measured in ulps of t*: at t* = 0, wrong roots, and derivatives.
#include <cmath>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/attribution/recorded_rays.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/stability/stability.hpp"
#include "measure/truth/conditioning.hpp"
#include "number/dual.hpp"
#include "shapes/sphere/forms/schoolbook.hpp"
#include "shapes/sphere/forms/unified.hpp"

namespace lostbits::test::test_errors_of_t {

using intersect::table::Intersector;
using measure::stability::is_wrong_root;

namespace {

bool is_wrong(const Primitive<double>& primitive, const Ray<double>& ray, double exact, double t) {
    return is_wrong_root(ray, primitive, measure::truth::as_certified(exact), t);
}

const Intersector& form_named(std::string_view name) {
    return *std::ranges::find(intersect::table::catalogue(), name, [](const auto& f) { return f.info->name; });
}

/// dt/d(number) of a sphere's form by `Dual` in float, and by its tape.
template <class Form>
void compare_derivatives() {
    using D = Dual<float, 10>;
    const Intersector& form = form_named(Form::info.name);
    Random random(7);
    int hits = 0;
    for (int i = 0; i < 200; ++i) {
        const Setting s = draw_setting(random, form, *find_format("f32"), 3);
        std::size_t k = 0;
        const auto input = [&k](double x) { return D::input(static_cast<float>(x), k++); };
        const auto vec = [&input](const Vec<double>& v) {
            const D x = input(v.x), y = input(v.y), z = input(v.z);
            return Vec<D>(x, y, z);
        };
        const Sphere<double> at = s.primitives.front().sphere();
        const Vec<D> o = vec(s.ray.origin), d = vec(s.ray.direction), c = vec(at.centre);
        const Hit<D> hit = Form::template intersect<D>(Ray<D>{o, d}, Sphere<D>{c, input(at.radius)});
        if (!hit.hit) continue;
        Tape tape;
        form.record(*find_format("f32"), s.ray, s.target(form), HUGE_VAL, tape);
        const std::vector<double> found = measure::stability::compute_forward_derivatives(tape);
        REQUIRE(found.size() == 11);  // where the ray ends is an input, too
        for (std::size_t x = 0; x < 10; ++x) REQUIRE(found[x] == static_cast<double>(hit.t.derivative(x)));
        CHECK(found[10] == 0);
        ++hits;
    }
    CHECK(hits > 50);
}

double derivative_error(const Intersector& form, const char* format, const Setting& setting) {
    const Format in = *find_format(format);
    measure::attribution::Attributor attributor(form, in, {}, false);
    const auto blame = attributor.attribute_ray(setting.ray, setting.target(form));
    return measure::metric::find_metric("derivative_error")
        ->value({.format = &in,
                 .ray = &setting.ray,
                 .primitive = &setting.primitives.front(),
                 .attribution = &blame,
                 .direction = form.info->direction});
}

}  // namespace

TEST_CASE("a wrong root is another crossing of the primitive, ahead or behind, and rounding noise is not",
          "[measure][metric]") {
    Random random(11);
    for (int i = 0; i < 2000; ++i) {
        const double distance = 4 * random.unit(), aside = 0.99 * random.unit(), half = std::sqrt(1 - aside * aside);
        const Ray<double> ray{{-distance, aside, 0}, {random.one_in(2) ? 1.0 : -1.0, 0, 0}};
        const Sphere<double> sphere{{0, 0, 0}, 1};
        const double middle = distance * ray.direction.x, near = middle - half, far = middle + half;
        if (far < 0) continue;
        INFO("from " << distance << ", aside by " << aside);
        const double meant = near >= 0 ? near : far, other = near >= 0 ? far : near;
        CHECK_FALSE(is_wrong(sphere, ray, meant, meant * (1 + 0x1p-30)));
        CHECK_FALSE(is_wrong(sphere, ray, meant, middle));
        CHECK_FALSE(is_wrong(sphere, ray, meant, other + 3 * (other - meant)));
        CHECK(is_wrong(sphere, ray, meant, other + 0x1p-5 * half));
    }
    const Ray<double> along{{-8, 0, 0}, {1, 0, 0}};
    const Torus<double> torus{{0, 0, 0}, {0, 0, 1}, 2, 0.5};
    for (const double other : {6.5, 9.5, 10.5}) CHECK(is_wrong(torus, along, 5.5, other));
    for (const double none : {5.5, 6.0, 8.0, 12.0}) CHECK_FALSE(is_wrong(torus, along, 5.5, none));
    const Box<double> box{{-1, -1, -1}, {1, 1, 1}};
    CHECK(is_wrong(box, along, 7, 9));
    CHECK(is_wrong(box, {{0, 0, 0}, {1, 0, 0}}, 0, 1));  // from inside its answer is 0
    CHECK(is_wrong(box, {{0, 0, 0}, {1, 0, 0}}, 0, -1));
}

TEST_CASE("an error at t* = 0 is relative to the size of the problem", "[measure][metric]") {
    const Format in = *find_format("f32");
    const Ray<double> ray{{3, 4, 0}, {-2, 0, 0}};
    const Primitive<double> sphere = Sphere<double>{{0, 0, 0}, 5};
    const auto error = [&](double t, double exact) {
        const auto truth = measure::truth::as_certified(exact);
        return measure::metric::find_metric("error_at_zero")
            ->value({.t = t, .format = &in, .true_t = &truth, .ray = &ray, .primitive = &sphere});
    };
    CHECK(error(0, 0) == 0);
    CHECK(error(0x1p-20, 0) == Approx(2 * 0x1p-20 / 5 * 0x1p24));
    CHECK(std::isnan(error(0x1p-20, 1)));
}

TEST_CASE("the gradient is undefined at a tangent, for a miss and from inside a box", "[measure][metric]") {
    const Ray<double> ray{{-8, 3, 0}, {1, 0, 0}};
    const Primitive<double> sphere = Sphere<double>{{0, 0, 0}, 5};
    CHECK(measure::truth::gradient(ray, sphere).size() == 10);
    CHECK(measure::truth::gradient({{-8, 5, 0}, {1, 0, 0}}, sphere).empty());
    CHECK(measure::truth::gradient({{-8, 6, 0}, {1, 0, 0}}, sphere).empty());
    CHECK(measure::truth::gradient(ray, Box<double>{{-9, -9, -9}, {9, 9, 9}}).empty());
}

TEST_CASE("derivatives from a tape equal those of Dual bit for bit", "[measure][metric]") {
    compare_derivatives<intersect::sphere::Schoolbook>();
    compare_derivatives<intersect::sphere::Unified>();
}

TEST_CASE("derivatives of every form are close to the true ones in double, and less so in float", "[measure][metric]") {
    for (const Intersector& form : intersect::table::catalogue()) {
        if (form.shape == Shape::sdf || form.info->direction == intersect::Direction::unit || !form.native64) continue;
        if (form.info->roots == intersect::Roots::none) continue;
        Random random(3);
        int near = 0, known = 0;
        for (int i = 0; i < (is_long() ? 60 : 15); ++i) {
            const Setting s = draw_setting(random, form, *find_format("f32"), 1);
            const double wide = derivative_error(form, "f64", s), narrow = derivative_error(form, "f32", s);
            if (std::isnan(wide) || std::isnan(narrow)) continue;
            ++known;
            near += wide < 0x1p20 && narrow < 0x1p20;
        }
        INFO(form.info->name << ": " << near << " of " << known);
        CHECK(near >= known / 2);
    }
}

}  // namespace lostbits::test::test_errors_of_t
