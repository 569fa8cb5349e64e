// Residuals over columns have the bits of the metric's own function, at every register width.
#include <algorithm>
#include <bit>
#include <cmath>

#include "catch.hpp"
#include "measure/columns/columns.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/widths.hpp"
#include "number/random.hpp"
#include "number/rounded.hpp"

namespace lostbits::test::test_residual_columns {

using measure::truth::missing;

namespace {

/// Source of the numbers of a scene.
enum class Range { near, far, extreme };

/// Rays that point at primitives from all sides, answers close to a surface or anywhere.
struct Scene {
    Format format;
    scene::rays::RayBlock rays;
    std::vector<Primitive<double>> primitives;
    std::vector<std::int32_t> primitive_indices;
    std::vector<double> answers;

    Scene(const char* name, Shape shape, Range range, std::size_t n, Random& random)
        : format(find_format(name).value()) {
        const auto stored = [&](double x) { return rounding::to_format(x, 0, format.parameters); };
        const int wide = range == Range::near ? 2 : range == Range::far ? 40 : format.parameters.emax - 2;
        const auto number = [&] {
            return stored(random.sign() * std::ldexp(1 + random.unit(), static_cast<int>(random.between(-wide, wide))));
        };
        for (int s = 0; s < (n % 2 == 0 ? 1 : 5); ++s) {
            if (shape == Shape::sphere) {
                primitives.emplace_back(Sphere<double>{{number(), number(), number()}, std::fabs(number())});
            } else {
                const auto pair = [&] { return std::minmax({number(), random.one_in(9) ? 0.0 : number()}); };
                const auto x = pair(), y = pair(), z = pair();
                primitives.emplace_back(Box<double>{{x.first, y.first, z.first}, {x.second, y.second, z.second}});
            }
        }
        for (std::size_t i = 0; i < n; ++i) {
            const auto primitive_index =
                static_cast<std::size_t>(random.between(0, static_cast<long>(primitives.size()) - 1));
            const Primitive<double>& primitive = primitives[primitive_index];
            const auto corner = [&](std::size_t k) {
                return primitive.numbers[shape == Shape::box && random.one_in(2) ? k + 3 : k];
            };
            Vec<double> o(number(), number(), number()), p(corner(0), corner(1), corner(2));
            if (shape == Shape::sphere)
                p.x += random.sign() * primitive.numbers[3] * (random.one_in(4) ? 1 : random.unit());
            if (random.one_in(6)) o.y = p.y;
            rays.push({o, {stored(p.x - o.x), stored(p.y - o.y), stored(p.z - o.z)}});
            double t = random.one_in(3)
                           ? 1
                           : stored(1 + std::ldexp(random.unit() - 0.5, -static_cast<int>(random.between(0, 30))));
            if (random.one_in(12)) t = number();
            if (random.one_in(40)) t = 0;
            if (range == Range::extreme && random.one_in(40)) t = HUGE_VAL;
            if (random.one_in(5)) t = missing;
            answers.push_back(t);
            primitive_indices.push_back(std::isnan(t) ? -1 : static_cast<std::int32_t>(primitive_index));
        }
    }
};

/// Checks that every ray is left to the function or has the bits of the metric; returns the share that is left.
double compare(const Scene& s) {
    std::vector<double> values(s.answers.size(), -77.0);
    std::vector<std::uint32_t> left;
    const scene::rays::PrimitiveList<double> primitives(s.primitives);
    measure::columns::compute_residual_columns(s.answers, {s.rays, primitives, s.primitive_indices, s.format.engine},
                                               values.data(), left);
    const measure::metric::Metric& metric = *measure::metric::find_metric("residual");
    std::size_t measured = 0, wrong = 0;
    auto next = left.begin();
    for (std::size_t i = 0; i < s.answers.size(); ++i) {
        const bool wanted = !std::isnan(s.answers[i]);
        measured += wanted;
        if (next != left.end() && *next == i) {
            wrong += !wanted;
            ++next;
            continue;
        }
        double want = missing;
        const Ray<double> ray = s.rays[i];
        if (wanted)
            want = metric.value({.t = s.answers[i],
                                 .format = &s.format,
                                 .ray = &ray,
                                 .primitive = &s.primitives[s.primitive_indices[i]]});
        if (std::bit_cast<std::uint64_t>(values[i]) == std::bit_cast<std::uint64_t>(want)) continue;
        if (++wrong < 5) UNSCOPED_INFO("ray " << i << ": " << std::hexfloat << values[i] << ", not " << want);
    }
    CHECK(next == left.end());
    CHECK(wrong == 0);
    return static_cast<double>(left.size()) / static_cast<double>(measured);
}

}  // namespace

TEST_CASE("columns of residuals have the bits of the metric", "[measure][columns]") {
    test::at_every_width([](intersect::simd::Isa isa) {
        if (isa == intersect::simd::Isa::scalar) return;
        Random random(1122);
        for (const char* name : {"f32", "f64"}) {
            for (const Shape shape : {Shape::sphere, Shape::box}) {
                INFO(name << ", " << name_of(shape));
                // Points exactly on a sphere are left to the function.
                CHECK(compare(Scene(name, shape, Range::near, 40'000, random)) < 0.05);
                CHECK(compare(Scene(name, shape, Range::near, 40'001, random)) < 0.05);
                CHECK(compare(Scene(name, shape, Range::far, 10'001, random)) < 0.5);
                for (int k = 0; k < 20; ++k) compare(Scene(name, shape, Range::extreme, 501, random));
            }
        }
    });
}

TEST_CASE("residuals in emulated formats or of mixed primitives are left to the metric", "[measure][columns]") {
    Random random(4);
    CHECK(compare(Scene("bf16", Shape::sphere, Range::near, 100, random)) == 1);
    Scene mixed("f32", Shape::sphere, Range::near, 101, random);
    mixed.primitives.back() = Primitive<double>(Box<double>{{0, 0, 0}, {1, 1, 1}});
    CHECK(compare(mixed) == 1);
}

}  // namespace lostbits::test::test_residual_columns
