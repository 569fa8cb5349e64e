// The search for the worst ray: the same on every machine, inside its ranges, and better than chance.
#include "measure/sweep/worst.hpp"

#include <cmath>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "measure/truth/lost_bits.hpp"
#include "number/rounded.hpp"
#include "scratch.hpp"

namespace test_worst {

using namespace lostbits;
using namespace lostbits::test;
using measure::answer::Outcome;
using measure::evaluate::TestedForm;
using measure::sweep::find_worst;
using measure::sweep::WorstRequest;
using measure::sweep::WorstResult;
using scene::sweep::SearchFile;

namespace {

const auto folder = std::filesystem::path(LOSTBITS_DATA_DIR) / "sweeps/worst";

std::string search_text(const std::string& more) {
    return "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n[search]\norigin = [-8, 8]\ndirection = "
           "[-1, 1]\ncentre = [-1, 1]\nradius = [0.5, 2]\n" +
           more;
}

std::vector<const measure::metric::Metric*> metrics_of(const SearchFile& search) {
    return {measure::metric::find_metric("lost_bits"), measure::metric::find_metric("ulp_error"),
            measure::metric::find_metric(search.metric)};
}

std::optional<WorstResult> worst_of(const SearchFile& search, const TestedForm& row) {
    return find_worst({.search = search, .tested_forms = {row}, .metrics = metrics_of(search)})[0];
}

bool equal(const std::optional<WorstResult>& a, const std::optional<WorstResult>& b) {
    if (a.has_value() != b.has_value()) return false;
    return !a || (a->outcome == b->outcome && a->value == b->value && a->ray.origin == b->ray.origin &&
                  a->ray.direction == b->ray.direction && a->primitive.numbers == b->primitive.numbers &&
                  (a->t == b->t || std::isnan(a->t)) && a->evaluation_count == b->evaluation_count);
}

bool is_of(double x, const FloatFormat& format) { return rounding::to_format(x, 0, format) == x; }

/// One ray with one form alone, and its truth computed again.
struct SingleRay {
    SingleRay(const TestedForm& row, const Ray<double>& ray, const Primitive<double>& primitive)
        : truth(measure::truth::find_truth(ray, primitive, {}, row.form->info->touching)) {
        const auto answer = evaluate_alone(row, ray, primitive);
        hit = answer.has_value(), t = answer.value_or(0);
        if (!hit || !truth.is_hit()) return;
        const std::int64_t ulp = ulp_exponent(row.format.parameters, truth.t.floor_log2());
        lost =
            measure::truth::lost_bits(measure::truth::scaled_difference(measure::truth::as_certified(t), truth.t, ulp),
                                      row.format.parameters.precision);
    }
    measure::truth::Truth truth;
    double t = 0, lost = 0;
    bool hit = false;
};

}  // namespace

TEST_CASE("a search keeps to its ranges and formats, ignores other rows, and depends on its seed") {
    const TextFile text(
        search_text("impact_radii = [0, 0.9]\ndistance_radii = [1.25, 8]\nstarts = 2\ngenerations = 12\n"));
    const SearchFile search(text.path());
    const WorstRequest request{
        .search = search, .tested_forms = all_rows(Shape::sphere, {"f32", "bf16"}), .metrics = metrics_of(search)};
    const auto found = find_worst(request);
    REQUIRE(found.size() == request.tested_forms.size());
    for (std::size_t i = 0; i < request.tested_forms.size(); ++i) {
        CAPTURE(request.tested_forms[i].form->info->name, request.tested_forms[i].format.name);
        // A row's result does not depend on its neighbours.
        if (i % 7 == 0) CHECK(equal(worst_of(search, request.tested_forms[i]), found[i]));
        REQUIRE(found[i].has_value());
        const WorstResult& w = *found[i];
        const FloatFormat& f = request.tested_forms[i].format.parameters;
        CHECK(search.contains(w.ray, w.primitive));
        for (int k = 0; k < 3; ++k) CHECK((is_of(w.ray.origin[k], f) && is_of(w.ray.direction[k], f)));
        for (const double x : w.primitive.shape_numbers()) CHECK(is_of(x, f));
        CHECK(w.evaluation_count <= 2 * 12 * 32);
        if (w.outcome == Outcome::agree_hit) CHECK(w.evaluation_count == 2 * 12 * 32);
    }
    const TextFile other(
        search_text("impact_radii = [0, 0.9]\ndistance_radii = [1.25, 8]\nstarts = 2\ngenerations = 12\nseed = 2\n"));
    const SearchFile second(other.path());
    CHECK_FALSE(equal(worst_of(second, request.tested_forms[0]), found[0]));
}

TEST_CASE("a search at edges separates slabs further than random rays do") {
    SearchFile search(folder / "padding.toml");
    search.start_count = 64;
    search.generation_count = 96;
    const WorstRequest request{.search = search,
                               .tested_forms = {row("box.filtered", "f32"), row("box.filtered", "f64")},
                               .metrics = metrics_of(search)};
    for (const auto& found : find_worst(request)) {
        REQUIRE(found);
        CHECK(search.contains(found->ray, found->primitive));
        CHECK(found->value > 2.5);  // box-edge-inside shows 2 u
        CHECK(found->value < 6);    // docs/bounds.md: the padding that slabs need
    }
}

TEST_CASE("a search for a minimum reports the metric itself and goes on after a wrong decision") {
    SearchFile search(folder / "bound-ratio.toml");
    search.start_count = 8;
    search.generation_count = 16;
    const auto found = worst_of(search, row("sphere.embree_point", "f32"));
    REQUIRE(found);
    CHECK(found->outcome == Outcome::agree_hit);
    CHECK(found->value >= 1);
    CHECK(found->value < 8);
    CHECK(found->evaluation_count == 8 * 16 * 32);
}

TEST_CASE("a search that counts hits only does not stop at a wrong decision") {
    SearchFile search(folder / "backward-far.toml");
    search.start_count = 2;
    search.generation_count = 16;
    const auto worst = [&] { return worst_of(search, row("sphere.schoolbook", "f32")); };
    const auto hit = worst();
    search.hits_only = false;
    const auto wrong = worst();
    REQUIRE((hit && wrong));
    CHECK(hit->outcome == Outcome::agree_hit);
    CHECK(hit->value > 100);
    CHECK(hit->evaluation_count == 2 * 16 * 32);
    CHECK(wrong->outcome != Outcome::agree_hit);
    CHECK(wrong->evaluation_count < hit->evaluation_count);
}

TEST_CASE("a search reports for its worst ray what that ray measures alone") {
    int hits = 0, wrong = 0;
    for (const char* name : {"near", "far"}) {
        SearchFile search(folder / (std::string(name) + ".toml"));
        search.start_count = 2;
        search.generation_count = 16;
        for (const TestedForm& tested_form : {row("sphere.schoolbook", "f32"), row("sphere.press", "f64"),
                                              row("sphere.pythagoras", "bf16"), row("sphere.hearn_baker", "p12")}) {
            CAPTURE(name, tested_form.form->info->name, tested_form.format.name);
            const auto found = worst_of(search, tested_form);
            REQUIRE(found.has_value());
            const SingleRay alone(tested_form, found->ray, found->primitive);
            CHECK(search.contains(found->ray, found->primitive));
            const bool agrees = found->outcome == Outcome::agree_hit;
            (agrees ? hits : wrong) += 1;
            if (agrees) {
                CHECK(alone.hit);
                CHECK(alone.t == found->t);
                CHECK(alone.lost == Approx(found->value).epsilon(1e-9));
                CHECK(found->truth == measure::truth::round_truth(alone.truth, found->ray, found->primitive, binary64));
            } else {
                CHECK(alone.hit != alone.truth.is_hit());
                CHECK(std::isinf(found->value));
            }
        }
    }
    CHECK(hits > 0);
    CHECK(wrong > 0);
}

TEST_CASE("a search over empty ranges finds nothing, and a search stops at a wrong decision") {
    const TextFile none(search_text("distance_radii = [500, 600]\n"));
    const SearchFile empty(none.path());
    CHECK_FALSE(worst_of(empty, row("sphere.press", "f32")).has_value());
    // Near the silhouette a five-bit format decides wrongly at once.
    const TextFile edge(search_text("impact_radii = [0.95, 1]\nstarts = 64\n"));
    const SearchFile hard(edge.path());
    const auto found = worst_of(hard, row("sphere.schoolbook", "p5"));
    REQUIRE(found.has_value());
    CHECK(found->outcome != Outcome::agree_hit);
    CHECK(found->evaluation_count < 64 * 64 * 32);
    const SingleRay alone(row("sphere.schoolbook", "p5"), found->ray, found->primitive);
    CHECK(alone.hit == (found->outcome == Outcome::false_hit));
    CHECK(alone.truth.is_hit() == (found->outcome == Outcome::false_miss));
}

TEST_CASE("the nearest false miss of the schoolbook form respects the error bound of its discriminant") {
    // With u = 2^-p and an impact of s radii, disc = b·b − 4·a·c is 4 d·d r² (1 − s²). A dot product of three is off by
    // 3u |f||d| at most, so b·b by 7u, 4·a·c by 8u (a 3u, c 4u, their product u) of 4 d·d f·f: to first order a miss
    // needs 15u (D² + …) >= 1 − s², with D the distance in radii.
    const TextFile text(
        "schema = \"lostbits-sweep/1\"\ntitle = \"-\"\nsource = \"-\"\n[search]\norigin = [-1, 1]\ndirection = [-1, "
        "1]\ncentre = [\"-0x1p30\", \"0x1p30\"]\nradius = [0.75, 1.25]\ndistance_radii = [1.25, \"0x1p30\"]\n"
        "impact_radii = [0, 0.99]\nnearest = true\nstarts = 32\ngenerations = 192\n");
    const SearchFile search(text.path());
    const WorstRequest request{.search = search,
                               .tested_forms = {row("sphere.schoolbook", "p16"), row("sphere.schoolbook", "f32"),
                                                row("sphere.schoolbook", "f64")},
                               .metrics = metrics_of(search)};
    const auto found = find_worst(request);
    for (std::size_t r = 0; r < found.size(); ++r) {
        const TestedForm& what = request.tested_forms[r];
        INFO(what.format.name);
        REQUIRE(found[r]);
        CHECK(found[r]->outcome == Outcome::false_miss);
        const double floor = std::sqrt((1 - 0.99 * 0.99) / 15 * std::ldexp(1.0, what.format.parameters.precision));
        CHECK(found[r]->distance > floor);
        CHECK(found[r]->distance < 4 * floor);  // and near to it: the search is good
        CHECK(found[r]->distance == scene::sweep::distance_in_radii(found[r]->ray, found[r]->primitive.sphere()));
        const SingleRay alone(what, found[r]->ray, found[r]->primitive);
        CHECK((!alone.hit && alone.truth.is_hit()));
    }
}

TEST_CASE("a search that aims at a rim starts at the distance that its file states") {
    const Scratch scratch;
    const auto with = [&](const std::string& distance) {
        return SearchFile(scratch.write(
            "a.toml",
            "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n[search]\norigin = [-1e7, 1e7]\n"
            "direction = [-1, 1]\nbase = [-2, 2]\ntop = [-2, 2]\nradius = [0.5, 2]\nhits_only = true\nstarts = 8\n"
            "generations = 1\naim = \"rim\"\ndistance = " +
                distance + "\n"));
    };
    const TestedForm by = row("cylinder.framed", "f64");
    const auto near = worst_of(with("[1, 2]"), by), far = worst_of(with("[32768, 65536]"), by);
    REQUIRE((near && far));
    CHECK(length(near->ray.origin) < 64);
    CHECK(length(far->ray.origin) > 0x1p10);
}

}  // namespace test_worst
