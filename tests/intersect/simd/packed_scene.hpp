// Primitives and rays of every shape for rows that must give the same answers, to the bit. That covers hit, t, near and
// far, even if hit is false: the same operations on the same numbers leave the same numbers.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

#include "catch.hpp"
#include "intersect/simd/packed.hpp"
#include "number/draw.hpp"

namespace lostbits::test {

inline constexpr float untouched = -12345;
inline constexpr std::size_t widest = 16;

/// Rays against one primitive, as columns.
template <class S>
struct Scene {
    Primitive<S> primitive;
    std::vector<S> column[6];
    std::vector<S> tmax;  ///< empty: no ray ends

    void add(const std::array<S, 6>& ray) {
        for (std::size_t i = 0; i < 6; ++i) column[i].push_back(ray[i]);
    }
    [[nodiscard]] std::size_t size() const { return column[0].size(); }
};

/// Numbers that end at the end of a page, before a page that must not be touched: reading one number too many is a
/// fault.
template <class S>
class CornerRays {
public:
    explicit CornerRays(std::span<const S> x) : size_(x.size()) {
        if (x.size_bytes() > page || memory_ == MAP_FAILED || mprotect(memory_ + page, page, PROT_NONE) != 0)
            FAIL("no page that ends where a column does");
        std::copy(x.begin(), x.end(), data());
    }
    CornerRays(const CornerRays&) = delete;
    CornerRays& operator=(const CornerRays&) = delete;
    ~CornerRays() { munmap(memory_, 2 * page); }
    [[nodiscard]] std::span<const S> span() const { return {data(), size_}; }

private:
    [[nodiscard]] S* data() const { return reinterpret_cast<S*>(memory_ + page) - size_; }

