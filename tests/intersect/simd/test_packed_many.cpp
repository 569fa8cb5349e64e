// One ray and many primitives, compared with the forms' scalar answers for each primitive, to the bit.
#include <memory>

#include "intersect/simd/packed_many.hpp"
#include "intersect/simd/packed_scene.hpp"

namespace lostbits::test {

using intersect::simd::Isa;

namespace {

/// A ray, primitives of one shape as columns, and where the ray ends for each.
template <class S>
struct DrawnPrimitives {
    std::array<S, 6> ray;
    std::array<std::vector<S>, max_number_count> column;
    std::vector<S> t;
};

/// The lowest bits of k are the signs of the direction; one ray in four is anything at all, and so is a number of one
/// primitive in six.
template <class S>
DrawnPrimitives<S> draw(Random& random, Shape shape, std::size_t k, std::size_t n) {
    DrawnPrimitives<S> d{draw_ray(random, draw_primitive<S>(random, shape), k), {}, {}};
    for (std::size_t axis = 0; axis < 3; ++axis)
        d.ray[3 + axis] = std::copysign(d.ray[3 + axis], k >> axis & 1 ? S(-1) : S(1));
    if (k % 4 == 3)
        for (S& x : d.ray) x = random.one_in(3) ? draw_any<S>(random) : x;
    for (std::size_t i = 0; i < n; ++i) {
        const auto near = [&](std::size_t axis) {
            return static_cast<S>(d.ray[axis] + d.ray[3 + axis] + static_cast<S>(random.unit() - 0.5));
        };
        Primitive<S> primitive =
            primitive_around<S>(shape, {near(0), near(1), near(2)}, static_cast<S>(0.25 + random.unit()));
        for (S& x : primitive.shape_numbers()) x *= static_cast<S>(1 + random.unit() / 64);
        if (random.one_in(5)) primitive.numbers[random.between(0, 2)] = d.ray[0];
        if (random.one_in(6))
            primitive.shape_numbers()[random.between(0, static_cast<long>(primitive.shape_numbers().size()) - 1)] =
                draw_any<S>(random);
        for (std::size_t c = 0; c < max_number_count; ++c) d.column[c].push_back(primitive.numbers[c]);
        d.t.push_back(draw_end<S>(random));
    }
    return d;
}

/// Answers of the table's own row for each primitive by itself.
template <class S>
struct Expected {
    std::vector<S> t;
    std::vector<std::uint8_t> hit;
};

template <class S>
Expected<S> one_by_one(const intersect::simd::PackedFormKernels& row, Shape shape, const DrawnPrimitives<S>& d,
                       std::size_t n) {
    Expected<S> e;
    for (std::size_t i = 0; i < n; ++i) {
        Scene<S> scene;
        scene.primitive.shape = shape;
        for (std::size_t c = 0; c < max_number_count; ++c) scene.primitive.numbers[c] = d.column[c][i];
        scene.add(d.ray);
        scene.tmax.push_back(d.t[i]);
        const Answers<S> a = run(row, scene);
        e.hit.push_back(a.hit[0]);
        e.t.push_back(!takes_tmax(shape) || a.hit[0] ? a.t[0] : d.t[i]);
    }
    return e;
}

/// The first n primitives, columns that end where a page ends, answers with a margin that stays.
template <class S>
Expected<S> at_once(const intersect::simd::ManyFormKernels& row, Shape shape, const DrawnPrimitives<S>& d,
                    std::size_t n) {
    std::array<std::unique_ptr<const CornerRays<S>>, max_number_count> columns;
    intersect::simd::PrimitiveArrays<S> primitives;
    for (std::size_t c = 0; c < row_of(shape).number_count; ++c) {
        columns[c] = std::make_unique<const CornerRays<S>>(std::span(d.column[c]).first(n));
        primitives.numbers[c] = columns[c]->span();
    }
    Expected<S> e{d.t, std::vector<std::uint8_t>(d.t.size(), 77)};
    const Ray<S> ray{{d.ray[0], d.ray[1], d.ray[2]}, {d.ray[3], d.ray[4], d.ray[5]}};
    const auto call = [&](const auto& kernel) {
        kernel(ray, primitives, std::span(e.t).first(n), std::span(e.hit).first(row.takes_tmax ? 0 : n));
    };
    if constexpr (std::same_as<S, float>) call(row.f32);
    else call(row.f64);
    bool margin = true;
    for (std::size_t i = n; i < e.t.size(); ++i) margin = margin && same(e.t[i], d.t[i]) && e.hit[i] == 77;
    CHECK(margin);
    e.t.resize(n);
    e.hit.resize(n);
    return e;
}

template <class S>
void compare(Shape shape) {
    Random random(11);
    const auto native = intersect::simd::all_packed_kernels(Isa::scalar);
    std::vector<DrawnPrimitives<S>> all;
    for (std::size_t k = 0; k < share(shape, 160); ++k) all.push_back(draw<S>(random, shape, k, 2 * widest + 3));
    for (std::size_t form = 0; form < native.size(); ++form) {
        if (intersect::table::intersectors()[form].shape != shape || !kernel_of<S>(native[form])) continue;
        std::size_t hits = 0, rays = 0;
        std::vector<std::size_t> wrong(intersect::simd::isa_names.size());
        for (std::size_t k = 0; k < all.size(); ++k) {
            const std::size_t n = 7 * k % (2 * widest + 1);  // every size for 33 draws, and large sizes for a few
            const Expected<S> want = one_by_one(native[form], shape, all[k], n);
            hits += static_cast<std::size_t>(std::count(want.hit.begin(), want.hit.end(), 1));
            rays += n;
            for (const Isa isa : intersect::simd::available_isas()) {
                const Expected<S> got = at_once(intersect::simd::all_many_kernels(isa)[form], shape, all[k], n);
                for (std::size_t i = 0; i < n; ++i)
                    wrong[static_cast<std::size_t>(isa)] +=
                        !same(got.t[i], want.t[i]) || (!takes_tmax(shape) && got.hit[i] != want.hit[i]);
            }
        }
        INFO(native[form].info->name << ": " << hits << " hits of " << rays);
        CHECK(wrong == std::vector<std::size_t>(intersect::simd::isa_names.size(), 0));
        CHECK(1000 * hits >= least_of(shape).hits_of_many * rays);
        CHECK(hits < rays - rays / 20);
    }
}

}  // namespace

TEMPLATE_TEST_CASE("kernels for one ray and many primitives give the bits of the forms", "[intersect][packed]", float,
                   double) {
    for (const ShapeRow& row : shape_rows)
        if (std::is_same_v<TestType, float> || intersect::simd::has_many_kernels(row.shape))
            compare<TestType>(row.shape);
}

TEST_CASE("rows for many primitives are the catalogue's binary64 rows, with kernels where the shape has them",
          "[intersect][packed]") {
    const auto rows = intersect::table::intersectors();
    for (const Isa isa : {Isa::scalar, Isa::w128, Isa::w256, Isa::w512}) {
        const auto many = intersect::simd::all_many_kernels(isa);
        INFO(name_of(isa));
        CHECK(many.size() == intersect::simd::all_packed_kernels(isa).size());
        for (std::size_t i = 0; i < many.size(); ++i) {
            const bool primitive = is_primitive(rows[i].shape),
                       has64 = rows[i].native64 && intersect::simd::has_many_kernels(rows[i].shape);
            CHECK(many[i].info == rows[i].info);
            CHECK(static_cast<bool>(many[i].f32) == primitive);
            CHECK(static_cast<bool>(many[i].f64) == has64);
            CHECK(many[i].takes_tmax == takes_tmax(rows[i].shape));
        }
    }
}

}  // namespace lostbits::test
