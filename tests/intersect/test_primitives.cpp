// Properties of every shape: one test over the closed list.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "number/ball.hpp"
#include "number/interval.hpp"
#include "shapes/number_names.hpp"

using namespace lostbits;

namespace {

/// 1, 4, 9, …: no two numbers alike, and every limit is kept.
Primitive<double> counted_up(const ShapeRow& row) {
    Primitive<double> primitive(row.shape);
    double next = 1;
    for (double& x : primitive.shape_numbers()) x = next * next, ++next;
    for_each_key(row.shape, [&](const Key& key, std::size_t k) {
        if (key.limit == Key::Limit::non_negative_below_previous || key.limit == Key::Limit::positive_below_previous)
            primitive.numbers[k] = primitive.numbers[k - 1] - 1;
    });
    return primitive;
}

/// True if a shape has no inside: a line crosses it at one t, or at two.
template <class Of>
constexpr bool is_surface = SurfaceSpan<decltype(std::declval<Of>().span(Ray<double>())), double>;

/// True if a line may enter the primitive twice.
template <class Of>
constexpr bool is_holed = std::same_as<decltype(std::declval<Of>().span(Ray<double>())), QuarticSpan<double>>;

}  // namespace

TEST_CASE("a shape is written to its keys and read back with the same numbers in the same order") {
    for (const ShapeRow& row : shape_rows) {
        CAPTURE(row.name);
        const Primitive<double> primitive = counted_up(row);
        REQUIRE(primitive.shape_numbers().size() == row.number_count);
        CHECK(&row == &row_of(row.shape));
        CHECK(shape_named(row.name) == row.shape);
        const Primitive<double> back = visit(primitive, [](const auto& shape) { return Primitive<double>(shape); });
        CHECK(back.shape == primitive.shape);
        CHECK(back.numbers == primitive.numbers);
        CHECK(number_names(row.shape).size() == row.number_count);
        CHECK(column_names(row.shape).size() == row.number_count);
        CHECK(number_paths(row.shape).size() == row.number_count);
        std::size_t numbers = 0;
        for_each_key(row.shape, [&](const Key& key, std::size_t k) {
            CHECK(k == numbers);
            numbers += key.count();
        });
        CHECK(numbers == row.number_count);
    }
    CHECK_FALSE(shape_named("spheroid"));
}

TEST_CASE("column names are unique in a shape, and columns and keys identify the shape") {
    using Names = std::set<std::string>;
    std::vector<Names> columns, keys;
    for (const ShapeRow& row : shape_rows) {
        CAPTURE(row.name);
        Names names;
        for (std::size_t k = 0; k < row.number_count; ++k) {
            CHECK(names.insert(column_names(row.shape)[k]).second);
            for (const std::string& other : other_column_names(row.shape, k)) CHECK(names.insert(other).second);
        }
        columns.emplace_back(column_names(row.shape).begin(), column_names(row.shape).end());
        keys.emplace_back();
        for (const Key& key : row.keys) keys.back().emplace(key.name);
    }
    for (const auto& sets : {columns, keys})
        for (std::size_t a = 0; a < sets.size(); ++a)
            for (std::size_t b = 0; b < sets.size(); ++b)
                if (a != b) CHECK_FALSE(std::ranges::includes(sets[b], sets[a]));
}

TEST_CASE("a number outside its limits is reported with its key and value, and so is NaN") {
    for (const ShapeRow& row : shape_rows) {
        CAPTURE(row.name);
        const Primitive<double> good = counted_up(row);
        CHECK_FALSE(broken_limit(good));
        for_each_key(row.shape, [&](const Key& key, std::size_t first) {
            for (std::size_t k = first; k < first + key.count(); ++k) {
                for (const double bad :
                     {key.limit == Key::Limit::positive ? 0.0 : -1.0, std::numeric_limits<double>::quiet_NaN()}) {
                    Primitive<double> primitive = good;
                    primitive.numbers[k] = bad;
                    const auto broken = broken_limit(primitive);
                    const bool of_points = key.limit == Key::Limit::not_collinear_with_previous ||
                                           key.limit == Key::Limit::differs_from_previous ||
                                           key.limit == Key::Limit::not_zero;
                    if (of_points) {
                        CHECK(broken.has_value() == std::isnan(bad));
                    } else if (key.limit != Key::Limit::none) {
                        REQUIRE(broken);
                        CHECK(broken->key == &key);
                        CHECK(broken->number_index == k);
                    }
                }
            }
        });
    }
    Primitive<double> flat(Box<double>{{0, 0, 0}, {1, 0, 1}});
    CHECK_FALSE(broken_limit(flat));
    flat.numbers[1] = 2;
    REQUIRE(broken_limit(flat));
    CHECK(broken_limit(flat)->number_index == 4);
    CHECK(order_phrase(*broken_limit(flat)->key) == "lo <= hi");
}

