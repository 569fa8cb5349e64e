// A tree of boxes never leaves out a primitive that the ray meets: over all exponents, for every shape. It changes no
// form's answer.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/table/sets.hpp"
#include "intersect/table/union_field.hpp"
#include "measure/answer/answers.hpp"
#include "measure/culling/box_tree.hpp"
#include "measure/culling/sort_by_index.hpp"
#include "measure/truth/band.hpp"
#include "measure/truth/truth_columns.hpp"
#include "number/random.hpp"
#include "number/rounded.hpp"
#include "scene/rays/rays.hpp"
#include "shapes/bounding_box.hpp"

namespace lostbits::test::test_box_tree {

using measure::culling::BoxTree;
using measure::truth::find_truth;
using measure::truth::Truth;
using scene::rays::PrimitiveList;

namespace {

class RandomPoints {
public:
    explicit RandomPoints(std::uint64_t seed) : engine_(seed) {}
    double in(double low, double high) { return low + (high - low) * engine_.unit(); }
    /// From −1 to 1, a third of the time 0 or an end, like vertices and directions of real scenes.
    double component() {
        const double x = in(-1.5, 1.5);
        return x < -1 ? -1 : x > 1 ? 1 : std::fabs(x) < 0.1 ? 0 : x;
    }
    Vec<double> point(double size) { return {size * component(), size * component(), size * component()}; }

private:
    Random engine_;
};

/// A third triangles, a third boxes, and of the last third each shape in turn.
std::vector<Primitive<double>> primitives_of(RandomPoints& draw, double size) {
    std::vector<Primitive<double>> all;
    while (all.size() < 96) {
        const Vec<double> at = draw.point(size);
        const double part = size * std::exp2(-draw.in(0, 6));
        Primitive<double> primitive = primitive_around(shape_rows[all.size() / 3 % shape_rows.size()].shape, at, part);
        if (all.size() % 3 == 0) {
            primitive = Triangle<double>{at + draw.point(part), at + draw.point(part), at + draw.point(part)};
        } else if (all.size() % 3 == 1) {
            const Vec<double> lo = at + draw.point(part), more = draw.point(part);
            primitive = Box<double>{lo, lo + Vec<double>(std::fabs(more.x), std::fabs(more.y), std::fabs(more.z))};
        }
        if (!broken_limit(primitive)) all.push_back(primitive);
    }
    return all;
}

/// A corner of a triangle or a box, else a point on the way from the middle out.
Vec<double> target(const Primitive<double>& primitive, bool first) {
    if (has_bounding_box(primitive.shape) && !length_key(primitive.shape)) return primitive.point(first ? 0 : 3);
    const auto ball = ball_around(primitive);
    return ball.centre + Vec<double>(0, first ? 0 : std::min(ball.radius, length(ball.centre)), 0);
}

}  // namespace

TEST_CASE("a tree of boxes finds every primitive that a ray meets", "[culling]") {
    std::size_t met = 0, candidate_count = 0, pairs = 0;
    for (int round = 0; round < 60; ++round) {
        RandomPoints draw(static_cast<std::uint64_t>(round) + 1);
        // Squares of the truth's polynomials must not leave the doubles' range only in the tree: sizes 2^-90 to 2^90.
        const double size = std::exp2(std::floor(draw.in(-90, 90))), away = size * std::exp2(draw.in(-2, 20));
        const std::vector<Primitive<double>> primitives = primitives_of(draw, size);
        scene::rays::RayBlock rays;
        for (int i = 0; i < 40; ++i) {
            const Vec<double> origin = i % 4 == 0 ? target(primitives[i], true) : draw.point(away);
            const std::size_t at = static_cast<std::size_t>(draw.in(0, 95.9));
            Vec<double> direction = i % 5 == 0 ? draw.point(1) : target(primitives[at], i % 2 == 0) - origin;
            if (direction == Vec<double>(0, 0, 0)) direction = {0, 0, 1};
            rays.push({origin, direction * std::exp2(std::floor(draw.in(-60, 60)))});
        }
        rays.width = 40, rays.y1 = 1;
        const auto tree = BoxTree::make(PrimitiveList<double>(primitives), measure::culling::bounds_of(rays), nullptr);
        REQUIRE(tree);
        std::vector<std::uint32_t> found;
        // Rays that walk down the tree together have the same candidates as alone. There are more of them than walk at
        // a time.
        const measure::culling::CandidateLists lists(*tree, rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            tree->find_candidates(rays[i], found);
            CHECK(std::ranges::equal(lists.candidates_of(i), found));
            CHECK(std::ranges::is_sorted(found));
            CHECK(std::ranges::adjacent_find(found) == found.end());
            candidate_count += found.size(), pairs += primitives.size();
            for (std::uint32_t s = 0; s < primitives.size(); ++s) {
                if (!find_truth(rays[i], primitives[s]).is_hit()) continue;
                ++met;
                INFO("round " << round << ", ray " << i << ", solid " << s);
                CHECK(std::ranges::binary_search(found, s));
            }
        }
    }
    CHECK(met > 2000);
    CHECK(candidate_count < pairs / 2);  // and it spares most of the others
}

TEST_CASE("rays that walk down a tree in several groups have the candidates of each ray alone", "[culling]") {
    RandomPoints draw(11);
    std::vector<Ray<double>> rays;
    for (int i = 0; i < 700; ++i) rays.push_back({draw.point(8), draw.point(1)});
    rays[3].direction = {0, 0, 0};
    rays[300].origin.x = std::nan("");
    rays[699].origin.y = 0x1p1020;
    const auto tree = BoxTree::make(PrimitiveList<double>(primitives_of(draw, 1)), {8, 1, 1}, nullptr);
    REQUIRE(tree);
    std::vector<std::uint32_t> all{77}, one, expected{77};
    std::vector<std::size_t> ends(rays.size());
    tree->append_candidates(rays, all, ends);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        tree->find_candidates(rays[i], one);
        expected.insert(expected.end(), one.begin(), one.end());
        CHECK(ends[i] == expected.size());
    }
    CHECK(all == expected);
}

