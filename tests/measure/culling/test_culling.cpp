// Culling changes nothing: answers and truths with an index, compared with brute force, for every form.
#include "catch.hpp"
#include "counts.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "scene/file/scene.hpp"
#include "scene/scene_text.hpp"

namespace lostbits::test::test_culling {

using intersect::Touching;
using measure::culling::SphereIndex;

namespace {

/// A flake and a large sphere below it, seen from `eye`.
scene::file::Scene flake_scene(int levels, const std::string& eye, const std::string& camera,
                               const std::string& inputs = "shared", int size = 20) {
    const scene::test::Scratch folder;
    const std::string text = R"(schema = "lostbits-scene/1"
title = "A test"
inputs = ")" + inputs + R"("
size = [)" + std::to_string(size) +
                             ", " + std::to_string(size) + R"(]
[camera]
eye = )" + eye + R"(
look_at = [0, 0, 0]
)" + camera + R"(
[sphereflake]
levels = )" + std::to_string(levels) +
                             R"(
axis = [0.2, 0.9, 0.4]
[[sphere]]
centre = [0, -1001.5, 0]
radius = 1000
)";
    return scene::file::load_scene(folder.write("flake.toml", text)).front();
}

struct Counts {
    std::size_t hits = 0, few = 0, rays = 0;  ///< few: rays with candidates at most a thirty-second of all
};

/// Every sphere form in some formats with and without the index.
Counts compare(const scene::file::Scene& scene, std::initializer_list<const char*> formats) {
    measure::culling::Culler culler(scene);
    const measure::truth::Band quick(scene, 0, scene.height, {}, &culler), slow(scene, 0, scene.height);
    REQUIRE(culler.index_for_truth() != nullptr);
    Counts counts;
    for (std::size_t i = 0; i < quick.pixel_count(); ++i) {
        for (const Touching touching : {Touching::hit, Touching::miss}) {
            const measure::truth::Truth &a = quick.truth(i, touching), &b = slow.truth(i, touching);
            CHECK(a.decision == b.decision);
            CHECK(a.primitive == b.primitive);
            CHECK(a.touches == b.touches);
            if (a.is_hit() && b.is_hit()) CHECK(compare(a.t, b.t) == 0);
        }
    }
    for (const char* name : formats) {
        const Format format = *find_format(name);
        const measure::truth::FormatInputs in = quick.inputs(format, {.unit_rays = true, .stored_truth = true}),
                                           all = slow.inputs(format, {.unit_rays = true, .stored_truth = true});
        CHECK(all.index == nullptr);
        for (std::size_t i = 0; i < in.stored_truth.size(); ++i)
            CHECK(in.stored_truth[i].primitive == all.stored_truth[i].primitive);
        std::vector<std::uint32_t> found;
        for (std::size_t i = 0; in.index && i < in.rays.size(); ++i, ++counts.rays) {
            in.index->find_candidates(in.rays[i], found);
            counts.few += found.size() <= std::max<std::size_t>(16, in.primitives.size() / 32);
        }
        if (!in.index) continue;  // both test every sphere
        for (const intersect::table::Intersector& form : intersect::table::intersectors(Shape::sphere)) {
            if (!form.exists_in(format)) continue;
            const measure::answer::Answers got = measure::answer::evaluate(form, in),
                                           want = measure::answer::evaluate(form, all);
            INFO(form.info->name << " in " << name);
            CHECK(got.hit == want.hit);
            CHECK(got.primitive == want.primitive);
            std::size_t different = 0;
            for (std::size_t i = 0; i < got.t.size(); ++i)
                different += !(got.t[i] == want.t[i] || (std::isnan(got.t[i]) && std::isnan(want.t[i])));
            CHECK(different == 0);
            for (const auto h : want.hit) counts.hits += h;
        }
    }
    return counts;
}

const std::string pinhole = "kind = \"pinhole\"\nfov_deg = ";

}  // namespace

TEST_CASE("an index of many spheres changes no answer: near", "[measure][culling]") {
    // Arithmetic bit by bit takes a minute with 821 spheres, so the short tests have 92.
    CHECK(compare(flake_scene(test::is_long() ? 3 : 2, "[2.1, 1.3, 1.7]", pinhole + "60"), {"bf16"}).hits > 1000);
    const auto scene = flake_scene(3, "[2.1, 1.3, 1.7]", pinhole + "60");
    if (test::is_long()) compare(scene, {"p20", "fp16"});
    const Counts c = compare(scene, {"f32", "f64"});
    CHECK(c.hits > 1000);
    CHECK(c.few > c.rays / 3);
}

