// Forms that do not receive a range, used as a renderer uses them: an answer in the range counts, and a root that the
// form does not return is lost.
#include <set>
#include <string_view>

#include "catch.hpp"
#include "intersect/table/in_range.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/rows.hpp"
#include "measure/seeded.hpp"
#include "measure/widths.hpp"

namespace lostbits::test::test_forms_in_range {

using intersect::Roots;
using intersect::Touching;
using measure::answer::Outcome;
using scene::rays::RayGroup;

namespace {

/// A ray along an axis, whose roots are 2 and 8, or 2 alone for flat shapes, in every arithmetic: nothing is rounded.
RayGroup plain_ray(Shape shape, const Range<double>& range) {
    RayGroup group = scene::rays::make_group({{-5, 0, 0}, {1, 0, 0}});
    group.rays.tmin = {range.tmin};
    group.rays.tmax = {range.tmax};
    group.rays.open_ends = range.open_ends;
    if (shape == Shape::sphere) group.primitives = {Primitive<double>(Sphere<double>{{0, 0, 0}, 3})};
    else if (shape == Shape::box) group.primitives = {Primitive<double>(Box<double>{{-3, -3, -3}, {3, 3, 3}})};
    else if (shape == Shape::triangle)
        group.primitives = {Primitive<double>(Triangle<double>{{-3, -8, -8}, {-3, 0, 16}, {-3, 8, -8}})};
    else if (shape == Shape::ellipsoid) group.primitives = {Primitive<double>(Ellipsoid<double>{{0, 0, 0}, {3, 2, 4}})};
    else if (shape == Shape::cylinder)
        group.primitives = {Primitive<double>(Cylinder<double>{{0, 0, -4}, {0, 0, 4}, 3})};
    else if (shape == Shape::capsule) group.primitives = {Primitive<double>(Capsule<double>{{0, 0, -4}, {0, 0, 4}, 3})};
    else if (shape == Shape::tube) group.primitives = {Primitive<double>(Tube<double>{{0, 0, -4}, {0, 0, 4}, 3})};
    else if (shape == Shape::cone) group.primitives = {Primitive<double>(Cone<double>{{0, 0, -4}, {0, 0, 4}, 4, 2})};
    else if (shape == Shape::disc) group.primitives = {Primitive<double>(Disc<double>{{-3, 0, 0}, {1, 0, 0}, 4, 0})};
    else if (shape == Shape::torus) group.primitives = {Primitive<double>(Torus<double>{{-8, 0, 0}, {0, 1, 0}, 8, 3})};
    else group.primitives = {Primitive<double>(Plane<double>{{-3, 1, 0}, {1, 0, 0}})};
    return group;
}

Outcome outcome_of(const intersect::table::Intersector& form, const char* format, RayGroup group) {
    const auto summaries = measure::evaluate::measure_groups({std::move(group)}, {{&form, *find_format(format), {}}},
                                                             {measure::metric::find_metric("lost_bits")}, {});
    for (const Outcome o : {Outcome::agree_hit, Outcome::agree_miss, Outcome::false_hit, Outcome::false_miss})
        if (summaries[0].count(o) == 1) return o;
    return Outcome::unresolved;
}

/// All ranges between these numbers, with every kind of end.
template <class Use>
void for_each_range(const Use& use) {
    for (const double tmin : {0.0, 1.0, 2.0, 5.0, 8.0, 9.0})
        for (const double tmax : {0.0, 1.0, 2.0, 5.0, 8.0, 9.0, HUGE_VAL})
            for (const auto& [name, open] : open_ends_names) use(Range<double>{tmin, tmax, open});
}

/// The rays at the plain primitive of a shape.
RayGroup at_primitive(scene::rays::RayBlock rays, Shape shape) {
    RayGroup group;
    group.rays = std::move(rays);
    group.rays.width = static_cast<int>(group.rays.size());
    group.rays.y1 = 1;
    group.primitives = plain_ray(shape, {}).primitives;
    return group;
}

template <class Use>
void for_each_form(const Use& use) {
    for (const intersect::table::Intersector& form : intersect::table::catalogue()) {
        if (!is_primitive(form.shape) || !form.exists_in(*find_format("f32"))) continue;
        INFO(form.info->name);
        use(form);
    }
}

void check_equal(const measure::answer::Answers& a, const measure::answer::Answers& b) {
    CHECK(a.hit == b.hit);
    CHECK(std::ranges::equal(a.t, b.t, [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); }));
}

/// By hand: the surface is at 2 and 8, and a box contains all between; a flat shape is at 2. If a touch is a miss, a
/// ray may not end where it enters an inside.
bool meets(Shape shape, bool closed, const Range<double>& r) {
    if (!r.holds_any()) return false;
    const auto in = [&r](double t) { return !r.is_before(t) && !r.is_after(t); };
    if (shape == Shape::triangle || shape == Shape::disc || shape == Shape::plane) return in(2);
    if (!inside_returns_zero(shape)) return (in(2) && (closed || !has_inside(shape) || r.tmax > 2)) || in(8);
    if (closed) return in(2) || in(8) || (r.tmin < 8 && r.tmax > 2);
    return r.tmin < 8 && r.tmax > 2;
}

/// Forms that pad a box. A range that begins at the far end, or ends at the near one, keeps the width of the padding,
/// which makes a false hit.
const std::set<std::string_view> pads_an_end{"box.max_mult", "box.pbrt_padded", "box.bvh_robust", "box.embree_padded"};
/// A ray that ends at its entry is not a hit by the form's properties.
constexpr std::string_view open_at_the_end = "box.tinybvh";

}  // namespace

