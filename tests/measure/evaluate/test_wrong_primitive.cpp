// A hit of another primitive than the first one that the ray meets: a separate outcome, for which no error is measured.
#include <array>
#include <cmath>

#include "catch.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/evaluate/summary_columns.hpp"
#include "measure/rows.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::test::test_wrong_primitive {

using measure::answer::Outcome;
using measure::evaluate::FormSummary;

namespace {

/// Counts the outcomes of a band independently.
class Recount {
public:
    void add_band(const measure::evaluate::BandResult& result) {
        for (std::size_t i = 0; i < result.outcomes.size(); ++i) {
            const auto truth = result.truth(i);
            const bool both = truth.is_hit() && result.answers->hit[i] != 0 && !std::isnan(result.answers->t[i]);
            const bool other = both && truth.primitive != result.answers->primitive[i];
            wrong += other;
            mistaken += other != (result.outcomes[i] == Outcome::wrong_primitive);
            mistaken += (result.outcomes[i] == Outcome::agree_hit) != (both && !other);
            for (const auto& values : result.metrics)
                mistaken += std::isnan(values[i]) != (result.outcomes[i] != Outcome::agree_hit);
        }
    }
    std::uint64_t wrong = 0, mistaken = 0;
};

}  // namespace

TEST_CASE("a hit of the wrong primitive is not an agreed hit, and its error is not measured", "[outcome]") {
    const auto scene = test::load("rtg-fig-7-6-far", 96, 96);
    const measure::evaluate::MapStudy request{
        .scene = &scene,
        .tested_forms = {test::row("sphere.schoolbook", "f32"), test::row("sphere.schoolbook", "f64")},
        .metrics = {measure::metric::find_metric("lost_bits"), measure::metric::find_metric("ulp_error")}};
    std::array<Recount, 2> counts;
    const auto& [single, wide] = counts;
    const auto summaries = measure::evaluate::run_map(request, measure::evaluate::show_to_each(counts));
    CHECK(single.wrong > 500);
    CHECK(wide.wrong == 0);
    CHECK(single.mistaken + wide.mistaken == 0);

    const FormSummary& s = summaries.front();
    CHECK(s.count(Outcome::wrong_primitive) == single.wrong);
    CHECK(s.metrics[0].count() == s.count(Outcome::agree_hit));
    CHECK(s.agreement().agreed_count == s.count(Outcome::agree_hit));
    CHECK(s.agreement().true_hit_count == s.true_hit_count);
    CHECK(s.true_hit_count ==
          s.count(Outcome::agree_hit) + s.count(Outcome::wrong_primitive) + s.count(Outcome::false_miss));
    // The wrong primitive is the most frequent wrong decision here, so the first fault is such a ray.
    CHECK(s.most_frequent_wrong_decision() == Outcome::wrong_primitive);
    REQUIRE(s.first_fault() != nullptr);
    CHECK(s.first_fault()->outcome == Outcome::wrong_primitive);
    CHECK(s.first_fault()->t != s.first_fault()->truth);

    const auto columns = measure::evaluate::make_summary_columns(request.metrics);
    CHECK(measure::evaluate::find_column(columns, "wrong_primitive")->value(s) == static_cast<double>(single.wrong));
    CHECK(measure::evaluate::find_column(columns, "wrong_primitive_fraction")->value(s) ==
          static_cast<double>(single.wrong) / static_cast<double>(s.true_hit_count));
    REQUIRE(s.count(Outcome::unresolved) == 0);
    CHECK(measure::evaluate::find_column(columns, "wrong_fraction")->value(s) ==
          static_cast<double>(s.ray_count - s.count(Outcome::agree_hit) - s.count(Outcome::agree_miss)) /
              static_cast<double>(s.ray_count));
}

}  // namespace lostbits::test::test_wrong_primitive
