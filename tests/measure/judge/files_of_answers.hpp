// Rays and answers in the form of files of rays, and a comparison of two summaries of them.
#pragma once

#include <cmath>
#include <vector>

#include "catch.hpp"
#include "measure/answer/answers.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "scene/ray_file/ray_file_writer.hpp"

namespace lostbits::test {

inline const std::vector<const measure::metric::Metric*> all_metrics{
    measure::metric::find_metric("lost_bits"),      measure::metric::find_metric("ulp_error"),
    measure::metric::find_metric("relative_error"), measure::metric::find_metric("absolute_error"),
    measure::metric::find_metric("residual"),       measure::metric::find_metric("herbie_bits"),
    measure::metric::find_metric("excess_bits"),    measure::metric::find_metric("input_error")};

inline scene::test::Columns make_ray_columns(const scene::rays::RayBlock& rays) {
    scene::test::Columns columns;
    const char* const names[] = {"ox", "oy", "oz", "dx", "dy", "dz"};
    const std::vector<double>* const from[] = {&rays.ox, &rays.oy, &rays.oz, &rays.dx, &rays.dy, &rays.dz};
    for (std::size_t k = 0; k < 6; ++k) columns.add(names[k], *from[k]);
    return columns;
}

inline void add_answers(scene::test::Columns& columns, const measure::answer::Answers& answers) {
    columns.add("hit", {answers.hit.begin(), answers.hit.end()});
    columns.add("t", answers.t);
}

/// Checks for the same numbers everywhere in two summaries.
inline void require_same(const measure::evaluate::FormSummary& a, const measure::evaluate::FormSummary& b) {
    CHECK(a.ray_count == b.ray_count);
    CHECK(a.outcomes == b.outcomes);
    CHECK(a.true_hit_count == b.true_hit_count);
    REQUIRE(a.metrics.size() == b.metrics.size());
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    for (std::size_t m = 0; m < a.metrics.size(); ++m) {
        CHECK(a.metrics[m].count() == b.metrics[m].count());
        CHECK(same(a.metrics[m].mean(), b.metrics[m].mean()));
        for (const double q : {0.5, 0.99, 1.0}) CHECK(same(a.metrics[m].quantile(q), b.metrics[m].quantile(q)));
    }
    CHECK(a.worst.x == b.worst.x);
    CHECK(a.worst.y == b.worst.y);
    CHECK(a.worst.primitive_index == b.worst.primitive_index);
    CHECK(a.worst.t == b.worst.t);
    CHECK(same(a.worst.ulps, b.worst.ulps));
    REQUIRE((a.first_fault() == nullptr) == (b.first_fault() == nullptr));
    if (a.first_fault()) CHECK(a.first_fault()->x == b.first_fault()->x);
}

}  // namespace lostbits::test