TEST_CASE("forms with both roots decide as the truth in every range, and forms with one lose the far root",
          "[measure][range]") {
    std::size_t right = 0, lost = 0;
    for_each_form([&](const intersect::table::Intersector& form) {
        if (pads_an_end.contains(form.info->name)) return;
        const bool closed = form.info->touching == Touching::hit, open_box = form.shape == Shape::box && !closed;
        for_each_range([&](const Range<double>& range) {
            // A third has no format, and a division by 3 rounds.
            const auto is_root = [](double t) { return t == 2 || t == 8; };
            const bool rounds = form.shape == Shape::ellipsoid || form.info->name == "torus.quilez";  // 1/k0
            if (rounds && (is_root(range.tmin) || is_root(range.tmax))) return;
            const bool hit = meets(form.shape, closed, range);
            // A strict tmin < tmax excludes a range of a single t, which an open box can still contain.
            if (open_box && range.tmin == range.tmax) return;
            if (form.info->name == open_at_the_end && range.tmax == 2) return;
            // If only the far root is in the range, a form that does not return it has no answer. A box has no such
            // case: its nearest point is the beginning of the range.
            const bool far_alone = !inside_returns_zero(form.shape) && form.shape != Shape::triangle && hit &&
                                   (range.is_before(2) || range.is_after(2));
            const bool loses =
                far_alone && form.info->roots != Roots::both && form.info->inside != intersect::Inside::near;
            INFO("from " << range.tmin << " to " << range.tmax << ", open " << name_of(range.open_ends));
            const Outcome got = outcome_of(form, "f32", plain_ray(form.shape, range));
            if (form.info->inside == intersect::Inside::near && far_alone) return;  // by its property there is no hit
            CHECK(got == (loses ? Outcome::false_miss : hit ? Outcome::agree_hit : Outcome::agree_miss));
            (loses ? lost : right) += 1;
        });
    });
    CHECK(right > 3000);
    CHECK(lost > 50);
}

TEST_CASE("a range of everything ahead changes no answer", "[measure][range]") {
    test::Seeded rng(1);
    for_each_form([&rng](const intersect::table::Intersector& form) {
        scene::rays::RayBlock rays;
        for (int i = 0; i < 300; ++i) {
            const Vec<double> origin = test::stored(rng.vec(-3, 3), binary32);
            rays.push({origin, test::stored(rng.vec(-1, 1), binary32)});
        }
        const measure::truth::Band without(at_primitive(rays, form.shape));
        rays.tmin.assign(rays.size(), 0);
        rays.tmax.assign(rays.size(), HUGE_VAL);
        const measure::truth::Band with(at_primitive(rays, form.shape));
        const bool unit = form.info->direction == intersect::Direction::unit;
        const auto answers = [&](const measure::truth::Band& band) {
            return measure::answer::evaluate(form, band.inputs(*find_format("f32"), {.unit_rays = unit}));
        };
        check_equal(answers(without), answers(with));
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto x = without.truth(i, form.info->convention()), y = with.truth(i, form.info->convention());
            REQUIRE(x.decision == y.decision);
            REQUIRE((x.t.hi == y.t.hi && x.t.lo == y.t.lo && x.t.bound == y.t.bound && x.proof_bits == y.proof_bits));
        }
    });
}

TEST_CASE("answers in a range agree in packs and ray by ray", "[measure][range]") {
    test::Seeded rng(2);
    for_each_form([&rng](const intersect::table::Intersector& form) {
        scene::rays::RayBlock rays;
        for (int i = 0; i < 600; ++i) {
            const Vec<double> origin = test::stored(rng.vec(-6, 6), binary32);
            rays.push({origin, test::stored(Vec<double>(rng.vec(-2, 2) - origin), binary32)});
            const double tmin = test::stored(rng.uniform(0, 1.5), binary32);
            rays.tmin.push_back(tmin);
            rays.tmax.push_back(test::stored(tmin + rng.uniform(0, 1), binary32));
        }
        const measure::truth::Band band(at_primitive(std::move(rays), form.shape));
        const auto inputs = band.inputs(*find_format("f32"), {.unit_rays = true});
        std::optional<measure::answer::Answers> first;
        test::at_every_width([&](intersect::simd::Isa) {
            const auto answers = measure::answer::evaluate(form, inputs);
            if (!first) first = answers;
            check_equal(answers, *first);
            CHECK(std::ranges::count(answers.hit, 1) > 10);
        });
    });
}

TEST_CASE("a root beyond the format's largest number is not an entry at the end of a ray", "[range]") {
    for (const Roots roots : {Roots::both, Roots::near_only}) {
        intersect::Info info = *test::form_named("sphere.unified").info;
        info.roots = roots;
        info.touching = Touching::miss;
        float t = HUGE_VALF, near = t, far = t;
        const float tmin = 1;
        std::uint8_t hit = 1;
        const float zero = 0, one = 1;
        const auto alone = [](const float& x) { return std::span<const float>(&x, 1); };
        const intersect::table::RayBatch<float> ray{.ox = alone(zero),
                                                    .oy = alone(zero),
                                                    .oz = alone(zero),
                                                    .dx = alone(one),
                                                    .dy = alone(zero),
                                                    .dz = alone(zero),
                                                    .tmin = alone(tmin)};
        intersect::table::limit_batch_to_range<float>(info, Shape::sphere, ray,
                                                      {{&t, 1}, {&near, 1}, {&far, 1}, {&hit, 1}});
        CHECK(hit == 1);
    }
}

}  // namespace lostbits::test::test_forms_in_range
