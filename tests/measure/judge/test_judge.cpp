// The answers in a file measure the same as the form that gave them. Rays with their own primitives have the truth of
// each such ray alone.
#include "measure/judge/judge.hpp"

#include <cmath>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/answer/answers.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/judge/files_of_answers.hpp"
#include "measure/judge/worst_rays.hpp"
#include "measure/rows.hpp"
#include "measure/seeded.hpp"
#include "measure/truth/lost_bits.hpp"
#include "scene/file/march_table.hpp"
#include "scene/ray_file/late_ray_file.hpp"
#include "scene/ray_file/ray_file_writer.hpp"
#include "scene/rays/stored_mesh.hpp"

namespace test_judge {
using namespace lostbits;
using namespace lostbits::measure;
using judge::JudgeRequest, judge::JudgeResult;
using scene::test::Columns, test::Seeded;
using test::add_answers, test::all_metrics, test::make_ray_columns, test::require_same;

namespace {

/// Judges the answers of these forms as a file, and compares with a map of the scene.
void hold_map_and_judge(const char* scene_id, std::initializer_list<const char*> forms, const char* format) {
    const auto scene = test::scene_named(scene_id, std::pair{48, 40});
    const std::vector<Primitive<double>> primitives = scene::rays::make_shared_primitives(scene);
    for (const char* name : forms) {
        INFO(scene_id << ": " << name);
        const evaluate::TestedForm row = test::row(name, format);
        const auto expected = evaluate::run_map({.scene = &scene, .tested_forms = {row}, .metrics = all_metrics});

        const scene::rays::RayBlock rays = scene::rays::make_shared_rays(scene, 0, scene.height);
        std::optional<intersect::MarchConstants<double>> march;
        if (scene.march) march = scene::file::round_march(*scene.march, binary32);
        const truth::Band band(scene::rays::RayGroup{rays, primitives, march});
        const auto answers = answer::evaluate(
            *row.form, band.inputs(row.format, {.unit_rays = row.form->info->direction == intersect::Direction::unit}));
        Columns columns = make_ray_columns(rays);
        add_answers(columns, answers);
        columns.add("object", {answers.primitive.begin(), answers.primitive.end()});
        const scene::test::ScratchRayFile file("a.bin", scene::test::to_bytes<double>(columns));
        const auto ray_file = scene::ray_file::open_ray_file(
            file.path(),
            {.columns = columns.joined_names(":f64"), .format = row.format, .primitive = primitives.front().shape});
        const judge::FileForm form("a", primitives.front().shape, *row.form->info);
        const JudgeResult result = judge::run_judge(
            *ray_file,
            {.primitives = scene::rays::make_stored_primitives_beside_mesh(scene, row.format.parameters),
             .mesh = scene::rays::make_stored_mesh(scene, row.format.parameters),
             .march = march,
             .tested_forms = {{&form.form(), row.format}, row},
             .file_answers_form = &form.form(),
             .metrics = all_metrics,
             .picture = std::pair{scene.width, scene.height}},
            {});
        CHECK(result.rounded_count == 0);
        // A file does not contain what its intersector claims about the other triangles of a mesh.
        if (!scene.mesh) require_same(result.summaries[0], expected[0]);
        require_same(result.summaries[1], expected[0]);
        CHECK(expected[0].outcomes[0] > 100);
    }
}

/// Keeps the results of the first row.
judge::ShowJudged kept_in(judge::WorstRays& worst) {
    return [&worst](std::size_t row, const scene::ray_file::Chunk& chunk, const evaluate::BandResult& result) {
        if (row == 0) worst.add_rays(chunk.first, result);
    };
}

/// Rays aimed near spheres or boxes, each with its own.
scene::rays::RayGroup random_pairs(Shape shape, int count, std::uint64_t seed) {
    Seeded random(seed);
    const auto any = [&](double size) {
        return static_cast<double>(static_cast<float>(size * (2 * 0x1p-53 * static_cast<double>(random.bits(53)) - 1)));
    };
    scene::rays::RayGroup group;
    for (int i = 0; i < count; ++i) {
        Primitive<double> primitive;
        primitive.shape = shape;
        for (int k = 0; k < 3; ++k) primitive.numbers[k] = any(4);
        for (std::size_t k = 3; k < primitive.shape_numbers().size(); ++k) {
            const double size = std::fabs(any(2)) + 0x1p-10;
            primitive.numbers[k] = shape == Shape::sphere ? size : static_cast<float>(primitive.numbers[k - 3] + size);
        }
        const Vec<double> o(any(10), any(10), any(10));
        Vec<double> d;
        for (int k = 0; k < 3; ++k) d[k] = static_cast<float>(primitive.numbers[k] + any(1.2) - o[k]);
        if (random.index(8) == 0) d[random.index(3)] = 0;
        if (d.x == 0 && d.y == 0 && d.z == 0) d.x = 1;
        group.rays.push({o, d});
        group.primitives.push_back(primitive);
        if (shape == Shape::box) group.rays.tmax.push_back(random.index(3) == 0 ? std::fabs(any(2)) : HUGE_VAL);
    }
    group.rays.width = count;
    group.rays.y1 = 1;
    group.is_paired = true;
    return group;
}

/// Rays and the spheres that they are aimed at.
Columns columns_of_pairs(const scene::rays::RayGroup& group) {
    Columns columns = make_ray_columns(group.rays);
    const char* const names[] = {"cx", "cy", "cz", "radius"};
    for (std::size_t k = 0; k < 4; ++k) {
        std::vector<double> column;
        for (const Primitive<double>& primitive : group.primitives) column.push_back(primitive.numbers[k]);
        columns.add(names[k], column);
    }
    return columns;
}

}  // namespace

TEST_CASE("the answers of a form in a file measure as the form does in a map") {
    hold_map_and_judge("grazing", {"sphere.unified"}, "f64");
    hold_map_and_judge("near-benign", {"sphere.schoolbook", "sphere.press", "sphere.unit_half_b"}, "f32");
    hold_map_and_judge("rtg-fig-7-3-2000", {"sphere.schoolbook", "sphere.expanded"}, "f32");
    hold_map_and_judge("raycast-course", {"sphere.schoolbook"}, "f32");  // several spheres
    hold_map_and_judge("sdf-union", {"sdf.sphere_trace", "sphere.schoolbook+box.signs"}, "f32");
    hold_map_and_judge("box-offset", {"box.signs", "box.exclusive"}, "f32");
    // Cracks, double hits, wrong neighbours and ties.
    hold_map_and_judge("mesh-grid-vertices", {"triangle.undivided", "triangle.havel_herout"}, "f32");
    hold_map_and_judge("mesh-sheets-far", {"triangle.moller_trumbore"}, "f32");
}

TEST_CASE("primitives of any kinds that are hit at the same t share the hit") {
    // The ray goes down along z from 9. All but the last are met at z = 2, which is t = 7.
    const std::vector<Primitive<double>> primitives{Sphere<double>{{0, 0, 0}, 2},
                                                    Box<double>{{-1, -1, -1}, {1, 1, 2}},
                                                    Triangle<double>{{-1, -1, 2}, {2, -1, 2}, {-1, 2, 2}},
                                                    Sphere<double>{{0, 0, 1}, 1},
                                                    Sphere<double>{{0, 0, 0}, 2},
                                                    Cylinder<double>{{0, 0, -3}, {0, 0, 2}, 1},
                                                    Disc<double>{{0, 0, 2}, {0, 0, 1}, 1, 0},
                                                    Plane<double>{{5, 5, 2}, {0, 0, 3}},
                                                    Capsule<double>{{0, 0, -1}, {0, 0, 1}, 1},
                                                    Ellipsoid<double>{{0, 0, 0}, {1, 3, 2}},
                                                    Sphere<double>{{0, 0, 0}, 1.9999999}};
    const auto last = static_cast<double>(primitives.size() - 1);
    Columns columns;
    for (const char* const name : {"ox", "oy", "dx", "dy"})
        columns.add(name, std::vector<double>(primitives.size(), 0));
    columns.add("oz", std::vector<double>(primitives.size(), 9));
    columns.add("dz", std::vector<double>(primitives.size(), -1));
    columns.add("t", std::vector<double>(primitives.size(), 7));
    std::vector<double> objects;
    for (double k = 0; k <= last; ++k) objects.push_back(k);
    columns.add("object", objects);
    const scene::test::ScratchRayFile file("a.bin", scene::test::to_bytes<double>(columns));
    const auto open = [&] {
        return scene::ray_file::open_ray_file(
            file.path(), {.columns = columns.joined_names(":f64"), .primitive = primitives.front().shape});
    };
    const judge::FileForm form("a", Shape::sphere, {});
    JudgeRequest request{.primitives = primitives, .file_answers_form = &form.form(), .metrics = all_metrics};
    request.tested_forms = {{&form.form(), *find_format("f64")}};
    const auto outcomes_are_right = [&](std::size_t, const scene::ray_file::Chunk&,
                                        const evaluate::BandResult& result) {
        for (std::size_t i = 0; i < primitives.size(); ++i) {
            INFO(i);
            CHECK(result.outcomes[i] ==
                  (static_cast<double>(i) < last ? answer::Outcome::agree_hit : answer::Outcome::wrong_primitive));
        }
    };
    judge::run_judge(*open(), request, outcomes_are_right);

    // A primitive that does not exist is refused, at its place.
    request.primitives.pop_back();
    CHECK_THROWS_WITH(judge::run_judge(*open(), request, {}),
                      Catch::Contains("record 10") && Catch::Contains("object is 10; there are 10 primitives, numbered "
                                                                      "from 0 to 9"));
}

TEST_CASE("a ray with its own primitive has the truth and the answers of that ray and primitive alone") {
    for (const Shape shape : {Shape::sphere, Shape::box}) {
        const auto count = static_cast<int>(lostbits::test::draws(50000));
        const scene::rays::RayGroup group = random_pairs(shape, count, 3);
        const truth::Band band(group);
        std::size_t hits = 0;
        for (const intersect::Convention convention :
             {intersect::Convention{}, intersect::Convention{intersect::Touching::miss}}) {
            for (std::size_t i = 0; i < group.rays.size(); ++i) {
                const truth::Truth alone =
                    truth::find_truth(group.rays[i], group.primitives[i], {}, convention, group.rays.range(i));
                const truth::Truth& found = band.truth(i, convention);
                REQUIRE(found.decision == alone.decision);
                REQUIRE(found.primitive == (alone.is_hit() ? static_cast<int>(i) : -1));
                if (alone.is_hit()) REQUIRE((found.t.hi == alone.t.hi && found.t.exponent == alone.t.exponent));
                hits += alone.is_hit();
            }
        }
        CHECK(hits > group.rays.size() / 5);
        for (const char* format : {"f32", "f64", "bf16"}) {
            const auto inputs = band.inputs(*find_format(format), {.unit_rays = true});
            const std::size_t few = std::string(format) == "bf16" ? 500 : 5000;
            for (const evaluate::TestedForm& row : test::all_rows(shape, {format})) {
                INFO(row.form->info->name << " in " << format);
                const auto together = answer::evaluate(*row.form, inputs);
                for (std::size_t i = 0; i < few; i += 1 + i / 20) {
                    scene::rays::RayGroup one = scene::rays::make_group(group.rays[i]);
                    if (!group.rays.tmax.empty()) one.rays.tmax = {group.rays.tmax[i]};
                    one.primitives = {group.primitives[i]};
                    const truth::Band alone(one);
                    const auto answers = answer::evaluate(*row.form, alone.inputs(row.format, {.unit_rays = true}));
                    REQUIRE(answers.hit[0] == together.hit[i]);
                    REQUIRE((answers.t[0] == together.t[i] || std::isnan(answers.t[0])));
                    REQUIRE(together.primitive[i] == (together.hit[i] != 0 ? static_cast<int>(i) : -1));
                }
            }
        }
    }
}

TEST_CASE("rays beyond the first 2^32 of a file keep their indices") {
    const scene::rays::RayGroup group = random_pairs(Shape::sphere, 2000, 8);
    const evaluate::TestedForm row = test::row("sphere.expanded", "f32");
    Columns columns = columns_of_pairs(group);
    const scene::test::ScratchRayFile file("a.bin", scene::test::to_bytes<float>(columns));
    const auto judged = [&](bool late, judge::WorstRays& worst) {
        auto ray_file = scene::ray_file::open_ray_file(file.path(), {.columns = columns.joined_names(":f32")});
        if (late) ray_file = std::make_unique<scene::test::LateRayFile>(std::move(ray_file));
        return judge::run_judge(*ray_file, {.tested_forms = {row}, .metrics = all_metrics}, kept_in(worst));
    };
    judge::WorstRays first(5, 1), later(5, 1);
    const JudgeResult at_start = judged(false, first), beyond = judged(true, later);
    const evaluate::WorstRay &a = at_start.summaries[0].worst, &b = beyond.summaries[0].worst;
    REQUIRE(a.x >= 0);
    CHECK(b.x - a.x == std::int64_t{scene::test::LateRayFile::before});
    CHECK(a.primitive_index == a.x);
    CHECK(b.primitive_index == b.x);
    CHECK(b.ulps == a.ulps);
    const auto noted = first.all(), noted_later = later.all();
    REQUIRE(noted.size() >= 5);
    REQUIRE(noted_later.size() == noted.size());
    for (std::size_t k = 0; k < noted.size(); ++k)
        CHECK(noted_later[k].ray_index == noted[k].ray_index + scene::test::LateRayFile::before);
}

TEST_CASE("answers in a file are judged like those of the form, and the worst rays are the worst of all") {
    const scene::rays::RayGroup group = random_pairs(Shape::sphere, 100000, 5);
    const evaluate::TestedForm row = test::row("sphere.schoolbook", "f32");
    Columns columns = columns_of_pairs(group);
    const truth::Band band(group);
    const auto inputs = band.inputs(row.format, {});
    const auto answers = answer::evaluate(*row.form, inputs);
    add_answers(columns, answers);
    const scene::test::ScratchRayFile file("a.bin", scene::test::to_bytes<float>(columns));

    const test::Threads limit(5);  // for four pieces
    const auto ray_file = scene::ray_file::open_ray_file(file.path(), {.columns = columns.joined_names(":f32")});
    const judge::FileForm form("a", Shape::sphere, *row.form->info);
    judge::WorstRays worst(10, 1);
    const JudgeResult result = judge::run_judge(
        *ray_file,
        {.tested_forms = {{&form.form(), row.format}, row}, .file_answers_form = &form.form(), .metrics = all_metrics},
        kept_in(worst));
    CHECK(result.ray_count == group.rays.size());
    CHECK(result.nonzero_answer_count == result.float_answer_count);
    require_same(result.summaries[1], result.summaries[0]);
    const auto noted = worst.all();
    // One by one.
    std::vector<double> errors;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < group.rays.size(); ++i) {
        const truth::Truth& truth = band.truth(i, {});
        const bool hit = answers.hit[i] != 0;
        wrong += hit != truth.is_hit();
        if (hit && truth.is_hit()) errors.push_back(std::fabs(truth::ulp_error(answers.t[i], truth.t, binary32)));
    }
    std::ranges::sort(errors, std::greater<>());
    const auto& s = result.summaries[0];
    CHECK(s.count(answer::Outcome::false_hit) + s.count(answer::Outcome::false_miss) == wrong);
    CHECK(s.count(answer::Outcome::agree_hit) == errors.size());
    REQUIRE(noted.size() >= 10);
    for (std::size_t k = 0; k < noted.size(); ++k) {
        if (k < 10) CHECK(std::fabs(noted[k].ulps) == Approx(errors[k]).epsilon(1e-9));
        const auto& given = *noted[k].ray_group;
        CHECK(given.rays.ox[0] == group.rays.ox[noted[k].ray_index]);
        CHECK(given.primitives.size() == 1);
        CHECK(given.primitives[0].numbers == group.primitives[noted[k].ray_index].numbers);
    }
    CHECK(s.worst.x == static_cast<int>(noted[0].ray_index));
    CHECK(s.worst.primitive_index == s.worst.x);
}

