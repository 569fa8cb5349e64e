// One ray against many solids, against the forms' scalar answers one by one, to the bit.
#include "intersect/simd/packed_boxes.hpp"
#include "intersect/simd/packed_many.hpp"
#include "intersect/simd/packed_scene.hpp"

namespace lostbits::test {

using intersect::simd::Isa;

namespace {

/// Solids of one shape as columns, and where the ray ends for each.
template <class S>
struct Solids {
    std::vector<S> column[6], t;

    void add(const Solid<S>& solid, S end) {
        for (std::size_t c = 0; c < 6; ++c) column[c].push_back(solid.numbers[c]);
        t.push_back(end);
    }
};

template <class S>
struct Drawn {
    Ray<S> ray;
    Solids<S> solids;
};

template <class S>
Ray<S> ray_of(const std::array<S, 6>& r) {
    return {{r[0], r[1], r[2]}, {r[3], r[4], r[5]}};
}

/// The lowest bits of k are the signs of the direction; one ray in four is anything at all.
template <class S>
Drawn<S> draw(Random& random, Shape shape, std::size_t k, std::size_t n) {
    const Box<S> first = draw_box<S>(random);
    std::array<S, 6> numbers = draw_ray(random, first, k);
    for (std::size_t axis = 0; axis < 3; ++axis)
        numbers[3 + axis] = std::copysign(numbers[3 + axis], k >> axis & 1 ? S(-1) : S(1));
    if (k % 4 == 3)
        for (S& x : numbers) x = random.one_in(3) ? draw_any<S>(random) : x;
    Drawn<S> d{ray_of(numbers), {}};
    for (std::size_t i = 0; i < n; ++i) {
        Solid<S> solid;
        if (shape == Shape::box) {
            Box<S> box = draw_box<S>(random);
            for (int axis = 0; axis < 3; ++axis) {  // about the ray, and one of its planes at the origin
                const S shift = d.ray.origin[axis] + d.ray.direction[axis] - box.lo[axis];
                if (std::abs(shift) < S(1e6)) box.lo[axis] += shift, box.hi[axis] += shift;
                if (random.one_in(5)) box.lo[axis] = d.ray.origin[axis];
            }
            solid = box;
        } else {
            const auto near = [&](int axis) {
                return static_cast<S>(d.ray.origin[axis] + d.ray.direction[axis] + static_cast<S>(random.unit() - 0.5));
            };
            solid = Sphere<S>{{near(0), near(1), near(2)}, static_cast<S>(0.25 + random.unit())};
        }
        if (random.one_in(6))
            solid.used()[static_cast<std::size_t>(random.between(0, shape == Shape::box ? 5 : 3))] =
                draw_any<S>(random);
        d.solids.add(solid, draw_end<S>(random));
    }
    return d;
}

/// What the table's own row says of each solid by itself.
template <class S>
struct Expected {
    std::vector<S> t;
    std::vector<std::uint8_t> hit;
};

template <class S>
Expected<S> one_by_one(const intersect::simd::PackedRow& row, Shape shape, const Drawn<S>& d, std::size_t n) {
    Expected<S> e;
    for (std::size_t i = 0; i < n; ++i) {
        Scene<S> scene;
        scene.solid.shape = shape;
        for (std::size_t c = 0; c < 6; ++c) scene.solid.numbers[c] = d.solids.column[c][i];
        scene.add(
            {d.ray.origin.x, d.ray.origin.y, d.ray.origin.z, d.ray.direction.x, d.ray.direction.y, d.ray.direction.z});
        scene.tmax.push_back(d.solids.t[i]);
        const Answers<S> a = run(row, scene);
        e.hit.push_back(a.hit[0]);
        e.t.push_back(shape == Shape::sphere || a.hit[0] ? a.t[0] : d.solids.t[i]);
    }
    return e;
}

/// The first n solids, columns that end where a page ends, answers with a margin that stays.
template <class S>
Expected<S> at_once(const intersect::simd::ManyRow& row, Shape shape, const Drawn<S>& d, std::size_t n) {
    const auto first = [&](std::size_t c) { return Cornered<S>(std::span(d.solids.column[c]).first(n)); };
    const Cornered<S> c0 = first(0), c1 = first(1), c2 = first(2), c3 = first(3), c4 = first(4), c5 = first(5);
    Expected<S> e{d.solids.t, std::vector<std::uint8_t>(d.solids.t.size(), 77)};
    const auto call = [&](const auto& kernel) {
        REQUIRE(row.told_end == (shape == Shape::box));
        kernel(d.ray, {c0.span(), c1.span(), c2.span(), c3.span(), c4.span(), c5.span()}, std::span(e.t).first(n),
               std::span(e.hit).first(shape == Shape::box ? 0 : n));
    };
    if constexpr (std::same_as<S, float>) call(row.f32);
    else call(row.f64);
    bool margin = true;
    for (std::size_t i = n; i < e.t.size(); ++i) margin = margin && same(e.t[i], d.solids.t[i]) && e.hit[i] == 77;
    CHECK(margin);
    e.t.resize(n);
    e.hit.resize(n);
    return e;
}

template <class S>
void compare(Shape shape) {
    Random random(11);
    const auto native = intersect::simd::packed_rows(Isa::scalar);
    std::vector<Drawn<S>> all;
    for (std::size_t k = 0; k < 160; ++k) all.push_back(draw<S>(random, shape, k, 2 * widest + 3));
    for (std::size_t form = 0; form < native.size(); ++form) {
        if (intersect::table::intersectors()[form].shape != shape || !kernel_of<S>(native[form])) continue;
        std::size_t hits = 0, rays = 0;
        std::vector<std::size_t> wrong(intersect::simd::isa_names.size());
        for (std::size_t k = 0; k < all.size(); ++k) {
            const std::size_t n = k % (2 * widest + 1);
            const Expected<S> want = one_by_one(native[form], shape, all[k], n);
            hits += static_cast<std::size_t>(std::count(want.hit.begin(), want.hit.end(), 1));
            rays += n;
            for (const Isa isa : intersect::simd::available_isas()) {
                const Expected<S> got = at_once(intersect::simd::many_rows(isa)[form], shape, all[k], n);
                for (std::size_t i = 0; i < n; ++i)
                    wrong[static_cast<std::size_t>(isa)] +=
                        !same(got.t[i], want.t[i]) || (shape == Shape::sphere && got.hit[i] != want.hit[i]);
            }
        }
        INFO(native[form].info->name << ": " << hits << " hits of " << rays);
        CHECK(wrong == std::vector<std::size_t>(intersect::simd::isa_names.size(), 0));
        CHECK(hits > rays / 20);
        CHECK(hits < rays - rays / 20);
    }
}

}  // namespace

TEST_CASE("one ray against many boxes: the bits of the forms", "[intersect][packed]") {
    compare<float>(Shape::box);
    compare<double>(Shape::box);
}

TEST_CASE("one ray against many spheres: the bits of the forms", "[intersect][packed]") {
    compare<float>(Shape::sphere);
    compare<double>(Shape::sphere);
}

TEST_CASE("the rows for many solids are the catalogue's, each with the kernels of its shape", "[intersect][packed]") {
    const auto rows = intersect::table::intersectors();
    for (const Isa isa : {Isa::scalar, Isa::w128, Isa::w256, Isa::w512}) {
        const auto many = intersect::simd::many_rows(isa);
        INFO(name_of(isa));
        CHECK(many.size() == intersect::simd::packed_rows(isa).size());
        for (std::size_t i = 0; i < many.size(); ++i) {
            const bool solid = is_solid(rows[i].shape), has64 = rows[i].native64 != nullptr;
            CHECK(many[i].info == rows[i].info);
            CHECK(static_cast<bool>(many[i].f32) == solid);
            CHECK(static_cast<bool>(many[i].f64) == (solid && has64));
            CHECK(many[i].told_end == (rows[i].shape == Shape::box));
        }
    }
}

}  // namespace lostbits::test
