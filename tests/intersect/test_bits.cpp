// The rows of the table against the forms themselves, and the rounded numbers against the machine's own: to the bit,
// on ordinary rays and on every kind of number that a format can hold.
#include <vector>

#include "catch.hpp"
#include "intersect/cases.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/table/table.hpp"
#include "number/draw.hpp"
#include "number/error.hpp"
#include "number/rounded.hpp"

namespace lostbits::test {

using intersect::Direction;
using intersect::table::Intersector;

namespace {

/// Rays against one sphere, columns as the table wants them.
template <class S>
struct Batch {
    std::vector<S> column[6];
    std::vector<S> t, near, far;
    std::vector<std::uint8_t> hit;

    void add(const std::array<S, 6>& ray) {
        for (std::size_t i = 0; i < 6; ++i) column[i].push_back(ray[i]);
    }
    intersect::table::RayBatch<S> rays() const {
        return {column[0], column[1], column[2], column[3], column[4], column[5]};
    }
    intersect::table::HitBatch<S> hits() {
        for (auto* v : {&t, &near, &far}) v->assign(column[0].size(), S(-12345));
        hit.assign(column[0].size(), 77);
        return {t, near, far, hit};
    }
    Ray<S> ray(std::size_t i) const {
        return {Vec<S>(column[0][i], column[1][i], column[2][i]), Vec<S>(column[3][i], column[4][i], column[5][i])};
    }
};

template <class S>
constexpr FloatFormat format_of = std::same_as<S, float> ? binary32 : binary64;

/// Any number: specials, subnormals, the ends of the range.
template <class S>
S draw_any(Random& random) {
    const FloatFormat f = format_of<S>;
    return static_cast<S>(random.one_in(12) ? draw_special(random, f) : draw_finite(random, f));
}

template <class S>
struct Scene {
    Sphere<S> sphere;
    Batch<S> batch;
};

template <class S>
std::vector<Scene<S>> scenes() {
    std::vector<Scene<S>> all;
    Random random(sizeof(S));
    for (const Setup setup : every_setup)
        for (int i = 0; i < 6; ++i) {
            const Case x = as_stored<S>(draw_case(random, setup), random.one_in(2) ? Direction::unit : Direction::any);
            const auto narrow = [](const Rational& q) { return static_cast<S>(as_double(q)); };
            Scene<S> scene{lift_sphere<S>(x, narrow), {}};
            // Some scenes move towards underflow or overflow whole; in others scene and direction move apart, so that t
            // does.
            const int middle = format_of<S>.emax / 2, mode = static_cast<int>(random.between(0, 6));
            const int wobble = static_cast<int>(random.between(-4, 4));
            const int shift = mode == 0   ? static_cast<int>(random.between(-2 * middle, middle))
                              : mode == 1 ? wobble - middle - 3
                              : mode == 2 ? middle + wobble
                                          : 0;
            const int turn = mode == 1 ? middle - 2 : mode == 2 ? 3 - middle : 0;
            const auto move = [shift](S v) { return std::ldexp(v, shift); };
            scene.sphere = {
                Vec<S>(move(scene.sphere.centre.x), move(scene.sphere.centre.y), move(scene.sphere.centre.z)),
                move(scene.sphere.radius)};
            for (int k = 0; k < 60; ++k) {
                const Case y =
                    as_stored<S>(draw_case(random, setup), random.one_in(2) ? Direction::unit : Direction::any);
                const Ray<S> r = lift_ray<S>(k % 8 == 7 ? y : x, narrow);
                std::array<S, 6> ray{move(r.origin.x),
                                     move(r.origin.y),
                                     move(r.origin.z),
                                     std::ldexp(r.direction.x, turn),
                                     std::ldexp(r.direction.y, turn),
                                     std::ldexp(r.direction.z, turn)};
                for (S& v : ray) v = k % 4 == 0 ? v : static_cast<S>(v * (1 + random.unit() / 8));
                if (random.one_in(10)) ray[static_cast<std::size_t>(random.between(0, 5))] = draw_any<S>(random);
                if (random.one_in(12)) ray[static_cast<std::size_t>(random.between(3, 5))] = S(random.sign() * 0.0);
                scene.batch.add(ray);
            }
            all.push_back(std::move(scene));
        }
    for (int i = 0; i < 30; ++i) {  // no picture at all: any number anywhere
        Scene<S> scene{{Vec<S>(draw_any<S>(random), draw_any<S>(random), draw_any<S>(random)), draw_any<S>(random)},
                       {}};
        for (int k = 0; k < 60; ++k) {
            std::array<S, 6> ray;
            for (S& v : ray) v = draw_any<S>(random);
            scene.batch.add(ray);
        }
        all.push_back(std::move(scene));
    }
    return all;
}

struct Tally {
    long wrong = 0, seen = 0, hits = 0, not_a_number = 0, infinite = 0, subnormal = 0;