TEST_CASE("a long list is sorted by its indices as a short one is, and equal indices keep their order", "[culling]") {
    RandomPoints draw(5);
    for (const double most : {1.0, 700.0, 5e6, 4294967295.0})
        for (const std::size_t count :
             {std::size_t{0}, std::size_t{1}, std::size_t{512}, std::size_t{513}, std::size_t{9000}}) {
            std::vector<std::pair<std::uint32_t, std::size_t>> list, expected;
            for (std::size_t i = 0; i < count; ++i) list.emplace_back(static_cast<std::uint32_t>(draw.in(0, most)), i);
            expected = list;
            std::ranges::sort(expected);
            measure::culling::sort_by_index(list, [](const auto& one) { return one.first; });
            CHECK(list == expected);
        }
}

TEST_CASE("the truth through a tree equals the truth among all primitives", "[culling]") {
    RandomPoints draw(7);
    const std::vector<Primitive<double>> primitives = primitives_of(draw, 1);
    scene::rays::RayBlock rays;
    for (int i = 0; i < 500; ++i) {
        const Vec<double> origin = draw.point(4), to = target(primitives[static_cast<std::size_t>(i) % 96], i % 2 == 0);
        if (to != origin) rays.push({origin, to - origin});
    }
    rays.width = static_cast<int>(rays.size()), rays.y1 = 1;
    const PrimitiveList<double> list(primitives);
    const auto tree = BoxTree::make(list, measure::culling::bounds_of(rays), nullptr);
    measure::truth::RayTruths quick, slow;
    find_truths({rays, list, tree.get()}, {}, quick);
    find_truths({rays, list}, {}, slow);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        CHECK(quick[i].decision == slow[i].decision);
        CHECK(quick[i].primitive == slow[i].primitive);
        CHECK(compare(quick[i].t, slow[i].t) == 0);
    }
}

