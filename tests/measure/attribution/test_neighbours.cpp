// Better forms for a ray are ranked on the rays around it, to average out luck.
#include <algorithm>
#include <cmath>

#include "catch.hpp"
#include "measure/attribution/explanation.hpp"
#include "measure/attribution/operation_error.hpp"
#include "measure/rows.hpp"
#include "measure/truth/lost_bits.hpp"

namespace test_neighbours {

using namespace lostbits;
using intersect::table::Intersector;
using measure::answer::OneRay;
using measure::answer::Outcome;
using measure::attribution::Explanation;
using measure::attribution::FormResult;
using test::form_named;
using test::scene_named;

namespace {

const Format f32 = *find_format("f32");

std::vector<double> numbers_of(const Ray<double>& ray) {
    return {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z};
}

/// Bits that a form loses on one ray, from its answer and the truth; all bits if it decides wrongly.
double lost(const Intersector& form, const OneRay& ray) {
    const OneRay::Inputs in = ray.inputs(form, f32);
    const auto answers = measure::answer::evaluate(form, in.format_inputs);
    const bool hit = answers.hit[in.index] != 0, truly = ray.find_truth(*form.info).is_hit();
    if (hit != truly || (hit && std::isnan(answers.t[in.index]))) return 24;
    if (!hit) return 0;
    return measure::truth::lost_bits(
        measure::truth::ulp_error(answers.t[in.index], ray.true_t(*form.info), f32.parameters), 24);
}

}  // namespace

TEST_CASE("neighbours differ by at most an ulp per number, keep zeros and repeat in every run") {
    const auto scene = scene_named("rtg-fig-7-3-4100");  // along the axis: the eye has zeros
    const Intersector& form = form_named("sphere.schoolbook");
    const OneRay ray(scene, 100, 128);
    const OneRay::Inputs in = ray.inputs(form, f32);
    const std::vector<Primitive<double>> primitives{in.format_inputs.primitives[0]};
    const auto around = measure::attribution::make_neighbours(ray, in, f32.parameters, primitives),
               again = measure::attribution::make_neighbours(ray, in, f32.parameters, primitives);
    REQUIRE(around.size() == measure::attribution::neighbour_count);
    const auto middle = numbers_of(in.format_inputs.rays[in.index]);
    std::vector<int> down(6), up(6);
    for (std::size_t k = 0; k < around.size(); ++k) {
        const auto here = around[k].inputs(form, f32), same = again[k].inputs(form, f32);
        CHECK(around[k].is_unrounded(here));  // numbers of the format
        const auto x = numbers_of(here.format_inputs.rays[here.index]);
        CHECK(x == numbers_of(same.format_inputs.rays[same.index]));
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double ulps = (x[i] - middle[i]) / measure::attribution::ulp_at(middle[i], f32.parameters);
            CHECK((ulps == -1 || ulps == 0 || ulps == 1));
            if (middle[i] == 0) CHECK(x[i] == 0);
            down[i] += ulps < 0;
            up[i] += ulps > 0;
        }
    }
    int zeros = 0;
    for (std::size_t i = 0; i < middle.size(); ++i) {
        if (middle[i] == 0) ++zeros;
        else CHECK((down[i] > 8 && up[i] > 8));  // a third of 64 each, or so
    }
    CHECK(zeros > 0);
    CHECK(zeros < 4);
}

TEST_CASE("a better row loses less on the ray and its neighbours, and luck on one ray is not reported") {
    const auto scene = scene_named("near-benign");
    const Intersector& form = form_named("sphere.schoolbook");
    int better = 0, lucky = 0, unlucky = 0;
    for (const int x : {60, 80, 100, 120, 140, 160}) {
        const OneRay ray(scene, x, 128);
        const Explanation all = measure::attribution::explain(form, f32, ray);
        if (all.result.outcome != Outcome::agree_hit) continue;
        const OneRay::Inputs in = ray.inputs(form, f32);
        const auto around = measure::attribution::make_neighbours(ray, in, f32.parameters,
                                                                  {in.format_inputs.primitives[all.primitive_index]});
        const auto mean = [&](const Intersector& each) {
            double sum = 0;
            for (const OneRay& beside : around) sum += lost(each, beside);
            return sum / static_cast<double>(around.size());
        };
        CHECK(all.result.mean_lost_nearby == Approx(mean(form)));
        double before = 0;
        for (const FormResult& s : all.better_forms) {
            INFO(x << " " << s.form->info->name);
            CHECK(s.mean_lost_nearby == Approx(mean(*s.form)));
            CHECK(s.mean_lost_nearby < all.result.mean_lost_nearby);
            CHECK(s.mean_lost_nearby >= before);
            before = s.mean_lost_nearby;
            ++better;
            unlucky += !(lost(*s.form, ray) < all.result.lost_bits);  // loses more on this very ray
        }
        for (const Intersector& other : intersect::table::intersectors()) {
            if (other.info->roots == intersect::Roots::none || other.shape != form.shape || !other.exists_in(f32) ||
                other.info->direction != form.info->direction)
                continue;
            const bool named = std::ranges::find(all.better_forms, &other, &FormResult::form) != all.better_forms.end();
            const bool beats = lost(other, ray) < all.result.lost_bits;
            if (beats && !named) {
                ++lucky;
                CHECK(!(mean(other) < all.result.mean_lost_nearby));
            }
        }
    }
    CHECK(better > 20);
    CHECK(lucky + unlucky > 0);  // otherwise the ranking on the ray alone would be enough
}

}  // namespace test_neighbours
