// The rows of the table compared with each other, to the bit: the machine's arithmetic and rounded numbers of the same
// format, on ordinary rays and on every kind of number that a format can hold.
#include "intersect/form_shape.hpp"
#include "intersect/simd/packed_scene.hpp"
#include "number/error.hpp"
#include "number/rounded.hpp"
#include "shapes/sphere/forms/forms.hpp"

namespace lostbits::test {

using intersect::table::Intersector;

namespace {

/// The scene in doubles, which hold the numbers of every format.
template <class S>
Scene<double> lifted(const Scene<S>& scene) {
    Scene<double> wide{convert_numbers(scene.primitive, [](S x) { return static_cast<double>(x); }), {}, {}};
    for (std::size_t c = 0; c < 6; ++c) wide.column[c].assign(scene.column[c].begin(), scene.column[c].end());
    wide.tmax.assign(scene.tmax.begin(), scene.tmax.end());
    return wide;
}

template <class Kernel, class S>
Answers<S> answers_of(const Kernel& kernel, const Scene<S>& scene) {
    const auto& c = scene.column;
    Answers<S> answers(scene.size());
    kernel(intersect::table::RayBatch<S>{c[0], c[1], c[2], c[3], c[4], c[5], scene.tmax}, scene.primitive,
           answers.batch());
    return answers;
}

template <class S>
auto native_of(const Intersector& row) {
    if constexpr (std::same_as<S, float>) return row.native32;
    else return row.native64;
}

/// True if a ray has finite numbers and an end that is a number. For others, and for misses, the filter of boxes leaves
/// whatever its steps computed; and it goes on in double from float, but in two words from a format that no register
/// has.
template <class S>
bool is_ray(const Scene<S>& scene, std::size_t i) {
    return std::ranges::all_of(scene.column, [i](const auto& all) { return std::isfinite(all[i]); }) &&
           (scene.tmax.empty() || !std::isnan(scene.tmax[i]));
}

}  // namespace

TEMPLATE_TEST_CASE("a row and its emulation in the same format give the same bits", "[intersect][bits]", float,
                   double) {
    using S = TestType;
    for (const ShapeRow& shape : shape_rows) {
        const std::vector<Scene<S>> all = draw_scenes<S>(shape.shape, share(shape.shape, 32));
        Tally total;
        for (const Intersector& row : intersect::table::intersectors(shape.shape)) {
            if (!native_of<S>(row) || !row.rounded) continue;
            Tally tally;
            std::size_t wrong = 0;
            for (const Scene<S>& scene : all) {
                const Answers<S> want = answers_of(native_of<S>(row), scene);
                const Answers<double> got =
                    answers_of([&row](const auto&... batch) { row.rounded(format_of<S>, batch...); }, lifted(scene));
                tally.note(want), total.note(want);
                const auto differ = [](S a, double b) { return !same(static_cast<double>(a), b); };
                const bool of_box = row.info->name == "box.filtered";
                for (std::size_t i = 0; i < want.size; ++i) {
                    if (of_box && !is_ray(scene, i)) continue;
                    wrong += want.hit[i] != got.hit[i];
                    if (of_box && want.hit[i] == 0) continue;
                    wrong += differ(want.t[i], got.t[i]) || differ(want.near[i], got.near[i]) ||
                             differ(want.far[i], got.far[i]);
                }
            }
            INFO(row.info->name);
            CHECK(wrong == 0);
            tally.check(shape.shape);
        }
        INFO(shape.name << ": infinite " << total.infinite << ", subnormal " << total.subnormal);
        CHECK((shape.shape != Shape::sphere || (total.infinite > 1000 && total.subnormal > 500)));
    }
}

/// Together these use all that a form may use.
using SomeForms = intersect::FormList<intersect::sphere::Schoolbook, intersect::sphere::KahanDiscriminant,
                                      intersect::sphere::PbrtInterval, intersect::sphere::TwoStep>;

TEMPLATE_TEST_CASE("forms of spheres over a fixed emulated format give the bits of their rows", "[intersect][bits]",
                   float, double) {
    using S = TestType;
    using T = std::conditional_t<std::same_as<S, float>, Rounded<24, -126, 127>, Rounded<53>>;
    const std::vector<Scene<S>> all = draw_scenes<S>(Shape::sphere, 24);
    SomeForms::for_each([&]<class Form>() {
        const Intersector& native = *std::ranges::find(intersect::table::catalogue(), &Form::info, &Intersector::info);
        std::size_t wrong = 0;
        for (const Scene<S>& scene : all) {
            const Answers<S> want = answers_of(native_of<S>(native), scene);
            for (std::size_t i = 0; i < want.size; ++i) {
                const auto at = [&](std::size_t c) { return T(static_cast<double>(scene.column[c][i])); };
                const auto number = [&](std::size_t k) { return T(static_cast<double>(scene.primitive.numbers[k])); };
                const Hit<T> got = intersect::intersect_numbers<Form, T>({{at(0), at(1), at(2)}, {at(3), at(4), at(5)}},
                                                                         number, T(HUGE_VAL));
                const auto differ = [](S a, const T& b) { return !same(static_cast<double>(a), b.value()); };
                wrong += want.hit[i] != got.hit || differ(want.t[i], got.t) || differ(want.near[i], got.near) ||
                         differ(want.far[i], got.far);
            }
        }
        INFO(Form::info.name);
        CHECK(wrong == 0);
    });
}

TEST_CASE("a row in a narrower format rounds its inputs first", "[intersect][bits]") {
    const Intersector& row = intersect::table::intersectors(Shape::sphere)[0];
    Scene<double> scene{Sphere<double>{Vec<double>(0, 0, 0), 1.0}, {}, {}};
    scene.add({0.1, 0, -5, 0, 0, 1});
    const Answers<double> got = answers_of([&row](const auto&... batch) { row.rounded(binary16, batch...); }, scene);
    const Hit<Half> want = intersect::sphere::Schoolbook::intersect(
        Ray<Half>{Vec<Half>(Half(0.1), Half(0), Half(-5)), Vec<Half>(Half(0), Half(0), Half(1))},
        Sphere<Half>{Vec<Half>(Half(0), Half(0), Half(0)), Half(1)});
    CHECK(got.hit[0] == 1);
    CHECK(got.t[0] == want.t.value());
    CHECK(Half(got.t[0]).value() == got.t[0]);
    CHECK_THROWS_AS(CurrentFormat::get(), Error);
}

}  // namespace lostbits::test