TEST_CASE("decisions without a t have outcomes and no errors") {
    const scene::rays::RayGroup group = random_pairs(Shape::sphere, 2000, 9);
    const truth::Band band(group);
    std::string text = "ox,oy,oz,dx,dy,dz,cx,cy,cz,radius,hit\n";
    std::uint64_t wrong = 0;
    for (std::size_t i = 0; i < group.rays.size(); ++i) {
        const Ray<double> ray = group.rays[i];
        for (const Vec<double>& v : {ray.origin, ray.direction})
            for (int k = 0; k < 3; ++k) text += output::file::decimal(v[k]) + ",";
        for (const double x : group.primitives[i].shape_numbers()) text += output::file::decimal(x) + ",";
        const bool lie = i % 10 == 3;
        wrong += lie;
        text += (band.truth(i, {}).is_hit() != lie) ? "1\n" : "0\n";
    }
    const scene::test::ScratchRayFile file("a.csv", text);
    const auto ray_file = scene::ray_file::open_ray_file(file.path(), {});
    intersect::Info decides;
    decides.roots = intersect::Roots::none;
    const judge::FileForm form("a b.c", Shape::sphere, decides);
    CHECK(form.form().info->name == "file.a_b_c");
    const auto s = std::move(judge::run_judge(*ray_file, {.tested_forms = {{&form.form(), ray_file->format()}},
                                                          .file_answers_form = &form.form(),
                                                          .metrics = all_metrics})
                                 .summaries.front());
    CHECK(s.count(answer::Outcome::false_hit) + s.count(answer::Outcome::false_miss) == wrong);
    CHECK(s.count(answer::Outcome::agree_hit) + s.count(answer::Outcome::false_miss) == s.true_hit_count);
    CHECK(s.count(answer::Outcome::not_a_number) == 0);
    for (const metric::Distribution& d : s.metrics) CHECK(d.count() == 0);
    CHECK(s.worst.x == -1);
}

TEST_CASE("the first of equal errors and the first of wrong decisions are kept") {
    std::string text = "ox,oy,oz,dx,dy,dz,hit,t\n";
    for (int i = 0; i < 30; ++i) text += i % 3 == 2 ? "0,0,-5,0,0,1,0,\n" : "0,0,-5,0,0,1,1,4.5\n";
    const scene::test::ScratchRayFile file("a.csv", text);
    const auto ray_file = scene::ray_file::open_ray_file(file.path(), {.primitive = Shape::sphere});
    const judge::FileForm form("a", Shape::sphere, intersect::Info{});
    judge::WorstRays worst(5, 1);
    judge::run_judge(*ray_file,
                     {.primitives = {Primitive<double>(Sphere<double>{{0, 0, 0}, 1})},
                      .tested_forms = {{&form.form(), ray_file->format()}},
                      .file_answers_form = &form.form(),
                      .metrics = all_metrics},
                     kept_in(worst));
    std::vector<std::uint64_t> places;
    for (const judge::ReportedRay& ray : worst.all()) places.push_back(ray.ray_index);
    CHECK(places == std::vector<std::uint64_t>{0, 1, 3, 4, 6, 2, 5, 8, 11, 14});
}

}  // namespace test_judge
