// Measurements of marches: the parts of their error, their records, and one ray in detail.
#include <cmath>

#include "catch.hpp"
#include "measure/answer/one_ray.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/rows.hpp"
#include "number/real.hpp"

namespace lostbits::test::test_march {

using intersect::StopReason;
using measure::answer::OneRay;
using measure::evaluate::MapStudy;

namespace {

scene::file::Scene scene_of(const std::string& name, int size) { return test::load(name, size, size); }

std::vector<measure::evaluate::TestedForm> marches(const scene::file::Scene& scene,
                                                   std::initializer_list<const char*> formats) {
    std::vector<measure::evaluate::TestedForm> tested_forms;
    for (const intersect::table::Intersector& form : intersect::table::intersectors()) {
        if (form.shape != Shape::sdf || !scene.accepts(form.shape)) continue;
        for (const char* format : formats) tested_forms.push_back({&form, *find_format(format)});
    }
    return tested_forms;
}

/// Checks the results of a band ray by ray.
class Checker {
public:
    explicit Checker(int max_steps) : max_steps_(max_steps) {}
    void add_band(const measure::evaluate::BandResult& result) {
        for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
            const intersect::MarchRecord& m = result.answers->march[i];
            const double ulps = result.metrics[0][i], model = result.metrics[1][i], rounding = result.metrics[2][i],
                         input = result.metrics[3][i];
            wrong += m.iterations < 1 || m.iterations > max_steps_;
            wrong += (m.stop == StopReason::hit) != (result.answers->hit[i] != 0);
            wrong += (m.stop == StopReason::max_steps || m.stop == StopReason::stagnated) && m.iterations != max_steps_;
            wrong += result.metrics[4][i] != m.iterations || result.metrics[5][i] != static_cast<double>(m.stop);
            if (result.outcomes[i] != measure::answer::Outcome::agree_hit) {
                wrong += !std::isnan(ulps);
                continue;
            }
            if (std::isnan(model)) {
                ++without_self;
                continue;
            }
            ++compared;
            wrong +=
                !(std::fabs(model + rounding + input - ulps) <= 1e-6 * (1 + std::fabs(model) + std::fabs(rounding)));
        }
    }
    int wrong = 0, compared = 0, without_self = 0;

private:
    int max_steps_;
};

}  // namespace

TEST_CASE("input, model and rounding error of a march sum to its total error", "[measure][march]") {
    const auto scene = scene_of("sdf-union", 24);
    MapStudy request{.scene = &scene, .tested_forms = marches(scene, {"f32", "f64", "bf16"}), .metrics = {}};
    for (const char* name : {"ulp_error", "model_error", "rounding_error", "input_error", "iterations", "stop"})
        request.metrics.push_back(measure::metric::find_metric(name));
    std::vector<Checker> checkers(request.tested_forms.size(), Checker(scene.march->max_steps));
    const auto summaries = measure::evaluate::run_map(request, measure::evaluate::show_to_each(checkers));
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        INFO(request.tested_forms[r].form->info->name << " in " << request.tested_forms[r].format.name
                                                      << ", without a value " << checkers[r].without_self);
        CHECK(checkers[r].wrong == 0);
        CHECK(checkers[r].compared > 50);  // in bf16 most of the union is missed
        CHECK(checkers[r].without_self < checkers[r].compared / 20);
        std::uint64_t stops = 0;
        for (const std::uint64_t n : summaries[r].categories[5]) stops += n;
        CHECK(stops == summaries[r].ray_count);
        CHECK(summaries[r].metrics[4].count() == summaries[r].ray_count);
    }
}

