// Culprits as categories: every operation that can be one has a place and a name, and colours go to those that are.
#include "measure/blame/culprits.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "catch.hpp"
#include "measure/blame/recorded_rays.hpp"
#include "measure/map/culprit_order.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::test {

using intersect::table::Intersector;
using measure::metric::Metric;

namespace {

/// What the library calls a setting, of the rays that the tests draw.
lostbits::measure::blame::Setting given(const Setting& s) { return {s.solids, &s.march}; }

}  // namespace

TEST_CASE("every culprit is among the operations of its form, and no plain miss has one", "[culprits]") {
    int blamed = 0, misses = 0;
    for (const char* name : {"f32", "p12"}) {
        const Format format = *find_format(name);
        for (const Intersector& form : intersect::table::intersectors()) {
            if (!form.exists_in(format)) continue;
            Random random(7);
            for (int i = 0; i < 40; ++i) {
                const Setting s = draw_setting(random, form, format, 1);
                const Intersector* const forms[] = {&form};
                const Metric* const culprit = measure::blame::culprit_among(forms, given(s));
                measure::blame::Blamer blamer(form, format, culprit->categories);
                const measure::blame::Blame blame = blamer.of(s.ray, s.target(form), HUGE_VAL);
                INFO(form.info->name << " in " << name << ", ray " << i);
                if (measure::blame::is_plain_miss(*blame.tape, *blame.attribution)) {
                    CHECK(std::isnan(blame.culprit));
                    CHECK(blame.attribution->culprit == no_node);
                    ++misses;
                    continue;
                }
                if (blame.attribution->culprit == no_node) continue;
                REQUIRE(blame.culprit >= 1);
                const auto operations = operations_of(form, given(s));
                CHECK(std::ranges::find(operations, culprit->categories[static_cast<std::size_t>(blame.culprit)]) !=
                      operations.end());
                ++blamed;
            }
        }
    }
    CHECK(blamed > 1500);
    CHECK(misses > 100);
}

TEST_CASE("cancellation and contributions of labels: parts of what there is", "[culprits]") {
    const Format format = *find_format("f32");
    int cancelled = 0;
    for (const Intersector& form : intersect::table::intersectors()) {
        Random random(11);
        for (int i = 0; i < 40; ++i) {
            const Setting s = draw_setting(random, form, format, 100);
            measure::blame::Blamer blamer(form, format, {});
            const measure::blame::Blame blame = blamer.of(s.ray, s.target(form), HUGE_VAL);
            const int worst = measure::blame::worst_cancellation(*blame.attribution);
            for (const std::string_view label : measure::blame::labels_of(form, given(s))) {
                INFO(form.info->name << " " << label);
                const double bits = measure::blame::cancellation_of(*blame.tape, *blame.attribution, label);
                const bool there =
                    std::ranges::any_of(blame.tape->nodes, [&](const TapeNode& n) { return n.label == label; });
                CHECK(std::isnan(bits) == !there);
                if (there) CHECK(bits <= worst);
                cancelled += bits > 0;
            }
            CHECK(std::isnan(measure::blame::cancellation_of(*blame.tape, *blame.attribution, "no such label")));
            CHECK(std::isnan(measure::blame::contribution_of(*blame.tape, *blame.attribution, "no such label")));
        }
    }
    CHECK(cancelled > 200);
}

TEST_CASE("shares are of the rays that have a culprit: those on which nothing rounds are none", "[culprits]") {
    const std::array<std::uint64_t, 4> counts{90, 1, 3, 6};
    CHECK(measure::blame::culprit_share(counts, std::array<std::size_t, 1>{2}) == 0.3);
    CHECK(measure::blame::culprit_share(counts, std::array<std::size_t, 3>{1, 2, 3}) == 1);
    CHECK(std::isnan(measure::blame::culprit_share(std::array<std::uint64_t, 2>{5, 0}, std::array<std::size_t, 1>{1})));
}

TEST_CASE("an unknown label is refused with what was meant, a known one is bound", "[culprits]") {
    const Sphere<double> unit{{0, 0, 5}, 1};
    const std::array<Solid<double>, 1> solids{unit};
    std::vector<const Intersector*> forms;
    for (const Intersector& form : intersect::table::intersectors(Shape::sphere)) forms.push_back(&form);
    std::vector<const Metric*> metrics{measure::blame::labelled_metric("contribution:disc"),
                                       measure::blame::labelled_metric("cancellation:c"),
                                       measure::metric::find_metric("culprit")};
    measure::blame::bind_to_run(metrics, forms, {solids});
    CHECK(metrics[2]->categories.size() > 100);
    CHECK(measure::blame::labelled_metric("contribution:") == nullptr);
    CHECK(measure::blame::labelled_metric("contributions:c") == nullptr);
    std::vector<const Metric*> wrong{measure::blame::labelled_metric("cancellation:disk")};
    CHECK_THROWS_WITH(measure::blame::bind_to_run(wrong, forms, {solids}), Catch::Contains("did you mean \"disc\"?"));
}

TEST_CASE("categories go by how often they are to blame", "[culprits]") {
    const auto found = scene::file::find_scene("near-benign", LOSTBITS_DATA_DIR);
    const scene::file::Scene scene = scene::file::load_scene(found.path, {.size = std::pair{60, 40}}).front();
    measure::map::MapRequest request{
        .scene = &scene,
        .rows = {},
        .metrics = {measure::metric::find_metric("lost_bits"), measure::metric::find_metric("culprit")}};
    for (const Intersector& form : intersect::table::intersectors(Shape::sphere))
        request.rows.push_back({&form, *find_format("f32")});
    measure::blame::bind_to_run(request.metrics, measure::map::forms_of(request.rows),
                                measure::blame::SettingOf(scene).get());
    const Metric* const before = request.metrics[1];
    order_culprits(request);
    const Metric* const after = request.metrics[1];
    CHECK(after->categories.front() == before->categories.front());
    std::vector<std::string_view> a(before->categories.begin(), before->categories.end()),
        b(after->categories.begin(), after->categories.end());
    CHECK(a != b);
    std::ranges::sort(a);
    std::ranges::sort(b);
    CHECK(a == b);
    // The picture is small enough to be its own small picture.
    const auto summaries = measure::map::run_map(request, {});
    std::vector<std::uint64_t> total(after->categories.size());
    for (const measure::map::MapSummary& s : summaries) {
        for (std::size_t c = 0; c < total.size(); ++c) total[c] += s.categories[1][c];
    }
    CHECK(std::is_sorted(total.begin() + 1, total.end(), std::greater{}));
    CHECK(total[1] > 0);
}

}  // namespace lostbits::test
