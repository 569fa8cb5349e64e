// Rays that each have their own primitive, measured together and alone: in files of rays, and as distributions draw
// them. The metrics and counts of a ray do not depend on the rays beside it.
#include <algorithm>
#include <cmath>
#include <map>

#include "measure/judge/files_of_answers.hpp"
#include "measure/judge/judge.hpp"
#include "measure/metric/metric_set.hpp"
#include "measure/rows.hpp"
#include "scene/sweep/distributions.hpp"
#include "shapes/number_names.hpp"

namespace test_alone {
using namespace lostbits;
using namespace lostbits::measure;
using evaluate::FormSummary, evaluate::TestedForm, metric::Metric;
using scene::rays::RayGroup;

namespace {

RayGroup ray_of(const RayGroup& from, std::size_t i) {
    RayGroup one = scene::rays::make_group(from.rays[i]);
    one.rays.push_range(from.rays, i);
    one.primitives = {from.primitives[from.is_paired ? i : 0]};
    return one;
}

/// A ray of the easy distribution, then some rays that miss another primitive, then more of both: a miss is seldom
/// measured at the primitive of the first ray.
std::vector<RayGroup> rays_at(const scene::sweep::DistributionRow& distribution) {
    const auto drawn = distribution.ray_sets().front().groups();
    const auto timed = distribution.draw_timed_rays();
    std::vector<RayGroup> all{ray_of(drawn.at(0), 0)};
    for (std::size_t i = 0; i < 5; ++i) all.push_back(ray_of(timed.misses, i));
    for (std::size_t i = 1; i < 5; ++i) all.push_back(ray_of(drawn.at(i % drawn.size()), i / drawn.size()));
    for (std::size_t i = 0; i < 2; ++i) all.push_back(ray_of(timed.hits, i));
    return all;
}

/// All metrics of the table that need one form, with the operations of these rows.
std::vector<const Metric*> all_of(const std::vector<TestedForm>& tested_forms, const RayGroup& rays,
                                  metric::MetricSet& made) {
    std::vector<const Metric*> all;
    for (const Metric& m : metric::metrics())
        if (m.domain != metric::MetricDomain::pairs) all.push_back(&m);
    return made.adapt_to_forms(all, evaluate::forms_of(tested_forms), attribution::OwnedSetting(rays).get());
}

bool are_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Results of each row for each ray: the outcome, then the metrics.
using Found = std::map<std::pair<std::size_t, std::uint64_t>, std::vector<double>>;

/// The rays as a file with one primitive for each ray.
std::vector<FormSummary> judged(const std::vector<RayGroup>& rays, const std::vector<TestedForm>& tested_forms,
                                const std::vector<const Metric*>& metrics, std::uint64_t first, Found& found) {
    scene::rays::RayBlock block;
    for (const RayGroup& one : rays) block.push(one.rays[0]);
    scene::test::Columns columns = test::make_ray_columns(block);
    const Shape shape = rays.front().primitives.front().shape;
    for (std::size_t k = 0; k < row_of(shape).number_count; ++k) {
        std::vector<double> column;
        for (const RayGroup& one : rays) column.push_back(one.primitives.front().numbers[k]);
        columns.add(column_names(shape)[k], column);
    }
    const scene::test::ScratchRayFile file("own.bin", scene::test::to_bytes<float>(columns));
    const auto ray_file = scene::ray_file::open_ray_file(file.path(), {.columns = columns.joined_names(":f32")});
    const auto show = [&](std::size_t row, const scene::ray_file::Chunk& chunk, const evaluate::BandResult& result) {
        for (std::size_t i = 0; i < chunk.size(); ++i) {
            auto& values = found[{row, first + chunk.first + i}];
            values = {static_cast<double>(result.outcomes[i])};
            for (const auto& of_metric : result.metrics) values.push_back(of_metric[i]);
        }
    };
    // Rows of one piece are shown at the same time.
    const test::Threads one(1);
    return judge::run_judge(*ray_file, {.tested_forms = tested_forms, .metrics = metrics}, show).summaries;
}

/// All counts that claims may use.
void require_sum(const FormSummary& together, const std::vector<FormSummary>& alone) {
    FormSummary sum;
    sum.outcomes = {};
    sum.categories = std::vector<std::vector<std::uint64_t>>(together.categories.size());
    for (const FormSummary& one : alone) {
        sum.ray_count += one.ray_count, sum.true_hit_count += one.true_hit_count;
        for (std::size_t o = 0; o < sum.outcomes.size(); ++o) sum.outcomes[o] += one.outcomes[o];
        for (std::size_t m = 0; m < sum.categories.size(); ++m) {
            sum.categories[m].resize(one.categories[m].size());
            for (std::size_t c = 0; c < one.categories[m].size(); ++c) sum.categories[m][c] += one.categories[m][c];
        }
    }
    CHECK(together.ray_count == sum.ray_count);
    CHECK(together.true_hit_count == sum.true_hit_count);
    CHECK(together.outcomes == sum.outcomes);
    CHECK(together.categories == sum.categories);
    for (std::size_t m = 0; m < together.metrics.size(); ++m) {
        std::uint64_t count = 0;
        double largest = NAN;
        for (const FormSummary& one : alone) {
            count += one.metrics[m].count();
            largest = std::fmax(largest, one.metrics[m].quantile(1));
        }
        CHECK(together.metrics[m].count() == count);
        CHECK(are_same(together.metrics[m].quantile(1), largest));
    }
}

}  // namespace

TEST_CASE("a ray with its own primitive has the same metrics alone, in a file and in a distribution", "[alone]") {
    std::uint64_t misses = 0, values = 0;
    for (const scene::sweep::DistributionRow& distribution : scene::sweep::distributions()) {
        const std::vector<RayGroup> rays = rays_at(distribution);
        const auto rows = test::all_rows(distribution.shape, {"f32"});
        metric::MetricSet made;
        const auto metrics = all_of(rows, rays.front(), made);

        Found together, alone;
        const auto of_file = judged(rays, rows, metrics, 0, together);
        std::vector<std::vector<FormSummary>> of_rays(rows.size()), of_groups(rows.size());
        for (std::size_t i = 0; i < rays.size(); ++i) {
            auto one = judged({rays[i]}, rows, metrics, i, alone);
            auto group = evaluate::measure_groups({rays[i]}, rows, metrics, {});
            for (std::size_t r = 0; r < rows.size(); ++r) {
                of_rays[r].push_back(std::move(one[r]));
                of_groups[r].push_back(std::move(group[r]));
            }
        }
        const auto of_distribution = evaluate::measure_groups(rays, rows, metrics, {});
        for (std::size_t r = 0; r < rows.size(); ++r) {
            INFO(rows[r].form->info->name);
            misses += of_file[r].count(answer::Outcome::agree_miss);
            require_sum(of_file[r], of_rays[r]);
            require_sum(of_distribution[r], of_groups[r]);
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const auto &a = together.at({r, i}), &b = alone.at({r, i});
                REQUIRE(a.size() == metrics.size() + 1);
                CHECK(a[0] == b[0]);
                for (std::size_t m = 0; m < metrics.size(); ++m) {
                    INFO("ray " << i << ", " << metrics[m]->name << ": " << a[m + 1] << " and alone " << b[m + 1]);
                    CHECK(are_same(a[m + 1], b[m + 1]));
                    values += !std::isnan(a[m + 1]);
                }
            }
        }
    }
    CHECK(misses > 500);
    CHECK(values > 30000);
}

}  // namespace test_alone