TEST_CASE("forms that do not march have no march metrics", "[measure][march]") {
    const auto scene = scene_of("sdf-sphere", 16);
    MapStudy request{.scene = &scene,
                     .tested_forms = {{&intersect::table::intersectors().front(), *find_format("f32")}},
                     .metrics = {measure::metric::find_metric("lost_bits"), measure::metric::find_metric("iterations"),
                                 measure::metric::find_metric("stop")}};
    const auto summary = std::move(measure::evaluate::run_map(request).front());
    CHECK(summary.metrics[0].count() > 0);
    CHECK(summary.metrics[1].count() == 0);
    CHECK(summary.categories[2] == std::vector<std::uint64_t>(intersect::stop_names.size(), 0));
}

TEST_CASE("refining the answer removes the model error", "[measure][march]") {
    const auto scene = scene_of("sdf-sphere", 24);
    MapStudy request{.scene = &scene,
                     .tested_forms = marches(scene, {"f64"}),
                     .metrics = {measure::metric::find_metric("model_error")}};
    const auto summaries = measure::evaluate::run_map(request);
    const double plain = summaries[0].metrics[0].quantile(0.5);
    int refined = 0;
    for (std::size_t r = 0; r < request.tested_forms.size(); ++r) {
        if (!request.tested_forms[r].form->info->name.ends_with("_refined")) continue;
        ++refined;
        CHECK(summaries[r].metrics[0].quantile(0.5) < plain / 1000);
    }
    CHECK(refined == 2);
    // hit_eps over the cosine of incidence, in ulps of a t between 2 and 4: at least hit_eps / 2 of 2^-51 for most.
    CHECK(plain > 1e-5 / 0x1p-51);
    CHECK(plain < 1e-2 / 0x1p-51);
}

TEST_CASE("mixed primitives are hit by marches and by forms that cover all of their shapes", "[measure][march]") {
    const auto scene = scene_of("sdf-union", 8);
    CHECK(scene.accepts(Shape::sdf));
    CHECK_FALSE(scene.accepts(Shape::sphere));
    CHECK_FALSE(scene.accepts(Shape::box));
    CHECK(scene.accepts(Shapes(scene.shapes())));
    CHECK(scene.shapes() == std::vector{Shape::sphere, Shape::box});
    CHECK_FALSE(scene_of("near-benign", 8).accepts(Shape::sdf));
}

TEST_CASE("explaining one ray gives the values of its pixel in the map", "[measure][march]") {
    const auto scene = scene_of("sdf-union", 16);
    const intersect::table::Intersector& form = intersect::table::intersectors(Shape::sdf).front();
    measure::truth::Band band(scene, 0, 16);
    const auto inputs = band.inputs(*find_format("f32"), {.unit_rays = true, .stored_truth = false});
    const measure::answer::Answers all = measure::answer::evaluate(form, inputs);
    for (const auto& [x, y] : {std::pair{3, 4}, std::pair{8, 9}, std::pair{15, 0}}) {
        const OneRay one(scene, x, y);
        const intersect::table::MarchLog log = measure::answer::record_march(form, *find_format("f32"), one);
        const std::size_t i = static_cast<std::size_t>(y * 16 + x);
        CHECK(log.hit.hit == (all.hit[i] != 0));
        if (log.hit.hit) CHECK(log.hit.t == all.t[i]);
        CHECK(static_cast<int>(log.steps.size()) == all.march[i].iterations);
        CHECK(log.stop == all.march[i].stop);
        CHECK(one.find_truth(*form.info).is_hit() == band.truth(i, intersect::Touching::hit).is_hit());
        const Ray<double> ray = inputs.rays[i];
        const auto exact = [](const Vec<double>& v) { return Vec<Real>(Real(v.x), Real(v.y), Real(v.z)); };
        const OneRay again(scene, Ray<Real>{exact(ray.origin), exact(ray.direction)});
        CHECK(measure::answer::record_march(form, *find_format("f32"), again).hit.t == log.hit.t);
    }
    CHECK_THROWS_AS(OneRay(scene, 16, 0), InputError);
    CHECK_THROWS_AS(OneRay(scene, 0, -1), InputError);
}

}  // namespace lostbits::test::test_march