TEST_CASE("spheres and boxes have the documented names in files and options") {
    CHECK(option_placeholder(Shape::sphere) == "CX,CY,CZ,R");
    CHECK(option_placeholder(Shape::box) == "LOX,LOY,LOZ,HIX,HIY,HIZ");
    CHECK(option_placeholder(Shape::torus) == "CX,CY,CZ,AX,AY,AZ,RMAJOR,RMINOR");
    CHECK(number_paths(Shape::sphere).back() == "sphere.radius");
    CHECK(number_names(Shape::box).front() == "lo_x");
    CHECK(column_names(Shape::sphere).front() == "cx");
    CHECK(other_column_names(Shape::sphere, 0) == std::vector<std::string>{"centre_x", "center_x"});
    CHECK(other_column_names(Shape::sphere, 3) == std::vector<std::string>{"r"});
}

namespace {

/// 1/8 of a whole number, between -4 and 4: so coarse that sums and products of a few are exact.
Vec<double> coarse(std::mt19937& random) {
    std::uniform_int_distribution<int> eighths(-32, 32);
    const auto one = [&] { return eighths(random) / 8.0; };
    return {one(), one(), one()};
}

}  // namespace

TEST_CASE("lines, points and normals of a shape are consistent") {
    std::mt19937 random(11);
    int surfaces = 0;
    for (const ShapeRow& row : shape_rows) {
        CAPTURE(row.name);
        const Primitive<double> primitive = primitive_around<double>(row.shape, {1, -2, 3}, 2);
        int met = 0, from_inside = 0;
        visit(primitive, [&](const auto& shape) {
            constexpr bool surface = is_surface<std::decay_t<decltype(shape)>>;
            CHECK((surface || Vec<double>(shape.middle()) == Vec<double>(1, -2, 3)));
            CHECK((surface || shape.half_extent() == 2));
            for (int i = 0; i < 4096; ++i) {
                const Ray<double> ray{coarse(random), coarse(random)};
                if (ray.direction == Vec<double>(0, 0, 0)) continue;
                const auto ends = ends_of(shape.span(ray));
                const auto at = [&](double t) { return Vec<double>(ray.origin + t * ray.direction); };
                if (!ends || !(surface ? ends->near <= ends->far : ends->near < ends->far)) continue;
                ++met;
                for (const double t : {ends->near, ends->far}) {
                    INFO("t = " << t);
                    CHECK(std::fabs(shape.relative_distance(at(t))) <= 0x1p-40 * (1 + std::fabs(t)));
                }
                if (!surface) {
                    const double depth = shape.relative_distance(at((ends->near + ends->far) / 2));
                    CHECK(depth <= 0);
                    if (depth == 0) continue;  // along a face
                    // The line may enter a primitive with a hole again, so the point right behind the exit is checked.
                    const double beyond = is_holed<std::decay_t<decltype(shape)>> ? 0x1p-20 : 1;
                    CHECK(shape.relative_distance(at(ends->far + beyond * (ends->far - ends->near))) > 0);
                    from_inside += shape.relative_distance(ray.origin) < 0;
                    CHECK((shape.relative_distance(ray.origin) < 0) == (ends->near < 0 && ends->far > 0));
                }
                if (ends->near <= 0) continue;
                const Vec<double> p = at(ends->near), n = shape.outward_normal(ray, p);
                CHECK(std::fabs(shape.distance(p)) <= 0x1p-40 * (1 + ends->near));
                const auto bounded = shape.bounded_point(ray, ends->near, p);
                for (int k = 0; k < 3; ++k) {
                    CHECK(std::fabs(bounded.p[k] - p[k]) <= 2 * bounded.delta[k] + 0x1p-50);
                    CHECK(bounded.delta[k] <= 0x1p-46 * (1 + ends->near));
                }
                CHECK(std::fabs(length(n) - 1) <= 0x1p-50);
                CHECK((dot(n, ray.direction) < 0 || (surface && ends->near == ends->far)));
                CHECK(std::fabs(shape.relative_distance(shape.project_onto_surface(ray, p))) <= 0x1p-50);
                // The `distance` of an ellipsoid is a bound, and a cone grows about a point across its axis.
                if (row.name == "ellipsoid" || row.name == "cone") continue;
                const double away = shape.distance(ray.origin);
                if (const auto grown = shape.scaled_about_nearest(ray.origin, 2); grown && away > 0)
                    CHECK(std::fabs(grown->distance(ray.origin) - away) <= 0x1p-40);
            }
            surfaces += surface;
            CHECK(met > (surface ? 200 : 300));
            CHECK(from_inside > (surface ? -1 : 20));
        });
    }
    CHECK(surfaces > 3);
}

