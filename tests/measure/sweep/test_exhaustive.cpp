// Sweeps over every float, compared with single floats: the forms' kernels and the full truth.
#include "measure/sweep/exhaustive.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/bounding_box/behind.hpp"
#include "measure/metric/values.hpp"
#include "measure/rows.hpp"
#include "measure/truth/lost_bits.hpp"
#include "measure/truth/unit_direction.hpp"
#include "number/real.hpp"

namespace test_exhaustive {

using namespace lostbits;
using namespace lostbits::test;
using measure::evaluate::TestedForm;
using scene::sweep::ExhaustiveFile;
using scene::sweep::float_at;
using scene::sweep::index_of;
namespace answer = measure::answer;
namespace sweep = measure::sweep;
namespace truth = measure::truth;
using answer::Outcome;

namespace {

std::string sweep_text(const std::string& axis, const std::string& rays, const std::string& primitive) {
    return "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n[axis]\nname = \"x\"\nspacing = "
           "\"every_float\"\n" +
           axis + "\n" + rays + primitive + "\n";
}
std::string ray(const std::string& name, const std::string& origin, const std::string& direction) {
    return "[[ray]]\nname = \"" + name + "\"\norigin = [" + origin + "]\ndirection = [" + direction + "]\n";
}
const std::string unit_sphere = "[sphere]\ncentre = [0, 0, 0]\nradius = 1";
const std::string cube = "[box]\nlo = [-1, -1, -1]\nhi = [1, 1, 1]";

/// One form at one float, without packs.
struct SingleRays {
    Outcome outcome;
    double ulps = truth::missing, padding = 0;
};

SingleRays try_alone(const ExhaustiveFile& file, std::size_t ray, const TestedForm& row, float value) {
    const Ray<float> there = file.ray_at(ray, value);
    const auto wide = [](const Vec<float>& v) { return Vec<double>(v.x, v.y, v.z); };
    const Ray<double> given{wide(there.origin), wide(there.direction)};
    const Primitive<float> narrow = file.primitive_at(value);
    const Primitive<double> primitive = convert_numbers(narrow, [](float x) { return static_cast<double>(x); });
    const auto end = static_cast<double>(file.rays[ray].tmax);
    const truth::Truth t = truth::find_truth(given, primitive, {}, row.convention(), {.tmax = end});
    const bool unit = row.form->info->direction == intersect::Direction::unit;
    const Vec<double> d = unit ? truth::unit_direction(given.direction, binary32) : given.direction;
    const auto answer = evaluate_alone(row, {given.origin, d}, primitive, end);
    SingleRays found{answer::classify(t.decision, answer.has_value(), answer.value_or(0))};
    if (found.outcome == Outcome::agree_hit) found.ulps = truth::ulp_error(*answer, unit ? t.distance : t.t, binary32);
    if (found.outcome == Outcome::false_miss && narrow.is<Box>())
        found.padding = measure::metric::padding(there, narrow.box());
    return found;
}

/// Compares everything except the worst float, since another may be next to it, and the errors between.
void check_same(const sweep::FloatTally& packs, const sweep::FloatTally& alone) {
    CHECK(packs.outcomes == alone.outcomes);
    CHECK(packs.first_wrong == alone.first_wrong);
    CHECK(packs.last_wrong == alone.last_wrong);
    CHECK(packs.first_floats == alone.first_floats);
    CHECK(packs.padding == alone.padding);
    REQUIRE(packs.worst.has_value() == alone.worst.has_value());
    if (!alone.worst) return;
    const double worst = std::fabs(alone.worst->ulps), found = std::fabs(packs.worst->ulps);
    CHECK(found <= worst);
    CHECK(packs.error_bound >= worst);
    CHECK((worst == found || worst <= found + 0x1p-7));
    if (packs.error_bound < found + 0x1p-19 * std::max(found, 1.0))
        CHECK((worst == found || worst <= packs.error_bound));
}

sweep::ExhaustiveRequest request_of(const ExhaustiveFile& file, std::vector<TestedForm> tested_forms) {
    return {.sweep = file, .tested_forms = std::move(tested_forms)};
}

sweep::ExhaustiveState run(const sweep::ExhaustiveRequest& request) {
    sweep::ExhaustiveState state;
    sweep::run_exhaustive(request, state);
    return state;
}

/// Number of floats compared, and number of wrong rows.
struct Comparison {
    std::uint64_t floats = 0, wrong = 0;
};

Comparison compare(const std::string& text, const std::vector<TestedForm>& tested_forms) {
    const TextFile written(text);
    const ExhaustiveFile file(written.path(), LOSTBITS_DATA_DIR);
    const auto request = request_of(file, tested_forms);
    const auto state = run(request);
    const auto binades = sweep::split_into_binades(file);
    Comparison compared;
    for (std::size_t b = 0; b < binades.size(); ++b) {
        for (std::size_t r = 0; r < file.rays.size(); ++r) {
            for (std::size_t k = 0; k < tested_forms.size(); ++k) {
                sweep::FloatTally alone;
                for (std::uint64_t i = 0; i < binades[b].floats.size(); ++i) {
                    const std::uint32_t place = binades[b].floats.at(i);
                    const SingleRays at = try_alone(file, r, tested_forms[k], float_at(place));
                    alone.add(place, at.outcome, at.ulps);
                    if (at.padding > (alone.padding ? alone.padding->u : 0)) alone.padding = {place, at.padding};
                }
                const sweep::FloatTally& packs = state.tallies[request.tally_index(b, r, k)];
                CAPTURE(tested_forms[k].form->info->name, file.rays[r].name, binades[b].binade.name());
                check_same(packs, alone);
                compared.floats += alone.float_count();
                compared.wrong += alone.wrong_count() > 0;
            }
        }
    }
    return compared;
}

}  // namespace

TEST_CASE("every sphere form: sweeps over every float agree with single floats in distance, direction and radius") {
    const auto rows = all_rows(Shape::sphere, {"f32"});
    const std::string look = ray("half", "0.5, 0.25, 4200", "0, 0, -1") + ray("off", "1, 0.125, 4200", "0.25, 0, -1.5");
    Comparison all;
    const auto with = [&](const std::string& axis, const std::string& rays) {
        const Comparison some = compare(sweep_text(axis, rays, unit_sphere), rows);
        all.floats += some.floats;
        all.wrong += some.wrong;
    };
    with("set = \"ray.origin.z\"\nfrom = \"0x1.fffep11\"\nto = \"0x1.0001p12\"", look);
    with("set = \"ray.origin.x\"\nfrom = \"0x1.ffff8p-1\"\nto = \"0x1.00002p0\"", look);
    with("set = [\"ray.origin.x\", \"ray.origin.y\", \"ray.origin.z\"]\nfrom = \"0x1.0001p10\"\nto = \"0x1p10\"",
         ray("diagonal", "0, 0, 0", "-1, -1, -1"));
    with("set = \"ray.direction.x\"\nfrom = \"-0x1p-145\"\nto = \"0x1p-145\"", look);
    with("set = \"ray.direction.z\"\nfrom = \"-0x1p0\"\nto = \"-0x1.0001p0\"",
         ray("near", "0.5, 0.25, 3", "0, 0.125, 0"));
    with("set = \"sphere.radius\"\nfrom = \"0x1.0001p-1\"\nto = \"0x1p-1\"", look + ray("at", "0.5, 0, 3", "0, 0, -1"));
    with("set = [\"sphere.centre.y\", \"ray.origin.y\"]\nfrom = \"0x1p3\"\nto = \"0x1.0001p3\"", look);
    CHECK(all.floats > 30000);
    CHECK(all.wrong > 20);
}

TEST_CASE("every cylinder form: sweeps over more than one chunk of radii agree with single floats") {
    // The line passes 6144 floats in: 4096 are a chunk.
    const Comparison all = compare(sweep_text("set = \"cylinder.radius\"\nfrom = \"0x1p-1\"\nto = \"0x1.0041p-1\"",
                                              ray("beside", "-4, \"0x1.003p-1\", 0.25", "1, 0, 0"),
                                              "[cylinder]\nbase = [0, 0, -1]\ntop = [0, 0, 1]\nradius = 1"),
                                   all_rows(Shape::cylinder, {"f32"}));
    CHECK(all.floats > 40000);
}

TEST_CASE("every box form: sweeps over special values and the boundary agree with single floats") {
    const auto rows = all_rows(Shape::box, {"f32"});
    const std::string rays = ray("over", "0.5, 0.25, 4", "0, 0, -1") + ray("face", "1, 0.25, 4", "-0.0, 0, -1") +
                             ray("end", "0.5, -1, 4", "0.25, 0, -1") + "tmax = 3\n" +
                             ray("before", "0.5, 0.25, 4", "0.25, 0, -1") + "tmax = 2\n";
    Comparison all;
    const auto with = [&](const std::string& axis) {
        const Comparison some = compare(sweep_text(axis, rays, cube), rows);
        all.floats += some.floats;
        all.wrong += some.wrong;
    };
    with("set = \"ray.direction.x\"\nfrom = \"-0x1p-140\"\nto = \"0x1p-140\"");
    with("set = \"ray.direction.x\"\nfrom = \"0x1.fff8p-3\"\nto = \"0x1.0004p-2\"");
    with("set = \"ray.origin.x\"\nfrom = \"-0x1.0002p0\"\nto = \"-0x1.fffcp-1\"");
    with("set = \"box.hi.x\"\nfrom = \"0x1.0002p0\"\nto = \"0x1.fffcp-1\"");
    with("set = [\"box.hi.x\", \"ray.origin.x\"]\nfrom = \"0x1.0002p0\"\nto = \"0x1.fffcp-1\"");
    CHECK(all.floats > 50000);
    CHECK(all.wrong > 10);
}

TEST_CASE("all bit patterns: every float is counted, and infinities, NaNs and zeros have rows of their own") {
    const TextFile written(
        sweep_text("set = \"ray.direction.x\"\nall = true", ray("over", "0.5, 0.25, 4", "0, 0, -1"), cube));
    const ExhaustiveFile file(written.path(), LOSTBITS_DATA_DIR);
    const auto binades = sweep::split_into_binades(file);
    CHECK(binades.size() == 516);
    CHECK(std::accumulate(binades.begin(), binades.end(), std::uint64_t{0}, [](std::uint64_t sum, const auto& b) {
              return sum + b.floats.size();
          }) == file.float_count());
    const auto request = request_of(file, {row("box.signs", "f32"), row("box.baseline", "f32")});
    for (const float x : {0.0F, -0.0F, 1e-45F, HUGE_VALF, -HUGE_VALF, std::nanf("")}) {
        for (std::size_t k = 0; k < request.tested_forms.size(); ++k) {
            const auto there = sweep::answer_at(request, 0, k, index_of(x));
            CHECK(there.outcome == try_alone(file, 0, request.tested_forms[k], x).outcome);
        }
    }
}

TEST_CASE("every float of a binade from radius 4096 (a part in short tests) agrees with single floats") {
    const std::string to = test::is_long() ? "0x1.fffffep12" : "0x1.07fffep12";
    const auto text = sweep_text("set = \"ray.origin.z\"\nfrom = 4096\nto = \"" + to + "\"",
                                 ray("half", "0.5, 0.25, 0", "0, 0, -1"), unit_sphere);
    const Comparison compared = compare(text, {row("sphere.schoolbook", "f32")});
    CHECK(compared.floats == (test::is_long() ? 1 << 23 : 1 << 18));
}

TEST_CASE("the padding that suffices for every float is that of the slabs, also behind a box") {
    // The ray that separates the slabs further than any other, at the floats around its origin.
    const ExhaustiveFile boxes(std::filesystem::path(LOSTBITS_DATA_DIR) / "sweeps/exhaustive-padding-origin.toml",
                               LOSTBITS_DATA_DIR);
    const ExhaustiveFile triangles(
        std::filesystem::path(LOSTBITS_DATA_DIR) / "sweeps/exhaustive-behind-box-origin.toml", LOSTBITS_DATA_DIR);
    const auto most = [](ExhaustiveFile file, std::size_t ray, const intersect::table::Intersector& form) {
        file.narrow(Real(-0x1.0008p-24), Real(-0x1.fff0p-25), {});
        file.rays = {file.rays[ray]};
        const auto request = request_of(file, {{&form, *find_format("f32")}});
        const auto found = sweep::collect_findings(request, run(request)).front().tally;
        return sweep::max_padding(request.tested_forms[0], found);
    };
    const auto form = [](std::string_view name) -> const intersect::table::Intersector& {
        return *std::ranges::find(intersect::table::catalogue(), name, [](const auto& row) { return row.info->name; });
    };
    const double without = most(boxes, 0, form("box.signs"));
    CHECK(without > 5.99);
    CHECK(without < 5.9913);
    CHECK(most(boxes, 0, form("box.max_mult")) > 4);
    CHECK(most(boxes, 0, form("box.pbrt_padded")) == 0);
    CHECK(most(boxes, 2, form("box.signs")) == 0);
    const auto& outward = intersect::bounding_box::default_box_method();
    CHECK(most(triangles, 0, boxed_form(outward, form("box.signs"), form("triangle.filtered"))) > 5.99);
    CHECK(most(triangles, 0, boxed_form(outward, form("box.embree_robust"), form("triangle.filtered"))) == 0);
    CHECK(std::isnan(most(triangles, 0, form("triangle.filtered"))));
}

}  // namespace test_exhaustive
