// Contracts of the forms.
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "catch.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/form_shape.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::test {

using intersect::Info;

namespace {

/// Properties of a form that follow from its type. All checks are outside of the template, so they are compiled once.
struct FormFacts {
    const Info* info;
    Shape shape;
    bool marches;
};

std::vector<FormFacts> facts_of_catalogue() {
    std::vector<FormFacts> facts;
    intersect::AllForms::for_each([&facts]<class Form>() {
        facts.push_back({&Form::info, intersect::shape_of<Form>, intersect::marches<Form>});
    });
    return facts;
}

}  // namespace

TEST_CASE("every form has a name, a title and a source, and the table keeps the catalogue's order",
          "[intersect][info]") {
    std::set<std::string> names, titles;
    std::size_t i = 0;
    for (const FormFacts& form : facts_of_catalogue()) {
        const Info& info = *form.info;
        INFO(info.name);
        const std::string shape = std::string(name_of(form.shape)) + '.';
        CHECK(names.emplace(info.name).second);
        // Several forms of the other shapes do the same operations in another order. Their sources differ, not their
        // titles.
        if (form.shape <= Shape::triangle) CHECK(titles.insert(shape + std::string(info.title)).second);
        CHECK(info.name.starts_with(shape));
        CHECK(info.name.size() > shape.size());
        CHECK(info.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_", shape.size()) ==
              std::string_view::npos);
        CHECK_FALSE(info.title.empty());
        CHECK_FALSE(info.source.empty());

        REQUIRE(i < intersect::table::catalogue().size());
        const intersect::table::Intersector& row = intersect::table::catalogue()[i++];
        CHECK(row.info == &info);
        CHECK(row.native32 != nullptr);
        CHECK(row.ball != nullptr);
        CHECK(row.interval != nullptr);
        CHECK((row.log != nullptr) == form.marches);
        const bool everywhere = info.formats == intersect::Formats::all;
        CHECK((row.native64 != nullptr) == everywhere);
        CHECK((row.rounded != nullptr) == everywhere);
        CHECK(row.exists_in(*find_format("f32")));
        for (const char* format : {"f64", "fp16", "bf16", "tf32", "p24", "p53"})
            CHECK(row.exists_in(*find_format(format)) == everywhere);
        // Boxes, triangles and marches have more rules.
        if (form.shape == Shape::box)
            CHECK((info.direction == intersect::Direction::any && info.roots == intersect::Roots::both && everywhere));
        if (form.shape == Shape::triangle) CHECK(info.roots == intersect::Roots::first_only);
        if (form.marches)
            CHECK((info.direction == intersect::Direction::unit && info.roots == intersect::Roots::first_only));
    }
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
    CHECK(names_where([](const Info& info) { return info.direction == intersect::Direction::unit; }) ==
          Names{"sphere.unit_half_b", "sphere.unified_unit", "sphere.pythagoras"});
    CHECK(names_where([](const Info& info) { return info.roots == intersect::Roots::near_only; }) ==
          Names{"sphere.unit_half_b", "sphere.expanded"});
    CHECK(names_where([](const Info& info) { return info.roots == intersect::Roots::first_only; }) ==
          Names{"sphere.early_exit", "sphere.filtered"});
    CHECK(names_where([](const Info& info) { return info.touching == intersect::Touching::miss; }) ==
          Names{"sphere.schoolbook_strict", "sphere.two_step"});
    CHECK(names_where([](const Info& info) { return info.at_origin == intersect::AtOrigin::miss; }) ==
          Names{"sphere.pbrt_interval"});
    CHECK(names_where([](const Info& info) { return info.formats == intersect::Formats::binary32_only; }) ==
          Names{"sphere.double_inside"});
    CHECK(names_where([](const Info& info) { return info.touching == intersect::Touching::miss; }, Shape::box) ==
          Names{"box.baseline", "box.exclusive"});
    CHECK(names_where([](const Info& info) { return info.at_origin == intersect::AtOrigin::miss; }, Shape::triangle) ==
          Names{"triangle.undivided", "triangle.woop", "triangle.woop_double", "triangle.woop_once", "triangle.pbrt",
                "triangle.baldwin_weber"});
}

}  // namespace lostbits::test