namespace {

/// Many spheres, and of every other shape some.
std::vector<Primitive<double>> mixed_primitives(RandomPoints& draw) {
    std::vector<Primitive<double>> all;
    for (int i = 0; i < 60; ++i) all.push_back(primitive_around(Shape::sphere, draw.point(8), draw.in(0.1, 1)));
    for (const ShapeRow& row : shape_rows)
        for (int i = 0; i < (row.is_ball ? 0 : 4); ++i)
            all.push_back(primitive_around(row.shape, draw.point(8), draw.in(0.1, 1)));
    const auto as_float = [](double x) { return static_cast<double>(static_cast<float>(x)); };
    for (Primitive<double>& primitive : all) primitive = convert_numbers(primitive, as_float);
    return all;
}

/// Form number k of each shape, starting again at the first form if the shape has fewer. Null if these forms cannot be
/// a set. Quartics in t are left out: they hit a torus that a ray passes at a distance, where no renderer tests it.
const intersect::table::Intersector* set_number(std::size_t k) {
    constexpr std::array quartics_in_t{"torus.graphics_gems", "torus.quilez"};
    std::vector<const intersect::table::Intersector*> parts;
    for (const ShapeRow& row : shape_rows) {
        std::vector<const intersect::table::Intersector*> forms;
        for (const auto& form : intersect::table::intersectors(row.shape))
            if (std::ranges::find(quartics_in_t, form.info->name) == quartics_in_t.end()) forms.push_back(&form);
        parts.push_back(forms[k % forms.size()]);
    }
    return intersect::table::refusal_of_set(parts).empty() ? &intersect::table::find_or_add_set(parts) : nullptr;
}

/// Compares sets of forms, in float and double, with the tree and without; returns how many answers were compared.
std::size_t compare_sets(const measure::truth::Band& quick, const measure::truth::Band& slow) {
    std::size_t compared = 0;
    for (const char* const name : {"f32", "f64"}) {
        const Format format = *find_format(name);
        const auto in = quick.inputs(format, {.unit_rays = true}), all = slow.inputs(format, {.unit_rays = true});
        REQUIRE(in.candidates);
        CHECK(in.candidates->pair_count() < in.rays.size() * in.primitives.size() / 4);
        for (std::size_t k = 0; k < 24; ++k) {
            const intersect::table::Intersector* const set = set_number(k);
            if (set == nullptr || !set->exists_in(format)) continue;
            const auto got = measure::answer::evaluate(*set, in), want = measure::answer::evaluate(*set, all);
            INFO(set->info->name << " in " << name);
            CHECK(got.hit == want.hit);
            CHECK(got.primitive == want.primitive);
            CHECK(std::ranges::equal(got.t, want.t, [](double a, double b) { return a == b || (a != a && b != b); }));
            ++compared;
        }
    }
    return compared;
}

}  // namespace

TEST_CASE("a tree over spheres, planes and all other shapes changes no answer", "[culling]") {
    for (const double away : {10.0, 200.0}) {
        RandomPoints draw(11);
        scene::rays::RayGroup group;
        group.primitives = mixed_primitives(draw);
        for (int i = 0; i < 600; ++i) {
            const Vec<double> to =
                ball_around(group.primitives[static_cast<std::size_t>(i) % 60]).centre + draw.point(1);
            const Vec<double> origin = draw.point(away);
            group.rays.push({origin, to - origin});
        }
        group.rays = scene::rays::round_block(group.rays, binary32);
        group.rays.width = 600, group.rays.y1 = 1;
        measure::culling::Culler culler(PrimitiveList<double>(group.primitives), group.rays);
        REQUIRE(dynamic_cast<const BoxTree*>(culler.index_for_truth()));
        const measure::truth::Band quick(group, {}, &culler), slow(group);
        for (std::size_t i = 0; i < quick.pixel_count(); ++i) {
            const Truth a = quick.truth(i, {}), b = slow.truth(i, {});
            CHECK(a.decision == b.decision);
            CHECK(a.primitive == b.primitive);
            if (a.is_hit() && b.is_hit()) CHECK(compare(a.t, b.t) == 0);
        }
        CHECK(compare_sets(quick, slow) > 30);
    }
}

