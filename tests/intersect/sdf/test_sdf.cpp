// The forms that march: compared with plain loops, across registers, and in enclosures.
#include "catch.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/sdf/sdf_draw.hpp"
#include "intersect/simd/packed.hpp"
#include "intersect/table/kernels.hpp"
#include "number/real.hpp"

namespace lostbits::test::test_sdf {

using intersect::LiftedTarget;
using intersect::StopReason;

namespace {

template <class S>
struct Batch {
    std::vector<S> column[6], t, near, far;
    std::vector<std::uint8_t> hit;
    std::vector<intersect::MarchRecord> march;

    explicit Batch(const std::vector<Ray<double>>& rays) {
        for (const Ray<double>& r : rays) {
            for (int i = 0; i < 3; ++i) {
                column[i].push_back(static_cast<S>(r.origin[i]));
                column[3 + i].push_back(static_cast<S>(r.direction[i]));
            }
        }
        const std::size_t n = rays.size();
        t.resize(n), near.resize(n), far.resize(n), hit.resize(n), march.resize(n);
    }
    [[nodiscard]] intersect::table::RayBatch<S> rays() const {
        return {column[0], column[1], column[2], column[3], column[4], column[5]};
    }
    intersect::table::HitBatch<S> hits(bool records) {
        return {t, near, far, hit, records ? std::span(march) : std::span<intersect::MarchRecord>()};
    }
};

template <class S, class Kernel>
Batch<S> run(const Kernel& kernel, const DrawnField& field, bool records) {
    Batch<S> batch(field.rays);
    const LiftedTarget<S> target(field.target());
    kernel(batch.rays(), target.get(), batch.hits(records));
    return batch;
}

template <class S>
void compare_widths(std::uint64_t seed) {
    Random random(seed);
    std::size_t hits = 0, misses = 0;
    for (int k = 0; k < 60; ++k) {
        const DrawnField field = draw_field(random, static_cast<std::size_t>(random.between(0, 70)));
        for (std::size_t form = 0; form < intersect::form_count; ++form) {
            if (intersect::table::intersectors()[form].shape != Shape::sdf) continue;
            const auto kernel_of = [](const intersect::simd::PackedFormKernels& row) {
                if constexpr (std::same_as<S, float>) return row.f32;
                else return row.f64;
            };
            const auto want = run<S>(kernel_of(intersect::simd::all_packed_kernels(intersect::simd::Isa::scalar)[form]),
                                     field, false);
            for (const auto h : want.hit) ++(h ? hits : misses);
            for (const intersect::simd::Isa isa : intersect::simd::available_isas()) {
                const auto got = run<S>(kernel_of(intersect::simd::all_packed_kernels(isa)[form]), field, false);
                INFO(intersect::table::intersectors()[form].info->name << " at " << name_of(isa));
                CHECK(got.hit == want.hit);
                CHECK(got.t == want.t);
                CHECK(got.near == want.near);
                CHECK(got.far == want.far);
            }
        }
    }
    CHECK(hits > 1000);
    CHECK(misses > 1000);
}

/// The loop of the lesson SDF Sphere Marching, written plainly.
template <class S>
std::pair<bool, S> plain_march(const Ray<S>& ray, const Sphere<S>& sphere,
                               const intersect::MarchConstants<S>& constants, int& samples) {
    S t = 0;
    for (samples = 1; samples <= constants.max_steps; ++samples) {
        const S x = ray.origin.x + t * ray.direction.x - sphere.centre.x;
        const S y = ray.origin.y + t * ray.direction.y - sphere.centre.y;
        const S z = ray.origin.z + t * ray.direction.z - sphere.centre.z;
        const S d = std::sqrt(x * x + y * y + z * z) - sphere.radius;
        if (d < constants.hit_eps) return {true, t};
        t += d;
        if (t > constants.max_dist) return {false, t};
    }
    samples = constants.max_steps;
    return {false, t};
}

}  // namespace

TEST_CASE("distance fields: marches agree with the seed's table, and meet a box from every side", "[intersect][sdf]") {
    const Sphere<double> unit{{0, 0, 0}, 1};
    const double at[] = {0, 0.5, 1, 2, 5}, is[] = {-1, -0.5, 0, 1, 4};
    for (std::size_t i = 0; i < 5; ++i) CHECK(unit.distance({at[i], 0, 0}) == is[i]);
    const Box<double> box{{-1, -2, -3}, {1, 2, 3}};
    CHECK(box.distance({0, 0, 0}) == -1);
    CHECK(box.distance({0.75, 0, 0}) == -0.25);
    CHECK(box.distance({1, 2, 3}) == 0);
    CHECK(box.distance({-4, 0, 0}) == 3);
    CHECK(box.distance({4, 6, 0}) == 5);    // 3-4-5 beside an edge
    CHECK(box.distance({-3, 5, -9}) == 7);  // 2-3-6-7 off a corner
    const Primitive<double> both[] = {Primitive<double>(unit), Primitive<double>(Box<double>{{2, -1, -1}, {3, 1, 1}})};
    const intersect::table::UnionField<double> field{std::span<const Primitive<double>>(both)};
    CHECK(field({1.25, 0, 0}) == 0.25);
    CHECK(field({1.75, 0, 0}) == 0.25);
    CHECK(field({2.25, 0, 0}) == -0.25);
}

TEST_CASE("packed marches give the bits of the native rows", "[intersect][sdf][packed]") {
    compare_widths<float>(7);
    compare_widths<double>(8);
}

TEST_CASE("sphere_trace is the loop of the seed program", "[intersect][sdf]") {
    Random random(11);
    for (int k = 0; k < 400; ++k) {
        DrawnField field = draw_field(random, 4);
        field.primitives = {Primitive<double>(Sphere<double>{{0.5, -0.25, 0.125}, 0.75})};
        const auto got = run<double>(intersect::table::intersectors(Shape::sdf).front().native64, field, true);
        for (std::size_t i = 0; i < field.rays.size(); ++i) {
            int samples = 0;
            const auto [hit, t] =
                plain_march<double>(field.rays[i], field.primitives[0].sphere(), field.march, samples);
            CHECK((got.hit[i] != 0) == hit);
            CHECK(got.t[i] == t);
            CHECK(got.march[i].iterations == samples);
            const StopReason stop = hit                        ? StopReason::hit
                                    : t > field.march.max_dist ? StopReason::max_dist
                                                               : got.march[i].stop;
            CHECK(got.march[i].stop == stop);
        }
    }
}

TEST_CASE("a march stops advancing where t + d rounds to t", "[intersect][sdf]") {
    DrawnField field;
    field.primitives = {Primitive<double>(Sphere<double>{{0, 0, 0}, 1})};
    field.march = {0x1p-40, 100, 1e-3, 1e-3, 1.4, 200, 2, 4};
    const double d = static_cast<double>(static_cast<float>(1 / std::sqrt(3.0)));
    field.rays = {{{4, 4, 4}, {-d, -d, -d}}};
    const auto row = intersect::table::intersectors(Shape::sdf).front();
    const auto got = run<float>(row.native32, field, true);
    CHECK(got.hit[0] == 0);
    CHECK(got.march[0].stop == StopReason::stagnated);
    CHECK(got.march[0].iterations == 200);
    CHECK(got.march[0].least > 0x1p-40);
    CHECK(got.march[0].least < 0x1p-20);
    const intersect::table::MarchLog log = row.log(*find_format("f32"), field.rays[0], field.target());
    REQUIRE(log.steps.size() == 200);
    CHECK(log.steps[199].t == log.steps[198].t);
    CHECK(log.steps[199].d > 0);
    CHECK(log.hit.t == static_cast<double>(got.t[0]));
    CHECK(log.stop == StopReason::stagnated);
}

TEST_CASE("enclosures of the marches contain their unrounded results", "[intersect][sdf][containment]") {
    using Wide = BasicReal<1024>;
    Random random(5);
    std::size_t form = 0;
    intersect::SdfForms::for_each([&]<class Form>() {
        const intersect::table::Intersector& row = intersect::table::intersectors(Shape::sdf)[form++];
        int decided = 0, ray_count = 0, wrong = 0;
        for (int k = 0; k < 60; ++k) {
            const DrawnField field = draw_field(random, 3);
            const LiftedTarget<Wide> wide(field.target());
            for (const Ray<double>& r : field.rays) {
                intersect::sdf::NoMarchWatch unwatched;
                const auto lift = [](const Vec<double>& v) { return Vec<Wide>(Wide(v.x), Wide(v.y), Wide(v.z)); };
                const Hit<Wide> want = intersect::table::intersect_target<Form>(
                    Ray<Wide>{lift(r.origin), lift(r.direction)}, wide.get(), Wide(0), unwatched);
                const LiftedTarget<Ball> balls(field.target());
                const Hit<Ball> quick = row.ball({{Ball(r.origin.x), Ball(r.origin.y), Ball(r.origin.z)},
                                                  {Ball(r.direction.x), Ball(r.direction.y), Ball(r.direction.z)}},
                                                 balls.get());
                const Wide slack = ldexp(Wide(1) + abs(want.t), -500);
                wrong += (quick.hit.is_yes() && !want.hit) || (quick.hit.is_no() && want.hit);
                if (quick.t.is_bounded())
                    wrong += abs(want.t - Wide(quick.t.hi()) - Wide(quick.t.lo())) > Wide(quick.t.radius()) + slack;
                for (const long bits : {100L, 300L, 900L}) {
                    const Interval::Precision precision(bits);
                    const LiftedTarget<Interval> boxes(field.target());
                    const auto in = [](double x) { return Interval(x); };
                    const Hit<Interval> got = row.interval({{in(r.origin.x), in(r.origin.y), in(r.origin.z)},
                                                            {in(r.direction.x), in(r.direction.y), in(r.direction.z)}},
                                                           boxes.get());
                    wrong += (got.hit.is_yes() && !want.hit) || (got.hit.is_no() && want.hit);
                    if (got.t.is_bounded())
                        wrong += mpfr_cmp(got.t.lower(), Wide(want.t + slack).backend().data()) > 0 ||
                                 mpfr_cmp(got.t.upper(), Wide(want.t - slack).backend().data()) < 0;
                    if (bits == 900) decided += !got.hit.is_unknown();
                }
                ++ray_count;
            }
        }
        INFO(Form::info.name << " decided " << decided << " of " << ray_count);
        CHECK(wrong == 0);
        CHECK(decided > ray_count * 9 / 10);
    });
}

TEST_CASE("stepping by p += d dir equals o + t dir when nothing is rounded", "[intersect][sdf]") {
    using Wide = BasicReal<1024>;
    Random random(21);
    for (int k = 0; k < 200; ++k) {
        const DrawnField field = draw_field(random, 1);
        const LiftedTarget<Wide> target(field.target());
        const auto lift = [](const Vec<double>& v) { return Vec<Wide>(Wide(v.x), Wide(v.y), Wide(v.z)); };
        const Ray<Wide> ray{lift(field.rays[0].origin), lift(field.rays[0].direction)};
        intersect::sdf::NoMarchWatch unwatched;
        const auto one =
            intersect::table::intersect_target<intersect::sdf::SphereTrace>(ray, target.get(), Wide(0), unwatched);
        const auto other =
            intersect::table::intersect_target<intersect::sdf::Accumulated>(ray, target.get(), Wide(0), unwatched);
        CHECK(one.hit == other.hit);
        CHECK(abs(one.t - other.t) <= ldexp(Wide(1) + abs(one.t), -700));
    }
}

}  // namespace lostbits::test::test_sdf
