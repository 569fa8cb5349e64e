// Requirements of each pixel, compared with maps of each row by itself.
#include <algorithm>
#include <numeric>

#include "catch.hpp"
#include "measure/choose/requirement_map.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/rows.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::test::test_requirement {

using namespace lostbits::measure::choose;
using measure::answer::Outcome;
using measure::evaluate::TestedForm;

namespace {

scene::file::Scene small_scene(const char* name) { return test::load(name, 40, 30); }

std::vector<TestedForm> rows_of(std::initializer_list<const char*> forms, std::initializer_list<const char*> formats) {
    std::vector<TestedForm> tested_forms;
    for (const char* form : forms)
        for (const char* format : formats) tested_forms.push_back(test::row(form, format));
    return tested_forms;
}

/// Outcomes and lost bits of a row, pixel by pixel.
struct KeptPixels {
    std::vector<Outcome> outcomes;
    std::vector<double> lost;
    void add_band(const measure::evaluate::BandResult& r) {
        outcomes.insert(outcomes.end(), r.outcomes.begin(), r.outcomes.end());
        lost.insert(lost.end(), r.metrics[0].begin(), r.metrics[0].end());
    }
    [[nodiscard]] bool right(std::size_t i, double bits, int precision) const {
        return outcomes[i] == Outcome::agree_miss ||
               (outcomes[i] == Outcome::agree_hit && static_cast<double>(precision) - lost[i] >= bits);
    }
};

/// Maps of every row by itself.
std::vector<KeptPixels> maps_of(const scene::file::Scene& scene, const std::vector<TestedForm>& tested_forms) {
    std::vector<KeptPixels> kept(tested_forms.size());
    for (std::size_t r = 0; r < tested_forms.size(); ++r) {
        measure::evaluate::run_map({.scene = &scene,
                                    .tested_forms = {tested_forms[r]},
                                    .metrics = {measure::metric::find_metric("lost_bits")}},
                                   [&one = kept[r]](std::size_t, const auto& band) { one.add_band(band); });
    }
    return kept;
}

struct MeasuredRequirement {
    ChoiceRequest request;
    std::vector<Candidate> all;
    RequirementMap requirement_map;
};

/// With fixed costs for the rows, so that a test does not depend on the clock.
MeasuredRequirement require(const scene::file::Scene& scene, const std::vector<TestedForm>& tested_forms,
                            const std::vector<double>& prices, double bits,
                            const std::vector<TestedForm>& untimed_forms = {}) {
    MeasuredRequirement measured{
        .request = {.scene = &scene, .tested_forms = tested_forms, .untimed_forms = untimed_forms},
        .all = {},
        .requirement_map = {}};
    measured.request.requirement.bits = bits;
    PassingPixelsByForm meetings(measured.request, tested_forms);
    measured.request.show = meetings.show();
    const auto quality = measure_quality(measured.request);
    for (std::size_t r = 0; r < tested_forms.size(); ++r) {
        measured.all.push_back({.tested_form = tested_forms[r], .quality = quality[r]});
        measured.all.back().time.median = prices[r];
    }
    measured.requirement_map = make_requirement_map(measured.request, measured.all, meetings);
    return measured;
}

}  // namespace

TEST_CASE("each pixel takes the cheapest right row, and the narrowest format that has a right row") {
    for (const char* name : {"rtg-fig-7-3-4100-oblique", "near-benign", "grazing"}) {
        const auto scene = small_scene(name);
        const auto rows = rows_of({"sphere.schoolbook", "sphere.embree_point", "sphere.unified"}, {"f32", "f64"});
        const std::vector<double> prices{1, 4, 2, 5, 3, 6};
        const auto untimed_forms = rows_of({"sphere.schoolbook", "sphere.unified"}, {"fp16", "p14"});
        const double bits = 13;
        const auto [request, all, r] = require(scene, rows, prices, bits, untimed_forms);
        auto every = rows;
        every.insert(every.end(), untimed_forms.begin(), untimed_forms.end());
        const auto maps = maps_of(scene, every);
        REQUIRE(r.pixel_count() == scene.pixel_count());
        REQUIRE(r.formats.size() == 4);
        CHECK(r.formats[0].name == "fp16");
        CHECK(r.formats[3].name == "f64");
        for (std::size_t i = 0; i < r.pixel_count(); ++i) {
            int cheapest = RequirementMap::none, narrowest = 1000;
            for (std::size_t k = 0; k < every.size(); ++k) {
                if (!maps[k].right(i, bits, every[k].format.parameters.precision)) continue;
                narrowest = std::min(narrowest, every[k].format.parameters.precision);
                if (k < rows.size() && (cheapest < 0 || prices[k] < prices[cheapest])) cheapest = static_cast<int>(k);
            }
            INFO(name << ", pixel " << i);
            REQUIRE(r.cheapest[i] == cheapest);
            REQUIRE((r.narrowest[i] < 0 ? 1000 : r.formats[r.narrowest[i]].parameters.precision) == narrowest);
        }
    }
}

