// Every transform method with every form: t is right in exact arithmetic, batches answer as single rays, the tape as
// the kernel, and the errors of the steps sum to the whole error.
#include <cmath>
#include <set>
#include <vector>

#include "catch.hpp"
#include "intersect/simd/packed.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/answer/steps.hpp"
#include "measure/answer/without_rounding.hpp"
#include "measure/seeded.hpp"

namespace test_spaces {

using namespace lostbits;
using intersect::Target;
using intersect::table::Intersector;
using intersect::transform::transform_methods;
using intersect::transform::transformed_form;
using intersect::transform::TransformMethod;
using test::Seeded;

namespace {

double rounded(double x, const FloatFormat& format) { return rounding::to_format(x, 0, format); }
Vec<double> rounded(const Vec<double>& v, const FloatFormat& format) {
    return {rounded(v.x, format), rounded(v.y, format), rounded(v.z, format)};
}

/// A rotation by a quaternion of random numbers, a scale, and a translation, in floats, so that no rotation is exact.
Transform<double> random_transform(Seeded& r, double scale, const FloatFormat& format) {
    const double w = r.uniform(-1, 1), x = r.uniform(-1, 1), y = r.uniform(-1, 1), z = r.uniform(-1, 1);
    const double n = scale / (w * w + x * x + y * y + z * z);
    const Vec<double> shift = r.vec(-100, 100);
    const std::array<double, 12> m{n * (w * w + x * x - y * y - z * z),
                                   n * 2 * (x * y - w * z),
                                   n * 2 * (x * z + w * y),
                                   shift.x,
                                   n * 2 * (x * y + w * z),
                                   n * (w * w - x * x + y * y - z * z),
                                   n * 2 * (y * z - w * x),
                                   shift.y,
                                   n * 2 * (x * z - w * y),
                                   n * 2 * (y * z + w * x),
                                   n * (w * w - x * x - y * y + z * z),
                                   shift.z};
    return convert_numbers(Transform<double>{m, false, 1}, [&](double number) { return rounded(number, format); });
}

struct RayAndPrimitive {
    Primitive<double> primitive;
    Ray<double> ray;
};

/// A ray of the world that passes near the middle of the primitive, with a direction of length about one.
RayAndPrimitive draw(Seeded& r, Shape shape, const FloatFormat& format, double scale = 1) {
    RayAndPrimitive a{primitive_around<double>(shape, r.vec(-1, 1), 1), {}};
    a.primitive = convert_numbers(a.primitive, [&](double number) { return rounded(number, format); });
    const Vec<double> middle = visit(a.primitive, [](const auto& s) { return s.middle(); });
    a.primitive.transform = random_transform(r, scale, format);
    const Vec<double> at = a.primitive.transform->map().point(middle) + 0.4 * scale * r.vec(-1, 1);
    Vec<double> d = r.vec(-1, 1);
    d = d / std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    a.ray = {rounded(at - 7.0 * d, format), rounded(d, format)};
    return a;
}

/// For forms that take any direction and have the usual properties: their answer is t* except for rounding.
std::vector<const Intersector*> plain_forms() {
    std::vector<const Intersector*> forms;
    for (const Intersector& form : intersect::table::catalogue()) {
        const bool usual = form.info->direction == intersect::Direction::any &&
                           form.info->convention() == intersect::Convention() &&
                           form.info->roots != intersect::Roots::none && form.is_template() &&
                           form.info->formats == intersect::Formats::all;
        const auto same = [&](const Intersector* other) { return other->shape == form.shape; };
        if (is_primitive(form.shape) && usual && std::ranges::count_if(forms, same) < 2) forms.push_back(&form);
    }
    return forms;
}

struct One {
    bool hit;
    double t;
};

template <class S, class Kernel>
One ask(const Kernel& kernel, const RayAndPrimitive& a) {
    const auto& [o, d] = a.ray;
    const std::array<S, 6> x{static_cast<S>(o.x), static_cast<S>(o.y), static_cast<S>(o.z),
                             static_cast<S>(d.x), static_cast<S>(d.y), static_cast<S>(d.z)};
    const auto one = [](const S& value) { return std::span(&value, 1); };
    S t{}, near{}, far{};
    std::uint8_t hit = 0;
    kernel({one(x[0]), one(x[1]), one(x[2]), one(x[3]), one(x[4]), one(x[5])},
           Target<S>(convert_numbers(a.primitive, [](double n) { return static_cast<S>(n); })),
           {std::span(&t, 1), std::span(&near, 1), std::span(&far, 1), std::span(&hit, 1)});
    return {hit != 0, double{t}};
}

One ask(const Intersector& row, const Format& format, const RayAndPrimitive& a) {
    return format.engine == Format::Engine::native32 ? ask<float>(row.native32, a) : ask<double>(row.native64, a);
}

}  // namespace

TEST_CASE("a row with a transform is named after form and method, and has the requirements of both") {
    const Intersector& form = *plain_forms().front();
    for (const TransformMethod& space : transform_methods()) {
        const Intersector& row = transformed_form(space, form);
        CHECK(row.info->name == std::string(form.info->name) + "@" + std::string(space.info->name));
        CHECK(&transformed_form(space, form) == &row);
        CHECK(intersect::transform::find_transformed_parts(row).method == &space);
        CHECK(intersect::transform::find_transformed_parts(row).form == &form);
        CHECK(row.shapes() == Shapes(form.shape).with_transform());
        CHECK_THROWS_AS(transformed_form(space, row), InputError);
    }
    CHECK(intersect::transform::find_transformed_parts(form).method == nullptr);
}

TEST_CASE("every transform method gives the true t when nothing is rounded, rigid only for rotations") {
    std::set<Shape> shapes;
    for (const Intersector* const form : plain_forms()) {
        for (const TransformMethod& space : transform_methods()) {
            CAPTURE(form->info->name, space.info->name);
            const Intersector& row = transformed_form(space, *form);
            const bool rigid = space.info->name == "rigid";
            Seeded r(3);
            int hits = 0;
            for (int i = 0; i < 40; ++i) {
                const RayAndPrimitive a = draw(r, form->shape, binary32);
                const auto truth = measure::truth::find_truth(a.ray, a.primitive);
                const auto self = measure::answer::evaluate_exactly(row, a.ray, Target<double>(a.primitive));
                if (!truth.is_hit() || !self) continue;
                ++hits;
                const bool unit = row.info->direction == intersect::Direction::unit;
                const auto& t = unit ? truth.distance : truth.t;
                // A float matrix is a rotation to 2^-24 of itself, and its transpose is its inverse to as much.
                const double off = measure::truth::scaled_difference(*self, t, t.exponent);
                CHECK(std::fabs(off) < (rigid ? 1e-3 : 0x1p-60));
            }
            if (hits > 5) shapes.insert(form->shape);
        }
    }
    CHECK(shapes.size() == shape_rows.size());
}

TEST_CASE("batches with a transform answer as single rays, and the tape of a row as its kernel") {
    for (const Intersector* const form : plain_forms()) {
        for (const TransformMethod& space : transform_methods()) {
            CAPTURE(form->info->name, space.info->name);
            const Intersector& row = transformed_form(space, *form);
            for (const Format& format : {*find_format("f32"), *find_format("f64")}) {
                Seeded r(5);
                for (int i = 0; i < 20; ++i) {
                    const RayAndPrimitive a = draw(r, form->shape, format.parameters, 3);
                    const One alone = ask(row, format, a);
                    Tape tape;
                    row.record(format, a.ray, Target<double>(a.primitive), HUGE_VAL, tape);
                    REQUIRE((tape[tape.outputs.hit].value != 0) == alone.hit);
                    if (alone.hit) REQUIRE(tape[tape.outputs.t].value == alone.t);
                    const auto inputs =
                        static_cast<std::size_t>(std::ranges::count(tape.nodes, TapeOp::input, &TapeNode::op));
                    REQUIRE(inputs == 6 + a.primitive.shape_numbers().size() + 12 + 1);
                }
            }
        }
    }
}

namespace {

/// This many rays at the primitive of the first ray, all at once, in the registers of a width.
template <class S, class Kernel>
std::vector<S> ask_together(const Kernel& kernel, const std::vector<RayAndPrimitive>& all) {
    std::array<std::vector<S>, 6> x;
    for (const RayAndPrimitive& a : all)
        for (int k = 0; k < 3; ++k) {
            x[k].push_back(static_cast<S>(a.ray.origin[k]));
            x[k + 3].push_back(static_cast<S>(a.ray.direction[k]));
        }
    std::vector<S> t(all.size()), near(all.size()), far(all.size());
    std::vector<std::uint8_t> hit(all.size());
    kernel({x[0], x[1], x[2], x[3], x[4], x[5]},
           Target<S>(convert_numbers(all.front().primitive, [](double n) { return static_cast<S>(n); })),
           {t, near, far, hit});
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = hit[i] != 0 ? t[i] : S(-1);
    return t;
}

}  // namespace

TEST_CASE("batches with a transform answer as single rays at every register width") {
    const auto before = intersect::simd::current_isa();
    for (const Intersector* const form : plain_forms()) {
        for (const TransformMethod& space : transform_methods()) {
            CAPTURE(form->info->name, space.info->name);
            const Intersector& row = transformed_form(space, *form);
            Seeded r(13);
            std::vector<RayAndPrimitive> all;
            for (int i = 0; i < 37; ++i) {
                all.push_back(draw(r, form->shape, binary32, 3));
                all.back().primitive = all.front().primitive;
                const Vec<double> middle = visit(all.front().primitive, [](const auto& s) { return s.middle(); });
                const Vec<double> at = all.front().primitive.transform->map().point(middle) + 1.2 * r.vec(-1, 1);
                all.back().ray.origin = rounded(at - 7.0 * all.back().ray.direction, binary32);
            }
            for (const auto isa : intersect::simd::available_isas()) {
                intersect::simd::set_isa(isa);
                const auto f32 = ask_together<float>(row.native32, all);
                const auto f64 = ask_together<double>(row.native64, all);
                intersect::simd::set_isa(intersect::simd::Isa::scalar);
                for (std::size_t i = 0; i < all.size(); ++i) {
                    const One one32 = ask<float>(row.native32, all[i]), one64 = ask<double>(row.native64, all[i]);
                    REQUIRE((one32.hit ? one32.t : -1) == f32[i]);
                    REQUIRE((one64.hit ? one64.t : -1) == f64[i]);
                }
            }
        }
    }
    intersect::simd::set_isa(before);
}

TEST_CASE("errors assigned to the steps sum to the total, and a stored inverse has no error of inverting") {
    for (const Intersector* const form : plain_forms()) {
        for (const TransformMethod& space : transform_methods()) {
            CAPTURE(form->info->name, space.info->name);
            const Intersector& row = transformed_form(space, *form);
            for (const Format& format : {*find_format("f32"), *find_format("f64"), *find_format("p12")}) {
                Seeded r(11);
                for (int i = 0; i < 12; ++i) {
                    RayAndPrimitive a = draw(r, form->shape, format.parameters, 2);
                    a.primitive.transform->is_inverse = i % 3 == 2;
                    if (a.primitive.transform->is_inverse) a.ray.origin = rounded(a.ray.origin, format.parameters);
                    CAPTURE(i, format.name, a.ray.origin.x, a.ray.direction.x);
                    const auto steps = measure::answer::measure_steps(row, format, a.ray, a.primitive);
                    if (!format.is_emulated() && steps.t.back())
                        REQUIRE(ask(row, format, a).t == std::ldexp(steps.t.back()->hi + steps.t.back()->lo,
                                                                    static_cast<int>(steps.t.back()->exponent)));
                    if (!std::ranges::all_of(steps.t, [](const auto& t) { return t.has_value(); })) continue;
                    const std::int64_t ulp = ulp_exponent(format.parameters, steps.t[0]->floor_log2());
                    double sum = 0, size = 0;
                    for (std::size_t k = 0; k < measure::answer::step_count; ++k)
                        sum += steps.error(k, ulp), size += std::fabs(steps.error(k, ulp));
                    const double whole = measure::truth::scaled_difference(*steps.t.back(), *steps.t.front(), ulp);
                    REQUIRE(std::fabs(sum - whole) <= 1e-9 * (1 + size));
                    // Other methods also need the matrix to the world, and invert it.
                    if (a.primitive.transform->is_inverse && space.info->name == "plain")
                        REQUIRE(std::fabs(steps.error(0, ulp)) < 1e-6);
                    if (row.info->name.ends_with("@plain") && steps.worst())
                        REQUIRE(std::fabs(steps.error(*steps.worst(), ulp)) <= size);
                }
            }
        }
    }
}

}  // namespace test_spaces
