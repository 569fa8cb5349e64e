// The rays of a distribution have a primitive for each view. Measured together they give the results of one view at a
// time.
#include <algorithm>
#include <cmath>
#include <vector>

#include "catch.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "measure/rows.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::test::test_groups {

using measure::evaluate::FormSummary;
using measure::evaluate::WorstRay;

namespace {

const std::vector<const measure::metric::Metric*> metrics = [] {
    std::vector<const measure::metric::Metric*> all;
    for (const char* name : {"lost_bits", "ulp_error", "residual", "condition", "inherent_bits", "excess_bits",
                             "rounding_error", "iterations"})
        all.push_back(measure::metric::find_metric(name));
    return all;
}();

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

void check_same(const WorstRay& a, const WorstRay& b) {
    CHECK(a.x == b.x);
    CHECK(a.y == b.y);
    CHECK(a.group == b.group);
    CHECK(a.primitive_index == b.primitive_index);
    CHECK(same(a.ulps, b.ulps));
    CHECK(same(a.t, b.t));
    CHECK(same(a.truth, b.truth));
    CHECK(a.ray.origin == b.ray.origin);
    CHECK(a.ray.direction == b.ray.direction);
    CHECK(std::ranges::equal(a.primitive.shape_numbers(), b.primitive.shape_numbers()));
    REQUIRE((a.given == nullptr) == (b.given == nullptr));
    if (!a.given) return;
    CHECK(a.given->rays[0].origin == b.given->rays[0].origin);
    CHECK(a.given->rays.tmax == b.given->rays.tmax);
    REQUIRE(a.given->primitives.size() == b.given->primitives.size());
    for (std::size_t s = 0; s < a.given->primitives.size(); ++s)
        CHECK(std::ranges::equal(a.given->primitives[s].shape_numbers(), b.given->primitives[s].shape_numbers()));
}

/// Compares a summary of all views with the sum of one summary for each view.
void check_same(const FormSummary& together, const FormSummary& summed) {
    CHECK(together.ray_count == summed.ray_count);
    CHECK(together.true_hit_count == summed.true_hit_count);
    CHECK(together.outcomes == summed.outcomes);
    CHECK(together.categories == summed.categories);
    for (std::size_t m = 0; m < metrics.size(); ++m) {
        INFO(metrics[m]->name);
        CHECK(together.metrics[m].count() == summed.metrics[m].count());
        for (const measure::metric::Statistic& statistic : measure::metric::statistics)
            CHECK(same(statistic.of(together.metrics[m]), statistic.of(summed.metrics[m])));
    }
    check_same(together.worst, summed.worst);
    for (std::size_t kind = 0; kind < together.faults.size(); ++kind) {
        REQUIRE((together.faults[kind] == nullptr) == (summed.faults[kind] == nullptr));
        if (together.faults[kind]) check_same(*together.faults[kind], *summed.faults[kind]);
    }
}

FormSummary one_at_a_time(const std::vector<scene::rays::RayGroup>& groups, const measure::evaluate::TestedForm& row) {
    FormSummary sum(metrics);
    for (std::size_t g = 0; g < groups.size(); ++g) {
        measure::truth::Band band(groups[g]);
        band.find_condition();
        const auto inputs = band.inputs(
            row.format, {.unit_rays = row.form->info->direction == intersect::Direction::unit, .stored_truth = true});
        measure::evaluate::measure_form({row, metrics, {}, static_cast<int>(g)}, band, inputs, sum);
    }
    for (auto& d : sum.metrics) d.seal();
    return sum;
}

}  // namespace

TEST_CASE("rays of many views measured together agree with one view at a time", "[sweep]") {
    std::size_t worst = 0, faults = 0, compared = 0;
    for (const auto& [sweep, at, shape] : {std::tuple{"sphere-distance", 4096.0, Shape::sphere},
                                           {"sphere-height", 16.0, Shape::sphere},
                                           {"box-distance", 64.0, Shape::box}}) {
        const std::string path = std::string(LOSTBITS_DATA_DIR "/sweeps/") + sweep + ".toml";
        const scene::sweep::SweepFile file(path, LOSTBITS_DATA_DIR);
        const std::vector<double> values(file.axes.size(), at);
        for (const int rays : {1, 3}) {
            auto groups = file.rays(values);
            REQUIRE(groups.size() > 100);
            groups.resize(100);
            if (rays == 3) {  // views of several rays, and not all of as many
                for (std::size_t g = 0; g + 1 < groups.size(); g += 2) {
                    groups[g].rays.push(groups[g].rays[0]);
                    groups[g].rays.push(groups[g + 1].rays[0]);
                    if (!groups[g].rays.tmax.empty()) groups[g].rays.tmax.resize(3, groups[g].rays.tmax[0]);
                    groups[g].rays.width = 3;
                }
            }
            for (const auto& row : test::all_rows(shape, {"f32", "f64", "p16"})) {
                INFO(sweep << ", " << row.form->info->name << " in " << row.format.name);
                const FormSummary together =
                    std::move(measure::evaluate::measure_groups(groups, {row}, metrics, {}).front());
                check_same(together, one_at_a_time(groups, row));
                CHECK(together.view_count == groups.size());
                worst += together.worst.group > 0;
                faults += together.first_fault() != nullptr;
                ++compared;
            }
        }
    }
    CHECK(compared > 200);
    CHECK(worst > 100);
    CHECK(faults > 10);
}

}  // namespace lostbits::test::test_groups
