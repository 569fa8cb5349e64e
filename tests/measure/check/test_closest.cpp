// A row of boxes, with and without the closest t found so far as the end of the ray.
#include "catch.hpp"
#include "measure/check/claim_subjects.hpp"
#include "number/error.hpp"

namespace test_closest {

using namespace lostbits;

TEST_CASE("passing on the closest t changes no answer of a closed form, and a changed answer is detected") {
    for (const intersect::table::Intersector& form : intersect::table::intersectors(Shape::box)) {
        INFO(form.info->name);
        if (form.info->touching == intersect::Touching::hit)
            CHECK(measure::check::measure_closest_t_difference({&form, *find_format("f32")}, 8, 1, {}) == 0);
    }
    // A form that ignores the end of the ray still agrees; a form that then hits nothing does not.
    static const intersect::Info info{.name = "box.shy", .title = "-", .source = "-"};
    intersect::table::Intersector shy = intersect::table::intersectors(Shape::box).front();
    shy.info = &info;
    shy.native32 = +[](const intersect::table::RayBatch<float>& rays, const intersect::Target<float>& target,
                       const intersect::table::HitBatch<float>& hits) {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            hits.hit[i] = rays.tmax.empty() || !(rays.tmax[i] < 1e30F);
            hits.t[i] = hits.near[i] = hits.far[i] = -target.primitives.front().numbers[0];
        }
    };
    CHECK(measure::check::measure_closest_t_difference({&shy, *find_format("f32")}, 8, 1, {}) > 0.5);
    CHECK_THROWS_AS(measure::check::measure_closest_t_difference(
                        {&intersect::table::intersectors(Shape::sphere).front(), *find_format("f32")}, 8, 1, {}),
                    InputError);
}

}  // namespace test_closest
