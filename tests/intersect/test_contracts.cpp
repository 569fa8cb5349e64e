// Contracts of the forms.
#include <set>
#include <string>
#include <string_view>

#include "catch.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/form_shape.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::test {

using intersect::Info;

TEST_CASE("every form has a name, a title and a source, and the table keeps the catalogue's order",
          "[intersect][info]") {
    std::set<std::string> names, titles;
    std::size_t i = 0;
    intersect::for_each_form([&]<class Form>() {
        const Info& info = Form::info;
        INFO(info.name);
        const std::string shape = std::string(name_of(intersect::shape_of<Form>)) + '.';
        CHECK(names.emplace(info.name).second);
        // Several forms of the other shapes do the same operations in another order. Their sources differ, not their
        // titles.
        if (intersect::shape_of<Form> <= Shape::triangle) CHECK(titles.insert(shape + std::string(info.title)).second);
        CHECK(info.name.starts_with(shape));
        CHECK(info.name.size() > shape.size());
        CHECK(info.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_", shape.size()) ==
              std::string_view::npos);
        CHECK_FALSE(info.title.empty());
        CHECK_FALSE(info.source.empty());

        const intersect::table::Intersector& row = intersect::table::catalogue()[i++];
        CHECK(row.info == &Form::info);
        CHECK(row.native32 != nullptr);
        CHECK(row.ball != nullptr);
        CHECK(row.interval != nullptr);
        CHECK((row.log != nullptr) == intersect::marches<Form>);
        const bool everywhere = Form::info.formats == intersect::Formats::all;
        CHECK((row.native64 != nullptr) == everywhere);
        CHECK((row.rounded != nullptr) == everywhere);
        CHECK(row.exists_in(*find_format("f32")));
        for (const char* format : {"f64", "fp16", "bf16", "tf32", "p24", "p53"})
            CHECK(row.exists_in(*find_format(format)) == everywhere);
        // Boxes, triangles and marches have more rules.
        if (intersect::shape_of<Form> == Shape::box)
            CHECK((info.direction == intersect::Direction::any && info.roots == intersect::Roots::both && everywhere));
        if (intersect::shape_of<Form> == Shape::triangle) CHECK(info.roots == intersect::Roots::first_only);
        if (intersect::marches<Form>)
            CHECK((info.direction == intersect::Direction::unit && info.roots == intersect::Roots::first_only));
    });
    CHECK(i == intersect::table::catalogue().size());
}

TEST_CASE("the seed's forms come first, and every form has the contract it documents", "[intersect][info]") {
    const char* first[] = {"sphere.schoolbook",  "sphere.schoolbook_strict", "sphere.expanded",
                           "sphere.unit_half_b", "sphere.hearn_baker",       "sphere.press",
                           "sphere.unified",     "sphere.unified_unit",      "sphere.early_exit"};
    const auto rows = intersect::table::intersectors(Shape::sphere);
    for (std::size_t i = 0; i < std::size(first); ++i) CHECK(rows[i].info->name == first[i]);

    const auto names_where = [&](auto property, Shape shape = Shape::sphere) {
        std::set<std::string_view> names;
        for (const intersect::table::Intersector& row : intersect::table::intersectors(shape))
            if (property(*row.info)) names.insert(row.info->name);
        return names;
    };
    using Names = std::set<std::string_view>;
    CHECK(names_where([](const Info& f) { return f.direction == intersect::Direction::unit; }) ==
          Names{"sphere.unit_half_b", "sphere.unified_unit", "sphere.pythagoras"});
    CHECK(names_where([](const Info& f) { return f.roots == intersect::Roots::near_only; }) ==
          Names{"sphere.unit_half_b", "sphere.expanded"});
    CHECK(names_where([](const Info& f) { return f.roots == intersect::Roots::first_only; }) ==
          Names{"sphere.early_exit", "sphere.filtered"});
    CHECK(names_where([](const Info& f) { return f.touching == intersect::Touching::miss; }) ==
          Names{"sphere.schoolbook_strict", "sphere.two_step"});
    CHECK(names_where([](const Info& f) { return f.at_origin == intersect::AtOrigin::miss; }) ==
          Names{"sphere.pbrt_interval"});
    CHECK(names_where([](const Info& f) { return f.formats == intersect::Formats::binary32_only; }) ==
          Names{"sphere.double_inside"});
    CHECK(names_where([](const Info& f) { return f.touching == intersect::Touching::miss; }, Shape::box) ==
          Names{"box.baseline", "box.exclusive"});
    CHECK(names_where([](const Info& f) { return f.at_origin == intersect::AtOrigin::miss; }, Shape::triangle) ==
          Names{"triangle.undivided", "triangle.woop", "triangle.woop_double", "triangle.woop_once", "triangle.pbrt",
                "triangle.baldwin_weber"});
}

}  // namespace lostbits::test