    const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    char* memory_ =
        static_cast<char*>(mmap(nullptr, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    std::size_t size_;
};

/// Answers with a margin behind them that no kernel may touch.
template <class S>
struct Answers {
    std::vector<S> t, near, far;
    std::vector<std::uint8_t> hit;
    std::size_t size;

    explicit Answers(std::size_t n) : t(n + widest, untouched), near(t), far(t), hit(n + widest, 77), size(n) {}
    intersect::table::HitBatch<S> batch() {
        return {std::span(t).first(size), std::span(near).first(size), std::span(far).first(size),
                std::span(hit).first(size)};
    }
    [[nodiscard]] bool margin_is_untouched() const {
        for (std::size_t i = size; i < t.size(); ++i)
            if (t[i] != untouched || near[i] != untouched || far[i] != untouched || hit[i] != 77) return false;
        return true;
    }
};

template <class S>
auto kernel_of(const intersect::simd::PackedFormKernels& row) {
    if constexpr (std::same_as<S, float>) return row.f32;
    else return row.f64;
}

template <class S>
Answers<S> run(const intersect::simd::PackedFormKernels& row, const Primitive<S>& primitive,
               const intersect::table::RayBatch<S>& rays) {
    Answers<S> answers(rays.size());
    kernel_of<S>(row)(rays, primitive, answers.batch());
    return answers;
}

template <class S>
Answers<S> run(const intersect::simd::PackedFormKernels& row, const Scene<S>& scene) {
    const auto& c = scene.column;
    return run(row, scene.primitive, intersect::table::RayBatch<S>{c[0], c[1], c[2], c[3], c[4], c[5], scene.tmax});
}

template <class S>
bool same(S a, S b) {
    return std::isnan(a) ? std::isnan(b) : std::memcmp(&a, &b, sizeof a) == 0;
}

template <class S>
std::size_t count_differences(const Answers<S>& a, const Answers<S>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size; ++i)
        count +=
            a.hit[i] != b.hit[i] || !same(a.t[i], b.t[i]) || !same(a.near[i], b.near[i]) || !same(a.far[i], b.far[i]);
    return count;
}

template <class S>
constexpr FloatFormat format_of = std::same_as<S, float> ? binary32 : binary64;

/// ±0, ±∞, NaN, the least and the greatest subnormal and normal numbers, or any finite number.
template <class S>
S draw_any(Random& random) {
    const FloatFormat f = format_of<S>;
    return static_cast<S>(random.one_in(3) ? draw_special(random, f) : draw_finite(random, f));
}

/// A primitive about the origin whose numbers are close to those of the plainest one.
template <class S>
Primitive<S> draw_primitive(Random& random, Shape shape) {
    const auto at = [&] { return static_cast<S>(8 * random.unit() - 4); };
    const S x = at(), y = at(), z = at();
    const auto half = static_cast<S>(std::ldexp(1 + random.unit(), static_cast<int>(random.between(-4, 2))));
    Primitive<S> primitive = primitive_around<S>(shape, {x, y, z}, half);
    for (S& number : primitive.shape_numbers()) number *= static_cast<S>(1 + random.unit() / 64);
    if (shape == Shape::box && random.one_in(10)) primitive.numbers[3] = primitive.numbers[0];
    return primitive;
}

/// A ray at the primitive: from anywhere near it or from one of its numbers, at a point of it or past it; some
/// directions with zeros of either sign or a tiny component; one ray in three with any number at all in one place.
template <class S>
std::array<S, 6> draw_ray(Random& random, const Primitive<S>& primitive, std::size_t k) {
    const auto [middle, radius] = visit(primitive, [](const auto& s) {
        return std::pair(Vec<double>(s.middle()), static_cast<double>(s.half_extent()));
    });
    std::array<S, 6> ray;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        ray[axis] = static_cast<S>(12 * random.unit() - 6);
        const std::size_t number = axis + (random.one_in(2) ? 0 : 3);
        if (random.one_in(4) && number < primitive.shape_numbers().size()) ray[axis] = primitive.numbers[number];
        const auto target = static_cast<S>(middle[static_cast<int>(axis)] + (1.6 * random.unit() - 0.8) * radius);
        ray[axis + 3] = target - ray[axis];
        if (random.one_in(6)) ray[axis + 3] = static_cast<S>(random.sign() * (random.one_in(4) ? 1e-30 : 0.0));
    }
    // Half the time, the direction gets length one, which some forms take for granted; but not for shapes with ends,
    // which are meant for the length that was drawn.
    const double size = std::hypot(double(ray[3]), double(ray[4]), double(ray[5]));
    if (!takes_tmax(primitive.shape) && size > 0 && random.one_in(2))
        for (std::size_t axis = 3; axis < 6; ++axis) ray[axis] = static_cast<S>(static_cast<double>(ray[axis]) / size);
    if (k % 3 == 2) ray[k / 3 % 6] = draw_any<S>(random);
    return ray;
}

/// End of a ray: before, in or behind the target of `draw_ray` (t = 1), missing, or any number.
template <class S>
S draw_end(Random& random) {
    if (random.one_in(8)) return draw_any<S>(random);
    return random.one_in(4) ? std::numeric_limits<S>::infinity() : static_cast<S>(4 * random.unit());
}

/// `wild`: not a picture at all, but any number anywhere, even if it is not a valid primitive.
template <class S>
Scene<S> draw_scene(Random& random, Shape shape, std::size_t n, bool wild = false) {
    const auto any = [&random] { return draw_any<S>(random); };
    Scene<S> scene{draw_primitive<S>(random, shape), {}, {}};
    if (wild) std::ranges::generate(scene.primitive.shape_numbers(), any);
    const bool ends = takes_tmax(shape) && !random.one_in(3);
    for (std::size_t k = 0; k < n; ++k) {
        std::array<S, 6> ray = draw_ray(random, scene.primitive, k);
        if (wild) std::ranges::generate(ray, any);
        scene.add(ray);
        if (ends) scene.tmax.push_back(draw_end<S>(random));
    }
    return scene;
}

/// Number of primitives: many for the shapes with most tests, few for others: forms of tori take as long as ten others.
inline std::size_t share(Shape shape, std::size_t all) {
    return shape == Shape::sphere || shape == Shape::box ? all : shape == Shape::torus ? all / 16 : all / 4;
}

/// Lengths by one power of two and directions by another, so that t is by their quotient.
template <class S>
void move(Scene<S>& scene, int lengths, int directions) {
    const auto all_by = [](std::span<S> all, int power) {
        for (S& x : all) x = std::ldexp(x, power);
    };
    for_each_key(scene.primitive.shape, [&](const Key& key, std::size_t k) {
        if (key.kind != Key::Kind::direction) all_by(scene.primitive.shape_numbers().subspan(k, key.count()), lengths);
    });
    for (std::size_t c = 0; c < 6; ++c) all_by(scene.column[c], c < 3 ? lengths : directions);
    all_by(scene.tmax, lengths - directions);
}

/// One scene in eight is moved to where t is subnormal, one to where it overflows; `wild` scenes follow.
template <class S>
std::vector<Scene<S>> draw_scenes(Shape shape, std::size_t count) {
    std::vector<Scene<S>> all;
    Random random(512);
    const int middle = format_of<S>.emax / 2;
    for (std::size_t i = 0; i < count; ++i) {
        all.push_back(draw_scene<S>(random, shape, 192));
        const auto wobble = static_cast<int>(random.between(-4, 4));
        if (i % 8 == 3) move(all.back(), wobble - middle - 3, middle - 2);
        if (i % 8 == 7) move(all.back(), wobble + middle, 3 - middle);
    }
    for (std::size_t i = 0; i < count; ++i) all.push_back(draw_scene<S>(random, shape, 48, true));
    return all;
}

/// Least counts in a thousand answers of any form of a shape: hits at a finite t, misses, and answers that are not a
/// number; and hits of one ray against many primitives. Each is a tenth less than was measured for the form that has
/// the fewest: forms that take directions of length one have few hits, and forms whose min and max let no NaN through
/// have none.
struct Shares {
    Shape shape;
    std::size_t hits, misses, not_a_number, hits_of_many;
};
inline constexpr std::array<Shares, shape_rows.size()> least{{{Shape::sphere, 138, 180, 200, 350},
                                                              {Shape::box, 300, 495, 0, 475},
                                                              {Shape::triangle, 56, 695, 0, 100},
                                                              {Shape::ellipsoid, 238, 215, 218, 490},
                                                              {Shape::cylinder, 216, 224, 156, 360},
                                                              {Shape::capsule, 200, 530, 293, 395},
                                                              {Shape::tube, 154, 565, 145, 265},
                                                              {Shape::cone, 224, 500, 125, 370},
                                                              {Shape::disc, 187, 650, 0, 125},
                                                              {Shape::plane, 360, 270, 0, 555},
                                                              {Shape::torus, 150, 580, 0, 45}}};
inline const Shares& least_of(Shape shape) {
    const auto* const row = std::ranges::find(least, shape, &Shares::shape);
    if (row == least.end()) FAIL("no shares of " << row_of(shape).name);
    return *row;
}

struct Tally {
    std::size_t rays = 0, finite_hits = 0, misses = 0, not_a_number = 0, infinite = 0, subnormal = 0;

    template <class S>
    void note(const Answers<S>& a) {
        for (std::size_t i = 0; i < a.size; ++i) {
            ++rays;
            finite_hits += a.hit[i] == 1 && std::isfinite(a.t[i]);
            misses += a.hit[i] == 0;
            not_a_number += std::isnan(a.t[i]);
            infinite += std::isinf(a.t[i]);
            subnormal += std::fpclassify(a.t[i]) == FP_SUBNORMAL;
        }
    }
    /// Checks that the rays have the intended shares of hits, misses and NaN.
    void check(Shape shape) const {
        const Shares& shares = least_of(shape);
        CHECK(1000 * finite_hits >= shares.hits * rays);
        CHECK(1000 * misses >= shares.misses * rays);
        CHECK(1000 * not_a_number >= shares.not_a_number * rays);
    }
};

}  // namespace lostbits::test