TEST_CASE("the words and flags of the shape table are right for each shape") {
    for (const ShapeRow& row : shape_rows) {
        CAPTURE(row.name);
        for (const std::string_view words :
             {row.texts.simplest, row.texts.touching_ray, row.texts.degenerate, row.texts.anchor_points, row.plural})
            CHECK_FALSE(words.empty());
        // The plainest primitive is hit at 3 by a ray that comes from 5 away, as the table says.
        const Primitive<double> plainest = primitive_around<double>(row.shape, {0, 0, 0}, 2);
        const Ray<double> ray{{0, 0, -5}, {0, 0, 1}};
        CHECK(visit(plainest, [&](const auto& shape) { return ends_of(shape.span(ray))->near; }) == 3);
        CHECK(row.texts.simplest.find(row.name) != std::string_view::npos);
        const auto [centre, radius] = ball_around(plainest);
        if (row.is_ball) {
            CHECK(radius == 2);
            CHECK(Primitive<double>(Sphere<double>{centre, radius}).numbers == plainest.numbers);
        } else {
            CHECK(radius >= 2);
        }
        const auto length = length_key(row.shape);
        REQUIRE(length.has_value() == std::ranges::any_of(row.keys, [](const Key& key) { return key.count() == 1; }));
        if (length) CHECK(number_names(row.shape)[length->number_index] == length->key->name);
        CHECK_FALSE((row.is_ball && row.has_edges));
        CHECK(row.inside_returns_zero == row.takes_tmax);
    }
    CHECK_FALSE(inside_returns_zero(Shape::sdf));
    CHECK(length_key(Shape::sphere)->number_index == 3);
}

TEST_CASE("the span of a shape over balls contains its span over intervals") {
    std::mt19937 random(12);
    for (const ShapeRow& row : shape_rows) {
        CAPTURE(row.name);
        const Primitive<double> primitive = primitive_around<double>(row.shape, {1, -2, 3}, 2);
        const Interval::Precision precision(400);
        int met = 0;
        for (int i = 0; i < 2048; ++i) {
            const Ray<double> ray{coarse(random), coarse(random)};
            if (ray.direction == Vec<double>(0, 0, 0)) continue;
            const auto ends_in = [&]<class E>() {
                const auto vec = [](const Vec<double>& v) { return Vec<E>(E(v.x), E(v.y), E(v.z)); };
                return visit(convert_numbers(primitive, [](double x) { return E(x); }), [&](const auto& shape) {
                    return ends_of(shape.span(Ray<E>{vec(ray.origin), vec(ray.direction)}));
                });
            };
            const auto quick = ends_in.template operator()<Ball>();
            const auto sharp = ends_in.template operator()<Interval>();
            // Balls may leave a rim or a double root open.
            const bool open = visit(primitive, []<class Of>(const Of&) { return is_surface<Of> || is_holed<Of>; });
            REQUIRE((quick.has_value() == sharp.has_value() || (open && !quick)));
            if (!quick || !quick->near.is_bounded() || !quick->far.is_bounded()) continue;
            ++met;
            for (const auto& [ball, interval] : {std::pair(quick->near, sharp->near), {quick->far, sharp->far}}) {
                const Interval hi(ball.hi()), lo(ball.lo()), off = interval - hi - lo, radius(ball.radius());
                CHECK_FALSE((off > radius || off < -radius).is_yes());
                CHECK(ball.radius() <= 0x1p-40);
            }
        }
        CHECK(met > 100);
    }
}