namespace {

/// Closed and open meshes, with edges of three faces and faces given twice, in planes of two axes: some 500 triangles
/// about the origin, within 1 of it, in units of 2^power of a format.
std::shared_ptr<const scene::rays::StoredMesh> mesh_of(RandomPoints& draw, int power, const FloatFormat& format) {
    auto mesh = std::make_shared<scene::triangle::Mesh>();
    const auto scaled = [&](double x) { return rounding::to_format(std::ldexp(x, power), 0, format); };
    constexpr std::uint32_t side = 13;
    const auto add_grid = [&](double bump, int up) {
        const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
        for (std::uint32_t i = 0; i < side * side; ++i) {
            Vec<double> v(i % side / 6.0 - 1, i / side / 6.0 - 1, bump * draw.in(-1, 1));
            if (up > 0) std::swap(v[up - 1], v.z);
            mesh->vertices.push_back({scaled(v.x), scaled(v.y), scaled(v.z)});
        }
        for (std::uint32_t i = 0; i + side < side * side; ++i) {
            if (i % side == side - 1 || draw.in(0, 1) < 0.25) continue;
            const std::uint32_t a = first + i, b = a + 1, c = a + side, d = c + 1;
            mesh->faces.push_back({a, b, d}), mesh->faces.push_back({a, d, c});
        }
    };
    add_grid(0, 0), add_grid(0, 1), add_grid(0.5, 2);
    for (std::size_t i = 0; i < 20; ++i) mesh->faces.push_back(mesh->faces[7 * i]);
    scene::triangle::merge_and_count(*mesh, [](std::size_t i) { return std::to_string(i); });
    const auto inputs =
        format.precision == binary32.precision ? scene::file::InputRounding::shared : scene::file::InputRounding::own;
    return std::make_shared<const scene::rays::StoredMesh>(mesh, std::nullopt, inputs);
}

/// A component of a direction of any exponent that the format has.
double any_length(RandomPoints& draw, const FloatFormat& format) {
    const int low = format.emin - format.precision + 2;
    return std::exp2(std::floor(draw.in(0, 1) < 0.5 ? draw.in(-30, 30) : draw.in(low, format.emax - 1)));
}

/// A ray at a vertex, a point of an edge or of a face, from near and far, along an axis, in a plane of faces, from a
/// vertex or from anywhere; its direction of any length.
Ray<double> ray_at(RandomPoints& draw, const Triangle<double>& face, double size, const FloatFormat& format) {
    const int kind = static_cast<int>(draw.in(0, 6));
    const double u = kind == 0 ? 0 : draw.in(0, 1), v = kind <= 1 ? 0 : draw.in(0, 1 - u);
    const Vec<double> at = face.a + u * (face.b - face.a) + v * (face.c - face.a);
    Vec<double> from = at + draw.point(size * std::exp2(draw.in(-3, 8)));
    if (kind == 3) from = face.b;
    if (kind == 4) from = at, from[static_cast<int>(draw.in(0, 2.99))] += size * std::exp2(draw.in(-3, 8));
    if (kind == 5) from = face.a + draw.in(-4, 4) * (face.b - face.a) + draw.in(-4, 4) * (face.c - face.a);
    const auto stored = [&](double x) { return rounding::to_format(x, 0, format); };
    from = {stored(from.x), stored(from.y), stored(from.z)};
    Vec<double> d = at - from;
    const double most = std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
    if (most == 0) d = {0, 0, 1};
    else d = d / most * any_length(draw, format);
    d = {stored(d.x), stored(d.y), stored(d.z)};
    if (d == Vec<double>(0, 0, 0)) d = {0, 0, std::exp2(format.emin)};
    return {from, d};
}

}  // namespace

