// Bits needed, compared with maps of all 52 widths.
#include <algorithm>
#include <cmath>
#include <string>

#include "catch.hpp"
#include "measure/evaluate/bits_needed.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/rows.hpp"
#include "scene/file/scene.hpp"

namespace test_bits_needed {

using namespace lostbits;
using namespace lostbits::measure::evaluate;
using measure::answer::Outcome;
using measure::truth::as_certified;
using measure::truth::Truth;
using test::load;

namespace {

/// Every pixel's outcome and correct bits in one format, as the map has them.
struct CollectedBits {
    std::vector<Outcome> outcomes;
    std::vector<double> correct;
    void add_band(const BandResult& r) {
        outcomes.insert(outcomes.end(), r.outcomes.begin(), r.outcomes.end());
        correct.insert(correct.end(), r.metrics[0].begin(), r.metrics[0].end());
    }
    [[nodiscard]] bool suffices(std::size_t i, int bits) const {
        return outcomes[i] == Outcome::agree_miss || (outcomes[i] == Outcome::agree_hit && correct[i] >= bits);
    }
};

std::vector<CollectedBits> map_of(const scene::file::Scene& scene, const intersect::table::Intersector& form,
                                  const std::vector<std::string>& formats) {
    MapStudy request{.scene = &scene, .tested_forms = {}, .metrics = {measure::metric::find_metric("correct_bits")}};
    for (const auto& f : formats) request.tested_forms.push_back({&form, *find_format(f)});
    std::vector<CollectedBits> all(formats.size());
    run_map(request, show_to_each(all));
    return all;
}

std::vector<std::string> every_width() {
    std::vector<std::string> names;
    for (int p = min_precision; p <= max_precision; ++p) names.push_back("p" + std::to_string(p));
    return names;
}

std::vector<double> needed_of(const scene::file::Scene& scene, const intersect::table::Intersector& form, int bits,
                              BitsNeededSummary* summary = nullptr) {
    std::vector<double> values;
    const auto keep = [&values](std::size_t, const BitsNeededBand& r) {
        values.insert(values.end(), r.bits_needed.begin(), r.bits_needed.end());
    };
    const auto summaries = measure::study::run_study(
        BitsNeededStudy{.scene = scene, .tested_forms = {&form}, .correct_bits = bits}, {keep});
    if (summary) *summary = summaries.front();
    return values;
}

}  // namespace

TEST_CASE("bits needed agree with a map of all 52 widths", "[needed]") {
    std::size_t beyond = 0, lucky = 0, narrow_misses = 0;
    // Far, near, from a huge ground (own horizon), inputs rounded by each format, and several spheres.
    for (const char* name : {"rtg-fig-7-3-100-oblique", "near-benign", "rtg-fig-7-4.r1e6", "world-offset-own"}) {
        const scene::file::Scene scene = load(name, 20, 14);
        // Forms with both conventions on touching, and one that takes unit directions.
        for (const char* which : {"sphere.schoolbook", "sphere.unified", "sphere.factored_c", "sphere.unit_half_b"}) {
            const auto maps = map_of(scene, test::form_named(which), every_width());
            for (const int bits : {1, 12, 20, 52}) {
                INFO(name << ' ' << which << ' ' << bits);
                const auto values = needed_of(scene, test::form_named(which), bits);
                REQUIRE(values.size() == 20 * 14);
                std::size_t wrong = 0;
                for (std::size_t i = 0; i < values.size(); ++i) {
                    double expected = beyond_max_precision;
                    const auto is_enough = [&](int p) { return maps[p - min_precision].suffices(i, bits); };
                    for (int p = max_precision; p >= min_precision && is_enough(p); --p) expected = p;
                    wrong += values[i] != expected;
                    beyond += expected == beyond_max_precision;
                    narrow_misses += expected < bits;
                    for (int p = min_precision; p < expected && p <= max_precision; ++p) lucky += is_enough(p);
                }
                CHECK(wrong == 0);
            }
        }
    }
    // Each kind must occur, or nothing was tested: lucky widths are those at which a bisection could have ended.
    CHECK(beyond > 100);
    CHECK(lucky > 1000);
    CHECK(narrow_misses > 100);
}

TEST_CASE("more correct bits never need a narrower width, and a hit needs at least the bits it keeps", "[needed]") {
    const scene::file::Scene scene = load("rtg-fig-7-4.r1e4", 24, 18);
    for (const char* which : {"sphere.schoolbook", "sphere.unified"}) {
        std::vector<double> before(24 * 18, 0);
        BitsNeededSummary summary;
        for (int bits = 1; bits <= 52; ++bits) {
            INFO(which << ' ' << bits);
            const auto values = needed_of(scene, test::form_named(which), bits, &summary);
            CHECK(std::equal(before.begin(), before.end(), values.begin(), std::less_equal<>()));
            CHECK(std::all_of(summary.hits.begin(), summary.hits.begin() + bits, [](auto n) { return n == 0; }));
            CHECK(summary.pixel_count() == 24 * 18);
            before = values;
        }
    }
}

TEST_CASE("bits needed do not depend on other forms in the run", "[needed]") {
    const scene::file::Scene scene = load("rtg-fig-7-3-100-oblique", 70, 50);
    const std::vector<const intersect::table::Intersector*> forms{&test::form_named("sphere.schoolbook"),
                                                                  &test::form_named("sphere.unit_half_b"),
                                                                  &test::form_named("sphere.unified")};
    std::vector<std::vector<double>> together(3);
    std::uint64_t done = 0;
    BitsNeededStudy request{.scene = scene, .tested_forms = forms, .correct_bits = 16};
    request.progress = [&done](std::uint64_t n) { done += n; };
    measure::study::run_study(request, {[&together](std::size_t form, const BitsNeededBand& r) {
                                  together[form].insert(together[form].end(), r.bits_needed.begin(),
                                                        r.bits_needed.end());
                              }});
    CHECK(done == request.units());
    for (std::size_t f = 0; f < forms.size(); ++f) CHECK(together[f] == needed_of(scene, *forms[f], 16));
}

TEST_CASE("an answer keeps B bits up to an error of half an ulp of B bits", "[needed]") {
    const measure::truth::CertifiedNumber one = as_certified(1);
    CHECK(has_correct_bits(1 + 0x1p-12, one, 12));  // ulp of 12 bits at 1: 2^-11
    CHECK_FALSE(has_correct_bits(1 + 0x1p-12 + 0x1p-52, one, 12));
    CHECK(has_correct_bits(1 - 0x1p-12, one, 12));
    CHECK_FALSE(has_correct_bits(1 - 0x1p-12 - 0x1p-53, one, 12));
    CHECK(has_correct_bits(1.5, one, 1));
    CHECK(has_correct_bits(0, as_certified(0), 52));
    for (const double t : {HUGE_VAL, -HUGE_VAL, std::nan("")}) CHECK_FALSE(has_correct_bits(t, one, 1));
}

TEST_CASE("the width that one ray needs follows from its truth and its answers", "[needed]") {
    Truth hit, miss, open;
    hit.decision = Truth::Decision::hit;
    hit.t = as_certified(4);
    hit.distance = as_certified(8);
    hit.primitive = 3;
    open.decision = Truth::Decision::unresolved;
    const intersect::Info& any = *test::form_named("sphere.schoolbook").info;
    const intersect::Info& unit = *test::form_named("sphere.unit_half_b").info;
    REQUIRE(unit.direction == intersect::Direction::unit);
    CHECK(is_precision_enough(hit, any, 12, {true, 4}, 12));
    CHECK_FALSE(is_precision_enough(hit, any, 11, {true, 4}, 12));  // right, but by luck: 11 bits are not 12
    CHECK_FALSE(is_precision_enough(hit, any, 12, {true, 8}, 12));
    CHECK(is_precision_enough(hit, unit, 12, {true, 8}, 12));
    CHECK(is_precision_enough(hit, any, 12, {true, 4, hit.primitive}, 12));
    CHECK_FALSE(is_precision_enough(hit, any, 12, {true, 4, hit.primitive + 1}, 12));  // t of another primitive
    CHECK_FALSE(is_precision_enough(hit, any, 53, {false, 4}, 12));
    CHECK_FALSE(is_precision_enough(hit, any, 53, {true, std::nan("")}, 12));
    CHECK(is_precision_enough(miss, any, 2, {false, std::nan("")}, 12));
    CHECK_FALSE(is_precision_enough(miss, any, 53, {true, 4}, 12));
    CHECK_FALSE(is_precision_enough(open, any, 53, {true, 4}, 12));
    CHECK_FALSE(is_precision_enough(open, any, 53, {false, 4}, 12));
}

TEST_CASE("a ray without a proved truth has no width, and is counted apart", "[needed]") {
    // The line passes 2^-120 inside the unit sphere: double-double leaves that open, and this limit allows no further
    // stage.
    scene::rays::RayBlock rays{.width = 2,
                               .y0 = 0,
                               .y1 = 1,
                               .ox = {1, 0},
                               .oy = {0, 0},
                               .oz = {-4, -4},
                               .dx = {0, 0},
                               .dy = {0, 0},
                               .dz = {1, 1}};
    const Primitive<double> primitive = Sphere<double>{{0x1p-120, 0, 0}, 1};
    const measure::truth::Band band(rays, {primitive}, {.max_bits = 1});
    REQUIRE(band.truth(0, intersect::Touching::hit).decision == Truth::Decision::unresolved);
    const scene::file::Scene none;  // the band has its rays
    const auto results =
        BitsNeededStudy{.scene = none, .tested_forms = {&test::form_named("sphere.unified")}, .correct_bits = 12}
            .prepare(band);
    CHECK(std::isnan(results[0].bits_needed[0]));
    CHECK(results[0].bits_needed[1] <= max_precision);
    BitsNeededSummary summary;
    for (std::size_t i = 0; i < 2; ++i) summary.add(results[0].truth(i), results[0].bits_needed[i]);
    CHECK(summary.unresolved == 1);
    CHECK(summary.all().count() == 1);
}

TEST_CASE("statistics of whole widths are exact", "[needed]") {
    PrecisionCounts counts{};
    CHECK(std::isnan(counts.mean()));
    CHECK(std::isnan(counts.quantile(0.5)));
    counts[2] = 1, counts[14] = 97, counts[30] = 1, counts[53] = 1;
    CHECK(counts.count() == 100);
    CHECK(counts.mean() == (2 + 14 * 97 + 30 + 53) / 100.0);
    CHECK(counts.quantile(0.01) == 2);
    CHECK(counts.quantile(0.5) == 14);
    CHECK(counts.quantile(0.98) == 14);
    CHECK(counts.quantile(0.99) == 30);
    CHECK(counts.quantile(1) == 53);
}

}  // namespace test_bits_needed
