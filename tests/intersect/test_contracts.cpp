// What each form says of itself.
#include <set>
#include <string_view>

#include "catch.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::test {

using intersect::Info;
using intersect::sphere::SphereForms;

TEST_CASE("forms have names, titles and sources", "[intersect][info]") {
    std::set<std::string_view> names, titles;
    SphereForms::for_each([&]<class Form>() {
        const Info& info = Form::info;
        INFO(info.name);
        CHECK(names.insert(info.name).second);
        CHECK(titles.insert(info.title).second);
        CHECK(info.name.substr(0, 7) == "sphere.");
        CHECK(info.name.size() > 7);
        CHECK(info.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_", 7) == std::string_view::npos);
        CHECK_FALSE(info.title.empty());
        CHECK_FALSE(info.source.empty());
    });
    CHECK(names.size() == SphereForms::size);
}

TEST_CASE("the table shows every form in the catalogue's order", "[intersect][info]") {
    const auto rows = intersect::table::intersectors(Shape::sphere);
    REQUIRE(rows.size() == SphereForms::size);
    std::size_t i = 0;
    SphereForms::for_each([&]<class Form>() {
        const intersect::table::Intersector& row = rows[i++];
        INFO(Form::info.name);
        CHECK(row.info == &Form::info);
        CHECK(row.native32 != nullptr);
        CHECK(row.ball != nullptr);
        CHECK(row.interval != nullptr);
        const bool everywhere = Form::info.formats == intersect::Formats::all;
        CHECK((row.native64 != nullptr) == everywhere);
        CHECK((row.rounded != nullptr) == everywhere);
        CHECK(row.exists_in(*find_format("f32")));
        for (const char* format : {"f64", "fp16", "bf16", "tf32", "p24", "p53"})
            CHECK(row.exists_in(*find_format(format)) == everywhere);
    });
}

TEST_CASE("the seeds' forms come first and have the contracts of their words", "[intersect][info]") {
    const char* first[] = {"sphere.schoolbook",  "sphere.schoolbook_strict", "sphere.expanded",
                           "sphere.unit_half_b", "sphere.hearn_baker",       "sphere.press",
                           "sphere.unified",     "sphere.unified_unit",      "sphere.early_exit"};
    const auto rows = intersect::table::intersectors(Shape::sphere);
    for (std::size_t i = 0; i < std::size(first); ++i) CHECK(rows[i].info->name == first[i]);

    const auto names_where = [&](auto property) {
        std::set<std::string_view> names;
        for (const intersect::table::Intersector& row : rows)
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
}

}  // namespace lostbits::test
