// Culprits as categories: every possible culprit has an index and a name, and colours go to those that occur.
#include "measure/attribution/culprits.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/attribution/recorded_rays.hpp"
#include "measure/evaluate/culprit_order.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/rows.hpp"

namespace lostbits::test::test_culprits {

using intersect::table::Intersector;
using measure::metric::find_metric;
using measure::metric::Metric;
using measure::metric::MetricSet;

namespace {

/// The library's setting for the rays of these tests.
lostbits::measure::attribution::Setting given(const Setting& setting) { return {setting.primitives, &setting.march}; }

}  // namespace

TEST_CASE("every culprit is an operation of its form, and an ordinary miss has none", "[culprits]") {
    int blamed = 0, misses = 0;
    const int rays = is_long() ? 40 : 10;
    const auto see = [&](const Intersector& form, const Format& format, const Setting& setting, const Tape&) {
        MetricSet made;
        const Metric* const culprit = made.adapt_to_forms({find_metric("culprit")}, {&form}, given(setting)).front();
        measure::attribution::Attributor attributor(form, format, culprit->categories);
        const measure::attribution::RayAttribution blame = attributor.attribute_ray(setting.ray, setting.target(form));
        if (measure::attribution::is_plain_miss(*blame.tape, *blame.attribution)) {
            CHECK(std::isnan(blame.culprit));
            CHECK(blame.attribution->culprit == no_node);
            ++misses;
            return;
        }
        if (blame.attribution->culprit == no_node) return;
        REQUIRE(blame.culprit >= 1);
        const auto operations = measure::attribution::operation_names(form, given(setting));
        CHECK(std::ranges::find(operations, culprit->categories[static_cast<std::size_t>(blame.culprit)]) !=
              operations.end());
        ++blamed;
    };
    on_recorded_rays({{"f32", "p12"}, rays, 1, 7}, see);
    CHECK(blamed > 37 * rays);
    CHECK(misses > 2 * rays);
}

TEST_CASE("cancellation and contributions of labels are parts of the totals", "[culprits]") {
    int cancelled = 0;
    const auto see = [&](const Intersector& form, const Format& format, const Setting& setting, const Tape&) {
        measure::attribution::Attributor attributor(form, format, {});
        const measure::attribution::RayAttribution blame = attributor.attribute_ray(setting.ray, setting.target(form));
        const int worst = measure::attribution::worst_cancellation(*blame.attribution);
        for (const std::string_view label : measure::attribution::labels_of(form, given(setting))) {
            INFO(label);
            const double bits = measure::attribution::cancellation_of(*blame.tape, *blame.attribution, label);
            const bool there = std::ranges::find(blame.tape->nodes, label, &TapeNode::label) != blame.tape->nodes.end();
            CHECK(std::isnan(bits) == !there);
            if (there) CHECK(bits <= worst);
            cancelled += bits > 0;
        }
        CHECK(std::isnan(measure::attribution::cancellation_of(*blame.tape, *blame.attribution, "no such label")));
        CHECK(std::isnan(measure::attribution::contribution_of(*blame.tape, *blame.attribution, "no such label")));
    };
    on_recorded_rays({{"f32"}, 40, 100, 11}, see);
    CHECK(cancelled > 200);
}

TEST_CASE("a range limit changed by rounding has a culprit among the operations, as has the choice of a root",
          "[culprits]") {
    // t is 1.4e-4 in binary32 and 6.6e-5 without rounding, and the ray begins at 1e-4.
    const Intersector& form = form_named("sphere.unified");
    const std::array<Primitive<double>, 1> primitives{Sphere<double>{{0, -1001, -30}, 1000}};
    const Ray<double> ray{{-0x1.99f126p-1, -0x1.00b684p+0, -0x1.bccd1p+4},
                          {0x1.9a5e32p-2, 0x1.576072p-1, 0x1.3f964ep-1}};
    const measure::attribution::Setting without{primitives}, with{primitives, nullptr, nullptr, true};
    MetricSet made;
    const Metric* const culprit = made.adapt_to_forms({find_metric("culprit")}, {&form}, with).front();
    const Format f32 = *find_format("f32");
    measure::attribution::Attributor attributor(form, f32, culprit->categories);
    const auto whole = attributor.attribute_ray(ray, intersect::Target<double>(primitives[0]));
    CHECK(whole.attribution->is_exact_hit);
    CHECK(whole.attribution->subject == whole.tape->outputs.t);
    const auto blame =
        attributor.attribute_ray(ray, intersect::Target<double>(primitives[0]), {.tmin = 0x1.a36e2ep-14});
    CHECK_FALSE(blame.attribution->is_exact_hit);
    REQUIRE(blame.culprit >= 1);
    CHECK(culprit->categories[static_cast<std::size_t>(blame.culprit)] == "v.i = o.i - centre.i");
    const auto chooses = [&](const measure::attribution::Setting& setting) {
        return std::ranges::any_of(measure::attribution::operation_names(form, setting),
                                   [](const std::string& name) { return name.starts_with("t_in_range = "); });
    };
    CHECK(chooses(with));
    CHECK_FALSE(chooses(without));
}

TEST_CASE("shares count rays with a culprit, and rays without rounding have none", "[culprits]") {
    const std::array<std::uint64_t, 4> counts{90, 1, 3, 6};
    CHECK(measure::attribution::culprit_fraction(counts, std::array<std::size_t, 1>{2}) == 0.3);
    CHECK(measure::attribution::culprit_fraction(counts, std::array<std::size_t, 3>{1, 2, 3}) == 1);
    CHECK(std::isnan(
        measure::attribution::culprit_fraction(std::array<std::uint64_t, 2>{5, 0}, std::array<std::size_t, 1>{1})));
}

TEST_CASE("an unknown label is refused with a suggestion, and a known one is found", "[culprits]") {
    const Sphere<double> unit{{0, 0, 5}, 1};
    const std::array<Primitive<double>, 1> primitives{unit};
    std::vector<const Intersector*> forms;
    for (const Intersector& form : intersect::table::intersectors(Shape::sphere)) forms.push_back(&form);
    const measure::attribution::Setting setting{primitives};
    MetricSet made;
    const std::vector<const Metric*> base_metrics{made.find("contribution:disc"), made.find("cancellation:c"),
                                                  made.find("culprit")};
    const auto metrics = made.adapt_to_forms(base_metrics, forms, setting);
    CHECK(metrics[0] == base_metrics[0]);
    CHECK(metrics[1] == base_metrics[1]);
    CHECK(metrics[2]->categories.size() > 100);
    CHECK(base_metrics[2]->categories.empty());  // the row of the table does not change
    CHECK(made.find("contribution:") == nullptr);
    CHECK(made.find("contributions:c") == nullptr);
    CHECK_THROWS_WITH(made.adapt_to_forms({made.find("cancellation:disk")}, forms, setting),
                      Catch::Contains("did you mean \"disc\"?"));
}

TEST_CASE("a metric set keeps one row per label, and the row survives a move", "[culprits]") {
    MetricSet made;
    const Metric* const of_c = made.find("contribution:c");
    REQUIRE(of_c != nullptr);
    for (int i = 0; i < 100; ++i) made.find("contribution:c" + std::to_string(i));
    CHECK(made.find("contribution:c") == of_c);
    const MetricSet kept = std::move(made);
    CHECK(of_c->name == "contribution:c");
    CHECK(of_c->layer == "contribution.c");
    CHECK(of_c->label == "c");
    CHECK(find_metric("contribution:c") == nullptr);
}

TEST_CASE("categories are ordered by how often they are to blame", "[culprits]") {
    const scene::file::Scene scene = test::scene_named("near-benign", std::pair{60, 40});
    measure::evaluate::MapStudy request{
        .scene = &scene, .tested_forms = {}, .metrics = {find_metric("lost_bits"), find_metric("culprit")}};
    for (const Intersector& form : intersect::table::intersectors(Shape::sphere))
        request.tested_forms.push_back({&form, *find_format("f32")});
    MetricSet made;
    request.metrics = made.adapt_to_forms(request.metrics, measure::evaluate::forms_of(request.tested_forms),
                                          measure::attribution::OwnedSetting(scene).get());
    const Metric* const before = request.metrics[1];
    request.metrics = order_culprits(request, made);
    const Metric* const after = request.metrics[1];
    CHECK(after->categories.front() == before->categories.front());
    std::vector<std::string_view> a(before->categories.begin(), before->categories.end()),
        b(after->categories.begin(), after->categories.end());
    CHECK(a != b);
    std::ranges::sort(a);
    std::ranges::sort(b);
    CHECK(a == b);
    // The picture is small enough to be its own small picture.
    const auto summaries = measure::evaluate::run_map(request);
    std::vector<std::uint64_t> total(after->categories.size());
    for (const measure::evaluate::FormSummary& summary : summaries) {
        for (std::size_t c = 0; c < total.size(); ++c) total[c] += summary.categories[1][c];
    }
    CHECK(std::is_sorted(total.begin() + 1, total.end(), std::greater{}));
    CHECK(total[1] > 0);
}

}  // namespace lostbits::test::test_culprits
