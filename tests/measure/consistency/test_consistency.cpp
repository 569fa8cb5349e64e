// Consistency over scenes: properties of every form, numbers of an independent computation, and forms that are built to
// contradict themselves.
#include <numeric>

#include "catch.hpp"
#include "measure/consistency/consistency.hpp"
#include "measure/offset/points.hpp"
#include "measure/study/study.hpp"

namespace test_consistency {

using namespace lostbits;
using namespace lostbits::measure::consistency;
using intersect::table::HitBatch;
using intersect::table::RayBatch;
using test::load;
using test::row;

namespace {

const Check* named(std::string_view name) {
    for (const Check& c : checks()) {
        if (c.name == name) return &c;
    }
    throw std::logic_error("no check " + std::string(name));
}

std::vector<FormChecks> run(const scene::file::Scene& scene, std::vector<measure::evaluate::TestedForm> tested_forms,
                            std::vector<const Check*> among = all_checks()) {
    return measure::study::run_study(
        ConsistencyStudy{.scene = scene, .tested_forms = std::move(tested_forms), .checks = std::move(among)});
}

/// Result of one check for one row.
CheckSummary one(const std::string& scene, std::string_view form, std::string_view format, std::string_view check,
                 int width = 16, int height = 12) {
    const auto s = load(scene, width, height);
    return std::move(run(s, {row(form, format)}, {named(check)}).front().front());
}

/// `half_b`, but in batches the ray of pixel (5, 6) of 16 x 12 is a miss.
void forgets_one(const RayBatch<float>& rays, const intersect::Target<float>& target, const HitBatch<float>& hits) {
    test::form_named("sphere.half_b").native32(rays, target, hits);
    if (rays.size() > 1) hits.hit[rays.size() / 2 + 5] = 0;
}
/// `half_b`, but in batches t is one float further.
void drifts(const RayBatch<float>& rays, const intersect::Target<float>& target, const HitBatch<float>& hits) {
    test::form_named("sphere.half_b").native32(rays, target, hits);
    if (rays.size() == 1) return;
    for (float& t : hits.t) t = std::nextafter(t, HUGE_VALF);
}
/// `half_b`, but rays that go to +x hit nothing: a decision that depends on the direction.
void one_way_only(const RayBatch<float>& rays, const intersect::Target<float>& target, const HitBatch<float>& hits) {
    test::form_named("sphere.half_b").native32(rays, target, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) hits.hit[i] &= static_cast<std::uint8_t>(rays.dx[i] <= 0);
}
/// `half_b`, but its far side lies before its t, as if the two roots were exchanged.
void exchanged(const RayBatch<float>& rays, const intersect::Target<float>& target, const HitBatch<float>& hits) {
    test::form_named("sphere.half_b").native32(rays, target, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) std::swap(hits.t[i], hits.far[i]);
}
/// `half_b`, but hits are at NaN.
void nowhere(const RayBatch<float>& rays, const intersect::Target<float>& target, const HitBatch<float>& hits) {
    test::form_named("sphere.half_b").native32(rays, target, hits);
    for (auto& all : {hits.t, hits.near, hits.far}) std::ranges::fill(all, NAN);
}

CheckSummary of_kernel(intersect::table::Kernel<float>::Plain kernel, std::string_view check) {
    static const intersect::Info info{.name = "sphere.made_up", .title = "-", .source = "-"};
    intersect::table::Intersector form{.info = &info, .shape = Shape::sphere, .native32 = kernel, .native64 = {}};
    const auto scene = load("near-benign", 16, 12);
    return std::move(run(scene, {{&form, *find_format("f32")}}, {named(check)}).front().front());
}

}  // namespace

TEST_CASE("consistency: every form agrees in packs and alone, and summaries add up", "[measure][consistency]") {
    for (const std::string name : {"near-benign", "camera-inside", "box-slabs", "consistency-on-surface"}) {
        const auto scene = load(name);
        std::vector<measure::evaluate::TestedForm> tested_forms;
        for (const Shape shape : {Shape::sphere, Shape::box}) {
            if (!scene.accepts(shape)) continue;
            for (const auto& r : test::all_rows(shape, {"f32", "f64", "bf16"})) tested_forms.push_back(r);
        }
        const auto all = run(scene, tested_forms);
        for (std::size_t r = 0; r < tested_forms.size(); ++r) {
            for (std::size_t c = 0; c < checks().size(); ++c) {
                const CheckSummary& s = all[r][c];
                CAPTURE(name, tested_forms[r].form->info->name, tested_forms[r].format.name, checks()[c].name);
                CHECK(std::accumulate(s.counts.begin(), s.counts.end(), std::uint64_t{0}) == scene.pixel_count());
                CHECK(s.count_of(CheckResult::unresolved) == 0);
                CHECK(s.first_disagreement.has_value() == (s.disagreements() > 0));
                if (!checks()[c].applies(scene, *tested_forms[r].form)) CHECK(s.question_count() == 0);
                if (!checks()[c].compares_numbers) CHECK(s.excess.count() == 0);
                if (checks()[c].name != "packs") continue;
                CHECK(s.question_count() == scene.pixel_count());
                CHECK(s.disagreements() == 0);
            }
        }
    }
}

TEST_CASE("consistency: numbers agree with a Python computation whose truth is in fractions",
          "[measure][consistency]") {
    // float by `struct`, schoolbook operation by operation; exact discriminants as fractions, roots to 80 digits.
    const CheckSummary far = one("rtg-fig-7-3-4100-oblique", "sphere.schoolbook", "f32", "reverse");
    CHECK(far.count_of(CheckResult::agree) == 146);
    CHECK(far.count_of(CheckResult::first_alone) == 21);
    CHECK(far.count_of(CheckResult::second_alone) == 21);
    CHECK(far.count_of(CheckResult::other_number) == 4);
    CHECK(far.apart.quantile(1) == 2044);
    CHECK(far.excess.quantile(1) == Approx(2044.0336627394759).epsilon(1e-12));
    CHECK(far.excess.count() == 90);
    const CheckSummary segment = one("rtg-fig-7-3-4100-oblique", "sphere.schoolbook", "f32", "segment");
    CHECK(segment.count_of(CheckResult::agree) == 73);
    CHECK(segment.count_of(CheckResult::first_alone) == 21);
    CHECK(segment.count_of(CheckResult::second_alone) == 22);
    CHECK(segment.count_of(CheckResult::by_inputs) == 8);
    const CheckSummary shorter = one("rtg-fig-7-3-4100-oblique", "sphere.schoolbook", "f32", "short");
    CHECK(shorter.count_of(CheckResult::agree) == 73);
    CHECK(shorter.count_of(CheckResult::first_alone) == 27);
    CHECK(shorter.count_of(CheckResult::second_alone) == 24);
    const CheckSummary near = one("near-benign", "sphere.schoolbook", "f32", "reverse");
    CHECK(near.count_of(CheckResult::agree) == 132);
    CHECK(near.count_of(CheckResult::other_number) == 59);
    CHECK(near.count_of(CheckResult::by_inputs) == 1);
    CHECK(near.excess.quantile(1) == Approx(9.22616585020865).epsilon(1e-12));
}

TEST_CASE("consistency: a t rounded once agrees from either end within an ulp", "[measure][consistency]") {
    for (const char* scene : {"near-benign", "rtg-fig-7-3-4100-oblique", "camera-inside", "grazing"}) {
        const CheckSummary s = one(scene, "sphere.double_inside", "f32", "reverse", 48, 36);
        CAPTURE(scene);
        CHECK(s.excess.count() > 100);
        CHECK(s.excess.quantile(1) <= 1);
        CHECK(s.count_of(CheckResult::other_number) == 0);
    }
}

TEST_CASE("consistency: an origin on the surface and an end at a box are checked", "[measure][consistency]") {
    const CheckSummary beyond = one("consistency-on-surface", "sphere.half_b", "f32", "beyond");
    CHECK(beyond.count_of(CheckResult::first_alone) == beyond.question_count());
    CHECK(beyond.question_count() == 192);
    CHECK(one("consistency-on-surface", "sphere.half_b", "f32", "before").question_count() ==
          0);  // before t = 0 is no ray
    // This form does not count a hit at t = 0.
    CHECK(one("consistency-on-surface", "sphere.pbrt_interval", "f32", "beyond").disagreements() == 0);
    CHECK(one("box-octree", "box.max_mult", "f32", "before").decisions() ==
          one("box-octree", "box.max_mult", "f32", "before").question_count());
    CHECK(one("box-octree", "box.inclusive", "f32", "before").decisions() == 0);
    const CheckSummary closed = one("box-octree", "box.inclusive", "f32", "end");
    CHECK(closed.count_of(CheckResult::second_alone) == closed.question_count());
    CHECK(one("box-octree", "box.exclusive", "f32", "end").decisions() == 0);
}

TEST_CASE("consistency: forms that contradict themselves are detected", "[measure][consistency]") {
    const auto hits = one("near-benign", "sphere.half_b", "f32", "beyond").question_count();
    REQUIRE(hits > 50);
    CHECK(of_kernel(drifts, "packs").count_of(CheckResult::other_number) >= hits);
    CHECK(of_kernel(drifts, "packs").decisions() == 0);
    const CheckSummary forgetful = of_kernel(forgets_one, "packs");
    CHECK(forgetful.count_of(CheckResult::first_alone) == 1);
    CHECK(forgetful.disagreements() == 1);
    REQUIRE(forgetful.first_disagreement);
    CHECK(forgetful.first_disagreement->x == 5);
    CHECK(forgetful.first_disagreement->y == 6);
    CHECK(of_kernel(one_way_only, "reverse").decisions() > hits / 2);
    CHECK(of_kernel(exchanged, "before").count_of(CheckResult::second_alone) > hits / 2);
    CHECK(of_kernel(nowhere, "beyond").count_of(CheckResult::first_alone) ==
          of_kernel(nowhere, "beyond").question_count());
    CHECK(of_kernel(nowhere, "beyond").question_count() > 50);
}

TEST_CASE("consistency: a check that does not apply is not run", "[measure][consistency]") {
    const auto names = [](const std::string& scene, std::string_view form) {
        std::vector<std::string> all;
        for (const Check* c : select_checks(load(scene), {row(form, "f32")})) all.emplace_back(c->name);
        return all;
    };
    using Names = std::vector<std::string>;
    CHECK(names("near-benign", "sphere.half_b") ==
          Names{"beyond", "end", "before", "segment", "short", "packs", "reverse", "placed"});
    CHECK(names("near-benign", "sphere.unit_half_b") == Names{"beyond", "end", "before", "packs", "reverse", "placed"});
    CHECK(names("triangle-edge.plain", "triangle.moller_trumbore_culling") ==
          Names{"beyond", "end", "before", "segment", "short", "packs", "placed"});
    CHECK(names("offset-touching", "sphere.half_b").size() == checks().size());
}

}  // namespace test_consistency