TEST_CASE("pixel counts of a requirement sum to the image, and fewer pixels meet a stricter requirement") {
    const auto scene = small_scene("rtg-fig-7-3-4100-oblique");
    const auto rows = rows_of({"sphere.schoolbook", "sphere.embree_point"}, {"f32", "f64"});
    std::vector<std::uint64_t> before(rows.size(), scene.pixel_count() + 1);
    for (const double bits : {0.0, 10.0, 20.0, 24.5, 45.0, 53.5}) {
        const auto [request, all, r] = require(scene, rows, {1, 3, 2, 4}, bits);
        const auto sum = [](const std::vector<std::uint64_t>& counts) {
            return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
        };
        CHECK(sum(r.cheapest_pixel_counts) + r.unmet_pixel_count + r.unknown_pixel_count == r.pixel_count());
        CHECK(sum(r.narrowest_pixel_counts) + r.unmet_pixel_count + r.unknown_pixel_count == r.pixel_count());
        for (std::size_t k = 0; k < rows.size(); ++k) {
            CHECK(r.met_pixel_counts[k] <= before[k]);
            CHECK(r.cheapest_pixel_counts[k] <= r.met_pixel_counts[k]);
            const std::size_t format = rows[k].format.name == "f32" ? 0 : 1;
            CHECK(r.met_pixel_counts[k] <= r.met_by_any_form_pixel_counts[format]);
        }
        before = r.met_pixel_counts;
        const double least = r.min_time(all);
        CHECK(least >= 1);
        CHECK(least <= 4);
    }
}

TEST_CASE("where f32 cannot keep the bits, hits need f64 and misses do not") {
    const auto scene = small_scene("near-benign");
    const auto rows = rows_of({"sphere.unified"}, {"f32", "f64"});
    const auto [request, all, r] = require(scene, rows, {1, 2}, 30);
    const auto maps = maps_of(scene, {rows[1]});
    const auto hits = static_cast<std::uint64_t>(std::ranges::count(maps[0].outcomes, Outcome::agree_hit));
    REQUIRE(hits > 0);
    CHECK(r.narrowest_pixel_counts[1] == hits);
    CHECK(r.narrowest_pixel_counts[0] == r.pixel_count() - hits);
    CHECK(r.met_pixel_counts[1] == r.pixel_count());
}

TEST_CASE("a form that computes in double does not show that float is enough") {
    const auto scene = small_scene("rtg-fig-7-3-4100-oblique");
    const auto rows = rows_of({"sphere.schoolbook", "sphere.double_inside"}, {"f32"});
    const auto [request, all, r] = require(scene, rows, {1, 2}, 20);
    const auto maps = maps_of(scene, rows);
    REQUIRE(r.formats.size() == 2);
    CHECK(r.formats[1].name == "f64");
    std::uint64_t by_float = 0, by_double = 0;
    for (std::size_t i = 0; i < r.pixel_count(); ++i) {
        const bool narrow = maps[0].right(i, 20, 24);
        by_float += narrow;
        by_double += !narrow && maps[1].right(i, 20, 24);
    }
    CHECK(by_double > 0);
    CHECK(r.narrowest_pixel_counts == std::vector<std::uint64_t>{by_float, by_double});
}

}  // namespace lostbits::test::test_requirement