TEST_CASE("one tree over a mesh for all rays changes neither the truth nor a tie at any scale", "[culling]") {
    std::size_t hits = 0, ties = 0, candidate_count = 0, pairs = 0;
    for (const FloatFormat& format : {binary32, binary64}) {
        for (const int power : {0, -20, 30, -90, 90, -300, 300}) {
            if (std::abs(power) > 90 && format.precision == binary32.precision) continue;
            RandomPoints draw(static_cast<std::uint64_t>(power + 1000));
            scene::rays::RayGroup group;
            group.mesh = mesh_of(draw, power, format);
            for (int i = 0; i < lostbits::test::draws(2000); ++i) {
                const auto face = static_cast<std::size_t>(draw.in(0, static_cast<double>(group.mesh->size()) - 0.5));
                group.rays.push(ray_at(draw, group.mesh->mesh().triangle(face), std::ldexp(1.0, power), format));
            }
            group.rays.mark_as_list();
            const PrimitiveList<double> primitives = scene::rays::primitive_list_of(group);
            const measure::culling::Culler of_all(primitives);
            measure::culling::Culler culler(of_all, group.rays);
            REQUIRE(culler.index_for_truth());
            const measure::truth::Band quick(group, {}, &culler), slow(group);
            std::vector<std::uint32_t> found;
            for (std::size_t i = 0; i < quick.pixel_count(); ++i) {
                INFO("2^" << power << ", " << format.precision << " bits, ray " << i);
                const Truth a = quick.truth(i, {}), b = slow.truth(i, {});
                CHECK(a.decision == b.decision);
                CHECK(a.primitive == b.primitive);
                culler.index_for_truth()->find_candidates(group.rays[i], found);
                candidate_count += found.size(), pairs += primitives.size();
                if (!a.is_hit() || !b.is_hit()) continue;
                CHECK(compare(a.t, b.t) == 0);
                ++hits;
                for (std::uint32_t s = 0; s < primitives.size(); ++s) {
                    const Truth one = find_truth(group.rays[i], primitives[s]);
                    if (!one.is_hit()) continue;
                    CHECK(std::ranges::binary_search(found, s));
                    ties += static_cast<int>(s) != a.primitive && compare(one.t, a.t) == 0;
                }
            }
        }
    }
    CHECK(hits > 1000);
    CHECK(ties > 500);
    CHECK(candidate_count < pairs / 4);
}

TEST_CASE("the nearest primitive in a tree is the nearest of all", "[culling]") {
    RandomPoints draw(21);
    for (const int power : {0, -60, 60}) {  // at 2^300 the squares of a distance overflow
        scene::rays::RayGroup group;
        group.mesh = mesh_of(draw, power, binary64);
        const PrimitiveList<double> primitives = scene::rays::primitive_list_of(group);
        const auto tree = BoxTree::make(primitives, {HUGE_VAL, 0, HUGE_VAL}, nullptr);
        REQUIRE(tree);
        for (int i = 0; i < 200; ++i) {
            const Vec<double> p = draw.point(std::ldexp(draw.in(0, 3), power));
            const auto distance = [&](std::size_t s) {
                return std::fabs(intersect::table::distance(primitives[s], p));
            };
            std::uint32_t first = 0;
            for (std::uint32_t s = 1; s < primitives.size(); ++s)
                if (distance(s) < distance(first)) first = s;
            CHECK(distance(tree->nearest(p, distance)) == distance(first));
        }
    }
}

TEST_CASE("a primitive without a box is a candidate for every ray", "[culling]") {
    const Ray<double> away{{0, 0, 5}, {0, 0, 1}};
    const Primitive<double> flat = Triangle<double>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                            ground = Plane<double>{{0, 0, 0}, {0, 0, 1}}, ball = Sphere<double>{{0, 0, 0}, 1},
                            huge = Sphere<double>{{0, 0, 0}, 1e200};
    const measure::culling::RayBounds bounds{5, 1, 1};
    std::vector<std::uint32_t> found;
    BoxTree::make(PrimitiveList<double>({flat, ground, ball, huge}), bounds, &binary64)->find_candidates(away, found);
    CHECK(found == std::vector<std::uint32_t>{1, 3});
    CHECK_FALSE(BoxTree::make(PrimitiveList<double>({ground}), bounds, nullptr));
    // Bounds on rays matter only to forms that square lengths.
    const measure::culling::RayBounds none{HUGE_VAL, 0, HUGE_VAL};
    BoxTree::make(PrimitiveList<double>({flat, ball}), none, nullptr)->find_candidates(away, found);
    CHECK(found.empty());
    BoxTree::make(PrimitiveList<double>({flat, ball}), none, &binary64)->find_candidates(away, found);
    CHECK(found == std::vector<std::uint32_t>{1});
    CHECK_FALSE(BoxTree::make(PrimitiveList<double>(std::vector<Primitive<double>>{}), bounds, nullptr));
    std::vector<Primitive<double>> grounds(BoxTree::max_unboxed_primitives, ground);
    grounds.push_back(flat);
    CHECK(BoxTree::make(PrimitiveList<double>(grounds), bounds, nullptr));
    grounds.push_back(ground);
    CHECK_FALSE(BoxTree::make(PrimitiveList<double>(grounds), bounds, nullptr));
}

}  // namespace lostbits::test::test_box_tree
