// Rows that run the recording of a form, compared with the form compiled for the same numbers.
#include <cmath>

#include "catch.hpp"
#include "intersect/table/arithmetics.hpp"
#include "shapes/sphere/forms/forms.hpp"

namespace lostbits::test::test_recorded_rows {
namespace {

using intersect::Target;
using intersect::table::Intersector;

template <class Form>
const Intersector& row_of_form() {
    return *std::ranges::find(intersect::table::catalogue(), &Form::info, &Intersector::info);
}

/// A number that is 0, of which a ball knows only that it is less than 2^-100.
Ball almost_zero() {
    const Ball third = Ball(1) / Ball(3);
    return third - third;
}

template <class Form>
void check_open_sign() {
    const Ball zero(0), half = Ball(1) / Ball(2);
    const Ray<Ball> ray{{half, almost_zero(), zero}, {zero, Ball(1), zero}};
    const Primitive<Ball> primitive(Sphere<Ball>{{zero, zero, zero}, Ball(1)});
    const Hit<Ball> walked = row_of_form<Form>().ball(ray, primitive);
    const Hit<Ball> compiled = intersect::table::enclose_hit<Form, Ball>(ray, primitive);
    INFO(Form::info.name);
    REQUIRE((almost_zero() < zero).is_unknown());
    CHECK(walked.hit.is_yes());
    CHECK(walked.t.radius() < 0x1p-90);
    CHECK(std::fabs(walked.t.hi() - std::sqrt(0.75)) < 0x1p-50);
    CHECK(walked.t.radius() <= compiled.t.radius());
}

}  // namespace

TEST_CASE("every form works over operation counters and balls, recorded or compiled", "[intersect]") {
    for (const Intersector& row : intersect::table::catalogue()) {
        if (row.log) continue;  // marches: their target is a field
        INFO(row.info->name);
        Primitive<double> primitive(row.shape);
        primitive.numbers.fill(0.5);
        const auto as_float = [](double x) { return static_cast<float>(x); };
        const Ray<float> narrow{{3, 2, 1}, {-1, -0.5F, -0.25F}};
        const OperationCounts counts = row.count(narrow, convert_numbers(primitive, as_float), HUGE_VALF);
        CHECK(counts[Operation::add] + counts[Operation::mul] + counts[Operation::fma] > 0);
        CHECK_NOTHROW(row.ball({Vec<Ball>(Ball(3), Ball(2), Ball(1)), Vec<Ball>(Ball(-1), Ball(-0.5), Ball(-0.25))},
                               convert_numbers(primitive, [](double x) { return Ball(x); })));
    }
}

TEST_CASE("a recorded form follows both branches where an enclosure leaves a sign open", "[intersect][enclosures]") {
    check_open_sign<intersect::sphere::Press>();
}

}  // namespace lostbits::test::test_recorded_rows