    template <class S>
    void note(const Hit<S>& h) {
        ++seen;
        hits += h.hit && std::isfinite(h.t);
        not_a_number += std::isnan(h.t);
        infinite += std::isinf(h.t);
        subnormal += std::fpclassify(h.t) == FP_SUBNORMAL;
    }
};

template <class S>
bool same_hit(const Hit<S>& want, std::uint8_t hit, double t, double near, double far) {
    return hit == (want.hit ? 1 : 0) && same_number(want.t, t) && same_number(want.near, near) &&
           same_number(want.far, far);
}

template <class Form, class T, class S>
Hit<S> through(const Ray<S>& r, const Sphere<S>& s) {
    const auto vec = [](const Vec<S>& v) { return Vec<T>(T(double(v.x)), T(double(v.y)), T(double(v.z))); };
    const Hit<T> h =
        Form::intersect(Ray<T>{vec(r.origin), vec(r.direction)}, Sphere<T>{vec(s.centre), T(double(s.radius))});
    const auto back = [](T x) { return static_cast<S>(x.value()); };  // exact: x is a number of S
    return {h.hit, back(h.t), back(h.near), back(h.far)};
}

template <class S>
auto native_of(const Intersector& row) {
    if constexpr (std::same_as<S, float>) return row.native32;
    else return row.native64;
}

template <class S>
void compare_rows() {
    const auto all = scenes<S>();
    const auto rows = intersect::table::intersectors(Shape::sphere);
    std::size_t i = 0;
    Tally total;
    intersect::sphere::SphereForms::for_each([&]<class Form>() {
        const Intersector& row = rows[i++];
        INFO(Form::info.name);
        if (Form::info.formats == intersect::Formats::binary32_only && std::same_as<S, double>) return;
        using Same = std::conditional_t<std::same_as<S, float>, Rounded<24, -126, 127>, Rounded<53>>;
        const FloatFormat f = format_of<S>;
        const CurrentFormat::Scope scope(f);
        Tally native, fixed, any;
        for (Scene<S> scene : all) {
            Batch<S>& batch = scene.batch;
            Batch<double> lifted;
            for (std::size_t k = 0; k < batch.column[0].size(); ++k) {
                std::array<double, 6> ray;
                for (std::size_t c = 0; c < 6; ++c) ray[c] = batch.column[c][k];
                lifted.add(ray);
            }
            native_of<S>(row)(batch.rays(), Solid<S>(scene.sphere), batch.hits());
            if (row.rounded) {
                const Solid<double> sphere(
                    Sphere<double>{Vec<double>(scene.sphere.centre.x, scene.sphere.centre.y, scene.sphere.centre.z),
                                   scene.sphere.radius});
                row.rounded(f, lifted.rays(), sphere, lifted.hits());
            }
            for (std::size_t k = 0; k < batch.hit.size(); ++k) {
                const Ray<S> ray = batch.ray(k);
                const Hit<S> want = Form::intersect(ray, scene.sphere);
                native.note(want);
                total.note(want);
                native.wrong += !same_hit(want, batch.hit[k], batch.t[k], batch.near[k], batch.far[k]);
                if (!row.rounded) continue;
                any.wrong += !same_hit(want, lifted.hit[k], lifted.t[k], lifted.near[k], lifted.far[k]);
                const Hit<S> in_fixed = through<Form, Same>(ray, scene.sphere);
                const Hit<S> in_any = through<Form, RoundedAny>(ray, scene.sphere);
                fixed.wrong += !same_hit(want, in_fixed.hit, in_fixed.t, in_fixed.near, in_fixed.far);
                any.wrong += !same_hit(want, in_any.hit, in_any.t, in_any.near, in_any.far);
            }
        }
        INFO("finite hits " << native.hits << ", NaN " << native.not_a_number << " of " << native.seen);
        CHECK(native.wrong == 0);
        CHECK(native.hits > native.seen / 20);
        CHECK(native.not_a_number > native.seen / 100);
        CHECK(fixed.wrong == 0);
        CHECK(any.wrong == 0);
    });
    // The inputs reached what they were made to reach.
    CHECK(total.infinite > 1000);
    CHECK(total.subnormal > 500);
}

}  // namespace

TEST_CASE("binary32: the row, the form, Rounded<24> and RoundedAny are the same bits", "[intersect][bits]") {
    compare_rows<float>();
}

TEST_CASE("binary64: the row, the form, Rounded<53> and RoundedAny are the same bits", "[intersect][bits]") {
    compare_rows<double>();
}

TEST_CASE("a narrower row rounds its inputs on the way in", "[intersect][bits]") {
    const Intersector& row = intersect::table::intersectors(Shape::sphere)[0];
    Batch<double> batch;
    batch.add({0.1, 0, -5, 0, 0, 1});
    row.rounded(binary16, batch.rays(), Solid<double>(Sphere<double>{Vec<double>(0, 0, 0), 1.0}), batch.hits());
    const Hit<Half> want = intersect::sphere::Schoolbook::intersect(
        Ray<Half>{Vec<Half>(Half(0.1), Half(0), Half(-5)), Vec<Half>(Half(0), Half(0), Half(1))},
        Sphere<Half>{Vec<Half>(Half(0), Half(0), Half(0)), Half(1)});
    CHECK(batch.hit[0] == 1);
    CHECK(batch.t[0] == want.t.value());
    CHECK(Half(batch.t[0]).value() == batch.t[0]);
    CHECK_THROWS_AS(CurrentFormat::get(), Error);
}

}  // namespace lostbits::test
