// What every shape must say of itself: one test over the closed list.
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "catch.hpp"
#include "shapes/number_names.hpp"

using namespace lostbits;

namespace {

/// 1, 2, 3, …: no two numbers alike, and every limit is kept.
Solid<double> counted_up(const ShapeRow& row) {
    Solid<double> solid(row.shape);
    double next = 1;
    for (double& x : solid.used()) x = next++;
    return solid;
}

}  // namespace

TEST_CASE("a shape is the numbers of its keys, in their order, there and back") {
    for (const ShapeRow& row : shape_rows) {
        CAPTURE(row.name);
        const Solid<double> solid = counted_up(row);
        REQUIRE(solid.used().size() == row.numbers);
        CHECK(&row == &row_of(row.shape));
        CHECK(shape_named(row.name) == row.shape);
        const Solid<double> back = visit(solid, [](const auto& shape) { return Solid<double>(shape); });
        CHECK(back.shape == solid.shape);
        CHECK(back.numbers == solid.numbers);
        CHECK(number_names(row.shape).size() == row.numbers);
        CHECK(column_names(row.shape).size() == row.numbers);
        CHECK(number_paths(row.shape).size() == row.numbers);
        std::size_t numbers = 0;
        for_each_key(row.shape, [&](const Key& key, std::size_t k) {
            CHECK(k == numbers);
            numbers += key.count();
        });
        CHECK(numbers == row.numbers);
    }
    CHECK_FALSE(shape_named("spheroid"));
}

TEST_CASE("no name of a column or of a first key belongs to two shapes or two numbers") {
    std::set<std::string> columns, first;
    for (const ShapeRow& row : shape_rows) {
        CAPTURE(row.name);
        CHECK(first.insert(std::string(row.keys.front().name)).second);
        for (std::size_t k = 0; k < row.numbers; ++k) {
            CHECK(columns.insert(column_names(row.shape)[k]).second);
            for (const std::string& other : other_column_names(row.shape, k)) CHECK(columns.insert(other).second);
        }
    }
}

TEST_CASE("a limit that is broken is told with its key and its number, and so is NaN") {
    for (const ShapeRow& row : shape_rows) {
        CAPTURE(row.name);
        const Solid<double> good = counted_up(row);
        CHECK_FALSE(broken_limit(good));
        for_each_key(row.shape, [&](const Key& key, std::size_t first) {
            for (std::size_t k = first; k < first + key.count(); ++k) {
                for (const double bad :
                     {key.limit == Key::Limit::positive ? 0.0 : -1.0, std::numeric_limits<double>::quiet_NaN()}) {
                    Solid<double> solid = good;
                    solid.numbers[k] = bad;
                    const auto broken = broken_limit(solid);
                    if (key.limit != Key::Limit::none) {
                        REQUIRE(broken);
                        CHECK(broken->key == &key);
                        CHECK(broken->number == k);
                    }
                }
            }
        });
    }
    Solid<double> flat(Box<double>{{0, 0, 0}, {1, 0, 1}});
    CHECK_FALSE(broken_limit(flat));
    flat.numbers[1] = 2;
    REQUIRE(broken_limit(flat));
    CHECK(broken_limit(flat)->number == 4);
    CHECK(order_words(*broken_limit(flat)->key) == "lo <= hi");
}

TEST_CASE("the names that files and options have of spheres and boxes") {
    CHECK(option_words(Shape::sphere) == "CX,CY,CZ,R");
    CHECK(option_words(Shape::box) == "LOX,LOY,LOZ,HIX,HIY,HIZ");
    CHECK(number_paths(Shape::sphere).back() == "sphere.radius");
    CHECK(number_names(Shape::box).front() == "lo_x");
    CHECK(column_names(Shape::sphere).front() == "cx");
    CHECK(other_column_names(Shape::sphere, 0) == std::vector<std::string>{"centre_x", "center_x"});
    CHECK(other_column_names(Shape::sphere, 3) == std::vector<std::string>{"r"});
}