TEST_CASE("an index of many spheres changes no answer: far, where rounding turns misses into hits",
          "[measure][culling]") {
    CHECK(compare(flake_scene(test::is_long() ? 3 : 2, "[210, 130, 170]", pinhole + "0.66"), {"p30"}).hits > 1000);
    const Counts c = compare(flake_scene(3, "[210, 130, 170]", pinhole + "0.66"), {"f32", "f64"});
    CHECK(c.hits > 1000);
    CHECK(c.few > c.rays / 3);
    compare(flake_scene(2, "[2100, 1300, 1700]", pinhole + "0.066"), {"f32", "p40"});
}

TEST_CASE("an index of many spheres changes no answer: from inside, along the ground, parallel, of its own inputs",
          "[measure][culling]") {
    compare(flake_scene(3, "[0.1, 0.05, 0.3]", pinhole + "120"), {"f32", "f64"});
    compare(flake_scene(3, "[9, -1.4375, 7]", pinhole + "50"), {"f32", "f64"});
    compare(flake_scene(3, "[30, 20, 10]", "kind = \"orthographic\"\nwidth = 4"), {"f32", "f64"});
    compare(flake_scene(2, "[2.1, 1.3, 1.7]", pinhole + "60\nnormalise = false", "own"), {"f32", "f64", "bf16"});
}

TEST_CASE("an index of many spheres changes no answer: of several pages", "[measure][culling]") {
    // 66,431 spheres on nine pages.
    const Counts c = compare(flake_scene(5, "[2.1, 1.3, 1.7]", pinhole + "60", "shared", 5), {"f32"});
    CHECK(c.hits > 100);
    CHECK(c.few == c.rays);
}

TEST_CASE("blocks of candidates hold every sphere that the line comes near", "[measure][culling]") {
    const scene::file::Scene scene = flake_scene(5, "[2.1, 1.3, 1.7]", pinhole + "60");
    measure::culling::Culler culler(scene);
    const auto& index = dynamic_cast<const SphereIndex&>(*culler.index_for_truth());
    REQUIRE(index.page_count() == 9);
    const auto rays = scene::rays::make_shared_rays(scene, 0, scene.height);
    std::vector<std::uint32_t> found;
    std::vector<SphereIndex::Run> runs;
    for (std::size_t p = 0; p < rays.size(); p += 37) {
        const Ray<double> ray = rays[p];
        index.find_candidates(ray, found);
        CHECK(std::ranges::is_sorted(found));
        std::vector<bool> in_blocks(culler.shared_primitives().size());
        for (std::size_t page = 0; page < index.page_count(); ++page) {
            index.find_runs(SphereIndex::UnitRay(ray), page, SphereIndex::Grain::blocks, runs);
            for (const auto& [begin, end] : runs)
                for (std::size_t i = begin; i < end; ++i) in_blocks[i] = true;
        }
        std::size_t missed = 0, surplus = 0;
        for (std::uint32_t i = 0; i < culler.shared_primitives().size(); ++i) {
            const Sphere<double> s = culler.shared_primitives()[i].sphere();
            const Vec<double> m = cross<double>(s.centre - ray.origin, ray.direction);
            const double l2 = square(m) / square(ray.direction), r2 = s.radius * s.radius;
            const bool ahead = lostbits::dot(s.centre - ray.origin, ray.direction) > 0,
                       is_found = std::ranges::count(found, i) > 0;
            missed += l2 <= r2 && ahead && !(is_found && in_blocks[i]);
            surplus += is_found && l2 > r2 * 1.0001 + 1e-9;
        }
        CHECK(missed == 0);
        CHECK(surplus == 0);
    }
}

TEST_CASE("an index is not built where squares overflow, spheres are few or primitives are not spheres",
          "[measure][culling]") {
    const measure::culling::RayBounds bounds{3, 1, 1};
    std::vector<Primitive<double>> primitives;
    for (int i = 0; i < 100; ++i) primitives.emplace_back(Sphere<double>{{0.5 * i, 0, 0}, 0.25});
    const FloatFormat half = find_format("fp16")->parameters;
    CHECK(SphereIndex::make(primitives, bounds, &binary32) != nullptr);
    CHECK(SphereIndex::make(primitives, bounds, &binary64) != nullptr);
    CHECK(SphereIndex::make(primitives, bounds, &half) == nullptr);  // 64·50² > 65504
    CHECK(SphereIndex::make(std::vector(primitives.begin(), primitives.begin() + 63), bounds, &binary32) == nullptr);
    CHECK(SphereIndex::make(primitives, {0x1p70, 1, 1}, &binary32) == nullptr);
    CHECK(SphereIndex::make(primitives, {3, 0x1p-70, 1}, &binary32) == nullptr);
    CHECK(SphereIndex::make(primitives, {3, 0, 1}, nullptr) == nullptr);
    CHECK(SphereIndex::make(primitives, {HUGE_VAL, 1, 1}, nullptr) == nullptr);
    primitives[7] = Box<double>{{0, 0, 0}, {1, 1, 1}};
    CHECK(SphereIndex::make(primitives, bounds, &binary64) == nullptr);
}

}  // namespace lostbits::test::test_culling
